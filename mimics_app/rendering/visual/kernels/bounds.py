"""Bounding spheres of the draw items in the world, and boxes around many of them."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import B1, F8, I4, U1

__all__ = ["enclose", "follow_box", "gather_casters", "update_bounds"]


@kernel
def _stretch(world: F8, row: int) -> float:
    """Return an upper bound on the largest scale of a node's matrix, exact where its axes are orthogonal.

    The scale is the root of the largest eigenvalue of the axes' Gram matrix, bounded by its largest absolute row sum
    (Gershgorin 1931); this holds under shear too, as of a rotated child of a non-uniformly scaled parent.
    """
    largest = 0.0
    for i in range(3):
        total = 0.0
        for j in range(3):
            dot = world[row, 0, i] * world[row, 0, j] + world[row, 1, i] * world[row, 1, j]
            total += abs(dot + world[row, 2, i] * world[row, 2, j])
        largest = max(largest, total)
    return math.sqrt(largest)


@kernel
def _is_mirrored(world: F8, row: int) -> bool:
    a = world[row, 1, 1] * world[row, 2, 2] - world[row, 1, 2] * world[row, 2, 1]
    b = world[row, 1, 0] * world[row, 2, 2] - world[row, 1, 2] * world[row, 2, 0]
    c = world[row, 1, 0] * world[row, 2, 1] - world[row, 1, 1] * world[row, 2, 0]
    return bool(world[row, 0, 0] * a - world[row, 0, 1] * b + world[row, 0, 2] * c < 0.0)


@kernel
def update_bounds(
    rows: I4, world: F8, changed: U1, everything: bool, local: F8, centres: F8, radii: F8, mirrored: U1
) -> int:
    """Transform spheres to the world where their node moved.

    Args:
        rows: Row of the node per item, [n].
        world: T_world_from_node per row, [rows, 4, 4].
        changed: 1 where a row moved since the last call, [rows].
        everything: True transforms all items, moved or not.
        local: Centre [m] and radius [m] of each item's sphere in its node's frame, [n, 4].
        centres: Centres of the spheres in the world [m], written, [n, 3].
        radii: Their radii [m], written, [n].
        mirrored: 1 where the node's axes are left-handed, so that the winding is reversed; written, [n].

    Returns:
        How many items moved.
    """
    moved = 0
    for i in range(rows.shape[0]):
        row = rows[i]
        if not (everything or changed[row]):
            continue
        moved += 1
        for k in range(3):
            turned = world[row, k, 0] * local[i, 0] + world[row, k, 1] * local[i, 1] + world[row, k, 2] * local[i, 2]
            centres[i, k] = turned + world[row, k, 3]
        radii[i] = local[i, 3] * _stretch(world, row)
        mirrored[i] = _is_mirrored(world, row)
    return moved


@kernel
def enclose(centres: F8, radii: F8, clip_from_world: F8, inside: F8) -> tuple[float, bool]:
    """Measure spheres, and compare them with the box of an orthographic projection.

    Args:
        centres: Centres of the spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        clip_from_world: The projection, [4, 4].
        inside: Largest absolute clip coordinate that a sphere may reach on each axis, [3].

    Returns:
        Radius that holds all spheres around the centre of their common box [m], and whether all are inside.
    """
    middle, reach, held = np.empty(3), 0.0, True
    for k in range(3):
        low, high = math.inf, -math.inf
        for i in range(radii.shape[0]):
            low, high = min(low, centres[i, k] - radii[i]), max(high, centres[i, k] + radii[i])
        middle[k] = 0.5 * (low + high)
    for i in range(radii.shape[0]):
        away = 0.0
        for k in range(3):
            away += (centres[i, k] - middle[k]) ** 2
        reach = max(reach, math.sqrt(away) + radii[i])
        for k in range(3):
            row = clip_from_world[k]
            at = row[0] * centres[i, 0] + row[1] * centres[i, 1] + row[2] * centres[i, 2] + row[3]
            stretch = math.sqrt(row[0] ** 2 + row[1] ** 2 + row[2] ** 2)
            held = held and abs(at) + stretch * radii[i] <= inside[k]
    return reach, held


@kernel
def gather_casters(
    shown: U1, casting: B1, centres: F8, radii: F8, most: float, items: I4, held_centres: F8, held_radii: F8
) -> tuple[int, int]:
    """Gather the items that cast shadows, and the spheres of those that are not too large.

    Args:
        shown: 1 where an item may be drawn, [n].
        casting: True where it casts shadows, [n].
        centres: Centres of the items' spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        most: Largest radius of a gathered sphere [m].
        items: Written: numbers of the items, ascending, [>= n].
        held_centres: Written: centres of the spheres, [>= n, 3].
        held_radii: Written: their radii, [>= n].

    Returns:
        Number of items, and of spheres.
    """
    count, held = 0, 0
    for item in range(shown.shape[0]):
        if shown[item] and casting[item]:
            items[count] = item
            count += 1
            if radii[item] <= most:
                for k in range(3):
                    held_centres[held, k] = centres[item, k]
                held_radii[held] = radii[item]
                held += 1
    return count, held


@kernel
def follow_box(items: I4, lower: F8, upper: F8, half: F8, local: F8) -> None:
    """Set the bounds of the items of one deformable body.

    Args:
        items: Numbers of the items, [k].
        lower: Least corner of the body's box in the node's frame [m], [3].
        upper: Its greatest corner [m], [3].
        half: Written: half extents of the items' boxes [m], [n, 3].
        local: Written: their centres and the radii of the spheres around them [m], [n, 4].
    """
    reach = 0.0
    for k in range(3):
        extent = 0.5 * (upper[k] - lower[k])
        reach += extent * extent
        for item in items:
            half[item, k], local[item, k] = extent, 0.5 * (lower[k] + upper[k])
    for item in items:
        local[item, 3] = math.sqrt(reach)
