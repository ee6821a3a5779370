"""docs/blocks.md is complete and true: every block has a component, every component a scene without code."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import BUILT_IN, ONLY_LOOKED_AT
from mimics_app.contracts.loop.haptic_objects import EffectKind, ShapeKind, SignalSource, SignalTarget
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.world.components.objects import HapticObject
from mimics_app.world.components.registry import component_types
from mimics_app.world.components.robot import Robot

PAGE = (root() / "docs" / "blocks.md").read_text(encoding="utf-8")
EXAMPLES = root() / "scenes" / "examples"

BLOCKS = {
    "4.2.2": ["direct kinematics"],
    "4.2.3": ["inverse kinematics"],
    "4.2.4": ["Jacobian matrix"],
    "4.2.5": ["joint space PD"],
    "4.2.6": ["world space PD"],
    "4.2.7": ["admittance control"],
    "4.2.8.3": ["sphere"],
    "4.2.8.4": ["cube"],
    "4.2.8.5": ["cylinder"],
    "4.2.8.6": ["wall (six)"],
    "4.2.9.3": ["sphere-sphere", "sphere-wall", "box-box", "box-wall", "sphere-box"],
    "4.2.10": ["tunnel"],
    "4.2.12": ["example task"],
}
"""Every block of D2.1 4.2.2-4.2.12 by its section."""

FIGURES = {11, 14, 15, 17, 18, 20, 21, 23, 24, 31, 33, 35, 37, 38, 40, 41, 42, 43, 44, 50}
"""Figures of block symbols and masks, but for the cube's mask (29), which has a table of its own."""

GROUPS = 5
"""Subsystems of the library (Figure 49)."""

MASK = 15
"""Parameters of the mask in 4.2.8.2."""

SCENES = sorted(EXAMPLES.glob("*.json"))


def table(heading: str) -> list[list[str]]:
    """Rows of the table under a heading, without its own head."""
    section = PAGE.split(f"## {heading}", 1)[1].split("\n## ", 1)[0]
    rows = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows[2:]]


def components_of(scene: str) -> set[str]:
    return {name for entity in load_checked_scene(EXAMPLES / f"{scene}.json").entities for name in entity.components}


def test_every_block_has_a_row():
    rows = table("Blocks")
    listed = {(row[2].split(",")[0], row[1]) for row in rows}
    assert listed == {(section, block) for section, blocks in BLOCKS.items() for block in blocks}
    assert len({row[0] for row in rows}) == GROUPS


def test_every_figure_of_a_block_is_named():
    named = {int(number) for row in table("Blocks") for number in re.findall(r"\d+", row[2].partition("Fig.")[2])}
    assert named == FIGURES


@pytest.mark.parametrize("row", [*table("Blocks"), *table("Beyond the library")], ids=lambda row: row[0] + " " + row[1])
def test_scene_of_a_row_uses_its_component(row):
    component, scene = (row[3], row[5]) if len(row) == 6 else (row[1], row[2])
    assert component.strip("`") in component_types()
    assert component.strip("`") in components_of(scene)


def test_fields_named_in_the_table_exist():
    for row in table("Blocks"):
        struct = component_types()[row[3].strip("`")]
        known = {field.encode_name for field in msgspec.structs.fields(struct)} | {"box", "sphere", "cylinder"}
        known |= {
            "connections",
            "size",
            "rounding",
            "radius",
            "length",
            "enabled",
            "position",
            "rotation",
            "tunnel_view",
        }
        assert set(re.findall(r"`(\w+)`", row[4])) <= known, row[1]


STATED = [
    (*re.fullmatch(r"`(\w+)\.(\w+)` (\w+)", row[0]).groups(), row[-1])  # type: ignore[union-attr]
    for row in table("Equations selected by a scene")
    if row[-1] and "." in row[0]
]


@pytest.mark.parametrize(("component", "field", "value", "scene"), STATED)
def test_scene_of_an_equation_selects_it(component: str, field: str, value: str, scene: str) -> None:
    """It states the choice, or has the default."""
    found = load_checked_scene(next(EXAMPLES.parent.rglob(f"{scene}.json"))).components(component_types()[component])
    assert value in {getattr(struct, field) for _, struct, _ in found}


def test_what_d2_1_prints_is_in_a_scene() -> None:
    printed = {("admittance", "form"), ("world_pd", "form"), ("tunnel", "frame"), ("haptic_object", "integrator")}
    assert printed <= {row[:2] for row in STATED if row[3] == "printed_equations"}


def test_mask_of_4_2_8_2_is_complete():
    rows = table("Mask of a haptic object")
    assert len(rows) == MASK
    fields = {field.encode_name for field in msgspec.structs.fields(HapticObject)}
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row[1])} - {"transform"}
    assert named <= fields
    described = json.dumps(msgspec.json.schema(HapticObject))
    for row in rows[:7] + rows[10:11] + rows[12:]:
        assert row[0].split(" of haptic")[0] in described, f"{row[0]}: the schema does not name it"


def test_a_scene_beside_the_examples_has_a_scenario_of_its_name_or_says_that_it_has_none():
    files = list((root() / "scenes").glob("*.json"))
    looked_at = {file.stem for file in files if json.loads(file.read_text()).get("scenario") == ONLY_LOOKED_AT}
    assert {file.stem for file in files} == looked_at | set(BUILT_IN)
    assert looked_at == {"avatar_gallery"}


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_examples_have_no_code_of_their_own(file):
    """No scenario is made for one of them: what plays it is found by its components, or it is only looked at."""
    scene = load_checked_scene(file)
    assert scene.scenario not in BUILT_IN
    assert scene.scenario == ONLY_LOOKED_AT or scene.has(Robot)


def test_every_example_stands_in_the_table():
    rows = [row[-1] for row in [*table("Blocks"), *table("Beyond the library")]]
    assert {file.stem for file in SCENES} - set(rows) == {"bisector_only"}, "a second tunnel"


def test_examples_cover_every_shape_effect_and_signal():
    """What the loop can do, some example does."""
    made = [objects_of_scene(load_checked_scene(file)).rows for file in SCENES]
    assert {kind for rows in made for kind in rows.shapes["kind"]} == set(ShapeKind)
    assert {kind for rows in made for kind in rows.effects["kind"]} == set(EffectKind)
    assert {source for rows in made for source in rows.wires["source"]} == set(SignalSource)
    assert {target for rows in made for target in rows.wires["target"]} == set(SignalTarget)


def test_a_module_among_the_component_types_registers_before_scenes_are_read(tmp_path: Path) -> None:
    """Nothing else names it."""
    planted = 'from mimics_app.world.components.registry import Component, component\n\n\n@component("planted")\n'
    (tmp_path / "planted.py").write_text(planted + "class Planted(Component, frozen=True):\n    share: float = 0.5\n")
    code = (
        "import sys; from mimics_app.world import components; components.__path__.append(sys.argv[1]);"
        "from mimics_app.world.files.scene.file import load_scene;"
        "from mimics_app.world.components.registry import component_types; assert 'planted' in component_types()"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], cwd=root(), check=True, timeout=120)
