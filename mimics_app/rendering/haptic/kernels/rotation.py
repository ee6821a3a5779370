"""One step of a rigid body's orientation from its angular momentum (D2.1 equation 12), five rivals.

State: quaternion q (xyzw, world from body, unit) and angular momentum L [kg m^2/s] in the WORLD frame. The caller adds
torque times dt to L; a step then rotates q, so that |L| of a free body is constant with every rival. The body frame is
that of the principal axes; `inverse_inertia` are the reciprocals of the principal moments [1/(kg m^2)], 0 for a locked
axis.

Equation 12 as printed has four faults:

- `dR = rot(x) rot(y) rot(y)`: the last factor must be rot(z); as printed a body never rotates about z.
- `phi' = I^-1 L` with a constant I is right for spheres and cubes only; in the world frame it is R I^-1 R^T L. With the
  constant form a free asymmetric top never tumbles (173 degrees off after 10 s).
- A product of axis rotations depends on the order of its factors: it drifts (h/2) |wx wy wz|/|w| rad/s from the
  rotation about the axis of omega, 2.4 degrees in 10 s at (3, 4, 5) rad/s and 1 ms.
- The side of the product is not stated: an omega in the world frame multiplies from the left, R <- dR R. Nor is phi a
  vector of angles.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec, Vec3
from mimics_app.maths.quat import QUATERNION

__all__ = [
    "angular_velocity",
    "kinetic_energy",
    "product",
    "rotate_axes",
    "rotate_exponential",
    "rotate_printed",
    "rotate_rk4",
    "rotate_start",
    "rotated",
    "turn_axes",
    "turn_body",
    "turn_exponential",
    "turn_printed",
]

Four = tuple[float, float, float, float]

_SERIES_ANGLE = 1e-4
"""Half angle [rad] below which sin(a)/a and cos(a) are their series: the next term, a^4/24, is under 5e-18."""


@kernel
def product(a: Four, b: Four) -> Four:
    """Quaternion product a b: the rotation b followed by a."""
    return (
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    )


@kernel
def rotated(q: Four, v: Vec3) -> Vec3:
    """R(q) v, scaled by |q|^2 where q is not of unit length."""
    x, y, z, w = q
    tx = y * v[2] - z * v[1]
    ty = z * v[0] - x * v[2]
    tz = x * v[1] - y * v[0]
    square = x * x + y * y + z * z + w * w
    return (
        square * v[0] + 2.0 * (w * tx + y * tz - z * ty),
        square * v[1] + 2.0 * (w * ty + z * tx - x * tz),
        square * v[2] + 2.0 * (w * tz + x * ty - y * tx),
    )


@kernel
def _rate(q: Four, momentum: Vec, inverse_inertia: Vec) -> Vec3:
    """Angular velocity R I^-1 R^T L [rad/s], world frame."""
    lx, ly, lz = rotated((-q[0], -q[1], -q[2], q[3]), (momentum[0], momentum[1], momentum[2]))
    return rotated(q, (inverse_inertia[0] * lx, inverse_inertia[1] * ly, inverse_inertia[2] * lz))


@kernel
def _exponential(omega: Vec3, dt: float) -> Four:
    """Quaternion of the rotation by |omega| dt about omega; by its series near zero."""
    x, y, z = 0.5 * dt * omega[0], 0.5 * dt * omega[1], 0.5 * dt * omega[2]
    square = x * x + y * y + z * z
    if square < _SERIES_ANGLE * _SERIES_ANGLE:
        sinc = 1.0 - square / 6.0
        return sinc * x, sinc * y, sinc * z, 1.0 - 0.5 * square
    half = math.sqrt(square)
    sinc = math.sin(half) / half
    return sinc * x, sinc * y, sinc * z, math.cos(half)


@kernel
def _store(value: Four, q: F8) -> None:
    """Write a normalised quaternion, so that R^T stays R^-1 over many steps."""
    scale = 1.0 / math.sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2] + value[3] * value[3])
    for i in range(QUATERNION):
        q[i] = scale * value[i]


@kernel
def angular_velocity(q: F8, momentum: Vec, inverse_inertia: Vec, out: Vec) -> None:
    """Set out = R I^-1 R^T L: angular velocity [rad/s], world frame, shape [3].

    Args:
        q: World from body, xyzw.
        momentum: L [kg m^2/s], world.
        inverse_inertia: Reciprocals of the principal moments [1/(kg m^2)].
        out: Receives omega.
    """
    out[0], out[1], out[2] = _rate((q[0], q[1], q[2], q[3]), momentum, inverse_inertia)


@kernel
def kinetic_energy(q: F8, momentum: Vec, inverse_inertia: Vec) -> float:
    """Rotational energy L.omega/2 [J]."""
    wx, wy, wz = _rate((q[0], q[1], q[2], q[3]), momentum, inverse_inertia)
    return 0.5 * (momentum[0] * wx + momentum[1] * wy + momentum[2] * wz)


@kernel
def turn_exponential(q: F8, omega: Vec, dt: float) -> None:
    """Rotate q by omega [rad/s, world] for dt [s]: the exponential map, exact while omega is constant."""
    _store(product(_exponential((omega[0], omega[1], omega[2]), dt), (q[0], q[1], q[2], q[3])), q)


@kernel
def turn_axes(q: F8, omega: Vec, dt: float) -> None:
    """Rotate q by rot(x) rot(y) rot(z), (12) with its last factor corrected: first order in dt."""
    _store(product(_three_turns(dt * omega[0], dt * omega[1], dt * omega[2], True), (q[0], q[1], q[2], q[3])), q)


@kernel
def turn_printed(q: F8, omega: Vec, dt: float) -> None:
    """Rotate q by rot(x) rot(y) rot(y), (12) as printed: no rotation about z. Demonstration."""
    _store(product(_three_turns(dt * omega[0], dt * omega[1], dt * omega[1], False), (q[0], q[1], q[2], q[3])), q)


@kernel
def _three_turns(x: float, y: float, last: float, last_about_z: bool) -> Four:
    """Product of the rotations by x about x, by y about y, and by `last` about z or y [rad]."""
    about_x = (math.sin(0.5 * x), 0.0, 0.0, math.cos(0.5 * x))
    about_y = (0.0, math.sin(0.5 * y), 0.0, math.cos(0.5 * y))
    s, c = math.sin(0.5 * last), math.cos(0.5 * last)
    third = (0.0, 0.0, s, c) if last_about_z else (0.0, s, 0.0, c)
    return product(about_x, product(about_y, third))


@kernel
def rotate_exponential(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by the exponential map of the angular velocity at the half step: the default.

    R_m = exp([omega h/2]x) R, omega_m = R_m I^-1 R_m^T L, R <- exp([omega_m h]x) R: second order. The energy of a free
    top with moments (.01, .02, .03) kg m^2 at 7 rad/s drifts by 2e-6 in 10 s at 1 ms.

    Args:
        q: World from body, xyzw, unit; updated.
        momentum: L [kg m^2/s], world, with this step's torque times dt added already.
        inverse_inertia: Reciprocals of the principal moments [1/(kg m^2)], 0 for a locked axis.
        dt: Step [s].
    """
    start = (q[0], q[1], q[2], q[3])
    middle = product(_exponential(_rate(start, momentum, inverse_inertia), 0.5 * dt), start)
    _store(product(_exponential(_rate(middle, momentum, inverse_inertia), dt), start), q)


