"""One step of a rigid body's orientation from its angular momentum (D2.1 equation 12).

State: quaternion q (xyzw, world from body, unit) and angular momentum L [kg m^2/s] in the WORLD frame. The caller adds
torque times dt to L; a step then rotates q, so that |L| of a free body is constant. `inverse_inertia` are the
reciprocals of the principal moments [1/(kg m^2)], 0 for a locked axis. Rivals of the step are in the laboratory.

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
    "Four",
    "angular_rate",
    "product",
    "rotated",
    "rotation_by",
    "store_unit",
    "turn_body",
]

Four = tuple[float, float, float, float]
"""Quaternion, xyzw."""

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
def angular_rate(q: Four, momentum: Vec, inverse_inertia: Vec) -> Vec3:
    """Return the angular velocity R I^-1 R^T L [rad/s], world frame, of a body whose frame is its principal axes."""
    lx, ly, lz = rotated((-q[0], -q[1], -q[2], q[3]), (momentum[0], momentum[1], momentum[2]))
    return rotated(q, (inverse_inertia[0] * lx, inverse_inertia[1] * ly, inverse_inertia[2] * lz))


@kernel
def rotation_by(omega: Vec3, dt: float) -> Four:
    """Return the quaternion of the rotation by |omega| dt about omega; by its series near zero."""
    x, y, z = 0.5 * dt * omega[0], 0.5 * dt * omega[1], 0.5 * dt * omega[2]
    square = x * x + y * y + z * z
    if square < _SERIES_ANGLE * _SERIES_ANGLE:
        sinc = 1.0 - square / 6.0
        return sinc * x, sinc * y, sinc * z, 1.0 - 0.5 * square
    half = math.sqrt(square)
    sinc = math.sin(half) / half
    return sinc * x, sinc * y, sinc * z, math.cos(half)


@kernel
def store_unit(value: Four, q: F8) -> None:
    """Write a normalised quaternion, so that R^T stays R^-1 over many steps."""
    scale = 1.0 / math.sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2] + value[3] * value[3])
    for i in range(QUATERNION):
        q[i] = scale * value[i]


@kernel
def turn_body(q: F8, momentum: Vec, inverse_inertia: Vec, axes: F8, dt: float, omega: Vec) -> None:
    """Rotate q by the exponential map of the angular velocity at the half step.

    R_m = exp([omega h/2]x) R, omega_m = R_m I^-1 R_m^T L, R <- exp([omega_m h]x) R: second order. The energy of a free
    top with moments (.01, .02, .03) kg m^2 at 7 rad/s drifts by 2e-6 in 10 s at 1 ms.

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
    middle = product(rotation_by(angular_rate(start, momentum, inverse_inertia), 0.5 * dt), start)
    end = product(rotation_by(angular_rate(middle, momentum, inverse_inertia), dt), start)
    store_unit(product(end, (-tilt[0], -tilt[1], -tilt[2], tilt[3])), q)
    omega[0], omega[1], omega[2] = angular_rate(product((q[0], q[1], q[2], q[3]), tilt), momentum, inverse_inertia)
