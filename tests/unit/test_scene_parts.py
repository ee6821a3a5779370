"""Includes, prefabs, overrides, models and migrations: how a scene is put together, and what it says when it is not."""

from __future__ import annotations

import json

import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.tasks.task import TaskSpec
from mimics_app.world.components.registry import Component, register_section
from mimics_app.world.components.robot import Ball, Safety
from mimics_app.world.components.systems import AudioSettings, HapticSettings
from mimics_app.world.components.visible import LightComponent, MeshComponent
from mimics_app.world.files.reading.provenance import Layer, Origins, merged
from mimics_app.world.files.scene import document as scene_document
from mimics_app.world.files.scene import scene_files
from mimics_app.world.files.scene.file import load_scene
from tests.support.gltf_maker import square, write_gltf
from tests.support.scenes import faults, scene, thing, write


def path_of(height):
    """A straight recorded path, good enough for every stage's check."""
    return "x,y,z\n" + "".join(f"{i / 100},{height},0\n" for i in range(30))


def test_an_included_file_adds_its_parts_and_its_faults_are_reported_in_its_own_name(tmp_path):
    write(tmp_path, scene(thing("sun", light={"kindd": "point"}), materials={"red": {}}), "parts/sky.json")
    path = write(
        tmp_path,
        scene(thing("box", mesh={"primitive": {"shape": "box"}, "material": "red"}), include=["parts/sky.json"]),
    )
    assert faults(path) == [
        'parts/sky.json#/entities/0/components/light/kindd: unknown key "kindd"; did you mean "kind"'
    ]


def test_names_in_an_included_file_are_relative_to_that_file(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "path.csv").write_text(path_of(0.0))
    write(tmp_path, scene(thing("t", tunnel={"path_file": "path.csv"})), "parts/sky.json")
    loaded = load_scene(write(tmp_path, scene(include=["parts/sky.json"])))
    assert loaded.file_at("/entities/0/components/tunnel/path_file", "path.csv") == tmp_path / "parts" / "path.csv"


@pytest.mark.parametrize("names", [["a"], ["a", "b"], ["a", "b", "c"]])
def test_files_that_include_each_other_are_refused_with_the_chain(tmp_path, names):
    for i, name in enumerate(names):
        write(tmp_path, scene(include=[f"{names[(i + 1) % len(names)]}.json"]), f"{name}.json")
    found = faults(tmp_path / "a.json")
    assert len(found) == 1
    assert "/include/0: includes itself: " in found[0]
    assert found[0].endswith(" -> ".join(f"{name}.json" for name in [*names, "a"]))


def test_a_file_included_on_two_ways_counts_once(tmp_path):
    write(tmp_path, scene(thing("sun")), "base.json")
    write(tmp_path, scene(include=["base.json"]), "left.json")
    write(tmp_path, scene(include=["base.json"]), "right.json")
    loaded = load_scene(write(tmp_path, scene(include=["left.json", "right.json"])))
    assert [entity.id for entity in loaded.entities] == ["sun"]
    assert len(loaded.files) == 4


def test_a_device_brings_its_own_entities(tmp_path):
    """Those of the same id are replaced, wherever they are written; the others stay."""
    legs = {"devices": {"legs": [thing("robot", ball={"radius_max": 0.5}), thing("foot")]}}
    write(tmp_path, scene(thing("robot", ball={"radius_max": 0.25})) | legs, "part.json")
    path = write(tmp_path, scene(thing("sun"), include=["part.json"]))
    own, other = load_scene(path), load_scene(path, device="legs")
    assert own.devices == other.devices == ("legs",)
    assert [each.id for each in own.entities] == ["sun", "robot"]
    assert sorted(each.id for each in other.entities) == ["foot", "robot", "sun"]
    assert own.by_id["robot"].components["ball"].radius_max == 0.25
    assert other.by_id["robot"].components["ball"].radius_max == 0.5
    assert load_scene(path, device="arm").hash == own.hash != other.hash


