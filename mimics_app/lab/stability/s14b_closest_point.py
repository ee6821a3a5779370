"""S14B: radius times curvature near 1: Newton's closest point is lost where the ball passes the centre of the bend.

Seen from a point at distance a from the centre of a bend of radius R, the slope of the distance goes like the sine of
the angle between ball and closest point, and Newton's step like its tangent: from an angle beyond the root of
tan(x) = 2 x, 1.1656 rad, each step ends farther away than it began. A ball that crosses at speed v turns by
2 atan(v T / 2 a) within the tick that passes the centre, so that textbook Newton from the last tick's point is lost for

    a < v T / (2 tan(0.5828)) = 0.758 v T,     with a / R = 1 - r kappa for a ball on a wall of radius r.

The tick's `track` halves steps that do not go downhill and searches when it must: it is not lost.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.lab.experiment import Experiment, Outcome, Points
from mimics_app.lab.stability.linear import find_limit
from mimics_app.maths.bspline import basis_functions
from mimics_app.rendering.haptic.kernels.tunnel_projection import slope, track
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve, build_tunnel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Table, TunnelRecord, TunnelStateRecord

__all__ = ["EXPERIMENT", "exact_clearance", "newton_miss", "track_miss"]


_BEND = 0.05
"""Radius of the bend [m]."""

_DT = 1e-3  # tick [s]
_CONTROL_POINTS = 90  # of the curve
_ANGLE = 4.5  # of the arc that it follows [rad]
_ITERATIONS = 24  # of the reference search
_TICKS = 60  # ticks of a pass
_LOST = 1e-5  # miss at which the search has lost the point [m]
_KEPT = 1e-7  # and that of one that kept it, at most [m]


@cache
def _bend() -> tuple[TunnelCurve, NDArray[Any]]:
    """An arc of a circle about the origin in the plane z = 0, symmetrical about +y, and its record, shape [1]."""
    s = np.linspace(0.0, _CONTROL_POINTS - 3.0, 2000)
    angle = 0.5 * np.pi + _ANGLE * (s / s[-1] - 0.5)
    circle = _BEND * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    points = np.linalg.lstsq(basis_functions(_CONTROL_POINTS, s), circle, rcond=None)[0]
    curve = build_tunnel(points, 1e-3)
    record = np.zeros(1, TUNNEL)
    curve.fill(record[0])
    record["radius_scale"] = 1.0
    return curve, record


@kernel
def _newton(tunnel: TunnelRecord, p: F8, s: float) -> float:
    """Return the parameter by textbook Newton on the slope of the squared distance, without halving or search."""
    for _ in range(_ITERATIONS):
        _, gradient, bend, _ = slope(tunnel, p[0], p[1], p[2], s)
        s = min(max(s - gradient / bend, 0.0), float(tunnel.pieces))
    return s


@kernel
def _follow(
    tunnels: Table[TunnelRecord], path: F8, s: float, by_track: bool, states: Table[TunnelStateRecord]
) -> float:
    """Return the largest excess of the distance of the found over the closest point along a path [m]."""
    tunnel = tunnels[0]
    worst = 0.0
    for i in range(path.shape[0]):
        if by_track:
            s = track(tunnel, path[i, 0], path[i, 1], path[i, 2], states[0])
        else:
            s = _newton(tunnel, path[i], s)
        square, _, _, _ = slope(tunnel, path[i, 0], path[i, 1], path[i, 2], s)
        centre = math.sqrt(path[i, 0] ** 2 + path[i, 1] ** 2)
        worst = max(worst, math.sqrt(square) - (_BEND - centre))
    return worst


def _miss(speed: float, clearance: float, by_track: bool) -> float:
    curve, record = _bend()
    x = speed * _DT * (np.arange(_TICKS) - 0.5 * (_TICKS - 1))
    x = x[np.hypot(x, clearance) < _BEND]
    path = np.column_stack([x, np.full(len(x), clearance), 0.0 * x])
    angle = math.atan2(clearance, path[0, 0])
    start = len(curve.pieces) * (0.5 + (angle - 0.5 * math.pi) / _ANGLE)
    return float(_follow(record, path, start, by_track, np.zeros(1, TUNNEL_STATE)))


def newton_miss(speed: float, clearance: float) -> float:
    """Return the error of textbook Newton for a ball at `speed` [m/s], `clearance` [m] from the centre, in m."""
    return _miss(speed, clearance, by_track=False)


def track_miss(speed: float, clearance: float) -> float:
    """Return the same error of the tick's `track`."""
    return _miss(speed, clearance, by_track=True)


def _basin() -> float:
    """Return the root of tan(x) = 2 x in (0, pi/2) [rad]."""
    x = 1.2
    for _ in range(50):
        x -= (math.tan(x) - 2.0 * x) / (1.0 / math.cos(x) ** 2 - 2.0)
    return x


def exact_clearance(speed: float) -> float:
    """Return the clearance below which textbook Newton fails in the worst phase of the ticks [m]."""
    return speed * _DT / (2.0 * math.tan(0.5 * _basin()))


def _smallest_clearance(speed: float) -> float:
    """Return the same clearance by simulation [m]."""
    around = exact_clearance(speed)
    return find_limit(lambda a: newton_miss(speed, a) < _LOST, 2.0 * around, 0.8 * around)


def _simulate_grid(points: int) -> Outcome:
    speeds = [float(speed) for speed in np.geomspace(0.1, 5.0, max(points, 2))]
    simulated: Points = [(speed, _smallest_clearance(speed) / _BEND) for speed in speeds]
    exact: Points = [(speed, exact_clearance(speed) / _BEND) for speed in speeds]
    rows = [
        {
            "speed_m_s": speed,
            "simulated_clearance_share": simulated[i][1],
            "exact_clearance_share": exact[i][1],
            "newton_miss_mm": 1e3 * newton_miss(speed, 0.9 * exact_clearance(speed)),
            "track_miss_mm": 1e3 * max(track_miss(speed, share * exact_clearance(speed)) for share in (0.1, 0.5, 0.9)),
        }
        for i, speed in enumerate(speeds)
    ]
    kept = all(1e-3 * row["track_miss_mm"] < _KEPT for row in rows)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={"1 - r kappa = 0.1": [(speed, 0.1) for speed in speeds]},
        holds=kept,
        note=(
            f"A bend of {1e3 * _BEND:.0f} mm. Below the line textbook Newton from the last tick's point misses by up "
            f"to {max(row['newton_miss_mm'] for row in rows):.0f} mm; the tick's tracking by "
            f"{max(row['track_miss_mm'] for row in rows):.0e} mm."
        ),
    )


EXPERIMENT = Experiment(
    title="Closest point near the centre of a bend",
    claim=(
        "Newton without halving or search is lost exactly for 1 - r kappa < 0.758 v T/R; the tick's tracking stays "
        "within 0.1 um of the closest point."
    ),
    x_label="speed of the ball [m/s]",
    y_label="1 - radius x curvature where Newton is lost",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
    log_y=True,
)