@kernel
def turn_body(q: F8, momentum: Vec, inverse_inertia: Vec, axes: F8, dt: float, omega: Vec) -> None:
    """`rotate_exponential` for a body whose principal axes are not those of its frame.

    Args:
        q: World from body, xyzw, unit; updated.
        momentum: L [kg m^2/s], world, with this step's torque times dt added already.
        inverse_inertia: Reciprocals of the principal moments [1/(kg m^2)], 0 for a locked axis.
        axes: Body from principal axes, xyzw, unit.
        dt: Step [s].
        omega: Receives the angular velocity [rad/s], world, at the end of the step.
    """
    tilt = (axes[0], axes[1], axes[2], axes[3])
    start = product((q[0], q[1], q[2], q[3]), tilt)
    middle = product(_exponential(_rate(start, momentum, inverse_inertia), 0.5 * dt), start)
    end = product(_exponential(_rate(middle, momentum, inverse_inertia), dt), start)
    _store(product(end, (-tilt[0], -tilt[1], -tilt[2], tilt[3])), q)
    omega[0], omega[1], omega[2] = _rate(product((q[0], q[1], q[2], q[3]), tilt), momentum, inverse_inertia)


@kernel
def rotate_start(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by the exponential map of the angular velocity at the start of the step: first order.

    The energy of the top of `rotate_exponential` drifts by 6 %.

    Arguments as `rotate_exponential`.
    """
    start = (q[0], q[1], q[2], q[3])
    _store(product(_exponential(_rate(start, momentum, inverse_inertia), dt), start), q)


@kernel
def rotate_axes(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by (12) with last factor and inertia corrected: axis product of omega at the start of the step.

    Arguments as `rotate_exponential`.
    """
    start = (q[0], q[1], q[2], q[3])
    x, y, z = _rate(start, momentum, inverse_inertia)
    _store(product(_three_turns(dt * x, dt * y, dt * z, True), start), q)


@kernel
def rotate_printed(q: F8, momentum: Vec, inverse_inertia: Vec, dt: float) -> None:
    """Rotate q by (12) as printed: phi' = I^-1 L with constant I, dR = rot(x) rot(y) rot(y). For demonstration.

    Arguments as `rotate_exponential`.
    """
    x = dt * inverse_inertia[0] * momentum[0]
    y = dt * inverse_inertia[1] * momentum[1]
    _store(product(_three_turns(x, y, y, False), (q[0], q[1], q[2], q[3])), q)


@kernel
def _slope(q: Four, momentum: Vec, inverse_inertia: Vec) -> Four:
    """Derivative dq/dt = omega q / 2, omega taken as a quaternion without real part."""
    wx, wy, wz = _rate(q, momentum, inverse_inertia)
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
    _store(_along(_along(end, s3, dt / 3.0), s4, dt / 6.0), q)
