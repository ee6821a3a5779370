"""Layers, cross-fades, states, root motion, events, reaching and looking, on small models made here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.world.components.animation import AnimationState, AnimationTransition
from mimics_app.world.content.motion.animator import Animator, RootMotion, mask_of
from mimics_app.world.content.motion.clip import ClipEvent, Interpolation, MotionTrack, TrackPath, pack_clip
from mimics_app.world.content.motion.layer import Layer
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.state_machine import StateMachine
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.gltf_maker import GltfMaker, write_gltf
from tests.support.skin_maker import add_clip, bar, turn


def _lively(maker: GltfMaker) -> GltfMaker:
    """A bar that can bow (joint 1 about z), nod (joint 2 about x), stand, and walk 1 m/s along z with events."""
    add_clip(maker, "stand", [(2, "rotation", [0.0, 1.0], [turn("z", 0)] * 2, "LINEAR")])
    add_clip(maker, "bow", [(2, "rotation", [0.0, 1.0], [turn("z", 0), turn("z", 60)], "LINEAR")])
    add_clip(maker, "nod", [(3, "rotation", [0.0, 1.0], [turn("x", 10), turn("x", 40)], "LINEAR")])
    steps = {"mimics": {"events": [{"at": 0.75, "kind": "step", "strength": 0.5}, {"at": 0.25, "kind": "step"}]}}
    add_clip(maker, "walk", [(1, "translation", [0.0, 1.0], [[0, 0, 0], [0, 0, 1]], "LINEAR")], extras=steps)
    return maker


@pytest.fixture
def animator(tmp_path: Path) -> Animator:
    world = load_model_world(write_gltf(tmp_path / "bar.gltf", _lively(bar()).document()))
    return next(iter(world.motion.animators.values()))


def _angle(animator: Animator, joint: int) -> float:
    """How far a joint is turned [degrees]."""
    return float(2.0 * np.degrees(np.arccos(min(1.0, animator.pose.rotations[animator.rig.slot(f"joint{joint}"), 3]))))


def test_layers_have_weights_masks_and_speeds(animator: Animator) -> None:
    animator.play("bow", at=0.0, speed=0.5, weight=0.5)
    animator.step(1.0)
    assert _angle(animator, 1) == pytest.approx(15.0, abs=1e-4)
    animator.layers[0].weight = 1.0
    animator.layers[0].mask = mask_of(animator.rig, ["joint2"])
    animator.step(0.0)
    assert _angle(animator, 1) == pytest.approx(0.0, abs=1e-4)


def test_an_additive_layer_adds_what_differs_from_its_first_frame(animator: Animator) -> None:
    animator.play("nod", speed=0.0)
    animator.step(0.0)
    assert _angle(animator, 2) == pytest.approx(10.0, abs=1e-4)
    animator.play("nod", at=1.0, speed=0.0, additive=True, weight=0.5)
    animator.step(0.0)
    assert _angle(animator, 2) == pytest.approx(10.0 + 15.0, abs=1e-4)


def test_loops_begin_again_and_others_hold_their_end(animator: Animator) -> None:
    looping, held = animator.play("bow"), animator.play("nod", loop=False)
    animator.step(2.25)
    assert looping.at == pytest.approx(0.25) and held.at == 1.0 and held.ended and not looping.ended


@pytest.mark.parametrize("number", ["at", "speed", "weight", "fade"])
def test_a_number_that_is_none_is_refused_and_leaves_the_pose_alone(animator: Animator, number: str) -> None:
    with pytest.raises(ValueError, match="cannot play at"):
        animator.play("bow", **{number: float("nan")})
    assert not animator.layers
    animator.play("bow", at=1.0, speed=0.0)
    animator.step(0.1)
    assert _angle(animator, 1) == pytest.approx(60.0, abs=1e-4)


def test_a_cross_fade_never_shows_the_rest_pose(animator: Animator) -> None:
    """Half way between two poses of 60 degrees about one axis lies 60 degrees, not a share of it."""
    animator.change("bow", 0.0, 0.0).at = 1.0
    animator.step(0.1)
    animator.change("bow", 0.5, 0.0).at = 1.0
    for _ in range(7):
        animator.step(0.1)
        assert _angle(animator, 1) == pytest.approx(60.0, abs=1e-4)
    assert len(animator.layers) == 1


def test_states_follow_what_happens_and_clips_that_end(animator: Animator) -> None:
    states = {
        "still": AnimationState(clip="stand"),
        "greet": AnimationState(clip="bow", loop=False, next="still", fade=0.2),
    }
    machine = StateMachine(animator, states, [AnimationTransition(target="greet", on="goal", source="still", fade=0.0)])
    assert not machine.trigger("contact") and machine.state == "still"
    assert machine.trigger("goal") and machine.state == "greet"
    assert not machine.trigger("goal")
    seen = []
    for _ in range(14):
        animator.step(0.1)
        seen.append(_angle(animator, 1))
    assert machine.state == "still" and max(seen) > 45.0 and seen[-1] == pytest.approx(0.0, abs=1e-4)
    with pytest.raises(KeyError, match="stil"):
        StateMachine(animator, {"still": AnimationState(clip="stand", next="stil")})


def test_events_are_passed_once_each_time_round(animator: Animator) -> None:
    animator.play("walk")
    times, strengths = [], []
    for number in range(250):
        animator.step(0.01)
        times += [number * 0.01] * len(animator.events)
        strengths += [event.strength for event in animator.events]
    assert np.allclose(times, [0.24, 0.74, 1.24, 1.74, 2.24], atol=0.011)
    assert strengths == [1.0, 0.5, 1.0, 0.5, 1.0]


def test_root_motion_moves_the_model_and_joins_the_ends_of_a_loop(tmp_path: Path) -> None:
    world = load_model_world(write_gltf(tmp_path / "bar.gltf", _lively(bar()).document()))
    index, animator = next(iter(world.motion.animators.items()))
    animator.play("walk")
    animator.steps.append(RootMotion(animator, animator.rig.slot("joint0"), world.transforms, index))
    for number in range(1, 76):
        world.motion.time = number / 30.0
        world.update()
        assert np.allclose(world.transforms.translation(index), (0.0, 0.0, number / 30.0), atol=1e-6)
        assert np.allclose(animator.pose.translations[animator.rig.slot("joint0")], 0.0)


def test_what_is_far_moves_in_larger_steps_and_loses_no_time(tmp_path: Path) -> None:
    path = write_gltf(tmp_path / "bar.gltf", _lively(bar()).document())
    worlds = [load_model_world(path) for _ in range(2)]
    revisions = []
    for world, away in zip(worlds, (5.0, 40.0), strict=True):
        (animator,) = world.motion.animators.values()
        animator.play("bow", loop=False)
        world.motion.eye_world = np.array([0.0, 0.0, away])
        (body,) = world.motion.bodies.values()
        before = body.revision
        for number in range(1, 61):
            world.motion.time = number / 60.0
            world.update()
        revisions.append(body.revision - before)
        assert animator.layers[0].at == pytest.approx(1.0, abs=1.0 / 15.0)
    assert revisions[0] == 60 and 14 <= revisions[1] <= 17


def _scene(tmp_path: Path, components: dict[str, Any], more: list[Any] = []) -> Path:  # noqa: B006
    write_gltf(tmp_path / "bar.gltf", _lively(bar()).document())
    entity = {"id": "bar", "components": {"mesh": {"source": "bar"}, **components}}
    document = {"format": "mimics-scene", "version": 1, "scenario": "none", "assets": {"bar": {"uri": "bar.gltf"}}}
    return write_gltf(tmp_path / "scene.json", document | {"entities": [entity, *more]})


def test_a_scene_says_what_its_models_do(tmp_path: Path) -> None:
    states = {"still": {"clip": "stand"}, "greet": {"clip": "bow", "loop": False, "next": "still"}}
    transitions = [{"from": "still", "to": "greet", "on": "goal"}]
    animation = {"states": states, "transitions": transitions, "layers": [{"clip": "nod", "mask": ["joint2"]}]}
    scene = load_scene(_scene(tmp_path, {"animation": animation | {"skinning": "dual"}}))
    world = build_world(scene)
    assert "animation" not in scene.unread
    assert {body.skinning for body in world.motion.bodies.values()} == {"dual"}
    (machine,) = world.motion.machines.values()
    world.motion.trigger("goal")
    world.motion.time = 0.5
    world.update()
    assert machine.state == "greet"
    (animator,) = world.motion.animators.values()
    assert _angle(animator, 2) == pytest.approx(25.0, abs=1e-3)


@pytest.mark.parametrize(
    ("animation", "pointer", "what"),
    [
        ({"layers": [{"clip": "bough"}]}, "/layers/0/clip", 'no clip "bough"'),
        ({"states": {"a": {"clip": "bow", "next": "b"}}}, "/states/a/next", 'no state "b"'),
        ({"states": {"a": {"clip": "bow"}}, "start": "c"}, "/start", 'no state "c"'),
        ({"layers": [{"clip": "bow", "mask": ["arm"]}]}, "/layers/0/mask/0", 'no node "arm"'),
        ({"layers": [{"clip": "bow", "weight": 2}]}, "/layers/0/weight", "1"),
        ({"transitions": [{"to": "x", "on": "goal"}]}, "/transitions/0/to", 'no state "x"'),
    ],
)
def test_what_a_scene_says_wrongly_is_reported_with_its_place(
    tmp_path: Path, animation: Any, pointer: str, what: str
) -> None:
    with pytest.raises(SceneError) as refused:
        load_scene(_scene(tmp_path, {"animation": animation}))
    assert any(issue.pointer.endswith(pointer) and what in issue.what for issue in refused.value.issues), (
        refused.value.issues
    )


def test_an_avatar_without_a_persons_bones_is_refused(tmp_path: Path) -> None:
    avatar = {"avatar": {"reach": [{"limb": "left_arm", "target": "cup"}]}}
    scene = load_scene(_scene(tmp_path, avatar, [{"id": "cup"}]))
    with pytest.raises(SceneError, match="leftUpperArm"):
        build_world(scene)


def test_a_clip_of_next_to_no_duration_repeats_its_events_a_bounded_number_of_times() -> None:
    times, values = np.array([0.0, 1e-30], np.float32), np.zeros((2, 1, 3), np.float32)
    track = MotionTrack(0, TrackPath.TRANSLATION, Interpolation.LINEAR, times, values)
    clip = pack_clip("short", [track], (ClipEvent(0.0, "step"),))
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]), np.ones((1, 3)), np.zeros(0))
    assert len(Layer(clip, rest, np.zeros(2, np.int32)).step(1.0)) == 1000
