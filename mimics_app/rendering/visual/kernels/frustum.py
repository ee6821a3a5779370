"""Which items a frustum shows: sphere first, then box, against six planes."""

from __future__ import annotations

import math

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.contracts.kernel import kernel

__all__ = ["box_outside", "cull_flat", "distance_key", "is_seen"]


@kernel
def box_outside(plane: F8, depth: float, half: F8, item: int, world: F8, row: int) -> bool:
    """True when a box lies wholly behind a plane.

    Args:
        plane: Unit normal inwards and offset, [4].
        depth: Of the box's centre in front of the plane [m].
        half: Half sizes of the boxes in their nodes' frames [m], [n, 3].
        item: Which one.
        world: T_world_from_node per row, [rows, 4, 4].
        row: The node's row.
    """
    reach = 0.0
    for c in range(3):
        along = plane[0] * world[row, 0, c] + plane[1] * world[row, 1, c] + plane[2] * world[row, 2, c]
        reach += abs(along) * half[item, c]
    return bool(depth < -reach)


@kernel
def distance_key(eye: F8, centres: F8, radii: F8, item: int) -> float:
    """What items are sorted by from near to far [m].

    The distance of the centre; where the eye is inside the sphere, the sphere's far side, so that ground and sky, which
    are around everything, come last.
    """
    x, y, z = centres[item, 0] - eye[0], centres[item, 1] - eye[1], centres[item, 2] - eye[2]
    away = math.sqrt(x * x + y * y + z * z)
    return away if away > radii[item] else away + radii[item]


@kernel
def is_seen(planes: F8, item: int, row: int, centres: F8, radii: F8, half: F8, world: F8) -> bool:
    """False when some plane has the item wholly behind it: the sphere where that settles it, else the box."""
    x, y, z, radius = centres[item, 0], centres[item, 1], centres[item, 2], radii[item]
    for k in range(planes.shape[0]):
        depth = planes[k, 0] * x + planes[k, 1] * y + planes[k, 2] * z + planes[k, 3]
        if depth < -radius:
            return False
        if depth < radius and box_outside(planes[k], depth, half, item, world, row):
            return False
    return True


@kernel
def cull_flat(planes: F8, shown: U1, rows: I4, world: F8, centres: F8, radii: F8, half: F8, out: I4) -> int:
    """Test every item against every plane.

    Args:
        planes: Unit normals inwards and offsets, [k, 4].
        shown: 1 where the item may be drawn at all, [n].
        rows: Row of the node per item, [n].
        world: T_world_from_node per row, [rows, 4, 4].
        centres: Of the spheres in the world [m], [n, 3].
        radii: [m], [n].
        half: Half sizes of the boxes about the same centres, in their nodes' frames [m], [n, 3].
        out: Receives the items not wholly outside, ascending, [n].

    Returns:
        How many there are.
    """
    count = 0
    for i in range(rows.shape[0]):
        if shown[i] and is_seen(planes, i, rows[i], centres, radii, half, world):
            out[count] = i
            count += 1
    return count
