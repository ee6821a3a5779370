"""Culling of the shapes near a point: its ball against the bounding sphere of each.

Groups of 16 spheres are tested without a branch, which the compiler vectorises; only groups with a hit are tested one
by one. The test reads four rows of numbers and no record of a shape.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I8, Vec

__all__ = ["find_near", "reaches"]


_GROUP = 16
"""Bounding spheres tested together."""


@kernel
def reaches(bounds: F8, i: int, x: float, y: float, z: float, radius: float) -> bool:
    """Return whether a bounding sphere overlaps the ball; a radius < 0 never does, an infinite one always."""
    dx, dy, dz = bounds[0, i] - x, bounds[1, i] - y, bounds[2, i] - z
    reach = bounds[3, i] + radius
    return dx * dx + dy * dy + dz * dz < reach * abs(reach)


@kernel
def find_near(bounds: F8, shapes: int, p: Vec, radius: float, near: I8) -> int:
    """Find the rows of the shapes whose bounding sphere overlaps the point's ball, ascending.

    Args:
        bounds: Rows x, y, z, radius [m], shape [4, >= shapes]; a radius < -(radius of the ball) is never found, an
            infinite one always.
        shapes: Number of shapes in use.
        p: The point, world [m], shape [3].
        radius: Radius of the point's ball [m].
        near: Receives the rows, shape [>= shapes].

    Returns:
        Number of shapes found.
    """
    x, y, z = p[0], p[1], p[2]
    bx, by, bz, br = bounds[0], bounds[1], bounds[2], bounds[3]
    found = 0
    grouped = shapes - shapes % _GROUP
    for first in range(0, grouped, _GROUP):
        hit = False
        for j in range(_GROUP):  # only a fixed count and a test without calls are vectorised
            i = first + j
            dx, dy, dz, reach = bx[i] - x, by[i] - y, bz[i] - z, br[i] + radius
            hit |= dx * dx + dy * dy + dz * dz < reach * abs(reach)
        if hit:
            for i in range(first, first + _GROUP):
                if reaches(bounds, i, x, y, z, radius):
                    near[found] = i
                    found += 1
    for i in range(grouped, shapes):
        if reaches(bounds, i, x, y, z, radius):
            near[found] = i
            found += 1
    return found
