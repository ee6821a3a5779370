"""Frames t, n, b along a curve: rotation-minimising by double reflection, and two rivals with singularities.

The Frenet frame flips by 180 degrees at an inflection and is undefined on a straight line; the frame by a fixed "up"
direction is undefined where the curve is parallel to it. The rotation-minimising frame has neither fault: it follows
the tangent by the smallest possible rotation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec
from mimics_app.maths.vec import dot

__all__ = [
    "carry_normals",
    "frenet_normals",
    "plane_normal",
    "projected_up_normals",
    "rotation_minimising_normals",
    "start_normal",
]


@kernel
def rotation_minimising_normals(points: F8, tangents: F8, first_normal: F8) -> F8:
    """Normals of the rotation-minimising frame by double reflection (Wang, Juettler, Zheng & Liu 2008), order 4.

    Args:
        points: Points along the curve [m], shape [m, 3].
        tangents: Unit tangents there, shape [m, 3].
        first_normal: Unit normal at the first point, shape [3].

    Returns:
        Unit normals, shape [m, 3]; the binormals are cross(tangents, normals).
    """
    normals, chord, tangent, mirror = np.empty_like(points), np.empty(3), np.empty(3), np.empty(3)
    for k in range(3):
        normals[0, k] = first_normal[k]
    for i in range(len(points) - 1):
        normal, wanted = normals[i + 1], tangents[i + 1]
        for k in range(3):
            normal[k] = normals[i, k]
            tangent[k] = tangents[i, k]
            chord[k] = points[i + 1, k] - points[i, k]
        _mirror(normal, chord)
        _mirror(tangent, chord)
        for k in range(3):
            mirror[k] = wanted[k] - tangent[k]
        _mirror(normal, mirror)
        # Reflections keep length and angle; this only removes rounding errors accumulated over many points.
        along = dot(normal, wanted)
        for k in range(3):
            normal[k] -= along * wanted[k]
        size = np.sqrt(dot(normal, normal))
        for k in range(3):
            normal[k] /= size
    return normals


@kernel
def _mirror(vector: Vec, normal: Vec) -> None:
    """Mirror a vector in the plane with this normal of any length, in place; unchanged where that is zero."""
    square = dot(normal, normal)
    if square > 0.0:
        along = 2.0 * dot(normal, vector) / square
        for k in range(3):
            vector[k] -= along * normal[k]


def carry_normals(from_points: F8, from_tangents: F8, normals: F8, points: F8, tangents: F8) -> F8:
    """Transport normals by one double reflection, for many pairs of points at once.

    Args:
        from_points: Points with known normals [m], shape [m, 3].
        from_tangents: Unit tangents there, shape [m, 3].
        normals: Unit normals there, shape [m, 3].
        points: Points with unknown normals [m], shape [m, 3].
        tangents: Unit tangents there, shape [m, 3].

    Returns:
        Unit normals at `points`, shape [m, 3].
    """
    chord = points - from_points
    normals = _reflect(normals, chord)
    normals = _reflect(normals, tangents - _reflect(from_tangents, chord))
    normals = normals - tangents * np.sum(normals * tangents, axis=1, keepdims=True)
    unit: F8 = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return unit


def _reflect(vectors: F8, mirror: F8) -> F8:
    """Reflect each vector in the plane with the normal `mirror`; unchanged where that is zero."""
    square = np.sum(mirror * mirror, axis=1, keepdims=True)
    along = 2.0 * np.sum(vectors * mirror, axis=1, keepdims=True)
    reflected: F8 = vectors - mirror * np.divide(along, square, out=np.zeros_like(square), where=square > 0.0)
    return reflected


def frenet_normals(first: ArrayLike, second: ArrayLike) -> F8:
    """Principal normals from the first and second derivative of the curve, each of shape [m, 3].

    They point to the centre of curvature, hence jump by 180 degrees at an inflection; NaN where the curve is straight.
    """
    t = np.asarray(first, np.float64)
    a = np.asarray(second, np.float64)
    across = a - t * (np.sum(a * t, axis=1, keepdims=True) / np.sum(t * t, axis=1, keepdims=True))
    size = np.linalg.norm(across, axis=1, keepdims=True)
    straight = size <= 1e-12 * np.linalg.norm(a, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(straight | (size == 0.0), np.nan, across / size)


def projected_up_normals(tangents: ArrayLike, up: ArrayLike) -> F8:
    """Unit projection of `up` to the plane normal to each unit tangent, shape [m, 3]; NaN where parallel to it."""
    t = np.asarray(tangents, np.float64)
    across = np.asarray(up, np.float64) - t * (t @ np.asarray(up, np.float64))[:, None]
    size = np.linalg.norm(across, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(size <= 1e-12, np.nan, across / size)


def plane_normal(points: ArrayLike) -> F8:
    """Unit normal of the plane of best fit, with its largest component positive, shape [3].

    For collinear points it is the projection of the world axis nearest to perpendicular to the line (z before y before
    x).
    """
    centred = np.asarray(points, np.float64)
    centred = centred - centred.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred, full_matrices=False)
    normal: F8 = axes[2] if len(axes) > 2 else np.cross(axes[0], axes[-1])
    if len(sizes) < 2 or sizes[1] <= 1e-9 * sizes[0]:
        order = np.array([2, 1, 0])
        square = order[np.argmin(np.round(np.abs(axes[0][order]), 6))]
        normal = np.eye(3)[square] - axes[0] * axes[0][square]
        normal /= np.linalg.norm(normal)
    sign: float = np.sign(normal[np.argmax(np.round(np.abs(normal), 9))])
    return normal * sign


def start_normal(points: ArrayLike, tangent: ArrayLike) -> F8:
    """First normal of the frame of a tunnel: in the plane of the curve, so that b is the normal of that plane.

    Args:
        points: Points of the whole curve [m], shape [m, 3].
        tangent: Unit tangent at its start, shape [3].

    Returns:
        n = b x t, unit, shape [3]; where the plane is normal to the tangent, any normal.
    """
    t = np.asarray(tangent, np.float64)
    b = plane_normal(points)
    n: F8 = np.cross(b, t)
    if np.linalg.norm(n) < 1e-3:
        n = np.cross(np.eye(3)[np.argmin(np.abs(t))], t)
    return n / np.linalg.norm(n)
