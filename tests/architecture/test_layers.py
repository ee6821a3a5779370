"""The figure stays true: import-linter is green here, and red on each planted violation."""

from __future__ import annotations

import copy
import os
import re
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import grimp
import pytest
from importlinter.contracts.layers import LayersContract

from tests.architecture.sources import BUILDERS, PACKAGE, ROOT

PLANTED = {
    "one stage imports another": (
        "dsp/planted_stage.py",
        "from mimics_app.learning import planted_target\n",
        "Imports only go down",
    ),
    "a lower layer imports a higher one": ("maths/planted_low.py", "import mimics_app.world\n", "Imports only go down"),
    "touch imports picture": (
        "rendering/haptic/planted_picture.py",
        "import mimics_app.rendering.visual\n",
        "Touch, picture and sound",
    ),
    "OpenGL in a kernel": (
        "rendering/haptic/kernels/planted_gl.py",
        "import moderngl\n",
        "Kernels know only arrays",
    ),
    "OpenGL inside a function of the world": (
        "world/planted_gl.py",
        "def draw():\n    import moderngl\n    return moderngl\n",
        "OpenGL and windows",
    ),
    "a kernel that reaches JSON through maths": (
        "rendering/haptic/kernels/planted_reader.py",
        "import mimics_app.maths.planted_json\n",
        "Kernels know only arrays",
    ),
    "a room of the application knows the one above it": (
        "app/picture/planted_room.py",
        "import mimics_app.app.session.session\n",
        "Packages of the application",
    ),
    "a device knows the loop that plays it": (
        "rendering/haptic/devices/planted_device.py",
        "import mimics_app.rendering.haptic.loop\n",
        "Packages of touch",
    ),
    "a law knows the tick that uses it": (
        "rendering/haptic/kernels/friction.py",
        "import mimics_app.rendering.haptic.kernels.tick\n",
        "Kernels of touch",
    ),
    "a pass knows the stage that prepares it": (
        "rendering/visual/passes/planted_pass.py",
        "import mimics_app.rendering.visual.stages.world_stage\n",
        "Packages of the picture",
    ),
    "a table of the world knows scenes": (
        "world/graph/entity_ids.py",
        "import mimics_app.world.files.scene.scene\n",
        "Floors of the world",
    ),
    "a table of the world knows the world, for a type only": (
        "world/graph/levels.py",
        "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    import mimics_app.world.content.world\n",
        "Floors of the world",
    ),
    "a probe knows the chart it is drawn in": (
        "lab/haptic/planted_probe.py",
        "import mimics_app.lab.chart\n",
        "Packages of the laboratory",
    ),
    "a part of scenarios knows a scenario": (
        "scenarios/parts/planted_part.py",
        "import mimics_app.scenarios.city_walk\n",
        "Scenarios above their parts",
    ),
    "a session knows a probe of the laboratory": (
        "app/session/planted_lab.py",
        "def measure():\n    import mimics_app.lab.chart\n\n    return mimics_app.lab.chart\n",
        "No session reaches",
    ),
    "a session knows what made its models": (
        "app/session/planted_content.py",
        "import assets.builders.catalogue\n",
        "Only its command knows the builders",
    ),
    "a new module of touch nobody planned": ("rendering/haptic/planted_new.py", "", "Packages of touch"),
    "a new room nobody planned": ("attic/__init__.py", "", "Imports only go down"),
}
"""What is planted into one copy: module, its text, and the contract whose complaint names the module."""

TARGETS = {"learning/planted_target.py": "", "maths/planted_json.py": "import json\n"}
"""What planted modules import and nobody else has."""


Place = tuple[str, str]
"""A module below the package, and the module that it is made to import, both with dots."""


def _members(layer: str) -> list[str]:
    """Names in a layer of a contract, which may be in brackets where a container need not have them."""
    return [name.strip(" ()") for name in layer.split("|")]


def _faults_of(contract: dict[str, Any], package: Path) -> dict[str, Place]:
    """An import up, one sideways and one up for a type, each of which breaks this contract of layers."""
    (container,) = contract["containers"]
    folder = package.joinpath(*container.split(".")[1:])
    layers = [[name for name in _members(layer) if _modules_of(folder / name)] for layer in contract["layers"]]
    lowest, highest = layers[-1][0], layers[0][0]
    sideways = next((row for row in layers if len(row) > 1), [])
    faults = {"up": (lowest, highest), "for a type": (layers[-1][-1], highest)}
    if sideways:
        faults["sideways"] = sideways[0], sideways[1]
    return {
        what: (f"{container}.{_modules_of(folder / low)[-1]}", f"{container}.{_modules_of(folder / high)[0]}")
        for what, (low, high) in faults.items()
    }


