"""Skinning palettes: matrices from the bind pose to the present pose of each joint, and the bounding box.

Joints are followed in double precision; what leaves is single precision in the frame of the mesh's own node, so that
the distance of a person from the origin of the world costs no digits.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, U1
from mimics_app.maths.quat import (
    QUATERNION,
    from_matrix,
    normalise,
)

__all__ = ["bound_joints", "has_moved", "take_weights", "write_palette"]


_FLAT = 1e-300
"""Determinant below which a matrix has no inverse."""

_COLUMNS = 4
"""Of an affine matrix of three rows."""


@kernel
def _invert(world: F8, out: F8) -> bool:
    """Invert an affine matrix, [4, 4] to [3, 4]; return False where it is singular."""
    a, b, c = world[0, 0], world[0, 1], world[0, 2]
    d, e, f = world[1, 0], world[1, 1], world[1, 2]
    g, h, i = world[2, 0], world[2, 1], world[2, 2]
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    if not abs(det) > _FLAT:
        return False
    out[0, 0], out[0, 1], out[0, 2] = (e * i - f * h) / det, (c * h - b * i) / det, (b * f - c * e) / det
    out[1, 0], out[1, 1], out[1, 2] = (f * g - d * i) / det, (a * i - c * g) / det, (c * d - a * f) / det
    out[2, 0], out[2, 1], out[2, 2] = (d * h - e * g) / det, (b * g - a * h) / det, (a * e - b * d) / det
    for k in range(3):
        out[k, 3] = -(out[k, 0] * world[0, 3] + out[k, 1] * world[1, 3] + out[k, 2] * world[2, 3])
    return True


@kernel
def _compose(a: F8, b: F8, out: F8) -> None:
    """Set out = a b of affine matrices, the first three rows; out is neither of them."""
    for r in range(3):
        for c in range(_COLUMNS):
            out[r, c] = a[r, 0] * b[0, c] + a[r, 1] * b[1, c] + a[r, 2] * b[2, c]
        out[r, 3] += a[r, 3]


@kernel
def _stretch(m: F8) -> float:
    """Return the deviation of three columns from a rotation: the largest error of their products."""
    worst = 0.0
    for i in range(3):
        for j in range(i, 3):
            dot = m[0, i] * m[0, j] + m[1, i] * m[1, j] + m[2, i] * m[2, j]
            worst = max(worst, abs(dot - (1.0 if i == j else 0.0)))
    return worst


@kernel
def _store_dual(m: F8, out: F4) -> None:
    """Convert a rigid motion to a unit dual quaternion, real part then dual part, xyzw each (Kavan et al. 2008)."""
    q = np.empty(QUATERNION)
    from_matrix(m, q)
    normalise(q, q)
    x, y, z = m[0, 3], m[1, 3], m[2, 3]
    for i in range(QUATERNION):
        out[i] = q[i]
    out[4] = 0.5 * (x * q[3] + y * q[2] - z * q[1])
    out[5] = 0.5 * (-x * q[2] + y * q[3] + z * q[0])
    out[6] = 0.5 * (x * q[1] - y * q[0] + z * q[3])
    out[7] = -0.5 * (x * q[0] + y * q[1] + z * q[2])


@kernel
def has_moved(joint_rows: I4, mesh_row: int, changed: U1) -> bool:
    """Whether the mesh's node or a joint moved: `changed` is per row of the Transform table, [rows]."""
    if changed[mesh_row]:
        return True
    for row in joint_rows:
        if changed[row]:
            return True
    return False


@kernel
def take_weights(morphs: F8, weights: F4) -> float:
    """Copy the weights of morph targets, [targets]; return the largest absolute one, -1 where all are as before."""
    greatest, same = 0.0, True
    for k in range(len(morphs)):
        weight = np.float32(morphs[k])
        same = same and weights[k] == weight
        weights[k] = weight
        greatest = max(greatest, abs(float(weight)))
    return -1.0 if same else greatest


@kernel
def write_palette(joint_rows: I4, mesh_row: int, world: F8, inverse_bind: F8, rows: F4, duals: F4) -> float:
    """Write the palette of all joints in the frame of the mesh's node.

    Args:
        joint_rows: Row of each joint in the Transform table, [joints].
        mesh_row: Row of the node that carries the mesh; where that stands makes no difference to what is seen.
        world: T_world_from_node per row, [rows, 4, 4].
        inverse_bind: T_joint_from_mesh at rest, [joints, 4, 4].
        rows: Three rows of each matrix, written, [joints, 3, 4].
        duals: The same as dual quaternions, written, [joints, 8]; right only where nothing is stretched.

    Returns:
        How far the joints stretch: the largest error of a product of two axes; -1: the mesh's node is flat, and
        nothing was written.
    """
    back, joint, product = np.empty((3, _COLUMNS)), np.empty((3, _COLUMNS)), np.empty((3, _COLUMNS))
    if not _invert(world[mesh_row], back):
        return -1.0
    worst = 0.0
    for j in range(joint_rows.shape[0]):
        _compose(back, world[joint_rows[j]], joint)
        _compose(joint, inverse_bind[j], product)
        worst = max(worst, _stretch(product))
        for r in range(3):
            for c in range(_COLUMNS):
                rows[j, r, c] = product[r, c]
        _store_dual(product, duals[j])
    return worst


@kernel
def _extend_by_box(rows: F4, box: F8, grown: F8, least: F8, greatest: F8) -> None:
    """Extend an AABB by a box that moves with a joint.

    Args:
        rows: Of the joint's matrix, [3, 4].
        box: Least and greatest corner as modelled [m], [2, 3].
        grown: Margin for morph targets and rounding on each side [m], [3].
        least: Corner of the AABB, changed, [3].
        greatest: Likewise.
    """
    for i in range(3):
        middle, half = float(rows[i, 3]), 0.0
        for k in range(3):
            middle += rows[i, k] * 0.5 * (box[0, k] + box[1, k])
            half += abs(rows[i, k]) * (0.5 * (box[1, k] - box[0, k]) + grown[k])
        least[i], greatest[i] = min(least[i], middle - half), max(greatest[i], middle + half)


@kernel
def bound_joints(rows: F4, boxes: F8, grown: F8, least: F8, greatest: F8) -> None:
    """Compute the AABB of boxes that move with joints; it contains every blended vertex.

    Args:
        rows: Palette, [joints, 3, 4].
        boxes: Least and greatest corner of the vertices that follow each joint, as modelled [m], [joints, 2, 3]; an
            empty one has its least corner beyond its greatest.
        grown: Margin for morph targets and rounding on each side [m], [3].
        least: Corner, written, [3].
        greatest: Likewise.
    """
    for i in range(3):
        least[i], greatest[i] = math.inf, -math.inf
    for j in range(rows.shape[0]):
        if boxes[j, 0, 0] > boxes[j, 1, 0]:
            continue
        _extend_by_box(rows[j], boxes[j], grown, least, greatest)
