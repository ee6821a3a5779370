"""Closest point of the tunnel's bisector: methods with their cost and error."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import MAX_PIECES, TUNNEL
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.tunnel_projection import (
    project_brute_force,
    project_golden_section,
    track,
    track_one_step,
)
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve, build_tunnel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Table, TunnelRecord, TunnelStateRecord

__all__ = ["closest_by_roots"]


_PIECES = 16
_SIZES = (6, 12, 24, 48, MAX_PIECES)
_TICKS = 4000
_TICKS_OF = (_TICKS, _TICKS, 40, 400)
"""Ticks over which the cost of a method is measured, by its number: fewer for slow ones."""
_EVERY = 20


def closest_by_roots(pieces: F8, p: F8) -> tuple[float, float]:
    """Return parameter s and distance [m] of the closest point by the roots of the slope of every segment.

    Args:
        pieces: Cubic segments, shape [n, 3, 4].
        p: Point [m], shape [3].
    """
    best = (0.0, np.inf)
    for i, piece in enumerate(pieces):
        away = piece.copy()
        away[:, 0] -= p
        slope = np.sum([np.convolve(away[k], away[k, 1:] * np.arange(1, 4)) for k in range(3)], axis=0)
        roots = np.roots(slope[::-1])
        real = roots.real[(np.abs(roots.imag) < 1e-6) & (roots.real > 0.0) & (roots.real < 1.0)]
        u = np.concatenate([[0.0, 1.0], real])
        distance = np.linalg.norm(away @ (u ** np.arange(4)[:, None]), axis=0)
        nearest = int(np.argmin(distance))
        if distance[nearest] < best[1]:
            best = (i + float(u[nearest]), float(distance[nearest]))
    return best


@cache
def _probe_tunnel(pieces: int = _PIECES) -> tuple[TunnelCurve, NDArray[Any], F8]:
    """Return a wavy tunnel, its record, shape [1], and the path of a ball in it at 0.3 m/s [m], shape [4000, 3]."""
    i = np.arange(pieces + 3)
    points = np.column_stack([0.03 * i - 0.27, 0.05 * np.sin(0.9 * i), 0.02 * np.cos(0.7 * i)])
    curve = build_tunnel(points, 0.02)
    record = np.zeros(1, TUNNEL)
    curve.fill(record[0])
    record["radius_scale"] = 1.0
    arc = 0.5 * curve.length + 0.45 * curve.length * np.sin(0.3e-3 * np.arange(_TICKS) / (0.45 * curve.length))
    s = curve.parameter_at(arc)
    _, n, b = curve.frame(s)
    turn = 2.0 * np.pi * 1.3e-3 * np.arange(_TICKS)
    path = curve.point(s) + 0.015 * (np.cos(turn)[:, None] * n + np.sin(turn)[:, None] * b)
    return curve, record, np.ascontiguousarray(path)


@kernel
def _walk(number: int, tunnels: Table[TunnelRecord], path: F8, states: Table[TunnelStateRecord], out: F8) -> None:
    """Compute the parameter at every point of a path by the method of a number."""
    for i in range(path.shape[0]):
        x, y, z = path[i, 0], path[i, 1], path[i, 2]
        if number == 0:
            out[i] = track(tunnels[0], x, y, z, states[0])
        elif number == 1:
            out[i] = track_one_step(tunnels[0], x, y, z, states[0])
        elif number == 2:
            out[i] = project_brute_force(tunnels[0], x, y, z, states[0])
        else:
            out[i] = project_golden_section(tunnels[0], x, y, z, states[0])


def _cost_us(number: int, pieces: int) -> float:
    _, record, path = _probe_tunnel(pieces)
    ticks = _TICKS_OF[number]
    out = np.empty(ticks)
    return shortest_us(lambda: _walk(number, record, path[:ticks], np.zeros(1, TUNNEL_STATE), out), ticks)


@cache
def _reference_parameters() -> F8:
    curve, _, path = _probe_tunnel()
    return np.array([closest_by_roots(curve.pieces, p)[0] for p in path[::_EVERY]])


def _error(number: int) -> float:
    """Return the largest distance between the computed and the closest point along the path [m]."""
    curve, record, path = _probe_tunnel()
    out = np.empty(len(path))
    _walk(number, record, path, np.zeros(1, TUNNEL_STATE), out)
    difference = curve.point(out[::_EVERY]) - curve.point(_reference_parameters())
    return float(np.max(np.linalg.norm(difference, axis=1)))


compare(
    __name__,
    "closest point of a wavy tunnel's bisector for a ball that travels it at 0.3 m/s, tick by tick",
    "m",
    [
        Rival(
            "newton warm",
            "Newton on the slope of the square distance from the last tick's point; whole search when it is lost",
            "radius x curvature < 1; stays on its branch where the tunnel crosses or meets itself",
            {"projection": "newton warm"},
            (0,),
        ),
        Rival(
            "newton one step",
            "one Newton step a tick from the last tick's point; the guards of newton warm",
            "as newton warm; errs by about the square of a tick's motion over the bend's radius",
            {"projection": "newton one step"},
            (1,),
        ),
        Rival(
            "brute force",
            "nearest of 256 points a piece",
            "any curve; jumps between branches where the tunnel crosses itself",
            {"projection": "brute force"},
            (2,),
        ),
        Rival(
            "golden section",
            "golden section around the nearest of 8 points a piece (Kiefer 1953)",
            "any curve; to the square root of machine precision; jumps between branches",
            {"projection": "golden section"},
            (3,),
        ),
    ],
    Probes(_cost_us, _error),
    default="newton warm",
    growth=Growth(work="pieces of the tunnel", sizes=_SIZES, typical=_PIECES),
)
