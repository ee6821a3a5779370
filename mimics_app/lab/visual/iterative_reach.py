"""Two-bone reach by iteration: FABRIK (Aristidou & Lasenby 2011) and cyclic coordinate descent (Wang & Chen 1991)."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import QUATERNION

__all__ = ["reach_by_descent", "reach_by_fabrik"]


_NOWHERE = 1e-12
"""Lower bound of distances in divisions [m]."""

_NO_ARC = 1e-18
"""Product of two lengths [m^2] below which directions are undefined."""

_OPPOSED = 1e-9
"""1 + cosine below which two directions are opposite and the shortest arc is not unique."""


@kernel
def _away(a: F8, b: F8) -> float:
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@kernel
def _pull(point: F8, anchor: F8, length: float) -> None:
    """Move a point to a distance from an anchor along the line between them."""
    scale = length / max(_away(point, anchor), _NOWHERE)
    for i in range(3):
        point[i] = anchor[i] + scale * (point[i] - anchor[i])


@kernel
def _begin(asked: F8, a: float, b: float, elbow: F8, hand: F8) -> None:
    """Initialise both bones, of lengths a and b, from the shoulder towards the pole, then towards the target."""
    for i in range(3):
        elbow[i], hand[i] = asked[6 + i], asked[3 + i]
    _pull(elbow, asked[:3], a)
    _pull(hand, elbow, b)


@kernel
def reach_by_fabrik(asked: F8, limbs: F8, tolerance: float, most: int, out: F8) -> int:
    """Solve limbs by FABRIK, forward and backward; the elbow starts towards the pole.

    Args:
        asked: Shoulder, target and pole of each limb [m], [n, 9].
        limbs: Lengths of the two bones first, [n, >= 2].
        tolerance: Distance of hand and target that is enough [m].
        most: Rounds at most.
        out: Elbow and hand [m], written, [n, 6].

    Returns:
        Rounds in all.
    """
    rounds = 0
    for k in range(asked.shape[0]):
        shoulder, target = asked[k, :3], asked[k, 3:6]
        a, b, elbow, hand = limbs[k, 0], limbs[k, 1], out[k, :3], out[k, 3:]
        _begin(asked[k], a, b, elbow, hand)
        for _ in range(most):
            if _away(hand, target) < tolerance:
                break
            rounds += 1
            for i in range(3):
                hand[i] = target[i]
            _pull(elbow, hand, b)
            _pull(elbow, shoulder, a)
            _pull(hand, elbow, b)
    return rounds


@kernel
def _find_arc(pivot: F8, hand: F8, target: F8, turn: F8) -> bool:
    """Compute the arc about a pivot from hand to target: axis times sine, cosine; return False where there is none."""
    v0, v1, v2 = hand[0] - pivot[0], hand[1] - pivot[1], hand[2] - pivot[2]
    w0, w1, w2 = target[0] - pivot[0], target[1] - pivot[1], target[2] - pivot[2]
    lengths = math.sqrt((v0 * v0 + v1 * v1 + v2 * v2) * (w0 * w0 + w1 * w1 + w2 * w2))
    if lengths < _NO_ARC:
        return False
    turn[0] = (v1 * w2 - v2 * w1) / lengths
    turn[1] = (v2 * w0 - v0 * w2) / lengths
    turn[2] = (v0 * w1 - v1 * w0) / lengths
    turn[3] = (v0 * w0 + v1 * w1 + v2 * w2) / lengths
    return turn[3] > -1.0 + _OPPOSED


@kernel
def _apply_arc(pivot: F8, turn: F8, moved: F8) -> None:
    x, y, z, c = turn[0], turn[1], turn[2], turn[3]
    p0, p1, p2 = moved[0] - pivot[0], moved[1] - pivot[1], moved[2] - pivot[2]
    along = (x * p0 + y * p1 + z * p2) / (1.0 + c)
    moved[0] = pivot[0] + c * p0 + y * p2 - z * p1 + along * x
    moved[1] = pivot[1] + c * p1 + z * p0 - x * p2 + along * y
    moved[2] = pivot[2] + c * p2 + x * p1 - y * p0 + along * z


@kernel
def reach_by_descent(asked: F8, limbs: F8, tolerance: float, most: int, out: F8) -> int:
    """Solve limbs by cyclic coordinate descent: elbow and shoulder alternately; see `reach_by_fabrik`."""
    rounds, turn = 0, np.empty(QUATERNION)
    for k in range(asked.shape[0]):
        shoulder, target = asked[k, :3], asked[k, 3:6]
        a, b, elbow, hand = limbs[k, 0], limbs[k, 1], out[k, :3], out[k, 3:]
        _begin(asked[k], a, b, elbow, hand)
        for _ in range(most):
            if _away(hand, target) < tolerance:
                break
            rounds += 1
            if _find_arc(elbow, hand, target, turn):
                _apply_arc(elbow, turn, hand)
            if _find_arc(shoulder, hand, target, turn):
                _apply_arc(shoulder, turn, elbow)
                _apply_arc(shoulder, turn, hand)
    return rounds
