"""Walking: feet that stand do not slip, toes stay above the ground, given angles are followed, corrections told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.world.gltf.model_world import load_model_world
from mimics_app.world.motion.animator import Animator
from mimics_app.world.motion.gait import Pace, Walk
from mimics_app.world.motion.humanoid import find_humanoid
from mimics_app.world.motion.reach import Chain
from tests.support.person_maker import write_person

FRAME = 1.0 / 60.0
PACES = [Pace(0.6, 0.42), Pace(1.0, 0.55), Pace(1.4, 0.68)]


@pytest.fixture
def animator(tmp_path: Path) -> Animator:
    return next(iter(load_model_world(write_person(tmp_path / "person.gltf")).motion.animators.values()))


def _walk(
    animator: Animator, pace: Pace, seconds: float, **more: object
) -> tuple[list[Walk], np.ndarray, np.ndarray, np.ndarray]:
    """What each frame came to: contacts over the ground [n, 2, 3], soles (heel, ball) [n, 2, 2, 3], angles [n, 4]."""
    rig, bones = animator.rig, find_humanoid(animator.rig)
    gone = [0.0]
    walk = Walk(rig, bones, lambda: pace, move=lambda way: gone.append(gone[-1] + way), **more)  # type: ignore[arg-type]
    animator.steps[:] = [walk]
    chain, contacts, soles, angles = Chain(rig), [], [], []
    for _ in range(round(seconds / FRAME)):
        animator.step(FRAME)
        chain.follow(animator.pose)
        ahead = np.array([0.0, 0.0, gone[-1]])
        contacts.append(walk.gait.contacts + ahead)
        soles.append([[_sole(chain, side, along) + ahead for along in (-0.042, 0.14)] for side in ("left", "right")])
        angles.append(np.stack([walk.gait.hip, walk.gait.knee], 1).ravel())
    return [walk], np.array(contacts), np.array(soles), np.array(angles)


def _sole(chain: Chain, side: str, along: float) -> np.ndarray:
    """A point of the sole as the skeleton has it: below the ankle, ahead of it or behind."""
    slot = chain.rig.slot(f"{side}Foot")
    axis, w = chain.turns[slot][:3], chain.turns[slot][3]
    v = np.array([0.0, -0.08, along])
    turn = 2.0 * np.cross(axis, v)
    return chain.places[slot] + v + w * turn + np.cross(axis, turn)


@pytest.mark.parametrize("pace", PACES)
def test_what_stands_does_not_slip_and_nothing_dips_into_the_ground(animator: Animator, pace: Pace) -> None:
    _, contacts, soles, _ = _walk(animator, pace, 4.0)
    for side in (0, 1):
        standing = np.isfinite(contacts[:, side, 0])
        assert 0.55 < standing.mean() < 0.75
        both = standing[1:] & standing[:-1]
        moved = np.abs(np.diff(contacts[:, side, 2]))[both]
        # Heel, flat, ball: the point of contact changes twice in a stance; between, it is where it was.
        assert np.median(moved) < 1e-3 * FRAME
        for point in (0, 1):
            resting = soles[:, side, point, 1] < 1e-4
            still = resting[1:] & resting[:-1]
            slip = np.abs(np.diff(soles[:, side, point, 2])[still]) / FRAME
            assert still.sum() > 10 and np.percentile(slip, 95) <= 1e-3, slip.max()
    assert soles[..., 1].min() > -1e-6


@pytest.mark.parametrize("pace", PACES)
def test_the_way_is_that_of_the_speed_and_the_step(animator: Animator, pace: Pace) -> None:
    (walk,), contacts, *_ = _walk(animator, pace, 10.0)
    heel = contacts[:, 0, 2]
    starts = [k for k in range(1, len(heel)) if np.isfinite(heel[k]) and not np.isfinite(heel[k - 1])]
    strides = np.diff(heel[starts])
    assert np.allclose(strides, 2.0 * pace.step, atol=2.5 * pace.speed * FRAME)
    assert walk.gait.way == pytest.approx(pace.speed * FRAME)


def test_given_angles_are_followed_and_the_correction_is_told(animator: Animator) -> None:
    """Angles of its own path come back unchanged; others by as much as the standing foot forbids."""
    pace = PACES[1]
    *_, angles = _walk(animator, pace, 4.0)
    period = 1.0 / pace.cadence
    frames = round(period / FRAME)
    cycle = angles[-frames:]
    phases = (np.arange(len(angles) - frames, len(angles)) + 1) * FRAME / period % 1.0
    order = np.argsort(phases)

    def told(phase: float) -> np.ndarray:
        return np.array([np.interp(phase, phases[order], cycle[order, k], period=1.0) for k in range(4)])

    (walk,), *_ = _walk(animator, pace, 4.0, angles=told)
    assert np.degrees(walk.gait.correction) < 5.0
    (walk,), *_ = _walk(animator, pace, 4.0, angles=lambda phase: told(phase) + np.radians(12.0))
    assert np.degrees(walk.gait.correction) > 5.0
