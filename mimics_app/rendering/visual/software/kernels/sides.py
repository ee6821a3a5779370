"""Sides of triangles: their length in a mesh and on the picture."""

from __future__ import annotations

import math
from typing import NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, U1, U4

__all__ = ["Spheres", "StatesBySize", "choose_states", "measure_sides"]

_CORNERS = 3
_HYSTERESIS = 0.05
"""Relative distance from the limit at which a state changes."""


@kernel
def measure_sides(positions: F4, indices: U4) -> float:
    """Return the mean length of the longest side of each triangle, weighted by the areas [m]; 0 without any area.

    Args:
        positions: Vertices [m], [n, 3].
        indices: Three vertices per triangle, [3 k].
    """
    total, area = 0.0, 0.0
    for triangle in range(indices.shape[0] // _CORNERS):
        a, b, c = indices[_CORNERS * triangle], indices[_CORNERS * triangle + 1], indices[_CORNERS * triangle + 2]
        ab2, ac2, bc2, along = 0.0, 0.0, 0.0, 0.0
        for k in range(3):
            ab, ac = positions[b, k] - positions[a, k], positions[c, k] - positions[a, k]
            ab2 += ab**2
            ac2 += ac**2
            bc2 += (ac - ab) ** 2
            along += ab * ac
        twice = math.sqrt(max(0.0, ab2 * ac2 - along**2))
        total += twice * math.sqrt(max(ab2, ac2, bc2))
        area += twice
    return total / area if area > 0.0 else 0.0


class Spheres(NamedTuple):
    """Bounding spheres of items.

    Attributes:
        centres: Their centres, world [m], [n, 3].
        radii: Their radii [m], [n].
        local: Centres and radii in the nodes' frames [m], [n, 4].
    """

    centres: F8
    radii: F8
    local: F8


class StatesBySize(NamedTuple):
    """States of items by the size of their triangles.

    Attributes:
        sides: Sides of an item's triangles in its node's frame [m], [n]; 0: it has one state only.
        large: State on large triangles, [n].
        small: State on small triangles, [n].
    """

    sides: F8
    large: I4
    small: I4


@kernel
def choose_states(
    items: I4, spheres: Spheres, states: StatesBySize, eye: F8, limit: float, small: U1, chosen: I4
) -> None:
    """Choose the state of each item by the size of its triangles on the picture, at the distance of its centre.

    Args:
        items: Numbers of items, [k].
        spheres: The spheres of all.
        states: Their states.
        eye: Position of the camera, world [m], [3].
        limit: Length of a side at distance 1 up to which triangles are small [m].
        small: 1 where an item's triangles counted as small before; written, [n].
        chosen: Written: the states, [n].
    """
    for item in items:
        chosen[item] = states.large[item]
        side, radius = states.sides[item], spheres.local[item, 3]
        if side <= 0.0 or radius <= 0.0:
            continue
        away2 = 0.0
        for k in range(3):
            away2 += (spheres.centres[item, k] - eye[k]) ** 2
        wide = side * spheres.radii[item] / radius
        small[item] = wide <= math.sqrt(away2) * limit * (1.0 + _HYSTERESIS if small[item] else 1.0 - _HYSTERESIS)
        if small[item]:
            chosen[item] = states.small[item]
