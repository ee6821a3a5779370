"""Arms of every shipped person and of foreign skeletons after trackers: wrists exact, elbows without jumps."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.kernels.two_bone import reach_two_bones
from mimics_app.world.content.motion.reach import Chain, ReachCase
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.content.motion.upper_body import Trackers, UpperBody
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.person_maker import Places, resting, write_person
from tests.support.tracked_bodies import pose_all

PEOPLE = sorted((Path(__file__).parents[2] / "assets" / "models" / "avatars").glob("*.glb"))
FOREIGN = ["centimetres", "many bones"]


def _many_bones() -> Places:
    """More vertebrae than have names, twist bones in both halves of the arm, and bones of unequal lengths."""
    places = resting(45.0)
    places["vertebra"] = ("spine", (0.0, 1.10, 0.02))
    places["chest"] = ("vertebra", places["chest"][1])
    places["vertebra.001"] = ("upperChest", (0.0, 1.38, -0.02))
    places["neck"] = ("vertebra.001", places["neck"][1])
    for word in ("left", "right"):
        upper, lower, hand = (np.array(places[word + bone][1]) for bone in ("UpperArm", "LowerArm", "Hand"))
        lower = upper + 0.8 * (lower - upper)
        places[f"{word}Twist"] = (f"{word}UpperArm", tuple(0.5 * (upper + lower) + 0.01))
        places[f"{word}LowerArm"] = (f"{word}Twist", tuple(lower))
        places[f"{word}Roll"] = (f"{word}LowerArm", tuple(0.5 * (lower + hand)))
        places[f"{word}Hand"] = (f"{word}Roll", tuple(hand))
    return places


@pytest.fixture(params=[*PEOPLE, *FOREIGN], ids=lambda each: getattr(each, "stem", each))
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Rig:
    path = request.param
    if path == "centimetres":
        path = write_person(tmp_path / "person.gltf", armature=True, places=resting(0.0))
    elif path == "many bones":
        path = write_person(tmp_path / "person.gltf", places=_many_bones())
    return _rig_of(path)


@cache
def _rig_of(path: Path) -> Rig:
    """The rig of a file; nothing here changes it."""
    return next(iter(load_model_world(path).motion.animators.values())).rig


def _arms(rig: Rig) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Head's place, places of both shoulders, and lengths of both arms at rest."""
    rest, slots = Chain(rig), find_humanoid(rig).slots
    joints = [[rest.places[slots[word + bone]] for bone in ("UpperArm", "LowerArm", "Hand")] for word in _SIDES]
    lengths = [np.linalg.norm(b - a) + np.linalg.norm(c - b) for a, b, c in joints]
    return rest.places[slots["head"]], np.array([each[0] for each in joints]), np.array(lengths)


_SIDES = ("left", "right")


def _turns(rng: np.random.Generator, count: int, spread: float) -> np.ndarray:
    turns = np.concatenate([rng.normal(0.0, spread, (count, 3)), np.ones((count, 1))], axis=1)
    return turns / np.linalg.norm(turns, axis=1, keepdims=True)


def _random_trackers(rig: Rig, count: int) -> tuple[np.ndarray, np.ndarray]:
    rng, (head, shoulders, lengths) = np.random.default_rng(3), _arms(rig)
    moved = rng.uniform(-0.2, 0.2, (count, 3)) * (1.0, 0.7, 1.0)
    heads = np.concatenate([head + moved, _turns(rng, count, 0.4)], axis=1)
    way = rng.normal(size=(count, 2, 3))
    way *= (lengths * rng.uniform(0.0, 1.15, (count, 2)))[:, :, None] / np.linalg.norm(way, axis=2, keepdims=True)
    turned = _turns(rng, 2 * count, 2.0).reshape(count, 2, 4)
    return heads, np.concatenate([shoulders + moved[:, None] + way, turned], axis=2)


def _assert_wrists(rig: Rig, count: int) -> None:
    heads, hands = _random_trackers(rig, count)
    found = pose_all(rig, heads, hands)
    shoulder, elbow, wrist = found[:, :, :3], found[:, :, 3:6], found[:, :, 6:]
    a, b = np.linalg.norm(elbow - shoulder, axis=2), np.linalg.norm(wrist - elbow, axis=2)
    far = np.linalg.norm(hands[:, :, :3] - shoulder, axis=2)
    nearest = np.sqrt(a * a + b * b + 2.0 * a * b * np.cos(np.radians(150.0)))
    reachable = (far < 0.97 * (a + b)) & (far > nearest)
    assert reachable.mean() > 0.5
    assert (far[reachable] > 0.9 * (a + b)[reachable]).sum() > count / 50, "the collar bone gives in some"
    assert np.linalg.norm(wrist - hands[:, :, :3], axis=2)[reachable].max() < 1e-9
    assert np.ptp(a, axis=0).max() < 1e-9 and np.ptp(b, axis=0).max() < 1e-9, "bones keep their lengths"
    assert np.isfinite(found).all()


