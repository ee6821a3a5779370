"""Frustum culling: bounding sphere first, then oriented box, against six planes."""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4, U1

__all__ = ["cull_flat", "distance_key", "find_planes", "is_seen"]


@kernel
def _box_outside(plane: F8, depth: float, half: F8, item: int, world: F8, row: int) -> bool:
    """Return True when a box lies wholly behind a plane.

    Args:
        plane: Unit normal inwards and offset, [4].
        depth: Signed distance of the box's centre from the plane [m].
        half: Half extents of the boxes in their nodes' frames [m], [n, 3].
        item: Number of the box.
        world: T_world_from_node per row, [rows, 4, 4].
        row: Row of its node.
    """
    reach = 0.0
    for c in range(3):
        along = plane[0] * world[row, 0, c] + plane[1] * world[row, 1, c] + plane[2] * world[row, 2, c]
        reach += abs(along) * half[item, c]
    return bool(depth < -reach)


@kernel
def distance_key(eye: F8, centres: F8, radii: F8, item: int) -> float:
    """Return the distance an item is sorted by [m].

    That of the centre; with the camera inside the sphere the radius is added, so that ground and sky come last.
    """
    x, y, z = centres[item, 0] - eye[0], centres[item, 1] - eye[1], centres[item, 2] - eye[2]
    away = math.sqrt(x * x + y * y + z * z)
    return away if away > radii[item] else away + radii[item]


@kernel
def is_seen(planes: F8, item: int, row: int, centres: F8, radii: F8, half: F8, world: F8) -> bool:
    """Return False when an item is wholly behind a plane, by its sphere where that decides, else by its box."""
    x, y, z, radius = centres[item, 0], centres[item, 1], centres[item, 2], radii[item]
    for k in range(planes.shape[0]):
        depth = planes[k, 0] * x + planes[k, 1] * y + planes[k, 2] * z + planes[k, 3]
        if depth < -radius:
            return False
        if depth < radius and _box_outside(planes[k], depth, half, item, world, row):
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
        centres: Centres of the spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        half: Half extents of the boxes around the same centres, in their nodes' frames [m], [n, 3].
        out: Written: numbers of the items not wholly outside, ascending, [n].

    Returns:
        How many there are.
    """
    count = 0
    for i in range(rows.shape[0]):
        if shown[i] and is_seen(planes, i, rows[i], centres, radii, half, world):
            out[count] = i
            count += 1
    return count


@kernel
def find_planes(clip_from_world: F8, planes: F8) -> None:
    """Write the six planes of a frustum, [6, 4]: left, right, bottom, top, near, far.

    Unit normals inwards and offsets; a far plane at infinity has no normal, and everything is inside.

    Args:
        clip_from_world: Projection, [4, 4].
        planes: Written.
    """
    last = clip_from_world[3]
    for k in range(planes.shape[0]):
        row, sign = clip_from_world[k // 2], 1.0 - 2.0 * (k % 2)
        length = 0.0
        for i in range(3):
            length += (last[i] + sign * row[i]) ** 2
        length = math.sqrt(length)
        for i in range(planes.shape[1]):
            planes[k, i] = (last[i] + sign * row[i]) / length if length > 0.0 else (0.0 if i < 3 else 1.0)
