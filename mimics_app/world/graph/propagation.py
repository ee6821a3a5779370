"""Compiled passes over the scene graph: preorder walk, world matrices, poses in bulk."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4, U1

__all__ = ["are_rows", "preorder", "propagate", "store_poses", "store_scales"]


_MIN_LENGTH2, _MAX_LENGTH2 = 1e-280, 1e280
"""Squared lengths of quaternions that can be scaled to 1 without losing digits."""


@kernel
def preorder(start: int, parent: I4, first_child: I4, next_sibling: I4, out: I4) -> int:
    """Walk the subtree of `start` in preorder, without recursion: no depth overflows the stack.

    Args:
        start: Index of the subtree's root.
        parent: Per node, -1: none. Likewise `first_child` and `next_sibling`.
        first_child: First of each node's children.
        next_sibling: Next child of the same parent.
        out: Receives the indices.

    Returns:
        Number of nodes.
    """
    count = 0
    node = start
    while True:
        out[count] = node
        count += 1
        if first_child[node] >= 0:
            node = first_child[node]
            continue
        while node != start and next_sibling[node] < 0:
            node = parent[node]
        if node == start:
            return count
        node = next_sibling[node]


@kernel
def propagate(
    parent_row: I4,
    translation: F8,
    rotation: F8,
    scale: F8,
    visible: U1,
    dirty: U1,
    world: F8,
    shown: U1,
    changed: U1,
) -> int:
    """Compute world matrices and visibility of all rows that are dirty or whose parent changed; rows parent first.

    Args:
        parent_row: Row of the parent, below the own row; -1: none. [n]
        translation: Local [m], [n, 3].
        rotation: Local, unit xyzw, [n, 4].
        scale: Local, [n, 3].
        visible: Visibility flag of the node itself, [n].
        dirty: 1 where the local transform or flag was set; all 0 afterwards. [n]
        world: T_world_from_node, [n, 4, 4], written where needed.
        shown: Flags of the node and all its ancestors combined, [n], likewise.
        changed: 1 where this pass wrote, [n].

    Returns:
        Rows written.
    """
    written = 0
    for row in range(parent_row.shape[0]):
        parent = parent_row[row]
        changed[row] = dirty[row] | (changed[parent] if parent >= 0 else 0)
        if not changed[row]:
            continue
        dirty[row] = 0
        written += 1
        _place(row, parent, translation, rotation, scale, world)
        shown[row] = visible[row] & (shown[parent] if parent >= 0 else 1)
    return written


@kernel
def _place(row: int, parent: int, translation: F8, rotation: F8, scale: F8, world: F8) -> None:
    """World matrix of a row: that of its parent, if any, times T R S; its last row is 0 0 0 1 and stays so.

    Written in scalars: no intermediate matrix in memory, no view of a row.
    """
    x, y, z, w = rotation[row, 0], rotation[row, 1], rotation[row, 2], rotation[row, 3]
    a, b, c = scale[row, 0], scale[row, 1], scale[row, 2]
    l00, l01, l02 = (1.0 - 2.0 * (y * y + z * z)) * a, 2.0 * (x * y - z * w) * b, 2.0 * (x * z + y * w) * c
    l10, l11, l12 = 2.0 * (x * y + z * w) * a, (1.0 - 2.0 * (x * x + z * z)) * b, 2.0 * (y * z - x * w) * c
    l20, l21, l22 = 2.0 * (x * z - y * w) * a, 2.0 * (y * z + x * w) * b, (1.0 - 2.0 * (x * x + y * y)) * c
    t0, t1, t2 = translation[row, 0], translation[row, 1], translation[row, 2]
    if parent < 0:
        world[row, 0, 0], world[row, 0, 1], world[row, 0, 2], world[row, 0, 3] = l00, l01, l02, t0
        world[row, 1, 0], world[row, 1, 1], world[row, 1, 2], world[row, 1, 3] = l10, l11, l12, t1
        world[row, 2, 0], world[row, 2, 1], world[row, 2, 2], world[row, 2, 3] = l20, l21, l22, t2
        return
    for k in range(3):
        m0, m1, m2 = world[parent, k, 0], world[parent, k, 1], world[parent, k, 2]
        world[row, k, 0] = m0 * l00 + m1 * l10 + m2 * l20
        world[row, k, 1] = m0 * l01 + m1 * l11 + m2 * l21
        world[row, k, 2] = m0 * l02 + m1 * l12 + m2 * l22
        world[row, k, 3] = m0 * t0 + m1 * t1 + m2 * t2 + world[parent, k, 3]


@kernel
def store_poses(rows: I4, translation: F8, rotation: F8, into: F8, into_rotation: F8, dirty: U1) -> int:
    """Check and store the local poses of some rows; nothing is stored when one of them is invalid.

    Args:
        rows: Rows of the table, [n].
        translation: Translations [m], [n, 3].
        rotation: Quaternions xyzw of any length, [n, 4].
        into: The table's translations, [rows, 3].
        into_rotation: The table's rotations, unit with w >= 0, [rows, 4].
        dirty: 1 where the stored pose is another than before, [rows].

    Returns:
        -1, or the first pose with a number that is not finite or a quaternion of zero length.
    """
    for i in range(rows.shape[0]):
        x, y, z, w = rotation[i, 0], rotation[i, 1], rotation[i, 2], rotation[i, 3]
        size = abs(translation[i, 0]) + abs(translation[i, 1]) + abs(translation[i, 2])
        length2 = x * x + y * y + z * z + w * w
        if not (_MIN_LENGTH2 < length2 < _MAX_LENGTH2) or not (size < np.inf):
            return i
    for i in range(rows.shape[0]):
        row = rows[i]
        x, y, z, w = rotation[i, 0], rotation[i, 1], rotation[i, 2], rotation[i, 3]
        length = math.sqrt(x * x + y * y + z * z + w * w)
        shrink = 1.0 / length if w >= 0.0 else -1.0 / length
        unit = (x * shrink, y * shrink, z * shrink, w * shrink)
        for axis in range(len(unit)):
            if into_rotation[row, axis] != unit[axis]:
                into_rotation[row, axis] = unit[axis]
                dirty[row] = 1
        for axis in range(3):
            if into[row, axis] != translation[i, axis]:
                into[row, axis] = translation[i, axis]
                dirty[row] = 1
    return -1


@kernel
def store_scales(rows: I4, scale: F8, into: F8, dirty: U1) -> int:
    """Check and store the local scales of some rows, as `store_poses`.

    Args:
        rows: Rows of the table, [n].
        scale: Scales, [n, 3].
        into: The table's scales, [rows, 3].
        dirty: 1 where the stored scale is another than before, [rows].

    Returns:
        -1, or the first scale with a number that is not finite.
    """
    for i in range(rows.shape[0]):
        if not (abs(scale[i, 0]) + abs(scale[i, 1]) + abs(scale[i, 2]) < np.inf):
            return i
    for i in range(rows.shape[0]):
        for axis in range(3):
            if into[rows[i], axis] != scale[i, axis]:
                into[rows[i], axis] = scale[i, axis]
                dirty[rows[i]] = 1
    return -1


@kernel
def are_rows(rows: I4, count: int) -> bool:
    """Whether all numbers are rows of a table with so many, [n]."""
    for row in rows:
        if not 0 <= row < count:
            return False
    return True
