"""4x4 transforms on column vectors, float64: `T_a_from_b @ p_b`, translation in the last column.

Kernels write to `out` without allocation; `out` must not be one of the matrix arguments. The functions at the end
return new arrays, for code outside the loop.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths import quat
from mimics_app.maths.quat import Quat
from mimics_app.maths.vec import cross, norm, normalise, unit

__all__ = [
    "Mat4",
    "affine_inverse",
    "compose",
    "compose_trs",
    "look_at",
    "unscale",
]

Mat4 = NDArray[np.float64]
"""float64, shape [4, 4]."""


@kernel
def compose_trs(translation: Vec, rotation: Quat, scale: Vec, out: Mat4) -> None:
    """Set out = T R S: scale, then rotate (unit quaternion xyzw), then translate [m]."""
    quat.to_matrix(rotation, out)
    for row in range(3):
        for column in range(3):
            out[row, column] *= scale[column]
        out[row, 3] = translation[row]
        out[3, row] = 0.0
    out[3, 3] = 1.0


@kernel
def affine_inverse(m: Mat4, out: Mat4) -> float:
    """Set out = the inverse of a matrix with the last row 0 0 0 1; return its determinant (0: out is not finite)."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for row in range(3):
            p, q = (row + 1) % 3, (row + 2) % 3
            out[row, i] = m[j, p] * m[k, q] - m[j, q] * m[k, p]
    determinant: float = m[0, 0] * out[0, 0] + m[0, 1] * out[1, 0] + m[0, 2] * out[2, 0]
    for row in range(3):
        for column in range(3):
            out[row, column] /= determinant
        out[row, 3] = -(out[row, 0] * m[0, 3] + out[row, 1] * m[1, 3] + out[row, 2] * m[2, 3])
        out[3, row] = 0.0
    out[3, 3] = 1.0
    return determinant


def compose(translation: object, rotation: object = quat.IDENTITY, scale: object = (1.0, 1.0, 1.0)) -> Mat4:
    """A new matrix T R S from array-likes; the quaternion xyzw is normalised.

    Raises:
        ValueError: a shape does not fit, or the quaternion is zero or not finite.
    """
    out = np.empty((4, 4))
    turn = quat.normalise_rows(_floats(rotation, 4))
    compose_trs(_floats(translation, 3), turn, _floats(scale, 3), out)
    return out


@kernel
def unscale(matrix: Mat4) -> None:
    """Divide the three axes of an affine matrix by their lengths, in place."""
    for c in range(3):
        length = norm(matrix[:3, c])
        for r in range(3):
            matrix[r, c] /= length


def look_at(eye: object, target: object, up: object = (0.0, 1.0, 0.0)) -> Mat4:
    """T_world_from_camera of a camera whose -z points at the target and whose +y leans towards `up`.

    For a view direction parallel to `up`, the roll follows from the world axis least aligned with it.

    Args:
        eye: Position of the camera [m].
        target: Point at the centre of the view [m].
        up: Vector of any length.

    Raises:
        ValueError: eye and target are the same point, or up is zero.
    """
    position = _floats(eye, 3)
    back = unit(position - _floats(target, 3))
    right, above = np.empty(3), np.empty(3)
    cross(unit(up), back, right)
    if norm(right) < 1e-9:
        cross(np.eye(3)[int(np.argmin(np.abs(back)))], back, right)
    normalise(right, right)
    cross(back, right, above)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, above, back, position
    return pose


def _floats(values: object, size: int) -> NDArray[np.float64]:
    array = np.array(values, np.float64)
    if array.shape != (size,):
        raise ValueError(f"shape {list(array.shape)} instead of [{size}]")
    return array
