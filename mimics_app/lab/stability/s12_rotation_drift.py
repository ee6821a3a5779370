"""S12: a product of axis rotations drifts from the rotation about one axis; equation (12) as printed has another axis.

At constant omega a step of rot(x) rot(y) rot(z) is always the same rotation, so that N steps are its N-th power: exact
without any simulation. To first order it drifts (h/2) |wx wy wz| / |w| rad/s. The printed rot(x) rot(y) rot(y) does not
turn about z at all. The exponential map is exact while omega is constant, RK4 to (h w)^5/1920 a step.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numba import types

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.lab.experiment import Experiment, Outcome, Row, largest_disagreement, points_of
from mimics_app.lab.haptic.printed_equations import rotate_printed
from mimics_app.lab.haptic.rotation_updates import rotate_axes, rotate_exponential, rotate_rk4
from mimics_app.lab.stability.laws import ROTATION, Rotation

__all__ = ["DIRECTION", "EXPERIMENT", "drift", "exact_drift"]


DIRECTION = np.array([3.0, 4.0, 5.0]) / np.sqrt(50.0)
"""Axis of the rotation."""

_SECONDS = 10.0
_DT = 1e-3
_EXACT_DEG = 1e-6


@typed_kernel(types.void(ROTATION, types.float64[::1], types.int64, types.float64, types.float64[::1]))
def _spin(rotate: Rotation, omega: Vec, ticks: int, dt: float, q: Vec) -> None:
    """Rotate q by `ticks` steps at constant omega: a body with three moments of 1 kg m^2."""
    inverse_inertia = np.ones(3)
    for _ in range(ticks):
        rotate(q, omega, inverse_inertia, dt)


def drift(rotate: Rotation, omega: Vec, dt: float = _DT, seconds: float = _SECONDS) -> float:
    """Return the angle between a simulated and the exact orientation at constant omega [rad/s], in degrees."""
    q = np.array([0.0, 0.0, 0.0, 1.0])
    ticks = round(seconds / dt)
    _spin(rotate, np.ascontiguousarray(omega), ticks, dt, q)
    return _angle_deg(_matrix(q), _about(omega, ticks * dt))


def exact_drift(omega: Vec, axes: str, dt: float = _DT, seconds: float = _SECONDS) -> float:
    """Return the same angle of a product of axis rotations such as "xyz" by powers of its matrix [deg]."""
    step = np.eye(3)
    for axis in axes:
        i = "xyz".index(axis)
        step = step @ _about(omega[i] * np.eye(3)[i], dt)
    ticks = round(seconds / dt)
    return _angle_deg(np.linalg.matrix_power(step, ticks), _about(omega, ticks * dt))


def _about(omega: Vec, t: float) -> Mat:
    """Return the rotation matrix by |omega| t about omega (Rodrigues 1840)."""
    speed = float(np.linalg.norm(omega))
    if speed == 0.0:
        return np.eye(3)
    x, y, z = omega / speed
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Mat = np.eye(3) + np.sin(speed * t) * cross + (1.0 - np.cos(speed * t)) * cross @ cross
    return turned


def _matrix(q: Vec) -> Mat:
    x, y, z, w = q
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Mat = np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross
    return turned


def _angle_deg(a: Mat, b: Mat) -> float:
    """Return the angle between two orientations [deg], well conditioned near 0 and near 180 degrees."""
    away = a @ b.T
    sine = 0.5 * np.linalg.norm([away[2, 1] - away[1, 2], away[0, 2] - away[2, 0], away[1, 0] - away[0, 1]])
    return float(np.degrees(np.arctan2(sine, 0.5 * (np.trace(away) - 1.0))))


def _row(speed: float) -> Row:
    omega = speed * DIRECTION
    return {
        "speed_rad_s": speed,
        "axis_product_deg": drift(rotate_axes, omega),
        "axis_product_exact_deg": exact_drift(omega, "xyz"),
        "secular_rule_deg": float(np.degrees(0.5 * _DT * abs(np.prod(omega)) / speed * _SECONDS)),
        "printed_deg": drift(rotate_printed, omega),
        "printed_exact_deg": exact_drift(omega, "xyy"),
        "exponential_deg": drift(rotate_exponential, omega),
        "rk4_deg": drift(rotate_rk4, omega),
    }


def _simulate_grid(points: int) -> Outcome:
    seed = float(np.sqrt(50.0))
    rows = [_row(speed) for speed in sorted({*np.geomspace(1.0, 20.0, points).tolist(), seed, 2.0 * seed})]
    curve = partial(points_of, rows, "speed_rad_s")
    simulated, exact = curve("axis_product_deg"), curve("axis_product_exact_deg")
    disagreement = max(
        largest_disagreement(simulated, exact),
        largest_disagreement(curve("printed_deg"), curve("printed_exact_deg")),
    )
    at_seed = next(row for row in rows if row["speed_rad_s"] == seed)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={
            "(h/2) |wx wy wz|/|w|": curve("secular_rule_deg"),
            "(12) as printed": curve("printed_deg"),
            "exponential map": curve("exponential_deg"),
            "RK4": curve("rk4_deg"),
        },
        disagreement=disagreement,
        holds=max(row["exponential_deg"] for row in rows) < _EXACT_DEG,
        note=(
            f"After 10 s at (3, 4, 5) rad/s and 1 ms a product of axis rotations is {at_seed['axis_product_deg']:.2f} "
            f"degrees off, (12) as printed {at_seed['printed_deg']:.0f}, the exponential map "
            f"{at_seed['exponential_deg']:.0e}."
        ),
    )


EXPERIMENT = Experiment(
    title="Turning by axis rotations: drift",
    claim=(
        "At constant omega the axis product, and (12) as printed, drift as the power of their one-step matrix says, to "
        "1e-6; the exponential map stays within 1e-6 degrees for 10 s."
    ),
    x_label="speed of the turn about (3, 4, 5) [rad/s]",
    y_label="off after 10 s at 1 ms [deg]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=1e-6,
    log_x=True,
    log_y=True,
)
