"""The editor's model: values with their limits, edits that touch nothing else, faults at their place."""

from __future__ import annotations

import json
import math

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.viewer.edited_scene import EditedScene, pointer_of
from mimics_app.app.viewer.inspected import Cell, component_names, default_of, inspected_rows, quaternion_of
from mimics_app.app.viewer.new_entities import templates_of
from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.world.components.registry import component_types
from mimics_app.world.files.reading.json_edit import set_value, source_of

SCENE = """{"format": "mimics-scene", "version": 1,
  "x-mine":   "stays",
  "materials": {"red": {"base_colour": [0.8, 0.02, 0.02, 1.0]}},
  "prefabs": {"pin": {"components": {"mesh": {"primitive": {"shape": "sphere", "radius": 0.1}, "material": "red"}}}},
  "entities": [
    {"id": "sun", "components": {"light": {"target": [-1, -2, -1]}}},
    {"id": "floor", "x-why": "to stand on",
     "components": {"mesh": {"primitive": {"shape": "plane", "size": [6.0, 6]}}}},
    {"id": "cube", "transform": {"translation": [0, 0.25, 0]}, "components": {"mesh":
        {"primitive": {"shape": "box", "size": [5e-1, 0.50, 0.5]}, "material": "red"}}},
    {"id": "top", "parent": "cube", "prefab": "pin"}]}
"""


@pytest.fixture
def edited(tmp_path):
    file = tmp_path / "place.json"
    file.write_text(SCENE)
    return EditedScene(open_shown(file))


def row_of(edited, name, *steps):
    return next(row for row in edited.rows(edited.find(name)) if row.steps == steps)


def set_to(edited, name, steps, typed, cell=0):
    edited.set(edited.find(name), row_of(edited, name, *steps).cells[cell], typed)
    edited.apply()


def text_of(edited):
    return edited.texts.text(edited.texts.files[0])


SIZE = ("components", "mesh", "primitive", "size")


def test_a_value_has_unit_limits_and_words_and_one_number_changes(edited):
    row = row_of(edited, "cube", *SIZE)
    assert (row.unit, row.help, row.own) == ("m", "Extent along x, y, z [m]", True)
    assert [cell.limits for cell in row.cells] == ["above 0 to 1 000 000"] * 3
    set_to(edited, "cube", SIZE, "0.750", cell=1)
    assert text_of(edited) == SCENE.replace("0.50, 0.5]", "0.750, 0.5]"), "as it was typed"
    assert edited.scene.entity("cube").components["mesh"].primitive.size == (0.5, 0.75, 0.5)
    refused = {"0": "too small: above 0", "1e7": "too large", "wide": "not a number", "NaN": "not a number"}
    for typed, why in refused.items():
        with pytest.raises(ValueError, match=why):
            set_to(edited, "cube", SIZE, typed)
    assert edited.undo() == "cube: components.mesh.primitive.size.1" and text_of(edited) == SCENE


def test_what_a_prefab_brings_is_shown_and_becomes_the_instances_own(edited):
    radius = ("components", "mesh", "primitive", "radius")
    row = row_of(edited, "top", *radius)
    assert (row.cells[0].shown, row.own) == ("0.1", False)
    set_to(edited, "top", radius, "0.2")
    assert not edited.faults and row_of(edited, "top", *radius).own
    assert edited.scene.entity("top").components["mesh"].primitive.radius == 0.2
    edited.remove(edited.find("top"), ("components",))
    edited.apply()
    assert edited.scene.entity("top").components["mesh"].primitive.radius == 0.1


def test_every_limit_of_every_component_is_that_of_the_reader():
    """The oracle is msgspec, which decodes the components; the editor knows the schema only."""
    counted = 0
    for name in component_names():
        own = {"id": "a", "components": {name: default_of("components", name)}}
        for row in inspected_rows(own, own, {}):
            for cell in row.cells if row.steps[0] == "components" else ():
                if cell.kind not in ("number", "whole"):
                    continue
                for edge, step in ((cell.low, -1), (cell.high, 1)):
                    if edge is None:
                        continue
                    for value in (edge, edge - step, edge + step):
                        typed = source_of(int(value) if cell.kind == "whole" else float(value))
                        assert takes(cell, typed) == reads(own, row.steps, cell, typed), (name, row.label, typed)
                        counted += 1
    assert counted > 500


def takes(cell, typed):
    try:
        cell.written(typed)
    except ValueError:
        return False
    return True


