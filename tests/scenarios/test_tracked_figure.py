"""A person's model moved by head and hands: eyes and wrists where they are tracked, feet on the floor, else idling."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.maths.poses import pose_from_parts, rotation_from_vector
from mimics_app.scenarios.figures.tracked_figure import TrackedFigure
from mimics_app.world.content.raycast import cast_ray
from mimics_app.world.files.scene.file import build_world, load_scene

ROOT = Path(__file__).parents[2]
FRAME_NS = 16_666_667
FRONT = pose_from_parts((0.3, 0.0, -1.2), (0.0, np.sin(0.2), 0.0, np.cos(0.2)))
NOBODY = {"head": None, "hand_left": None, "hand_right": None}


@pytest.fixture
def figure():
    scene = load_scene(ROOT / "scenes" / "avatar_cord.json")
    world = build_world(scene)
    world.update()
    return TrackedFigure(scene, world, "avatar", 1.70), world


def part(place, turn=(0.0, 0.0, 0.0)):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation_from_vector(np.array(turn)), place
    return pose


def joint(world, name: str) -> np.ndarray:
    rig = world.motion.animators[world.find("avatar").index].rig
    return world.graph.world_matrix(int(rig.entities[rig.slot(name)]))[:3, 3]


def hold(figure, world, parts, frames: int = 60) -> None:
    for _ in range(frames):
        now_ns = round(world.motion.time * 1e9) + FRAME_NS
        figure.pose(FRONT, parts, now_ns)
        world.motion.time = now_ns * 1e-9
    world.update()


@pytest.mark.parametrize(("longer", "grown"), [(0.9, 1.0), (1.08, 1.08), (2.0, 1.15)])
def test_arms_become_as_long_as_the_wrists_are_tracked_apart(figure, longer: float, grown: float) -> None:
    body, world = figure
    body.pose(FRONT, NOBODY, FRAME_NS)
    world.update()
    shoulder, elbow, wrist, other = (
        joint(world, name) for name in ("leftUpperArm", "leftLowerArm", "leftHand", "rightUpperArm")
    )
    arm = float(np.linalg.norm(elbow - shoulder) + np.linalg.norm(wrist - elbow))
    height, out = float(shoulder[1]), 0.5 * float(np.linalg.norm(shoulder - other)) + longer * arm
    hands = {f"hand_{side}": part((sign * out, height, 0.0)) for side, sign in (("left", -1.0), ("right", 1.0))}
    hold(body, world, {"head": part((0.0, 1.7, 0.0))} | hands, 260)
    assert body.arms == pytest.approx(grown, abs=0.05)
    if longer < 1.1:
        tracked = FRONT @ np.array([-out, height, 0.0, 1.0])
        assert np.linalg.norm(joint(world, "leftHand") - tracked[:3]) < 0.006


@pytest.mark.parametrize("ahead", [0.3, 0.5], ids=["bent", "stretched out"])
@pytest.mark.parametrize("tall", [1.45, 1.70, 1.85])
def test_eyes_and_wrists_are_where_they_are_tracked_and_feet_on_the_floor(figure, tall: float, ahead: float) -> None:
    body, world = figure
    share = tall / 1.70
    hands = {
        "left": (-0.22 * share, 0.65 * tall, -ahead * share),
        "right": (0.2 * share, 0.72 * tall, -(ahead + 0.02) * share),
    }
    hold(body, world, {"head": part((0.0, tall, 0.0))} | {f"hand_{side}": part(at) for side, at in hands.items()}, 40)
    parts = {"head": part((0.04, tall - 0.03, -0.03), (0.1, 0.25, 0.05))}
    parts |= {f"hand_{side}": part(at, (0.2, -0.3, 0.4)) for side, at in hands.items()}
    hold(body, world, parts)
    eyes = 0.5 * (joint(world, "leftEye") + joint(world, "rightEye"))
    # Closed form: nothing is left over but rounding.
    np.testing.assert_allclose(eyes, (FRONT @ parts["head"])[:3, 3], atol=1e-6)
    np.testing.assert_allclose(body.head, eyes, atol=1e-6)
    for side in hands:
        np.testing.assert_allclose(joint(world, f"{side}Hand"), (FRONT @ parts[f"hand_{side}"])[:3, 3], atol=1e-6)
        # The ankle of the model at rest is 82 mm above its floor.
        assert joint(world, f"{side}Foot")[1] == pytest.approx(body.scale * 0.082, abs=0.004)


def test_a_sideways_lean_leaves_the_feet_and_a_step_takes_them_along(figure) -> None:
    body, world = figure
    feet = []
    for away in (0.0, 0.1, 0.6):
        hold(body, world, NOBODY | {"head": part((away, 1.70, 0.0))})
        feet.append(joint(world, "leftFoot"))
    assert np.linalg.norm(feet[1] - feet[0]) < 0.005
    assert np.linalg.norm(feet[2] - feet[0]) == pytest.approx(0.45, abs=0.01)


def test_the_cord_is_fixed_to_the_surface_and_goes_with_the_body(figure) -> None:
    body, world = figure
    hold(body, world, NOBODY)
    ahead = FRONT[:3, :3] @ [0.0, 0.0, -1.0]
    for place, out in ((body.stomach, ahead), (body.back, -ahead)):
        hits = cast_ray(world, place + 0.3 * out, -out)
        assert hits
        assert hits[0].distance == pytest.approx(0.3, abs=0.02)
    before = body.back.copy()
    hold(body, world, NOBODY | {"head": part((0.12, 1.68, 0.0))})
    assert np.linalg.norm(body.back - before) > 0.03


def test_nobody_tracked_is_idling_and_a_lost_tracker_lets_the_body_go_back_to_it(figure) -> None:
    body, world = figure
    hold(body, world, NOBODY)
    idle = joint(world, "leftHand")
    hands = {f"hand_{side}": part((x, 1.3, -0.4)) for side, x in (("left", -0.2), ("right", 0.2))}
    hold(body, world, {"head": part((0.0, 1.7, 0.0)), **hands})
    assert np.linalg.norm(joint(world, "leftHand") - idle) > 0.3
    hold(body, world, NOBODY)
    assert np.linalg.norm(joint(world, "leftHand") - idle) < 0.05


@pytest.mark.parametrize(
    ("change", "words"), [("gone", 'no entity "avatar"'), ("ball", "it has no joints; see mimics avatar import")]
)
def test_a_scene_without_a_person_is_refused(tmp_path: Path, change: str, words: str) -> None:
    document = json.loads((ROOT / "scenes" / "avatar_cord.json").read_text())
    kept = [each for each in document["entities"] if each["id"] != "avatar"]
    ball = {"mesh": {"primitive": {"shape": "sphere", "radius": 0.1}, "material": "iron"}}
    document["entities"] = kept if change == "gone" else [*kept, {"id": "avatar", "components": ball}]
    (tmp_path / "scene.json").write_text(json.dumps(document))
    scene = load_scene(tmp_path / "scene.json")
    with pytest.raises(SceneError, match=words):
        TrackedFigure(scene, build_world(scene), "avatar", 1.70)