def test_a_fault_in_what_a_device_brings_is_reported_where_it_is_written(tmp_path):
    path = write(tmp_path, scene() | {"devices": {"legs": [thing("foot", bal={})]}})
    with pytest.raises(SceneError) as error:
        load_scene(path, device="legs")
    assert error.value.issues[0].pointer == "/devices/legs/0/components/bal"


def test_ids_of_two_files_that_collide_name_the_other_file(tmp_path):
    write(tmp_path, scene(thing("sun"), materials={"red": {}}), "more.json")
    found = faults(write(tmp_path, scene(thing("sun"), materials={"red": {}}, include=["more.json"])))
    assert [line.split(": ")[0] for line in found] == ["more.json#/materials/red", "more.json#/entities/0/id"]
    assert "scene.json#/materials/red" in found[0]
    assert "scene.json#/entities/0/id" in found[1]


@pytest.mark.parametrize("uri", ["../out.json", "none.json", "http://x/y.json"])
def test_includes_that_cannot_be_read_are_reported_at_their_place(tmp_path, uri):
    inside = tmp_path / "inside"
    write(tmp_path, scene(), "out.json")
    assert faults(write(inside, scene(include=[uri])))[0].startswith("scene.json#/include/0: ")


def test_an_included_file_that_is_no_scene_does_not_hide_other_faults(tmp_path):
    write(tmp_path, "{", "broken.json")
    found = faults(write(tmp_path, scene(thing("a", bal={}), include=["broken.json"])))
    assert len(found) == 2


def test_the_main_files_systems_and_task_win_over_included_ones(tmp_path):
    more = scene(systems={"audio": {"gain": 0.5}, "visual": {"samples": 8}}, task={"x-from": "more"})
    write(tmp_path, more, "more.json")
    loaded = load_scene(write(tmp_path, scene(systems={"audio": {"gain": 2.0}}, include=["more.json"])))
    assert loaded.systems["audio"].gain == 2.0
    assert loaded.systems["visual"].samples == 8
    assert loaded.document["task"] == {"x-from": "more"}


def test_an_instance_has_what_its_prefab_says_and_changes_what_it_says_itself(tmp_path):
    prefab = {
        "transform": {"translation": [1, 0, 0]},
        "components": {"ball": {"radius_min": 0.01, "radius_max": 0.05}, "hud": {}},
    }
    one = {"id": "one", "prefab": "ball"}
    two = {
        "id": "two",
        "prefab": "ball",
        "transform": {"scale": [2, 2, 2]},
        "components": {"ball": {"radius_min": 0.02}, "hud": None},
    }
    loaded = load_scene(write(tmp_path, scene(one, two, prefabs={"ball": prefab})))
    assert [(name, ball.radius_min, ball.radius_max) for name, ball, _ in loaded.components(Ball)] == [
        ("one", 0.01, 0.05),
        ("two", 0.02, 0.05),
    ]
    second = loaded.entity("two")
    assert (second.transform.translation, second.transform.scale) == ((1, 0, 0), (2, 2, 2))
    assert "hud" in loaded.entity("one").components
    assert "hud" not in second.components


def test_a_fault_is_reported_where_the_value_stands_in_prefab_instance_or_override(tmp_path):
    prefabs = {
        "arm": {
            "components": {"ball": {"radius_max": -1}},
            "children": [{"id": "hand", "components": {"admittance": {"mass": 1}}}],
        },
    }
    instance = {
        "id": "left",
        "prefab": "arm",
        "components": {"ball": {"radius_min": -2}},
        "overrides": {"hand": {"components": {"admittance": {"damping": -3}}}},
    }
    assert faults(write(tmp_path, scene(instance, prefabs=prefabs))) == [
        "scene.json#/entities/0/components/ball/radius_min: expected a number > 0.0, got -2",
        "scene.json#/prefabs/arm/components/ball/radius_max: expected a number > 0.0, got -1",
        "scene.json#/entities/0/overrides/hand/components/admittance/damping: expected a number >= 0.0, got -3",
    ]


