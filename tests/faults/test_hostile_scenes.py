"""Scenes that are too large, wrong in very many places, or hold what no number, text or file can be."""

from __future__ import annotations

import json
import math
import os
import signal
import types
import typing
from pathlib import Path

import msgspec
import pytest

from mimics_app.app.cli import main
from mimics_app.app.commands.check import examine
from mimics_app.app.sweep.experiments import NAMES, find_experiment
from mimics_app.contracts.errors import MOST_LISTED, MOST_SOUGHT, Issue, SceneError, nearest
from mimics_app.contracts.messages.action_space import ActionSpace
from mimics_app.lab.sweep.spec import load_sweep
from mimics_app.learning.action_sequence import load_action_sequence
from mimics_app.tasks.task import TaskSpec
from mimics_app.world.components.objects import MAX_SHAPES
from mimics_app.world.components.registry import component_types, system_types
from mimics_app.world.content.world import World
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.mesh_file import add_mesh_file
from mimics_app.world.files.reading import struct_reader
from mimics_app.world.files.scene import scene_files
from mimics_app.world.files.scene.file import load_scene
from mimics_app.world.files.scene.spec import MAX_ENTITIES, SceneSpec
from tests.support.scenes import faults, scene, thing, write

SPHERE = {"shape": "sphere", "radius": 0.05}


def reported(folder: Path, document: object) -> list[str]:
    """Every fault that `mimics check` finds in a scene."""
    path = write(folder, document)
    try:
        examine(path)
    except SceneError as error:
        return [str(issue).replace(f"{folder}/", "") for issue in error.issues]
    return []


# --- caps come first ------------------------------------------------------------------------------------------------


def test_too_many_entities_are_refused_before_any_is_looked_at(tmp_path, monkeypatch):
    monkeypatch.setattr(scene_files, "read_struct", lambda *_: pytest.fail("looked at the entities"))
    document = scene(*({"id": 5} for _ in range(MAX_ENTITIES + 1)))
    assert faults(write(tmp_path, document)) == [
        "scene.json#/entities: 100001 entities are more than 100000; merge equal ones into one model"
    ]


def test_prefabs_that_unfold_to_too_many_entities_are_refused_alone(tmp_path):
    tens = {f"p{i}": {"children": [{"id": f"c{k}", "prefab": f"p{i + 1}"} for k in range(10)]} for i in range(5)}
    document = scene({"id": "top", "prefab": "p0"}, prefabs={**tens, "p5": {"components": {"msh": {}}}})
    found = faults(write(tmp_path, document))
    assert len(found) == 1 and "more than 100000 entities, prefabs expanded" in found[0]


def test_too_many_shapes_of_one_object_are_refused_before_any_is_looked_at(tmp_path, monkeypatch):
    looked = []
    read = struct_reader._Reader.read
    monkeypatch.setattr(struct_reader._Reader, "read", lambda *given: (looked.append(1), read(*given))[1])
    shapes = [{"shape": "spere"}] * 100_000
    found = reported(tmp_path, scene(thing("a", haptic_object={"shapes": shapes})))
    assert found == [f"scene.json#/entities/0/components/haptic_object/shapes: {LONG_LIST}"]
    assert len(looked) < 10


LONG_LIST = f"expected a list [..] of length <= {MAX_SHAPES}"


def test_too_many_components_of_a_kind_are_refused_before_they_are_checked(tmp_path):
    things = [thing(f"a{i}", haptic_object={"shapes": [{**SPHERE, "rotation": [0, 0, 0, 0]}]}) for i in range(1001)]
    found = reported(tmp_path, scene(*things))
    assert found == ['scene.json#/entities: 1001 entities have a "haptic_object"; at most 1000 may']


# --- very many faults -----------------------------------------------------------------------------------------------


def wrong(count: int) -> dict:
    return scene(*(thing(f"a{i}", mesh={"primitive": {"shape": "bx"}}) for i in range(count)))


