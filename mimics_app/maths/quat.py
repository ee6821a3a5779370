"""Unit quaternions xyzw. `out` may be one of the arguments; stored quaternions have w >= 0 (see `normalise`).

`multiply(a, b)` is the rotation b followed by a, like `R_a @ R_b` on column vectors.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import unit

__all__ = [
    "IDENTITY",
    "QUATERNION",
    "Quat",
    "about_axis",
    "conjugate",
    "exp_map",
    "from_matrix",
    "multiply",
    "normalise",
    "normalise_rows",
    "product",
    "rotate",
    "rotate_back",
    "slerp",
    "to_matrix",
]

Quat = NDArray[np.float64]
"""float64 xyzw, shape [4]."""

IDENTITY = (0.0, 0.0, 0.0, 1.0)

QUATERNION = 4
"""Numbers of a quaternion."""

_SERIES_ANGLE = 1e-4
"""Angle below which sin(a)/a is computed by its series [rad]: the next term, a^4/120, is under 1e-18."""

_STRAIGHT = 1e-6
"""Angle between quaternions below which slerp is linear [rad] (error of order angle^2, 1e-12)."""


@kernel
def normalise(q: Quat, out: Quat) -> float:
    """Set out = q / |q| with w >= 0; return |q|. A zero or not finite q gives the identity and returns 0."""
    largest = max(abs(q[0]), abs(q[1]), abs(q[2]), abs(q[3]))
    x, y, z, w = q[0] / largest, q[1] / largest, q[2] / largest, q[3] / largest
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not (0.0 < length < math.inf):
        out[0] = out[1] = out[2] = 0.0
        out[3] = 1.0
        return 0.0
    signed = length if w >= 0.0 else -length
    out[0], out[1], out[2], out[3] = x / signed, y / signed, z / signed, w / signed
    whole: float = largest * length
    return whole


@kernel
def multiply(a: Quat, b: Quat, out: Quat) -> None:
    """Set out = a b (Hamilton): the rotation b followed by a."""
    x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1]
    y = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0]
    z = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3]
    w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]
    out[0], out[1], out[2], out[3] = x, y, z, w


@kernel
def conjugate(q: Quat, out: Quat) -> None:
    """Set out = the inverse rotation of a unit quaternion."""
    out[0], out[1], out[2], out[3] = -q[0], -q[1], -q[2], q[3]


@kernel
def rotate(q: Quat, v: Vec, out: Vec) -> None:
    """Set out = R(q) v for a unit quaternion, by two cross products."""
    tx = 2.0 * (q[1] * v[2] - q[2] * v[1])
    ty = 2.0 * (q[2] * v[0] - q[0] * v[2])
    tz = 2.0 * (q[0] * v[1] - q[1] * v[0])
    x = v[0] + q[3] * tx + q[1] * tz - q[2] * ty
    y = v[1] + q[3] * ty + q[2] * tx - q[0] * tz
    z = v[2] + q[3] * tz + q[0] * ty - q[1] * tx
    out[0], out[1], out[2] = x, y, z


@kernel
def rotate_back(q: Quat, v: Vec, out: Vec) -> None:
    """Set out = R(q)^T v for a unit quaternion."""
    tx = 2.0 * (q[2] * v[1] - q[1] * v[2])
    ty = 2.0 * (q[0] * v[2] - q[2] * v[0])
    tz = 2.0 * (q[1] * v[0] - q[0] * v[1])
    x = v[0] + q[3] * tx + q[2] * ty - q[1] * tz
    y = v[1] + q[3] * ty + q[0] * tz - q[2] * tx
    z = v[2] + q[3] * tz + q[1] * tx - q[0] * ty
    out[0], out[1], out[2] = x, y, z


@kernel
def exp_map(rotation: Vec, out: Quat) -> None:
    """Set out = the rotation by |rotation| [rad] about its direction, exact and smooth for any angle; w may be < 0."""
    angle = math.sqrt(rotation[0] ** 2 + rotation[1] ** 2 + rotation[2] ** 2)
    scale = 0.5 - angle * angle / 48.0 if angle < _SERIES_ANGLE else math.sin(0.5 * angle) / angle
    x, y, z = scale * rotation[0], scale * rotation[1], scale * rotation[2]
    out[0], out[1], out[2], out[3] = x, y, z, math.cos(0.5 * angle)


@kernel
def slerp(a: Quat, b: Quat, t: float, out: Quat) -> None:
    """Set out = the rotation at share t of the shorter arc from a to b, at constant speed; unit, w >= 0."""
    cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    sign = 1.0 if cosine >= 0.0 else -1.0
    # |a - b| and |a + b| give the angle to full precision; the cosine alone would lose half the digits.
    difference = 0.0
    total = 0.0
    for i in range(QUATERNION):
        difference += (a[i] - sign * b[i]) ** 2
        total += (a[i] + sign * b[i]) ** 2
    angle = 2.0 * math.atan2(math.sqrt(difference), math.sqrt(total))
    if angle < _STRAIGHT:
        wa, wb = 1.0 - t, sign * t
    else:
        sine = math.sin(angle)
        wa, wb = math.sin((1.0 - t) * angle) / sine, sign * math.sin(t * angle) / sine
    for i in range(QUATERNION):
        out[i] = wa * a[i] + wb * b[i]
    normalise(out, out)


@kernel
def to_matrix(q: Quat, out: NDArray[np.float64]) -> None:
    """Set out[:3, :3] = R(q) of a unit quaternion; the rest of out is not changed. out must not be q."""
    x, y, z, w = q[0], q[1], q[2], q[3]
    out[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    out[0, 1] = 2.0 * (x * y - z * w)
    out[0, 2] = 2.0 * (x * z + y * w)
    out[1, 0] = 2.0 * (x * y + z * w)
    out[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    out[1, 2] = 2.0 * (y * z - x * w)
    out[2, 0] = 2.0 * (x * z - y * w)
    out[2, 1] = 2.0 * (y * z + x * w)
    out[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def from_matrix(m: NDArray[np.float64], out: Quat) -> None:
    """Set out = the unit quaternion, w >= 0, of the rotation m[:3, :3] (Shepperd 1978)."""
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    if trace >= max(m[0, 0], m[1, 1], m[2, 2]):
        out[3] = 1.0 + trace
        out[0] = m[2, 1] - m[1, 2]
        out[1] = m[0, 2] - m[2, 0]
        out[2] = m[1, 0] - m[0, 1]
    else:
        i = 0
        if m[1, 1] > m[0, 0]:
            i = 1
        if m[2, 2] > m[i, i]:
            i = 2
        j = (i + 1) % 3
        k = (i + 2) % 3
        out[i] = 1.0 + m[i, i] - m[j, j] - m[k, k]
        out[j] = m[i, j] + m[j, i]
        out[k] = m[i, k] + m[k, i]
        out[3] = m[k, j] - m[j, k]
    normalise(out, out)


def about_axis(axis: object, angle: float) -> Quat:
    """A new quaternion, w >= 0: the rotation by `angle` [rad] about `axis` (any length, right-hand rule).

    Raises:
        ValueError: the axis has no direction.
    """
    quaternion = np.empty(4)
    exp_map(unit(axis) * math.remainder(angle, 2.0 * math.pi), quaternion)
    normalise(quaternion, quaternion)
    return quaternion


def product(a: Quat, b: Quat) -> Quat:
    """A new quaternion: the rotation b followed by a."""
    both = np.empty(4)
    multiply(a, b, both)
    return both


def normalise_rows(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit quaternions with w >= 0, shape [..., 4], as a new array.

    Raises:
        ValueError: one of them is zero or not finite.
    """
    lengths = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    if not (np.isfinite(lengths).all() and (lengths > 0.0).all()):
        raise ValueError("a zero or not finite quaternion is not a rotation")
    rows: NDArray[np.float64] = quaternions / np.where(quaternions[..., 3:] < 0.0, -lengths, lengths)
    return rows