def test_children_of_nested_prefabs_are_named_by_their_path_and_reached_by_it(tmp_path):
    prefabs = {
        "finger": {"components": {"ball": {}}},
        "hand": {"children": [{"id": "thumb", "prefab": "finger"}, {"id": "nail", "parent": "thumb"}]},
        "arm": {"children": [{"id": "hand", "prefab": "hand", "transform": {"translation": [0, 1, 0]}}]},
    }
    instance = {
        "id": "left",
        "prefab": "arm",
        "overrides": {"hand/thumb": {"components": {"ball": {"radius_max": 0.2}}}},
    }
    loaded = load_scene(write(tmp_path, scene(instance, prefabs=prefabs)))
    assert [(entity.id, entity.parent) for entity in loaded.entities] == [
        ("left", None),
        ("left/hand", "left"),
        ("left/hand/thumb", "left/hand"),
        ("left/hand/nail", "left/hand/thumb"),
    ]
    assert loaded.components(Ball)[0][1].radius_max == 0.2


def test_a_prefab_built_on_another_lies_over_it(tmp_path):
    prefabs = {
        "ball": {"components": {"ball": {"radius_min": 0.01, "radius_max": 0.02}}},
        "big": {"prefab": "ball", "components": {"ball": {"radius_max": 0.5}}},
    }
    loaded = load_scene(write(tmp_path, scene({"id": "a", "prefab": "big"}, prefabs=prefabs)))
    ball = loaded.components(Ball)[0][1]
    assert (ball.radius_min, ball.radius_max) == (0.01, 0.5)


@pytest.mark.parametrize(
    ("prefabs", "what"),
    [
        ({"a": {"prefab": "a"}}, "/prefabs/a/prefab: the prefab contains itself: a -> a"),
        ({"a": {"prefab": "b"}, "b": {"prefab": "a"}}, "the prefab contains itself: a -> b -> a"),
        ({"a": {"children": [{"id": "c", "prefab": "a"}]}}, "/prefabs/a/children/0/prefab: the prefab contains itself"),
        ({"aa": {}}, '/entities/0/prefab: no prefab "a"; did you mean "aa"'),
        ({}, '/entities/0/prefab: no prefab "a"; the scene has no prefabs'),
    ],
)
def test_prefabs_that_contain_themselves_or_are_not_there(tmp_path, prefabs, what):
    found = faults(write(tmp_path, scene({"id": "e", "prefab": "a"}, prefabs=prefabs)))
    assert len(found) == 1
    assert what in found[0]


def test_prefabs_that_multiply_beyond_all_bounds_are_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr(scene_document, "MAX_ENTITIES", 1000)
    prefabs = {f"p{i}": {"children": [{"id": str(j), "prefab": f"p{i + 1}"} for j in range(10)]} for i in range(9)}
    found = faults(write(tmp_path, scene({"id": "e", "prefab": "p0"}, prefabs=prefabs | {"p9": {}})))
    assert found[0].endswith("more than 1000 entities, prefabs expanded")


def test_an_override_that_names_nothing_gets_reported(tmp_path):
    prefabs = {"arm": {"children": [{"id": "hand"}]}}
    instance = {"id": "left", "prefab": "arm", "overrides": {"hnd": {}}}
    found = faults(write(tmp_path, scene(instance, prefabs=prefabs)))
    assert found[0].startswith('scene.json#/entities/0/overrides/hnd: nothing inside "left" is called "hnd"')


def arm_model():
    document = square()
    document["nodes"] = [
        {"name": "Arm", "children": [1, 2], "extras": {"mimics": {"components": {"safety": {"force_limit": 10}}}}},
        {"name": "Hand", "mesh": 0, "extras": {"mimics": {"components": {"ball": {"radius_max": 0.03}}}}},
        {"name": "Plate", "mesh": 0},
    ]
    return document


