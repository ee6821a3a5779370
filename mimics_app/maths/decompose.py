"""Decomposition of an affine matrix into translation, rotation and scale, by numpy alone: file readers start fast."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["decompose_trs"]


def decompose_trs(matrix: F8) -> tuple[F8, F8, F8, float]:
    """Translation [m], unit quaternion (w >= 0), scale and shear of an affine matrix.

    A mirrored matrix gets a negative x scale. Exact when matrix = T R S; otherwise the rotation is the nearest one
    (polar decomposition) and the shear measures the remainder.

    Returns:
        (translation [3], rotation [4], scale [3], shear): shear is the largest absolute difference of T R S and the
        matrix, relative to the largest scale; 0 for a zero matrix.
    """
    linear = np.asarray(matrix, np.float64)[:3, :3]
    columns = np.linalg.norm(linear, axis=0)
    scale = columns * np.array([-1.0 if np.linalg.det(linear) < 0.0 else 1.0, 1.0, 1.0])
    u, _, vt = np.linalg.svd(linear / np.where(scale == 0.0, 1.0, scale))
    if np.linalg.det(u @ vt) < 0.0:  # a zero scale leaves the sign of an axis open: choose the proper rotation
        u[:, 2] *= -1.0
    rebuilt = (u @ vt) * scale
    largest = float(columns.max())
    shear = float(np.abs(rebuilt - linear).max()) / largest if largest > 0.0 else 0.0
    return np.array(matrix[:3, 3], np.float64), _quaternion(u @ vt), scale, shear


def _quaternion(rotation: F8) -> F8:
    """The unit quaternion xyzw, w >= 0, of a rotation matrix: the dominant eigenvector of Bar-Itzhack (2000), eq. 5."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    k = np.array(
        [
            [xx - yy - zz, yx + xy, zx + xz, zy - yz],
            [yx + xy, yy - xx - zz, zy + yz, xz - zx],
            [zx + xz, zy + yz, zz - xx - yy, yx - xy],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    q: F8 = np.linalg.eigh(k)[1][:, 3]
    return -q if q[3] < 0.0 else q
