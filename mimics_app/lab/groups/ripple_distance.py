"""Distances from a tap on a bent cord, which place the crest of a ripple.

Error: position of a crest after two radii, in any direction from a tap inside, beside or outside of the bend, against
geodesics of the tube [m]. Cost: of the distances of the vertices of a cord.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare

__all__ = ["BENDS", "crest_error", "midway", "straight"]

Distance = Callable[[F8, F8, float, float], F8]

BENDS = (0.0, 0.1, 0.3, 0.6, 0.9)
"""Radius of the cord times curvature of its centre line; from 1 on the surface intersects itself."""
_RADIUS = 0.025
_DISTANCE = 2.0 * _RADIUS
_TAPS = (0.0, 0.5 * np.pi, np.pi)
"""Angles of taps: inside the bend, beside it and outside [rad]."""
_DIRECTIONS = 181
_STEPS = 400
_VERTICES = 3200


def straight(ds: F8, dt: F8, bend: float, tap: float) -> F8:
    """Return the distance on a straight cord [radii]."""
    return np.hypot(ds, dt)


def midway(ds: F8, dt: F8, bend: float, tap: float) -> F8:
    """Return the distance with the length along the cord at half the angle [radii]."""
    return np.hypot(ds * (1.0 - bend * np.cos(tap + 0.5 * dt)), dt)


def crest_error(distance: Distance, bend: float) -> float:
    """Return the largest error of a crest at a geodesic distance of `_DISTANCE` [m]."""
    worst = 0.0
    for tap in _TAPS:
        along, around = _follow(bend, tap).T
        estimated = distance(along, around - tap, bend, tap) * _RADIUS
        worst = max(worst, float(np.abs(estimated - _DISTANCE).max()))
    return worst


def _follow(bend: float, tap: float) -> F8:
    """Return the ends of geodesics from a tap in all directions, [n, 2]: along the cord [radii] and around it [rad].

    On a torus the line element is (1 - bend cos t) ds along and dt around; midpoint rule (do Carmo 1976, 4-4).
    """
    angle = np.linspace(-np.pi / 2, np.pi / 2, _DIRECTIONS)
    step = _DISTANCE / _RADIUS / _STEPS
    reach = 1.0 - bend * np.cos(tap)
    state = np.stack([0.0 * angle, tap + 0.0 * angle, np.cos(angle) / reach, np.sin(angle)], axis=1)
    for _ in range(_STEPS):
        state = state + step * _slope(state + 0.5 * step * _slope(state, bend), bend)
    return state[:, :2]


def _slope(state: F8, bend: float) -> F8:
    _, t, along, around = state.T
    reach, change = 1.0 - bend * np.cos(t), bend * np.sin(t)
    return np.stack([along, around, -2.0 * change / reach * along * around, reach * change * along * along], axis=1)


def _cost_us(distance: Distance, bend: float) -> float:
    rng = np.random.default_rng(1)
    ds, dt = rng.uniform(-20.0, 20.0, _VERTICES), rng.uniform(-np.pi, np.pi, _VERTICES)
    return shortest_us(lambda: distance(ds, dt, bend, 0.0))


def _bent(bend: float) -> list[Rival]:
    """Return the two methods on a cord of a bend; on a straight one they are the same."""
    as_straight = Rival(
        f"as if straight, bend {bend:g}",
        "the hypotenuse of along and around; bend: radius times curvature",
        "exact on a straight cord, whatever the distance; else where its error does",
        None if bend else {},
        (straight, bend),
    )
    halfway = Rival(
        f"reach halfway, bend {bend:g}",
        "along shortened as the surface is halfway round to the place",
        "where its error does",
        probed=(midway, bend),
    )
    return [as_straight, halfway] if bend else [as_straight]


compare(
    __name__,
    "distance of 3,200 vertices from a tap on a bent cord of 25 mm; error: of a crest after 50 mm",
    "m",
    [rival for bend in BENDS for rival in _bent(bend)],
    Probes(_cost_us, crest_error),
    default="as if straight, bend 0",
)
