"""Bounds of spheres in a shadow map."""

from __future__ import annotations

import math

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.kernel import kernel

__all__ = ["bound_in_map"]


@kernel
def bound_in_map(clip_from_world: F8, items: I4, centres: F8, radii: F8, bounds: F8) -> None:
    """Write the rectangle that each of some spheres covers in an orthographic map.

    Args:
        clip_from_world: Projection of the map, [4, 4].
        items: Numbers of the spheres, [k].
        centres: Centres of all spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        bounds: Written: left, right, bottom, top as shares of the map, [k, 4].
    """
    for axis in range(2):
        row = clip_from_world[axis]
        stretch = math.sqrt(row[0] ** 2 + row[1] ** 2 + row[2] ** 2)
        for number, item in enumerate(items):
            at = row[0] * centres[item, 0] + row[1] * centres[item, 1] + row[2] * centres[item, 2] + row[3]
            bounds[number, 2 * axis] = 0.5 * (at - stretch * radii[item] + 1.0)
            bounds[number, 2 * axis + 1] = 0.5 * (at + stretch * radii[item] + 1.0)
