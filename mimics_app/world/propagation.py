"""The compiled passes over the scene graph: parents before children, and world matrices in one sweep."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.maths.mat import compose_trs, multiply_affine

__all__ = ["preorder", "propagate"]

I4 = NDArray[np.int32]
F8 = NDArray[np.float64]
U1 = NDArray[np.uint8]


@kernel
def preorder(start: int, parent: I4, first_child: I4, next_sibling: I4, out: I4) -> int:
    """Walk the subtree of `start`, each node before its children; no recursion, so that no depth can overflow.

    Args:
        start: Index of the first node.
        parent: Per node, -1: none. Likewise `first_child` and `next_sibling`.
        first_child: First of each node's children.
        next_sibling: Next child of the same parent.
        out: Receives the indices.

    Returns:
        How many there are.
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
    """World matrices and visibility of every row that is dirty or hangs on a row that changed; rows parent first.

    Args:
        parent_row: Row of the parent, below the own row; -1: none. [n]
        translation: Local [m], [n, 3].
        rotation: Local, unit xyzw, [n, 4].
        scale: Local, [n, 3].
        visible: The node's own switch, [n].
        dirty: 1 where the local transform or switch was touched; all 0 afterwards. [n]
        world: T_world_from_node, [n, 4, 4], written where needed.
        shown: Own switch and those of all ancestors, [n], likewise.
        changed: 1 where this pass wrote, [n].

    Returns:
        Rows written.
    """
    local = np.empty((4, 4))
    written = 0
    for row in range(parent_row.shape[0]):
        parent = parent_row[row]
        changed[row] = dirty[row] | (changed[parent] if parent >= 0 else 0)
        if not changed[row]:
            continue
        dirty[row] = 0
        written += 1
        if parent < 0:
            compose_trs(translation[row], rotation[row], scale[row], world[row])
            shown[row] = visible[row]
        else:
            compose_trs(translation[row], rotation[row], scale[row], local)
            multiply_affine(world[parent], local, world[row])
            shown[row] = visible[row] & shown[parent]
    return written