def test_components_of_a_models_extras_become_entities_and_the_scene_wins(tmp_path):
    write_gltf(tmp_path / "arm.gltf", arm_model())
    left = thing("left", mesh={"source": "arm#/nodes/Arm"}, safety={"ramp_force": 7})
    left["overrides"] = {"Hand": {"components": {"ball": {"radius_min": 0.02}}}, "Plate": {"components": {"hud": {}}}}
    loaded = load_scene(write(tmp_path, scene(left, assets={"arm": {"uri": "arm.gltf"}})))
    assert [entity.id for entity in loaded.entities] == ["left", "left/Hand", "left/Plate"]
    safety, ball = loaded.components(Safety)[0][1], loaded.components(Ball)[0][1]
    assert (safety.force_limit, safety.ramp_force) == (10, 7)
    assert (ball.radius_min, ball.radius_max) == (0.02, 0.03)


def test_a_fault_in_a_models_extras_is_reported_in_the_models_name(tmp_path):
    document = arm_model()
    document["nodes"][1]["extras"]["mimics"]["components"]["ball"]["radius_mx"] = 1
    write_gltf(tmp_path / "arm.gltf", document)
    found = faults(write(tmp_path, scene(thing("left", mesh={"source": "arm"}), assets={"arm": {"uri": "arm.gltf"}})))
    assert found == [
        'arm.gltf#/nodes/1/extras/mimics/components/ball/radius_mx: unknown key "radius_mx"; did you mean "radius_max"'
    ]


@pytest.mark.parametrize(
    ("source", "what"),
    [
        ("arm#/nodes/Hnd", 'no node "Hnd"; did you mean "Hand"'),
        ("arm#/meshes/Square", 'no mesh "Square"; did you mean "SquareMesh"'),
        ("arm#/nodes/Twin", '2 nodes are named "Twin"'),
        ("arm#/materials/x", "refers to nothing; write arm#/nodes/Name"),
        ("arm#", None),
        ("rm", 'no asset "rm"; did you mean "arm"'),
        ("pic", 'asset "path" is a path'),
    ],
)
def test_references_into_a_model_are_by_name_and_unambiguous(tmp_path, source, what):
    document = arm_model()
    document["nodes"] += [{"name": "Twin"}, {"name": "Twin"}]
    write_gltf(tmp_path / "arm.gltf", document)
    (tmp_path / "p.csv").write_text("x")
    source = "path" if source == "pic" else source
    assets = {"arm": {"uri": "arm.gltf"}, "path": {"uri": "p.csv"}}
    found = faults(write(tmp_path, scene(thing("a", mesh={"source": source}), assets=assets)))
    if what is None:
        assert found == []
    else:
        assert len(found) == 1
        assert found[0].startswith("scene.json#/entities/0/components/mesh/source: ")
        assert what in found[0]


def test_a_wrong_model_is_reported_once_in_its_own_name_and_not_again_where_it_is_used(tmp_path):
    document = square()
    document["nodes"][0]["mesh"] = 7
    write_gltf(tmp_path / "arm.gltf", document)
    parts = [thing(name, mesh={"source": "arm#/nodes/Square"}) for name in "ab"]
    found = faults(write(tmp_path, scene(*parts, assets={"arm": {"uri": "arm.gltf"}})))
    assert found == ["arm.gltf#/nodes/0/mesh: there is no mesh 7; the file has 1 mesh"]


def test_an_older_version_is_brought_up_to_date_step_by_step(monkeypatch):
    monkeypatch.setitem(scene_files.MIGRATIONS, -1, lambda old: {**old, "entities": old["things"]})
    monkeypatch.setitem(scene_files.MIGRATIONS, 0, lambda old: {**old, "entities": [*old["entities"], {"id": "new"}]})
    old = {"version": -1, "things": [{"id": "a"}]}
    newest = scene_files.migrate(old)
    assert newest["version"] == 1
    assert newest["entities"] == [{"id": "a"}, {"id": "new"}]
    assert old == {"version": -1, "things": [{"id": "a"}]}
    assert scene_files.migrate({"version": -2}) is None


