"""Broad phases of a point against shapes.

Probe: spheres of 2 cm on a square grid of 6 cm, and two thousand random points in their plane. Error: number of points
with a wrong number of shapes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I8, Vec, Words
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.haptic.touch_probe import RADIUS
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.objects.cull import find_near, reaches

__all__ = ["find_near_plain", "misses"]


_QUERIES = 2000
_TYPICAL = 1000
_CELL = 0.06


@kernel
def find_near_plain(bounds: F8, shapes: int, p: Vec, radius: float, near: I8) -> int:
    """Rival of `find_near` that tests one shape after the other; same arguments and result."""
    x, y, z = p[0], p[1], p[2]
    found = 0
    for i in range(shapes):
        if reaches(bounds, i, x, y, z, radius):
            near[found] = i
            found += 1
    return found


@kernel
def _in_cell(starts: Words, members: Words, bounds: F8, side: int, x: float, y: float, near: Words) -> int:
    """Find shapes by a grid of cells filled in advance; none near a point outside of it."""
    column, row = math.floor(x / _CELL + 0.5), math.floor(y / _CELL + 0.5)
    if column < 0 or row < 0 or column >= side or row >= side:
        return 0
    cell = row * side + column
    found = 0
    for k in range(starts[cell], starts[cell + 1]):
        i = members[k]
        dx, dy, dz = bounds[0, i] - x, bounds[1, i] - y, bounds[2, i]
        if dx * dx + dy * dy + dz * dz < bounds[3, i] * bounds[3, i]:
            near[found] = i
            found += 1
    return found


@kernel
def _cull_often(
    number: int, bounds: F8, points: F8, starts: Words, members: Words, side: int, near: Words, totals: Words
) -> None:
    shapes = bounds.shape[1]
    for k in range(points.shape[0]):
        if number == 0:
            totals[k] = find_near(bounds, shapes, points[k], 0.0, near)
        elif number == 1:
            totals[k] = find_near_plain(bounds, shapes, points[k], 0.0, near)
        else:
            totals[k] = _in_cell(starts, members, bounds, side, points[k, 0], points[k, 1], near)


def _spread_bounds(count: int) -> tuple[F8, int]:
    """Return bounds [4, count] of spheres of RADIUS on a square grid of 6 cm in a plane, and cells along its side."""
    side = max(1, math.ceil(math.sqrt(count)))
    places = np.arange(count)
    bounds = np.zeros((4, count))
    bounds[0], bounds[1], bounds[3] = _CELL * (places % side), _CELL * (places // side), RADIUS
    return bounds, side


def _cull_arguments(count: int) -> tuple[Any, ...]:
    bounds, side = _spread_bounds(count)
    cells = np.arange(side * side + 1)
    points = np.random.default_rng(1).uniform(-0.5 * _CELL, (side - 0.5) * _CELL, (_QUERIES, 3)) * (1.0, 1.0, 0.0)
    near, totals = np.zeros(count, np.int64), np.zeros(_QUERIES, np.int64)
    return bounds, points, np.minimum(cells, count), np.arange(count), side, near, totals


def _cull_us(number: int, count: int) -> float:
    arguments = _cull_arguments(count)
    return shortest_us(lambda: _cull_often(number, *arguments), _QUERIES)


def misses(number: int, count: int = _TYPICAL) -> float:
    """Return the number of queries, of two thousand, whose number of shapes differs from that by all distances."""
    arguments = _cull_arguments(count)
    _cull_often(number, *arguments)
    bounds, points = arguments[0], arguments[1]
    squares = (bounds[0] - points[:, :1]) ** 2 + (bounds[1] - points[:, 1:2]) ** 2
    return float(np.count_nonzero((squares < RADIUS * RADIUS).sum(axis=1) != arguments[-1]))


compare(
    __name__,
    "which of 1000 shapes a point may touch; error: of 2000 queries those with a shape too many or too few",
    "queries",
    [
        Rival("groups of 16", "bounds tested 16 at a time without a branch", "any scene, moving or not", {}, (0,)),
        Rival("one by one", "bounds tested one after the other", "any scene", None, (1,)),
        Rival(
            "grid", "the cell of the point lists its shapes", "shapes at rest: filled again at each change", None, (2,)
        ),
    ],
    Probes(_cull_us, misses, reference_us),
    default="groups of 16",
    growth=Growth(work="shapes", sizes=(1, 10, 100, 1000, 10_000), typical=_TYPICAL),
)