def _modules_of(place: Path) -> list[str]:
    """Modules at a place that are no package, relative to the folder above it, with dots."""
    if place.with_suffix(".py").is_file():
        return [place.name]
    files = sorted(file for file in place.rglob("*.py") if file.name != "__init__.py")
    return [".".join(file.relative_to(place.parent).with_suffix("").parts) for file in files]


LAYERED = {
    contract["name"]: contract
    for contract in tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    if contract["type"] == "layers"
}
"""Contracts of layers, by name."""

FAULTS = [(name, what) for name, contract in LAYERED.items() for what in _faults_of(contract, PACKAGE)]
"""Every contract of layers with every kind of fault that it can have."""


def _lint(folder: Path) -> subprocess.CompletedProcess[str]:
    tool = Path(sys.executable).with_name("lint-imports")
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    command = [str(tool), "--no-cache"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package that may be spoilt."""
    folder = tmp_path_factory.mktemp("copied")
    for source in (PACKAGE, BUILDERS):
        shutil.copytree(source, folder / source.relative_to(ROOT), ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)
    return folder


def test_members_of_a_layer_do_not_know_each_other() -> None:
    """import-linter would let the members of a layer with ":" import each other: a circle of packages."""
    assert not [layer for contract in LAYERED.values() for layer in contract["layers"] if ":" in layer]


def test_the_layers_are_kept() -> None:
    done = _lint(ROOT)
    assert done.returncode == 0, done.stdout


@pytest.fixture(scope="module")
def complaints(copied: Path) -> dict[str, str]:
    """What each broken contract has to say of the copy into which everything is planted, by the contract's name."""
    clean = _lint(copied)  # without this, planted faults might be looked for in the installed package
    assert clean.returncode == 0, clean.stdout
    for place, code in [*TARGETS.items(), *((place, code) for place, code, _ in PLANTED.values())]:
        file = copied / "mimics_app" / place
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(code)
    done = _lint(copied)
    assert done.returncode == 1, done.stdout
    parts = re.split(r"^(.+)\n-+\n", done.stdout, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("what", PLANTED)
def test_planted_violation_is_caught(complaints: dict[str, str], what: str) -> None:
    """The contract names the planted module as one that imports, or as one that it does not list."""
    place, _, contract = PLANTED[what]
    (said,) = [text for name, text in complaints.items() if name.startswith(contract)]
    module = re.escape("mimics_app." + place.removesuffix(".py").removesuffix("/__init__").replace("/", "."))
    assert re.search(rf"^ *-? *{module}(?: ->|$)", said, re.MULTILINE), said


@cache
def _graph() -> grimp.ImportGraph:
    """Every import of the package, those for types too, read anew: a kept graph may be that of another checkout."""
    options = {"include_external_packages": True, "exclude_type_checking_imports": False, "cache_dir": None}
    return grimp.build_graph("mimics_app", **options)


def _is_kept(contract: dict[str, Any], graph: grimp.ImportGraph) -> bool:
    options = {key: str(value) if value is True else value for key, value in contract.items()}
    session = {"root_packages": ["mimics_app"]}
    return LayersContract(contract["name"], session, options).check(graph, verbose=False).kept


@pytest.mark.parametrize(("name", "what"), FAULTS)
def test_a_fault_planted_into_each_contract_is_caught(name: str, what: str) -> None:
    """In the graph an import for a type is like any other; `PLANTED` has one as it is written."""
    low, high = _faults_of(LAYERED[name], PACKAGE)[what]
    graph = copy.deepcopy(_graph())
    graph.add_import(importer=low, imported=high)
    assert not _is_kept(LAYERED[name], graph)


def test_every_contract_of_layers_is_given_an_import_up_and_one_for_a_type() -> None:
    assert {name for name, _ in FAULTS} == set(LAYERED)
    assert sum(what == "sideways" for _, what in FAULTS) > len(LAYERED) // 2
