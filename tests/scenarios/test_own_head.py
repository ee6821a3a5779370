"""One's own head: not before one's own eyes, but in every other view, in mirrors and in one's shadow."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.contracts.messages.orders import VisualOrder
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.system.resources import root
from mimics_app.scenarios.figures.walking_figure import OWN_HEAD
from mimics_app.tasks.kinds.avatar_cord.features import DISTANCE, VIEWPOINT
from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world, load_scene
from tests.support.task_play import make_snapshot

ROOT = root()
PEOPLE = sorted((ROOT / "assets" / "models" / "avatars").glob("*.glb"))
BODIES = {"city_walk": "own_body", "guided_walk": "own_body", "avatar_cord": "subject"}


def world_of(person: Path, folder: Path) -> World:
    still = {"start": "still", "states": {"still": {"clip": "idle"}}}
    document = {
        "format": "mimics-scene",
        "version": 1,
        "scenario": "none",
        "assets": {"one": {"uri": f"mimics:{person.relative_to(ROOT)}"}},
        "entities": [{"id": "one", "components": {"mesh": {"source": "one"}, "animation": still}}],
    }
    (folder / "one.json").write_text(json.dumps(document))
    return build_world(load_scene(folder / "one.json"))


@pytest.mark.parametrize("person", PEOPLE, ids=lambda file: file.stem)
def test_a_head_is_within_the_distance_from_which_its_eyes_see(person: Path, tmp_path: Path) -> None:
    world = world_of(person, tmp_path)
    rig = next(iter(world.motion.animators.values())).rig
    slots, places = find_humanoid(rig).slots, Chain(rig).places
    eyes = 0.5 * (places[slots["leftEye"]] + places[slots["rightEye"]])
    head = {int(rig.entities[slot]) for slot in rig.below(slots["head"])}
    seen = []
    for body in world.motion.bodies.values():
        own = np.array([int(joint) in head for joint in body.binding.joints])
        for mesh in body.meshes.values():
            share = (own[mesh.weights.joints] * mesh.weights.weights).sum(axis=1)
            seen.append(mesh.positions[share > 0.5] - eyes)
    offsets = np.vstack(seen)
    before = offsets[offsets[:, 2] > -0.02]  # eyes do not see what is behind them
    assert len(before) > 100
    assert np.linalg.norm(before, axis=1).max() < OWN_HEAD - 0.018, "18 mm are left for the sway of a walk"


@pytest.mark.parametrize(("name", "body"), BODIES.items())
def test_only_the_own_eyes_see_past_the_own_head(name: str, body: str) -> None:
    scene = check_scene(read_scene(ROOT / "scenes" / f"{name}.json"))
    world = build_world(scene)
    near = [camera.near for camera in world.cameras]
    open_scenario(scene, world)
    world.update()
    node = world.find(body)
    animators = world.motion.animators
    animator = next(animators[each.index] for each in (node, *node.children) if each.index in animators)
    animator.step(0.1)
    np.testing.assert_allclose(animator.pose.scales[find_humanoid(animator.rig).slots["head"]], 1.0)
    assert world.cameras[0].near >= OWN_HEAD
    assert [camera.near for camera in world.cameras][1:] == near[1:]


def test_the_third_viewpoint_sees_the_cord_past_both_bodies() -> None:
    """No line of sight from it to a place of the cord comes near the axis of a body."""
    scene = check_scene(read_scene(ROOT / "scenes" / "avatar_cord.json"))
    world = build_world(scene)
    scenario = open_scenario(scene, world)
    for distance in (0.8, 1.2, 2.0):
        scenario.apply(TaskOrders(visual=VisualOrder({VIEWPOINT: "third", DISTANCE: distance})), make_snapshot())
        world.update()
        camera = world.cameras[0]
        eye, ahead = camera.world_from_eye[:3, 3], -camera.world_from_eye[:3, 2]
        start, end = scenario.subject.stomach, scenario.avatar.back
        for share in (0.2, 0.5, 0.8):
            place = start + share * (end - start)
            sight = (place - eye) / np.linalg.norm(place - eye)
            assert np.degrees(np.arccos(sight @ ahead)) < 0.5 * np.degrees(camera.vertical_fov)
            for axis in (np.zeros(2), np.array([0.0, -distance])):
                along = np.linspace(0.0, 0.85, 50)[:, None] * (place - eye)[[0, 2]] + eye[[0, 2]]
                assert np.linalg.norm(along - axis, axis=1).min() > 0.2
    scenario.apply(TaskOrders(visual=VisualOrder({VIEWPOINT: "first"})), make_snapshot())
    np.testing.assert_allclose(world.cameras[0].node.position, [0.0, 1.7, 0.0])