def reads(own, row_steps, cell, typed):
    name = row_steps[1]
    items = list(cell.items)
    if items:
        items[int(cell.steps[-1])] = json.loads(typed)
    text = set_value(json.dumps(own), row_steps if items else cell.steps, source_of(items) if items else typed)
    try:
        msgspec.convert(json.loads(text)["components"][name], component_types()[name])
    except msgspec.ValidationError:
        return False
    return True


@pytest.mark.parametrize("degrees", [(0, 0, 0), (30, 0, 0), (10, -80, 170), (-179, 45, 1), (0, 90, 0)])
def test_the_rotation_is_shown_in_degrees_and_written_as_a_unit_quaternion(edited, degrees):
    expected = Rotation.from_euler("xyz", degrees, degrees=True).as_quat(canonical=True)
    assert quaternion_of(degrees) == pytest.approx(expected, abs=1e-6)
    for axis, angle in enumerate(degrees):
        set_to(edited, "cube", ("transform", "rotation"), str(angle), cell=axis)
    assert not edited.faults
    written = edited.scene.entity("cube").transform.rotation
    turned = Rotation.from_quat(written) * Rotation.from_euler("xyz", degrees, degrees=True).inv()
    assert math.degrees(turned.magnitude()) < 0.05
    angles = [cell.value for cell in row_of(edited, "cube", "transform", "rotation").cells]
    shown = Rotation.from_euler("xyz", angles, degrees=True) * Rotation.from_quat(written).inv()
    assert math.degrees(shown.magnitude()) < 0.02


def test_faults_are_those_of_check_and_stand_at_their_entity_and_row(edited, tmp_path):
    set_to(edited, "cube", ("components", "mesh", "material"), "green")
    set_to(edited, "top", ("parent",), "nobody")
    other = tmp_path / "other.json"
    other.write_text(text_of(edited))
    with pytest.raises(SceneError) as caught:
        load_checked_scene(other)
    assert [(each.pointer, each.what) for each in edited.faults] == [
        (each.pointer, each.what) for each in caught.value.issues
    ]
    place = edited.find("cube")
    ((pointer, issue),) = edited.faults_of(place)
    assert pointer == pointer_of(("components", "mesh", "material")) and edited.place_of(issue) == place
    assert row_of(edited, "cube", "components", "mesh", "material").cells[0].shown == "green", (
        "what the file would have"
    )
    assert edited.scene.entity("top").parent == "cube", "the picture keeps the last scene without faults"
    edited.undo()
    edited.undo()
    edited.apply()
    assert not edited.faults and text_of(edited) == SCENE and not edited.texts.unsaved


def test_a_scene_with_a_fault_of_a_stage_can_be_opened_to_correct_it(tmp_path):
    file = tmp_path / "robot.json"
    robot = {"robot": {"device": "simulated_hapticmaster"}, "controller": {"name": "nobody"}}
    entities = [{"id": "arm", "components": robot}]
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "entities": entities}))
    with pytest.raises(SceneError) as caught:
        open_shown(file)
    edited = EditedScene(open_shown(file, faulty=True))
    edited.apply()
    assert edited.faults == caught.value.issues and edited.faults_of(edited.find("arm"))
    edited.remove(edited.find("arm"), ("components", "controller"))
    edited.apply()
    assert not edited.faults and edited.texts.save() == [file]
    assert open_shown(file).scene is not None


@pytest.mark.parametrize("wrong", [5, True, "x", [], {}, [1], ["a", "b", "c"], [None] * 4, {"a": 1}, [[1]]])
@pytest.mark.parametrize(
    "place",
    [
        ("transform",),
        ("transform", "translation"),
        ("transform", "rotation"),
        ("components",),
        ("components", "mesh"),
        ("components", "mesh", "primitive", "size"),
        ("prefab",),
    ],
)
def test_an_entity_that_is_written_wrongly_is_shown_moved_copied_and_given_components(edited, place, wrong):
    file = edited.texts.files[0]
    text = set_value(SCENE, ["prefabs"], source_of(wrong))
    file.write_text(set_value(text, ["entities", "2", *place], source_of(wrong)))
    edited.read_again()
    edited.apply()
    cube = edited.find("cube")
    assert all(cell.stepped(1) is not None for row in edited.rows(cube) for cell in row.cells)
    assert edited.prefabs(file) == (["a"] if wrong == {"a": 1} else [])
    edited.move("cube", (1.0, 2.0, 3.0))
    edited.put(cube, ("components", "light"), "{}")
    assert edited.plain(cube)["transform"]["translation"] == [1.0, 2.0, 3.0]
    copy = edited.plain(edited.find(edited.duplicate(cube, (0.5, 0.0, 0.0))))
    assert copy["transform"]["translation"] == [1.5, 2.0, 3.0] and copy["components"]["light"] == {}
    while edited.undo():
        pass
    assert text_of(edited) == file.read_text()


