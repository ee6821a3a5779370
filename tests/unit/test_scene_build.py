"""From scene to world, and a saved scene laid over a running one."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.reload import apply_scene, reload_scene
from mimics_app.world.files.scene.watcher import SceneWatcher
from mimics_app.world.graph.entity_ids import StaleHandleError
from tests.support.gltf_maker import square, write_gltf
from tests.support.scenes import scene, thing, write

BOX = {"primitive": {"shape": "box"}}


def loaded(folder, document, name="scene.json"):
    return load_scene(write(folder, document, name))


def test_a_built_world_has_the_scenes_nodes_bodies_lights_cameras_and_sky(tmp_path):
    Image.new("RGBA", (3, 2), (10, 20, 30, 255)).save(tmp_path / "p.png")
    document = scene(
        {
            "id": "eye",
            "parent": "arm",
            "transform": {"translation": [0, 0, 1]},
            "components": {"camera": {"vertical_fov": 0.5}},
        },
        {"id": "arm", "transform": {"translation": [0, 2, 0]}, "components": {"mesh": BOX | {"material": "red"}}},
        thing("sun", light={"intensity": 3, "casts_shadow": True}, environment={"ambient": 0.25}),
        thing("off", mesh=BOX | {"visible": False, "casts_shadow": False}),
        assets={"p": {"uri": "p.png", "wrap": ["clamp", "mirror"], "filter": "nearest"}},
        materials={"red": {"base_colour": [1, 0, 0, 1], "base_texture": "p"}},
    )
    world = build_world(loaded(tmp_path, document))
    listed = world.subentities()
    assert listed.material == ["red", "default"]
    assert listed.visible.tolist() == [1, 0]
    assert listed.casts_shadow.tolist() == [1, 0]
    assert world.cameras[0].world_from_eye[:3, 3].tolist() == [0, 2, 1]
    assert (world.lights[0].intensity, world.lights[0].casts_shadow, world.lights[0].range) == (3, True, math.inf)
    assert world.environment.ambient == 0.25
    assert world.materials["red"].base_texture == "p"
    texture = world.textures["p"]
    assert (texture.pixels.shape, texture.wrap, texture.filter) == ((2, 3, 4), ("clamp", "mirror"), "nearest")


def test_targets_turn_cameras_and_lights_in_the_world_also_below_a_parent(tmp_path):
    turned = {"id": "arm", "transform": {"rotation": [0, math.sin(0.4), 0, math.cos(0.4)], "translation": [1, 0, 0]}}
    eye = {"id": "eye", "parent": "arm", "components": {"camera": {"target": [1, 0, -5]}}}
    here = {"id": "here", "components": {"light": {"target": [0, 0, 0]}}}  # where it stands itself: left as it is
    world = build_world(loaded(tmp_path, scene(turned, eye, here)))
    assert world.find("eye").world_matrix()[:3, :3] == pytest.approx(np.eye(3), abs=1e-15)


def test_two_instances_of_a_model_share_its_data_and_move_apart(tmp_path):
    document = square()
    document["nodes"] = [
        {"name": "Arm", "mesh": 0, "children": [1]},
        {"name": "Hand", "mesh": 0, "translation": [0, 1, 0]},
    ]
    write_gltf(tmp_path / "m.gltf", document)
    parts = [
        thing("a", mesh={"source": "m#/nodes/Arm"}) | {"transform": {"translation": [5, 0, 0]}},
        thing("b", mesh={"source": "m#/nodes/Arm", "material": "red"}),
        thing("c", mesh={"source": "m#/meshes/SquareMesh"}),
        thing("d", mesh={"source": "m"}),
    ]
    world = build_world(loaded(tmp_path, scene(*parts, assets={"m": {"uri": "m.gltf"}}, materials={"red": {}})))
    assert list(world.meshes) == ["m#0/0"]
    listed = world.subentities()
    names = [world.node(int(index)).name for index in listed.entity]
    assert sorted(names) == ["a", "a/Hand", "b", "b/Hand", "c", "d/Arm", "d/Hand"]
    assert world.find("a/Hand").world_matrix()[:3, 3].tolist() == [5, 1, 0]
    assert {m for n, m in zip(names, listed.material, strict=True) if n.startswith("b")} == {"red"}


def test_lights_cameras_materials_and_hidden_nodes_of_a_model_come_along(tmp_path):
    document = square()
    document["materials"] = [{"name": "Paint", "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}}]
    document["meshes"][0]["primitives"][0]["material"] = 0
    document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}}]
    document["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 7, "range": 3}]}}
    document["nodes"] = [
        {"name": "Lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}, "camera": 0},
        {"name": "Ghost", "mesh": 0, "extensions": {"KHR_node_visibility": {"visible": False}}},
    ]
    document["scenes"][0]["nodes"] = [0, 1]
    write_gltf(tmp_path / "m.gltf", document)
    world = build_world(loaded(tmp_path, scene(thing("a", mesh={"source": "m"}), assets={"m": {"uri": "m.gltf"}})))
    assert (world.lights[0].kind, world.lights[0].intensity, world.lights[0].range) == ("spot", 7, 3)
    assert (world.cameras[0].vertical_fov, world.cameras[0].far) == (0.6, math.inf)
    assert world.subentities().material == ["m#Paint"]
    assert world.subentities().visible.tolist() == [0]


def test_reloading_keeps_state_that_was_not_edited_and_handles_of_what_stays(tmp_path):
    before = scene(thing("ball", mesh=BOX), thing("wall", mesh=BOX), thing("old"))
    old = loaded(tmp_path, before)
    world = build_world(old)
    ball, wall, gone = (world.find(name) for name in ("ball", "wall", "old"))
    ball.set_position((1, 2, 3))  # moved by the running session
    wall.set_position((9, 9, 9))
    after = scene(
        thing("ball", mesh=BOX, admittance={"mass": 5}),
        thing("wall", mesh=BOX) | {"transform": {"translation": [0, 1, 0]}},
        {"id": "new", "parent": "ball", "transform": {"translation": [1, 0, 0]}},
        systems={"audio": {"gain": 2}},
    )
    changes = apply_scene(world, old, loaded(tmp_path, after))
    assert (changes.added, changes.removed) == (["new"], ["old"])
    assert changes.components == {"ball": {"admittance"}, "wall": {"transform"}}
    assert changes.systems == {"audio"}
    assert changes.touch("admittance")
    assert not changes.touch("mesh")
    assert ball.position.tolist() == [1, 2, 3]
    assert wall.position.tolist() == [0, 1, 0]
    assert world.find("new").world_matrix()[:3, 3].tolist() == [2, 2, 3]
    with pytest.raises(StaleHandleError):
        _ = gone.position


def test_reloading_changes_meshes_lights_cameras_and_materials_in_place(tmp_path):
    before = scene(
        thing("a", mesh=BOX, light={}, camera={}), thing("b", mesh=BOX), materials={"red": {"roughness": 0.1}}
    )
    old = loaded(tmp_path, before)
    world = build_world(old)
    node = world.find("a")
    after = json.loads(json.dumps(before))
    after["materials"]["red"]["roughness"] = 0.9
    after["entities"][0]["components"] = {
        "mesh": {"primitive": {"shape": "sphere"}, "material": "red"},
        "light": {"intensity": 4},
    }
    after["entities"][1]["components"] = {}
    apply_scene(world, old, loaded(tmp_path, after))
    assert world.materials["red"].roughness == 0.9
    subentities = world.subentities()  # one for each form of the sphere, finest first
    assert set(subentities.material) == {"red"}
    assert world.meshes[subentities.mesh[0]].triangle_count > 12
    assert node.light.intensity == 4
    assert node.camera is None
    assert world.find("b").entity is None


def test_an_entity_that_stays_survives_the_removal_of_its_parent(tmp_path):
    old = loaded(tmp_path, scene(thing("arm"), {"id": "hand", "parent": "arm"}, {"id": "nail", "parent": "hand"}))
    world = build_world(old)
    hand = world.find("hand")
    apply_scene(world, old, loaded(tmp_path, scene(thing("hand"), {"id": "nail", "parent": "hand"})))
    assert hand.is_alive
    assert hand.parent == world.root
    assert world.find("nail").parent == hand
    assert "arm" not in world


def test_an_entity_moves_to_a_parent_that_came_with_the_reload(tmp_path):
    old = loaded(tmp_path, scene(thing("hand")))
    world = build_world(old)
    apply_scene(world, old, loaded(tmp_path, scene({"id": "hand", "parent": "arm"}, thing("arm"))))
    assert world.find("hand").parent == world.find("arm")


def test_a_model_that_was_edited_is_shown_anew_and_one_that_was_not_stays(tmp_path):
    document = square()
    document["nodes"] = [{"name": "Arm", "mesh": 0, "children": [1]}, {"name": "Hand", "mesh": 0}]
    write_gltf(tmp_path / "m.gltf", document)
    write_gltf(tmp_path / "n.gltf", document)
    assets = {"m": {"uri": "m.gltf"}, "n": {"uri": "n.gltf"}}
    parts = [thing(name, mesh={"source": f"{name}#/nodes/Arm"}) for name in "mn"]
    path = write(tmp_path, scene(*parts, assets=assets))
    old = load_scene(path)
    world = build_world(old)
    kept, replaced = world.find("n/Hand"), world.find("m/Hand")
    document["nodes"][1] |= {"name": "Claw", "translation": [0, 2, 0]}
    write_gltf(tmp_path / "m.gltf", document)
    _, changes = reload_scene(world, old)
    assert changes.components == {"m": {"model"}}
    assert kept.is_alive
    assert not replaced.is_alive
    assert world.find("m/Claw").world_matrix()[:3, 3].tolist() == [0, 2, 0]
    assert len(world.subentities().mesh) == 4


def test_overrides_of_a_models_nodes_come_and_go_with_a_reload(tmp_path):
    document = square()
    document["nodes"] = [{"name": "Arm", "mesh": 0, "children": [1]}, {"name": "Hand", "mesh": 0}]
    write_gltf(tmp_path / "m.gltf", document)
    plain, ring = thing("m", mesh={"source": "m#/nodes/Arm"}), {"id": "ring", "parent": "m"}
    raised = plain | {"overrides": {"Hand": {"transform": {"translation": [0, 5, 0]}}}}
    first, second = (
        loaded(tmp_path, scene(entity, ring, assets={"m": {"uri": "m.gltf"}})) for entity in (raised, plain)
    )
    world = build_world(first)
    for old, new, height in ((first, second, 0), (second, first, 5)):
        assert apply_scene(world, old, new).components == {"m": {"model"}}
        assert world.find("m/Hand").world_matrix()[1, 3] == height
        assert world.find("ring").parent == world.find("m")


def test_a_cord_and_an_inset_go_with_their_entity_and_a_changed_cord_is_replaced(tmp_path):
    end, camera = thing("end") | {"transform": {"translation": [1, 0, 0]}}, thing("eye", camera={})
    first = loaded(tmp_path, scene(end, camera, thing("c", cord={"to": "end"}, inset={"camera": "eye"})))
    second = loaded(tmp_path, scene(end, camera, thing("c", cord={"to": "end", "radius": 0.05})))
    third = loaded(tmp_path, scene(end, camera))
    world = build_world(first)
    apply_scene(world, first, second)
    assert (world.cords["c"].radius, world.cords["c"].ends[1].tolist()) == (0.05, [1, 0, 0])
    apply_scene(world, second, first)
    apply_scene(world, first, third)
    assert not (world.cords or world.insets)


def test_a_broken_scene_leaves_world_and_old_scene_as_they_are(tmp_path):
    path = write(tmp_path, scene(thing("a", mesh=BOX)))
    old = load_scene(path)
    world = build_world(old)
    revision = world.subentities().revision
    write(tmp_path, scene(thing("a", mesh={"primitive": {"shape": "bx"}})))
    with pytest.raises(SceneError, match="did you mean"):
        reload_scene(world, old)
    world.update()
    assert world.subentities().revision == revision
    assert world.find("a").entity is not None


def test_a_watcher_sees_a_save_of_the_same_size_a_removal_and_a_return_once_each(tmp_path):
    path = tmp_path / "a.json"
    path.write_text("one")
    watcher = SceneWatcher([path])
    assert not watcher.changed()
    stamp = path.stat().st_mtime_ns
    path.write_text("two")
    os.utime(path, ns=(stamp + 1, stamp + 1))
    assert watcher.changed()
    assert not watcher.changed()
    path.unlink()
    assert watcher.changed()
    assert not watcher.changed()
    path.write_text("three")
    assert watcher.changed()
    other = tmp_path / "b.json"
    path.write_text("a save while the list changes")
    watcher.watch([path, other])
    assert watcher.changed()


@pytest.mark.seconds
def test_the_shipped_scenes_are_right_and_build():
    import mimics_app.app.scenes.loading as loading

    folder = Path(__file__).parents[2] / "scenes"
    files = sorted(folder.rglob("*.json"))
    assert files
    for file in files:
        found = loading.load_checked_scene(file)
        world = build_world(found)
        assert all(entity.id in world for entity in found.entities)


def test_another_model_of_a_person_who_moves_is_taken_while_they_move(tmp_path: Path) -> None:
    """The pose of the old model has no nodes any more when the world is next updated."""
    moves = {"start": "still", "states": {"still": {"clip": "idle"}}}
    document = scene(
        thing("person", mesh={"source": "body"}, animation=moves),
        assets={"body": {"uri": "mimics:assets/models/avatars/woman_anna.glb"}},
    )
    old = load_scene(write(tmp_path, document))
    world = build_world(old)
    world.motion.time = 0.1
    world.update()
    document["assets"]["body"]["uri"] = "mimics:assets/models/avatars/man_tom.glb"
    document["entities"][0]["components"]["mesh"]["source"] = "other"
    document["assets"]["other"] = document["assets"].pop("body")
    write(tmp_path, document)
    world.motion.time = 0.2
    reload_scene(world, old)
    world.motion.time = 0.3
    world.update()
    person = world.find("person")
    assert len(world.motion.animators[person.index].rig.entities) > 20
    assert len(world.motion.machines) == 1, "it moves on"
