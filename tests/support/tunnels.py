"""Tunnels for tests, and single calls of the tick's force from Python."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.maths.bspline import basis_functions
from mimics_app.rendering.haptic.kernels.tunnel import tunnel_force
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve, build_tunnel

Array = NDArray[np.float64]


@kernel
def _walk(tunnels: Any, path: Array, velocities: Array, ball_radius: float, states: Any, out: Any) -> None:
    for i in range(path.shape[0]):
        tunnel_force(tunnels[0], path[i], velocities[i], ball_radius, states[0])
        out[i] = states[0]


def record_of(curve: TunnelCurve, **forces: float) -> NDArray[Any]:
    """A TUNNEL record, shape [1], with radius_scale 1 and no forces but the named ones."""
    record = np.zeros(1, TUNNEL)
    curve.fill(record[0])
    record["radius_scale"] = 1.0
    for name, value in forces.items():
        record[name] = value
    return record


def walk(
    record: NDArray[Any],
    path: ArrayLike,
    velocities: ArrayLike = (0.0, 0.0, 0.0),
    ball_radius: float = 0.0,
    state: NDArray[Any] | None = None,
) -> NDArray[Any]:
    """One tick at every point of the path; the state after each, shape [m]. A fresh state unless one is given."""
    points = np.ascontiguousarray(np.atleast_2d(path), np.float64)
    speeds = np.ascontiguousarray(np.broadcast_to(velocities, points.shape), np.float64)
    state = np.zeros(1, TUNNEL_STATE) if state is None else state
    out = np.zeros(len(points), TUNNEL_STATE)
    _walk(record, points, speeds, ball_radius, state, out)
    return out


def afresh(
    record: NDArray[Any], points: ArrayLike, velocities: ArrayLike = (0.0, 0.0, 0.0), ball_radius: float = 0.0
) -> NDArray[Any]:
    """One tick at every point, each with a new state; shape [m]."""
    points = np.atleast_2d(np.asarray(points, np.float64))
    speeds = np.broadcast_to(np.asarray(velocities, np.float64), points.shape)
    ticks = [walk(record, p, v, ball_radius) for p, v in zip(points, speeds, strict=True)]
    return np.concatenate(ticks)


def straight(radius: ArrayLike = 0.02, length: float = 0.4) -> TunnelCurve:
    """Along +x from the origin, four pieces."""
    x = np.array([0.0, 1.0, 3.0, 6.0, 9.0, 11.0, 12.0]) / 12.0 * length
    return build_tunnel(np.column_stack([x, 0.0 * x, 0.0 * x]), radius)


def wavy(radius: ArrayLike = 0.02, height: float = 0.06) -> TunnelCurve:
    """A planar wave in the plane z = 0, about 0.6 m long."""
    i = np.arange(9)
    return build_tunnel(np.column_stack([0.06 * i - 0.24, height * np.sin(1.5 * i), 0.0 * i]), radius)


def coil(radius: ArrayLike = 0.015) -> TunnelCurve:
    """A curve that leaves every plane."""
    i = np.arange(12)
    return build_tunnel(np.column_stack([0.08 * np.cos(0.8 * i), 0.02 * i, 0.08 * np.sin(0.8 * i)]), radius)


@cache
def ring(bend_radius: float = 0.1, radius: float = 0.03, angle: float = 4.5) -> tuple[TunnelCurve, float]:
    """(part of a torus in the plane z = 0 from (R, 0, 0) counter-clockwise, how far its bisector is off the circle)."""
    count = 60
    s = np.linspace(0.0, count - 3.0, 1000)
    basis = basis_functions(count, s)
    phi = angle * s / s[-1]
    circle = bend_radius * np.column_stack([np.cos(phi), np.sin(phi), 0.0 * phi])
    curve = build_tunnel(np.linalg.lstsq(basis, circle, rcond=None)[0], radius)
    return curve, float(np.max(np.abs(np.linalg.norm(curve.point(s), axis=1) - bend_radius)))