def test_of_many_errors_the_first_hundred_are_reported_and_the_number_of_the_rest(tmp_path, capsys):
    file = str(write(tmp_path, wrong(250)))
    for command in ("check", "run"):
        assert main([command, file]) == 3
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == MOST_LISTED + 1
        assert lines[-1] == "mimics: and 150 more errors"
        assert main([command, file, "--json"]) == 3
        answer = json.loads(capsys.readouterr().out)
        assert (len(answer["errors"]), answer["more_errors"]) == (MOST_LISTED, 150)
        assert "more_errors_at_least" not in answer


def test_after_very_many_faults_no_more_are_looked_for(tmp_path):
    found = reported(tmp_path, wrong(MOST_SOUGHT + 500))
    assert len(found) == MOST_SOUGHT + 1
    assert found[-1] == "scene.json: has more faults, which were not searched for"


def test_where_counting_stopped_the_number_of_the_rest_is_a_least_one(tmp_path, capsys):
    file = str(write(tmp_path, wrong(MOST_SOUGHT + 500)))
    more = MOST_SOUGHT + 1 - MOST_LISTED
    assert main(["check", file]) == 3
    assert capsys.readouterr().err.splitlines()[-1] == f"mimics: and at least {more} more errors"
    assert main(["check", file, "--json"]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert (answer["more_errors"], answer["more_errors_at_least"]) == (more, True)


def test_of_many_faulty_values_of_a_sweep_the_first_hundred_are_reported(tmp_path, capsys):
    values = {"stiffness": [-1.0] * 999, "period": 0.001}
    sweep = {"format": "mimics-sweep", "version": 1, "experiment": "wall_stability", "parameters": values}
    assert main(["sweep", str(write(tmp_path, sweep, "sweep.json"))]) == 3
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == MOST_LISTED + 1
    assert lines[-1] == f"mimics: and {999 - MOST_LISTED} more errors"


def test_sweep_of_more_points_than_could_ever_be_computed_is_refused(tmp_path):
    parts = ("stiffness", "wall_damping", "mass")
    values = {name: {"from": 1.0, "to": 2.0, "count": 10**6} for name in parts}
    sweep = {"format": "mimics-sweep", "version": 1, "experiment": "wall_stability", "parameters": values}
    with pytest.raises(SceneError, match="points are more than 1e\\+09"):
        load_sweep(write(tmp_path, sweep, "sweep.json"), find_experiment, NAMES)


def test_nearest_name_among_very_many_is_found_without_comparing_all():
    names = [f"thing{i}" for i in range(50_000)]
    assert nearest("thing77x", names) == 'did you mean "thing77"'
    assert nearest("zebra", names) == ""


# --- values that cannot be ------------------------------------------------------------------------------------------


def longest_word(line: str) -> int:
    return max(map(len, line.replace("/", " ").split()))


def test_long_values_are_reported_by_their_beginning_and_end(tmp_path):
    document = scene(thing("a", mesh={"source": "m" * 5000}, **{"x" * 3000: {}}), systems={"y" * 4000: {}})
    document["assets"] = {"b": {"uri": "u" * 5000}}
    found = reported(tmp_path, document)
    assert len(found) >= 4
    assert all(len(line) < 900 and longest_word(line) <= 120 for line in found), found
    assert Issue("f", "", f'no file "{"u" * 60}"').what == f'no file "{"u" * 60}"'
    path = "/a/" + "b" * 60 + "/" + "c" * 60
    assert path in Issue("f", "", f"the id is taken by {path}#/entities/0").what


@pytest.mark.parametrize(
    ("document", "pointer"),
    [
        (scene(task="\ud800"), "/task"),
        (scene(title="\ud800"), "/title"),
        (scene({"id": "a", "transform": {"translation": [0, "\udfff", 0]}}), "/entities/0/transform/translation/1"),
        (scene(assets={"a": {"uri": "\ud800.glb"}}), "/assets/a/uri"),
        (scene({"id": "a\ud800"}), "/entities/0/id"),
    ],
)
def test_half_a_character_is_reported_where_it_stands_once(tmp_path, document, pointer):
    found = reported(tmp_path, document)
    assert found == [f"scene.json#{pointer}: holds half of a character (a lone surrogate); write the character"]


@pytest.mark.parametrize(
    ("document", "pointer", "code"),
    [
        (scene(title="a\0b"), "/title", "0000"),
        (scene(description="a \x1b[31mred"), "/description", "001B"),
        (scene(picture="a\0.png"), "/picture", "0000"),
        (
            scene(thing("a", billboard={"text": "\x9b31m", "size": [1, 1]})),
            "/entities/0/components/billboard/text",
            "009B",
        ),
        (scene(**{"x-\x7f": "comment"}), "", "007F"),
    ],
)
@pytest.mark.parametrize("escaped", [True, False])
def test_a_control_character_is_reported_where_it_stands_once(tmp_path, document, pointer, code, escaped):
    (tmp_path / "scene.json").write_text(json.dumps(document, ensure_ascii=escaped))
    with pytest.raises(SceneError) as raised:
        load_scene(tmp_path / "scene.json")
    (issue,) = raised.value.issues
    assert (issue.pointer, issue.what) == (pointer, f"holds the control character U+{code}")


def test_lines_and_tabs_are_no_control_characters(tmp_path):
    (tmp_path / "scene.json").write_text(
        json.dumps(scene(title="a\tb", description="two\nlines, a \\backslash\\u0000"))
    )
    assert load_scene(tmp_path / "scene.json").description.startswith("two\nlines")


@pytest.mark.parametrize("number", [10**400, -(10**400), 10**309])
def test_whole_number_beyond_all_floats_is_no_number(tmp_path, number):
    found = reported(tmp_path, scene(thing("a", admittance={"mass": number})))
    assert len(found) == 1
    assert found[0].startswith("scene.json#/entities/0/components/admittance/mass: ")
    assert "is too large; at most 1.798e+308 may be" in found[0] and len(found[0]) < 200


@pytest.mark.parametrize("number", [10**400, 10**309])
def test_whole_number_beyond_all_floats_in_a_sweep(tmp_path, number):
    for values in ([number], {"from": 1.0, "to": number}, number):
        sweep = {"format": "mimics-sweep", "version": 1, "experiment": "wall_stability"}
        sweep["parameters"] = {"stiffness": values}
        with pytest.raises(SceneError, match=r"/parameters/stiffness.*is too large"):
            load_sweep(write(tmp_path, sweep, "sweep.json"), find_experiment, NAMES)


@pytest.mark.parametrize(
    "target", ["stiffness", "", "haptic", "haptic.", "haptic.bodies", "haptic.shapes.", ".", "task."]
)
def test_target_of_a_parameter_without_a_name_is_reported_with_its_place(tmp_path, target):
    parameter = {"min": 0.0, "max": 1.0, "default": 0.5, "maps": [{"to": target}]}
    task = {"parameters": {"p": parameter}, "goals": [{"kind": "duration", "seconds": 5}]}
    found = reported(tmp_path, scene(thing("a", robot={}), task=task))
    assert any(line.startswith("scene.json#/task/parameters/p/maps/0/to: ") for line in found), found


BOUNDS = [
    ({"tunnel": {"stiffness": 1e300}}, "tunnel/stiffness"),
    ({"admittance": {"mass": 1e-300}}, "admittance/mass"),
    ({"safety": {"force_limit": 1e9}}, "safety/force_limit"),
    ({"haptic_object": {"shapes": [SPHERE], "mass": 1e-300}}, "haptic_object/mass"),
    ({"light": {"intensity": 1e38}}, "light/intensity"),
]


@pytest.mark.parametrize(("components", "pointer"), BOUNDS)
def test_component_beyond_physics_is_refused(tmp_path, components, pointer):
    found = reported(tmp_path, scene(thing("a", **components)))
    assert any(line.startswith(f"scene.json#/entities/0/components/{pointer}: expected a number") for line in found)


@pytest.mark.parametrize(
    ("key", "value"), [("translation", [1e300, 0, 0]), ("rotation", [-1e308, 0, 0.7, 0.7]), ("scale", [1, 1e200, 1])]
)
def test_place_beyond_physics_is_refused(tmp_path, key, value):
    found = reported(tmp_path, scene({"id": "a", "transform": {key: value}, "components": {"mesh": {"source": "x"}}}))
    assert found[0].startswith(f"scene.json#/entities/0/transform/{key}/")


def test_scales_that_multiply_beyond_every_picture_are_refused(tmp_path):
    chain = [
        {"id": f"a{i}", "parent": f"a{i - 1}" if i else None, "transform": {"scale": [1e6] * 3}} for i in range(60)
    ]
    found = reported(tmp_path, scene(*chain))
    assert len(found) == 1
    assert found[0].startswith("scene.json#/entities/2/transform: its parents' scales put it 0 m away, 1e+18 times")


def test_time_limit_of_a_task_is_at_most_a_day(tmp_path):
    task = {"goals": [{"kind": "duration", "seconds": 5}], "time_limit_s": 1e308}
    assert reported(tmp_path, scene(task=task)) == [
        "scene.json#/task/time_limit_s: expected a number <= 86400.0, got 1e+308"
    ]


def test_second_robot_is_refused_with_the_place_of_the_first(tmp_path):
    found = reported(tmp_path, scene(thing("a", robot={}), thing("b", robot={})))
    line = 'scene.json#/entities/1/components/robot: a second "robot"; the first is '
    assert line + "scene.json#/entities/0/components/robot; keep one" in found


# --- bounds on every number -----------------------------------------------------------------------------------------

LOOKED_AT_BY_A_CHECK = {"Wire.gain", "Wire.gain[][]"}
"""Numbers whose bounds msgspec cannot hold; tests/unit/test_object_components.py requests them."""


def numbers_of(wanted: typing.Any, name: str, seen: set[type]) -> typing.Iterator[tuple[str, list[msgspec.Meta]]]:
    """(name, limits) of every number in a type, Structs within it included."""
    limits = [meta for meta in getattr(wanted, "__metadata__", ()) if isinstance(meta, msgspec.Meta)]
    bare = wanted.__origin__ if limits else wanted
    origin, parts = typing.get_origin(bare), [part for part in typing.get_args(bare) if part is not Ellipsis]
    if bare in (float, int):
        yield name, limits
    elif origin is typing.Annotated:
        yield from numbers_of(parts[0], name, seen)
    elif origin in (typing.Union, types.UnionType):
        for part in parts:
            yield from numbers_of(part, name, seen)
    elif origin in (list, tuple):
        for part in parts:
            yield from numbers_of(part, f"{name}[]", seen)
    elif origin is dict:
        yield from numbers_of(parts[1], f"{name}{{}}", seen)
    elif isinstance(bare, type) and issubclass(bare, msgspec.Struct) and bare not in seen:
        seen.add(bare)
        for field, hint in typing.get_type_hints(bare, include_extras=True).items():
            yield from numbers_of(hint, f"{bare.__name__}.{field}", seen)


def test_every_number_of_a_scene_has_a_least_and_a_greatest_value():
    seen: set[type] = set()
    found = {}
    for struct in (SceneSpec, TaskSpec, *component_types().values(), *system_types().values()):
        found |= dict(numbers_of(struct, "", seen))
    assert len(found) > 200
    for name, limits in found.items():
        least = [limit for meta in limits for limit in (meta.ge, meta.gt) if limit is not None]
        most = [limit for meta in limits for limit in (meta.le, meta.lt) if limit is not None]
        bounded = any(map(math.isfinite, least)) and any(map(math.isfinite, most))
        assert bounded or name in LOOKED_AT_BY_A_CHECK, name


# --- what only looks like a file ------------------------------------------------------------------------------------


@pytest.fixture
def pipe(tmp_path):
    """A FIFO; a reader that waits for somebody to write is ended by a signal."""

    def stop(*_):
        raise TimeoutError("waited for a writer")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(20)
    yield tmp_path
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("model.glb", load_gltf),
        ("scene.json", examine),
        ("mesh.stl", lambda path: add_mesh_file(World(), World().root, path)),
        ("actions.json", lambda path: load_action_sequence(path, ActionSpace())),
        ("sweep.json", lambda path: load_sweep(path, find_experiment, NAMES)),
    ],
)
def test_pipe_instead_of_a_file_is_refused_at_once(pipe, name, read):
    os.mkfifo(pipe / name)
    with pytest.raises(SceneError, match=r"not a regular file|scene not found"):
        read(pipe / name)
