"""Limbs that reach: exact below the soft zone, smooth across the limit, and never lost, whatever is asked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.lab.groups.limb_reach import arms, elbow_gain
from mimics_app.lab.visual.iterative_reach import reach_by_descent, reach_by_fabrik
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.humanoid import NEEDED, find_humanoid
from mimics_app.world.content.motion.kernels.two_bone import reach_two_bones
from mimics_app.world.content.motion.looking import LookAt
from mimics_app.world.content.motion.reach import Chain, LimbReach, ReachCase
from mimics_app.world.content.motion.upper_body import Trackers, UpperBody
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.person_maker import PLACES, write_person
from tests.support.skin_maker import turn

A, B, SOFT = 0.30, 0.27, 0.03


def solve(asked: np.ndarray, limbs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    out, cases = np.zeros((len(asked), 6)), np.zeros(len(asked), np.int32)
    reach_two_bones(asked, limbs, np.zeros((len(asked), 7)), out, cases)
    return out, cases


def test_the_hand_is_exact_and_bones_keep_their_lengths() -> None:
    asked, limbs = arms(20_000)
    out, cases = solve(asked, limbs)
    assert np.abs(out[:, 3:] - asked[:, 3:6]).max() <= 1e-9
    assert np.abs(np.linalg.norm(out[:, :3] - asked[:, :3], axis=1) - A).max() < 1e-12
    assert np.abs(np.linalg.norm(out[:, 3:] - out[:, :3], axis=1) - B).max() < 1e-12
    assert not cases.any()
    normal = np.cross(asked[:, 3:6] - asked[:, :3], asked[:, 6:] - asked[:, :3])
    off = np.einsum("ij,ij->i", normal, out[:, :3] - asked[:, :3]) / np.linalg.norm(normal, axis=1)
    assert np.abs(off).max() < 1e-9, "the elbow lies in the plane of the pole"


@pytest.mark.seconds
@pytest.mark.parametrize("lengths", [(0.30, 0.27), (0.27, 0.30), (0.30, 0.30)])
def test_nothing_that_is_asked_gives_nonsense(lengths: tuple[float, float]) -> None:
    """A million inputs, among them all that is degenerate: bones keep their lengths, nothing is not finite."""
    rng = np.random.default_rng(4)
    count = 1_000_000
    asked = rng.normal(size=(count, 9)) * 10.0 ** rng.uniform(-9, 2, (count, 1))
    kind = rng.integers(0, 6, count)
    asked[kind == 1, 3:6] = asked[kind == 1, :3]
    asked[kind == 2, 6:] = asked[kind == 2, 3:6]
    asked[kind == 3, 6:] = 2 * asked[kind == 3, :3] - asked[kind == 3, 3:6]
    limbs = np.tile([*lengths, SOFT, 0.2], (count, 1))
    out, states, cases = np.zeros((count, 6)), rng.normal(size=(count, 7)), np.zeros(count, np.int32)
    unit = states[:, :3] / np.linalg.norm(states[:, :3], axis=1, keepdims=True)
    side = np.cross(unit, states[:, 3:6])
    states[:, :3], states[:, 3:6] = unit, side / np.linalg.norm(side, axis=1, keepdims=True)
    reach_two_bones(asked, limbs, states, out, cases)
    assert np.isfinite(out).all() and np.isfinite(states).all()
    size = 1.0 + np.abs(asked).max(axis=1)
    assert (np.abs(np.linalg.norm(out[:, :3] - asked[:, :3], axis=1) - lengths[0]) < 1e-12 * size).all()
    assert (np.abs(np.linalg.norm(out[:, 3:] - out[:, :3], axis=1) - lengths[1]) < 1e-12 * size).all()
    assert {ReachCase.AT_SHOULDER, ReachCase.TOO_FAR, ReachCase.ON_POLE} <= {
        flag for flag in ReachCase if (cases & flag).any()
    }


@pytest.mark.parametrize(
    ("asked", "limb", "case"),
    [
        ([0, 0, 0, 0, 0, 0, 0, -1, 0], (A, B), ReachCase.AT_SHOULDER),
        ([0, 0, 0, 1e-12, 0, 0, 0, -1, 0], (A, B), ReachCase.AT_SHOULDER),
        ([0, 0, 0, 2, 0, 0, 0, -1, 0], (A, B), ReachCase.TOO_FAR),
        ([0, 0, 0, 0.57, 0, 0, 0, -1, 0], (A, B), ReachCase.PLAIN),
        ([0, 0, 0, 0.01, 0, 0, 0, -1, 0], (A, B), ReachCase.TOO_NEAR),
        ([0, 0, 0, 0, -0.4, 0, 0, -1, 0], (A, B), ReachCase.ON_POLE),
        ([0, 0, 0, 0, 0.4, 0, 0, -1, 0], (A, B), ReachCase.ON_POLE),
        ([0, 0, 0, 0.1, 0, 0, 0, -1, 0], (0.0, 0.0), ReachCase.NO_LENGTH),
        ([0, 0, 0, 0.2, 0, 0, 0, -1, 0], (0.3, 0.0), ReachCase.TOO_NEAR),
        ([np.nan, 0, 0, 0.2, 0, 0, 0, -1, 0], (A, B), ReachCase.NOT_FINITE),
        ([0, 0, 0, np.inf, 0, 0, 0, -1, 0], (A, B), ReachCase.NOT_FINITE),
    ],
)
def test_every_degenerate_case_has_a_name(asked: list[float], limb: tuple[float, float], case: ReachCase) -> None:
    out, cases = solve(np.array([asked], float), np.array([[*limb, SOFT, np.inf]]))
    assert ReachCase(int(cases[0])) & case == case or case == cases[0]
    assert np.isfinite(out).all()


def test_the_elbow_is_smooth_across_both_reach_limits() -> None:
    """Movement of the elbow per movement of the target: unbounded with a hard limit, 5 at most with the soft one."""
    for start, end in ((0.45, 0.70), (0.001, 0.12)):
        away = np.arange(start, end, 1e-5)
        gains = {}
        for soft in (0.0, SOFT):
            asked = np.zeros((len(away), 9))
            asked[:, 3], asked[:, 7] = away, -1.0
            out, _ = solve(asked, np.tile([A, B, soft, np.inf], (len(away), 1)))
            gains[soft] = np.linalg.norm(np.diff(out[:, :3], axis=0), axis=1).max() / 1e-5
        assert gains[SOFT] <= 5.0 < 20.0 < gains[0.0]
    assert elbow_gain(lambda a, limbs, out: reach_two_bones(a, limbs, np.zeros((len(a), 7)), out, _ints(a))) <= 5.0


def _ints(asked: np.ndarray) -> np.ndarray:
    return np.zeros(len(asked), np.int32)


def test_past_the_pole_line_the_elbow_swings_no_faster_than_it_may_and_the_hand_stays() -> None:
    most = np.radians(720.0) / 60.0
    states, out, cases = np.zeros((1, 7)), np.zeros((1, 6)), np.zeros(1, np.int32)
    sides, away = [], []
    for z in np.linspace(-0.05, 0.05, 300):
        asked = np.array([[0, 0, 0, 0, -0.4, z, 0, -1, 0]])
        reach_two_bones(asked, np.array([[A, B, SOFT, most]]), states, out, cases)
        sides.append(states[0, 3:6].copy())
        away.append(np.abs(out[0, 3:] - asked[0, 3:6]).max())
    turned = np.arccos(np.clip(np.einsum("ij,ij->i", sides[:-1], sides[1:]), -1, 1))
    assert max(away) < 1e-12
    assert turned.max() <= most + 0.01 and np.sum(turned) > 2.5, "the target's own direction turns by less than 0.01"


def test_the_rivals_reach_too_but_not_always() -> None:
    asked, limbs = arms(2_000)
    for rival in (reach_by_fabrik, reach_by_descent):
        out = np.zeros((2_000, 6))
        rival(asked, limbs, 1e-6, 200, out)
        assert np.median(np.linalg.norm(out[:, 3:] - asked[:, 3:6], axis=1)) < 2e-6
        assert np.abs(np.linalg.norm(out[:, :3] - asked[:, :3], axis=1) - A).max() < 1e-9


@pytest.fixture
def animator(tmp_path: Path) -> Animator:
    return _animator(tmp_path / "person.gltf")


def _animator(path: Path, **options: object) -> Animator:
    return next(iter(load_model_world(write_person(path, **options)).motion.animators.values()))


MIXAMO = {
    "hips": "mixamorig:Hips",
    "spine": "mixamorig:Spine",
    "chest": "mixamorig:Spine1",
    "upperChest": "mixamorig:Spine2",
    "neck": "mixamorig:Neck",
    "head": "mixamorig:Head",
} | {
    f"{word}{part}": f"mixamorig:{word.capitalize()}{other}"
    for word in ("left", "right")
    for part, other in (
        ("Eye", "Eye"),
        ("Shoulder", "Shoulder"),
        ("UpperArm", "Arm"),
        ("LowerArm", "ForeArm"),
        ("Hand", "Hand"),
        ("UpperLeg", "UpLeg"),
        ("LowerLeg", "Leg"),
        ("Foot", "Foot"),
        ("Toes", "ToeBase"),
    )
}
BLENDER = {"hips": "hips", "chest": "spine.001", "upperChest": "spine.002"} | {
    f"{word}{part}": f"{other}.{word[0].upper()}"
    for word in ("left", "right")
    for part, other in (
        ("Eye", "eye"),
        ("Shoulder", "shoulder"),
        ("UpperArm", "upper_arm"),
        ("LowerArm", "forearm"),
        ("Hand", "hand"),
        ("UpperLeg", "thigh"),
        ("LowerLeg", "shin"),
        ("Foot", "foot"),
        ("Toes", "toe"),
    )
}
VRM0 = {bone: f"J_Bip_C_{bone[0].upper()}{bone[1:]}" for bone in ("hips", "spine", "chest", "neck", "head")} | {
    f"{word}{part}": f"J_Bip_{word[0].upper()}_{part}"
    for word in ("left", "right")
    for part in ("Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")
}


@pytest.mark.parametrize("names", [{}, MIXAMO, BLENDER, VRM0])
def test_the_bones_of_others_are_found_by_what_they_call_them(tmp_path: Path, names: dict[str, str]) -> None:
    found = find_humanoid(_animator(tmp_path / "person.gltf", names=names).rig)
    assert found.complete and set(NEEDED) <= set(found.slots)
    for bone in (*NEEDED, "leftShoulder", "upperChest", "neck"):
        assert found.names[bone] == names.get(bone, bone)


def test_a_limb_reaches_and_is_blended_over_the_clip(animator: Animator) -> None:
    rig, target = animator.rig, np.array([0.35, 1.35, 0.3])
    reach = LimbReach(rig, find_humanoid(rig).limb("left_arm"), lambda: target, lambda s: s + (0.4, -0.8, -0.5))
    reach(animator.pose, 0.0)
    chain = Chain(rig)
    chain.follow(animator.pose)
    assert np.allclose(chain.places[rig.slot("leftHand")], target, atol=1e-9)
    half = animator.rig.rest.copy()
    reach.weight = 0.5
    reach(half, 0.0)
    chain.follow(half)
    away = np.linalg.norm(chain.places[rig.slot("leftHand")] - target)
    assert 0.05 < away < np.linalg.norm(np.array(PLACES["leftHand"][1]) - target)


def test_the_eyes_meet_what_is_looked_at(animator: Animator) -> None:
    rig = animator.rig
    target = np.array([1.0, 1.9, 2.0])
    look = LookAt(rig, find_humanoid(rig), lambda: target)
    look(animator.pose, 0.0)
    chain = Chain(rig)
    chain.follow(animator.pose)
    for eye in ("leftEye", "rightEye"):
        slot = rig.slot(eye)
        x, y, z, w = chain.turns[slot]
        gaze = np.array([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)])
        wanted = target - chain.places[slot]
        assert np.degrees(np.arccos(gaze @ wanted / np.linalg.norm(wanted))) < 1.0


def _standing(**moved: object) -> Trackers:
    at = {name: np.array([*PLACES[name][1], 0, 0, 0, 1.0]) for name in ("head", "leftHand", "rightHand")}
    for name, value in moved.items():
        at[name][: len(value)] = value  # type: ignore[arg-type]
    return Trackers(at["head"], at["leftHand"], at["rightHand"])


def test_head_and_hands_are_where_they_are_tracked(animator: Animator) -> None:
    rig = animator.rig
    reported = _standing(
        head=(0.1, 1.5, 0.15, *turn("y", 20)),
        leftHand=(0.3, 1.2, 0.45, *turn("x", 30)),
        rightHand=(-0.1, 1.4, 0.5, *turn("z", 60)),
    )
    UpperBody(rig, find_humanoid(rig), lambda: reported)(animator.pose, 0.0)
    chain = Chain(rig)
    chain.follow(animator.pose)
    for name, wanted in (("head", reported.head), ("leftHand", reported.left), ("rightHand", reported.right)):
        slot = rig.slot(name)
        assert np.allclose(chain.places[slot], wanted[:3], atol=1e-9), name
        assert abs(chain.turns[slot] @ wanted[3:]) == pytest.approx(1.0, abs=1e-9), name
    for bone, (parent, place) in PLACES.items():
        if parent:
            length = np.linalg.norm(chain.places[rig.slot(bone)] - chain.places[rig.slot(parent)])
            assert length == pytest.approx(np.linalg.norm(np.array(place) - PLACES[parent][1]), abs=1e-9)


def test_a_leg_goes_with_the_ball_of_its_foot_and_keeps_its_ankle(tmp_path: Path) -> None:
    rig = next(iter(load_model_world(write_person(tmp_path / "person.gltf")).motion.animators.values())).rig
    hip, knee, toes = (rig.slot(f"right{bone}") for bone in ("UpperLeg", "LowerLeg", "Toes"))
    chain, pose = Chain(rig), rig.rest.copy()
    target = chain.places[toes] + (0.0, 0.15, 0.20)
    LimbReach(rig, (hip, knee, toes), lambda: target, lambda shoulder: shoulder + (0.0, 0.0, 1.0))(pose, 0.0)
    chain.follow(pose)
    assert np.linalg.norm(chain.places[toes] - target) < 1e-9
    moved = [
        slot for slot in range(len(rig.names)) if not np.array_equal(pose.rotations[slot], rig.rest.rotations[slot])
    ]
    assert moved == [hip, knee]
