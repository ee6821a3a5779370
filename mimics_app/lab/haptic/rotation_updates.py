"""Steps of a body's orientation (D2.1 equation 12): the loop's, and rivals of it.

State as in `kernels.rotation`; the body frame is that of the principal axes.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec
from mimics_app.rendering.haptic.kernels.rotation import Four, angular_rate, product, rotation_by, store_unit

__all__ = [
    "angular_velocity",
    "kinetic_energy",
    "rotate_axes",
    "rotate_exponential",
    "rotate_rk4",
    "rotate_start",
    "three_turns",
]


@kernel
def angular_velocity(q: F8, momentum: Vec, inverse_inertia: Vec, out: Vec) -> None:
    """Set out = R I^-1 R^T L: angular velocity [rad/s], world frame, shape [3].

    Args:
        q: World from body, xyzw.
        momentum: L [kg m^2/s], world.
        inverse_inertia: Reciprocals of the principal moments [1/(kg m^2)].
        out: Receives omega.
    """
    out[0], out[1], out[2] = angular_rate((q[0], q[1], q[2], q[3]), momentum, inverse_inertia)


@kernel
def kinetic_energy(q: F8, momentum: Vec, inverse_inertia: Vec) -> float:
    """Rotational energy L.omega/2 [J]."""
    wx, wy, wz = angular_rate((q[0], q[1], q[2], q[3]), momentum, inverse_inertia)
    return 0.5 * (momentum[0] * wx + momentum[1] * wy + momentum[2] * wz)


@kernel
def rotate_exponential(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by the exponential map of the angular velocity at the half step: the loop's `turn_body`, without tilt.

    Args:
        q: World from body, xyzw, unit; updated.
        momentum: L [kg m^2/s], world, with this step's torque times dt added already.
        inverse_inertia: Reciprocals of the principal moments [1/(kg m^2)], 0 for a locked axis.
        dt: Step [s].
    """
    start = (q[0], q[1], q[2], q[3])
    middle = product(rotation_by(angular_rate(start, momentum, inverse_inertia), 0.5 * dt), start)
    store_unit(product(rotation_by(angular_rate(middle, momentum, inverse_inertia), dt), start), q)


@kernel
def rotate_start(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by the exponential map of the angular velocity at the start of the step: first order.

    The energy of the top of `rotate_exponential` drifts by 6 %.

    Arguments as `rotate_exponential`.
    """
    start = (q[0], q[1], q[2], q[3])
    store_unit(product(rotation_by(angular_rate(start, momentum, inverse_inertia), dt), start), q)


@kernel
def rotate_axes(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by (12) with last factor and inertia corrected: axis product of omega at the start of the step.

    Arguments as `rotate_exponential`.
    """
    start = (q[0], q[1], q[2], q[3])
    x, y, z = angular_rate(start, momentum, inverse_inertia)
    store_unit(product(three_turns(dt * x, dt * y, dt * z, True), start), q)


@kernel
def three_turns(x: float, y: float, last: float, last_about_z: bool) -> Four:
    """Return the product of the rotations by x about x, by y about y, and by `last` about z or y [rad]."""
    about_x = (math.sin(0.5 * x), 0.0, 0.0, math.cos(0.5 * x))
    about_y = (0.0, math.sin(0.5 * y), 0.0, math.cos(0.5 * y))
    s, c = math.sin(0.5 * last), math.cos(0.5 * last)
    third = (0.0, 0.0, s, c) if last_about_z else (0.0, s, 0.0, c)
    return product(about_x, product(about_y, third))


@kernel
def _slope(q: Four, momentum: Vec, inverse_inertia: Vec) -> Four:
    """Derivative dq/dt = omega q / 2, omega taken as a quaternion without real part."""
    wx, wy, wz = angular_rate(q, momentum, inverse_inertia)
    return product((0.5 * wx, 0.5 * wy, 0.5 * wz, 0.0), q)


@kernel
def _along(q: Four, slope: Four, dt: float) -> Four:
    """Quaternion q + dt slope, not normalised."""
    return q[0] + dt * slope[0], q[1] + dt * slope[1], q[2] + dt * slope[2], q[3] + dt * slope[3]


@kernel
def rotate_rk4(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by the classical Runge-Kutta method of order 4, and normalise it.

    Arguments as `rotate_exponential`.
    """
    start = (q[0], q[1], q[2], q[3])
    s1 = _slope(start, momentum, inverse_inertia)
    s2 = _slope(_along(start, s1, 0.5 * dt), momentum, inverse_inertia)
    s3 = _slope(_along(start, s2, 0.5 * dt), momentum, inverse_inertia)
    s4 = _slope(_along(start, s3, dt), momentum, inverse_inertia)
    end = _along(_along(start, s1, dt / 6.0), s2, dt / 3.0)
    store_unit(_along(_along(end, s3, dt / 3.0), s4, dt / 6.0), q)