def test_a_wrist_that_can_be_reached_is_where_it_is_tracked(rig: Rig) -> None:
    """Within 0.97 of the arm from where the shoulder comes to stand, and an elbow bent by 150 degrees at most."""
    _assert_wrists(rig, 4_000)


@pytest.mark.slow
def test_a_wrist_that_can_be_reached_is_where_it_is_tracked_of_many(rig: Rig) -> None:
    _assert_wrists(rig, 100_000)


def _smooth(rng: np.random.Generator, count: int, size: int) -> np.ndarray:
    """Sums of sines below 0.5 Hz at 90 pictures a second, of standard deviation 1."""
    seconds = np.arange(count)[:, None, None] / 90.0
    strength, pace, start = rng.normal(size=(6, size)), rng.uniform(0.02, 0.5, (6, size)), rng.uniform(0, 7, (6, size))
    return np.asarray((strength * np.sin(2.0 * np.pi * pace * seconds + start)).sum(axis=1) / np.sqrt(3.0))


@pytest.mark.parametrize("near", [False, True], ids=["everywhere", "near the shoulder"])
def test_an_elbow_moves_no_more_than_8_mm_per_mm_of_the_wrist(rig: Rig, near: bool) -> None:
    """Both from the upper arm's joint, so that what the trunk moves is left out; fastest hands about 3 m/s."""
    rng, count = np.random.default_rng(5), 3_000
    head, shoulders, lengths = _arms(rig)
    heads = np.zeros((count, 7))
    heads[:, :3] = head + 0.06 * _smooth(rng, count, 3) * (1.0, 0.5, 1.0)
    turns = np.concatenate([0.25 * _smooth(rng, count, 3), np.ones((count, 1))], axis=1)
    heads[:, 3:] = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    hands = np.zeros((count, 2, 7))
    hands[:, :, 6] = 1.0
    reach = (0.2 if near else 0.6) * lengths
    hands[:, :, :3] = shoulders + reach[:, None] * _smooth(rng, count, 6).reshape(count, 2, 3)
    found = pose_all(rig, heads, hands, seconds=1.0 / 90.0)
    elbow = np.linalg.norm(np.diff(found[:, :, 3:6] - found[:, :, :3], axis=0), axis=2)
    wrist = np.linalg.norm(np.diff(hands[:, :, :3] - found[:, :, :3], axis=0), axis=2)
    far = np.linalg.norm(hands[:, :, :3] - found[:, :, :3], axis=2)
    assert (far < 0.12).sum() > 50 if near else (far > 0.9 * lengths).sum() > 200, "where it is difficult"
    assert (elbow / wrist).max() <= 8.0
    missed = np.linalg.norm(found[:, :, 6:] - hands[:, :, :3], axis=2)
    assert missed[(far < 0.97 * lengths) & (far > 0.40 * lengths)].max() < 1e-9, "it has caught up out there"


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
@pytest.mark.parametrize("which", ["head", "left", "right"])
def test_a_tracker_without_a_pose_moves_nothing(tmp_path: Path, wrong: float, which: str) -> None:
    path = write_person(tmp_path / "person.gltf")
    rig = next(iter(load_model_world(path).motion.animators.values())).rig
    head, shoulders, _ = _arms(rig)
    joints = {"head": head, "left": shoulders[0] + (0, -0.2, 0.3), "right": shoulders[1] + (0, -0.2, 0.3)}
    poses = {name: np.array([*place, 0, 0, 0, 1.0]) for name, place in joints.items()}
    for index in range(7):
        spoilt = {name: pose.copy() for name, pose in poses.items()}
        spoilt[which][index] = wrong
        kept = None if which == "head" else Trackers(**{**poses, which: None})
        results = []
        for given in (Trackers(**spoilt), kept):
            pose = rig.rest.copy()
            UpperBody(rig, find_humanoid(rig), lambda given=given: given)(pose, 0.0)  # type: ignore[misc]
            results.append(pose)
        for got, wanted in zip(*results, strict=True):
            assert np.array_equal(got, wanted)


@pytest.mark.parametrize("index", range(4))
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -1.0])
def test_a_limb_of_no_sense_is_named_and_gives_numbers(index: int, wrong: float) -> None:
    """Lengths, soft share and swivel limit: not a number, infinite or negative; a swivel without limit is plain."""
    asked = np.array([[0, 0, 0, 0.3, -0.1, 0.2, 0, -1.0, 0.0]])
    limb = np.array([[0.3, 0.27, 0.03, 0.1]])
    limb[0, index] = wrong
    states, out, cases = np.array([[1.0, 0, 0, 0, 1.0, 0, 1.0]]), np.zeros((1, 6)), np.zeros(1, np.int32)
    reach_two_bones(asked, limb, states, out, cases)
    plain = index == 3 and wrong == np.inf
    assert bool(cases[0] & ReachCase.NOT_FINITE) is not plain
    assert np.isfinite(out).all() and np.isfinite(states).all()