def test_the_hash_changes_with_one_ulp_and_with_an_assets_bytes_and_not_with_layout(tmp_path):
    (tmp_path / "p.csv").write_text(path_of(0.0))
    document = scene(thing("t", tunnel={"path_file": "p.csv", "stiffness": 1500.0}))
    first = load_scene(write(tmp_path, document)).hash
    assert load_scene(write(tmp_path, json.dumps(document, indent=4))).hash == first
    document["entities"][0]["components"]["tunnel"]["stiffness"] = 1500.0000000000002
    assert load_scene(write(tmp_path, document)).hash != first
    document["entities"][0]["components"]["tunnel"]["stiffness"] = 1500.0
    assert load_scene(write(tmp_path, document)).hash == first
    (tmp_path / "p.csv").write_text(path_of(0.01))
    assert load_scene(write(tmp_path, document)).hash != first


class Errand(Component, frozen=True):
    goal: str
    seconds: float = 1.0


def test_a_registered_section_is_decoded_and_checked_with_its_own_pointers(tmp_path):
    def check(errand, loaded):
        return [] if errand.goal == "home" else [loaded.issue("/errand/goal", f'no way to "{errand.goal}"')]

    register_section("errand", Errand, check)
    path = write(tmp_path, scene(errand={"goal": "hme"}))
    assert faults(path) == ['scene.json#/errand/goal: no way to "hme"']
    assert faults(write(tmp_path, scene(errand={"seconds": "x"}))) == [
        'scene.json#/errand: the key "goal" is missing',
        "scene.json#/errand/seconds: expected a number, got a text",
    ]
    assert load_scene(write(tmp_path, scene(errand={"goal": "home"}))).sections["errand"].seconds == 1.0


def test_a_section_nobody_registered_is_an_unknown_key(tmp_path):
    assert 'unknown key "eror"' in faults(write(tmp_path, scene(eror={})))[0]


def test_merging_replaces_lists_goes_into_objects_and_takes_away_with_null():
    low, high = {"a": {"b": 1, "c": [1, 2]}, "d": 1}, {"a": {"c": [3], "e": {"f": 2}}, "d": None}
    assert merged(low, high) == {"a": {"b": 1, "c": [3], "e": {"f": 2}}}
    assert low == {"a": {"b": 1, "c": [1, 2]}, "d": 1}


def test_a_key_with_a_slash_is_located_by_its_escaped_pointer(tmp_path):
    origins = Origins(Layer("main", tmp_path, "", {}))
    origins.set("/a", [Layer("high", tmp_path, "/x", {"b/c": 1}), Layer("low", tmp_path, "/y", {"b/c": 2, "~": [5]})])
    assert (origins.locate("/a/b~1c").file, origins.locate("/a/~0/0").file) == ("high", "low")
    assert origins.locate("/a/~0/1").pointer == "/y/~0/1"
    assert origins.locate("/elsewhere").file == "main"


def test_first_component_settings_and_section_are_reported_by_type_or_missed(tmp_path):
    """Nothing there is None, and the first of two is the file's first."""
    lights = thing("a", light={"intensity": 2.0}), thing("b", light={})
    said = {"systems": {"haptic": {"projection": "newton warm"}}, "task": {"time_limit_s": 7.0}}
    loaded = load_checked_scene(write(tmp_path, scene(*lights, **said)))
    found, haptic, task = loaded.first(LightComponent), loaded.system(HapticSettings), loaded.section(TaskSpec)
    assert found is not None and found.intensity == 2.0
    assert haptic is not None and haptic.projection == "newton warm"
    assert task is not None and task.time_limit_s == 7.0
    assert (loaded.first(Ball), loaded.system(AudioSettings), loaded.section(Ball)) == (None, None, None)


def test_components_can_be_asked_for_by_type_or_name(tmp_path):
    box = {"primitive": {"shape": "box"}}
    loaded = load_scene(write(tmp_path, scene(thing("a", mesh=box, light={}), thing("b", light={}))))
    assert [name for name, _, _ in loaded.components(LightComponent)] == ["a", "b"]
    assert loaded.components("mesh") == loaded.components(MeshComponent)
    assert loaded.components("mesh")[0][2] == "/entities/0/components/mesh"
    assert loaded.issue("/entities/1/components/light/kind", "what") == Issue(
        loaded.file, "/entities/1/components/light/kind", "what"
    )
