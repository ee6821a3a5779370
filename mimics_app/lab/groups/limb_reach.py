"""Inverse kinematics of a limb of two bones with cost and error of the hand.

Probe: arms of 0.30 and 0.27 m with random targets below the zone of soft reach; the elbow points to a pole.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.ports.methods import Settings
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.iterative_reach import reach_by_descent, reach_by_fabrik
from mimics_app.world.content.motion.kernels.two_bone import reach_two_bones

__all__ = ["arms", "elbow_gain"]


UPPER, LOWER, SOFT = 0.30, 0.27, 0.03
_ARMS = 10_000
_STEP = 1e-5
"""Step of a target that moves across the reach limit [m]."""

Solve = Callable[[F8, F8, F8], None]
"""Writes elbow and hand of limbs to its last argument: targets [n, 9], limbs [n, 4], out [n, 6]."""


def arms(count: int) -> tuple[F8, F8]:
    """Return shoulder, target and pole [m], [n, 9], and parameters of the limbs, [n, 4]."""
    rng = np.random.default_rng(1)
    shoulder, direction = rng.normal(size=(count, 3)), rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    longest, shortest = UPPER + LOWER, UPPER - LOWER
    reach = rng.uniform(shortest + SOFT * longest + 1e-3, (1.0 - SOFT) * longest - 1e-3, (count, 1))
    asked = np.concatenate([shoulder, shoulder + reach * direction, shoulder + rng.normal(size=(count, 3))], axis=1)
    return asked, np.tile([UPPER, LOWER, SOFT, np.inf], (count, 1))


@cache
def _kept(count: int) -> tuple[F8, NDArray[np.int32]]:
    """Return the states of limbs and their cases; without effect here, as every pole determines a side."""
    return np.zeros((count, 7)), np.zeros(count, np.int32)


def _closed(asked: F8, limbs: F8, out: F8) -> None:
    states, cases = _kept(len(asked))
    reach_two_bones(asked, limbs, states, out, cases)


def _hard(asked: F8, limbs: F8, out: F8) -> None:
    stiff = limbs.copy()
    stiff[:, 2] = 0.0
    _closed(asked, stiff, out)


def _fabrik(asked: F8, limbs: F8, out: F8) -> None:
    reach_by_fabrik(asked, limbs, 1e-3, 10, out)


def _fabrik_long(asked: F8, limbs: F8, out: F8) -> None:
    reach_by_fabrik(asked, limbs, 1e-6, 200, out)


def _descent(asked: F8, limbs: F8, out: F8) -> None:
    reach_by_descent(asked, limbs, 1e-3, 10, out)


def elbow_gain(solve: Solve) -> float:
    """Return the largest ratio of the motions of elbow and target while the target crosses the reach limit."""
    away = np.arange(0.8 * (UPPER + LOWER), 1.1 * (UPPER + LOWER), _STEP)
    asked, limbs = np.zeros((len(away), 9)), np.tile([UPPER, LOWER, SOFT, np.inf], (len(away), 1))
    asked[:, 3], asked[:, 7] = away, -1.0
    out = np.zeros((len(away), 6))
    solve(asked, limbs, out)
    return float(np.linalg.norm(np.diff(out[:, :3], axis=0), axis=1).max() / _STEP)


def _cost_us(solve: Solve) -> float:
    asked, limbs = arms(_ARMS)
    out = np.zeros((_ARMS, 6))
    return shortest_us(lambda: solve(asked, limbs, out), _ARMS)


def _error(solve: Solve) -> float:
    asked, limbs = arms(_ARMS)
    out = np.zeros((_ARMS, 6))
    solve(asked, limbs, out)
    return float(np.linalg.norm(out[:, 3:] - asked[:, 3:6], axis=1).max())


def _rival(name: str, source: str, valid: str, solve: Solve, settings: Settings | None = None) -> Rival:
    gain = elbow_gain(solve)
    valid = f"{valid}; at the reach limit the elbow moves {gain:.3g} times as far as the target"
    return Rival(name, source, valid, settings, (solve,))


compare(
    __name__,
    "an arm that reaches for a point within its reach; error: how far the hand stays away",
    "m",
    [
        _rival("closed form", "law of cosines, soft reach, pole plane kept from step to step", "any", _closed, {}),
        _rival("closed form, hard limit", "the same clamped at full stretch", "below full stretch", _hard),
        _rival(
            "FABRIK, 10 rounds", "Aristidou & Lasenby 2011, to 1 mm", "no unequal bones near the inner limit", _fabrik
        ),
        _rival("FABRIK, 200 rounds", "the same, to 1 um", "as above", _fabrik_long),
        _rival("coordinate descent, 10 rounds", "Wang & Chen 1991, to 1 mm", "slow near full stretch", _descent),
    ],
    Probes(_cost_us, _error),
    default="closed form",
)