@pytest.mark.parametrize("typed", [r'"\ud800"', "1e999", "NaN", "[1,"])
def test_what_no_file_can_hold_is_refused_where_json_is_typed(typed):
    with pytest.raises(ValueError, match="is not JSON"):
        Cell(("x-note",), "json", None).written(typed)
    with pytest.raises(ValueError, match="is not a number"):
        Cell(("x",), "number", 1.0).written("1" + "0" * 400)


def test_every_template_can_be_added_and_is_without_a_fault(edited):
    templates = templates_of(edited.scene, ["pin"], 0.2)
    names = [edited.add({"id": each.entity["id"], **each.entity}) for each in templates]
    edited.apply()
    assert not edited.faults and len(set(names)) == len(names)
    assert set(names) <= set(edited.scene.by_id)
    radius = edited.scene.entity("sphere").components["mesh"].primitive.radius
    assert radius == 0.1, "half of the width"
    for _ in names:
        edited.undo()
    assert text_of(edited) == SCENE


def test_a_copy_has_the_authors_spelling_and_a_new_name(edited):
    name = edited.duplicate(edited.find("cube"), (0.25, 0.0, 0.0))
    edited.apply()
    assert name == "cube_2" and not edited.faults
    head = '{"id": "cube_2", "transform": {"translation": [0.25, 0.25, 0]}, "components": {"mesh":\n'
    assert head in text_of(edited) and text_of(edited).count("[5e-1, 0.50, 0.5]") == 2
    assert edited.duplicate(edited.find("cube"), (0.0, 0.0, 0.0)) == "cube_3"


def test_what_moves_with_an_entity_goes_and_is_renamed_with_it(edited):
    edited.set(edited.find("cube"), row_of(edited, "cube", "id").cells[0], "block")
    edited.apply()
    assert not edited.faults and edited.scene.entity("top").parent == "block"
    assert edited.delete(edited.find("block")) == 2
    edited.apply()
    assert not edited.faults and [row.id for row in edited.entities] == ["sun", "floor"]
    assert "x-why" in text_of(edited) and '"x-mine":   "stays"' in text_of(edited)
    edited.undo()
    edited.undo()
    edited.apply()
    assert text_of(edited) == SCENE and set(edited.scene.by_id) == {"sun", "floor", "cube", "top"}


def test_a_comment_is_a_value_like_others_and_a_drag_that_is_undone_puts_the_node_back(edited):
    set_to(edited, "floor", ("x-why",), "to walk on")
    assert text_of(edited) == SCENE.replace("to stand on", "to walk on")
    edited.undo()
    node = edited._shown.world.find("cube")
    node.set_position((1.0, 0.25, 0.0))
    edited.move("cube", (1.00004, 0.25, -0.0))
    assert text_of(edited) == SCENE.replace("[0, 0.25, 0]", "[1.0, 0.25, 0]")
    edited.undo()
    edited.apply()
    assert node.position == pytest.approx(np.array([0.0, 0.25, 0.0]), abs=0.0)


def test_the_scene_goes_on_under_a_new_name_unless_its_files_are_not_there(edited, tmp_path):
    set_to(edited, "cube", SIZE, "0.9")
    edited.save_as(tmp_path / "second.json")
    edited.apply()
    assert edited.scene.path == tmp_path / "second.json" and not edited.texts.unsaved
    assert (tmp_path / "place.json").read_text() == SCENE
    with pytest.raises(SceneError, match="exists already"):
        edited.save_as(tmp_path / "place.json")


def test_edits_outlive_that_their_file_is_no_more_included_and_the_history_ends_there(tmp_path):
    head = '{"format": "mimics-scene", "version": 1, '
    part, whole, other = (tmp_path / name for name in ("part.json", "whole.json", "other/part.json"))
    other.parent.mkdir()
    for file in (part, other):
        file.write_text(head + '"entities": [{"id": "lamp"}]}')
    whole.write_text(head + '"include": ["part.json"], "entities": [{"id": "own"}]}')
    edited = EditedScene(open_shown(whole))
    edited.move("lamp", (1.0, 2.0, 3.0))
    edited.apply()
    edited.save_as(other.with_name("new.json"))  # with another part.json beside it
    edited.apply()
    assert edited.texts.save() == [part] and "1.0, 2.0, 3.0" in part.read_text()
    edited.apply()
    assert edited.texts.files == [other.with_name("new.json"), other] and edited.undo() == ""
