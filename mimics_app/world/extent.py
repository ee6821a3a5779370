"""How far a world reaches: the box about what it shows."""

from __future__ import annotations

import itertools

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.world import World

__all__ = ["Extent", "world_extent"]

Extent = tuple[F8, F8]
"""Least and greatest corner, world [m], float64 [3] each."""

_CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))


def world_extent(world: World, node: int | None = None) -> Extent | None:
    """The axis-aligned box about what is visible; None where nothing is.

    The corners of each mesh's own box are taken along, so that it may be larger than the tightest one.

    Args:
        world: After its update.
        node: Entity index of a node: only what hangs on it counts, itself included; None: everything.
    """
    listed, hierarchy = world.subentities(), world.graph.hierarchy
    least, greatest = np.full(3, np.inf), np.full(3, -np.inf)
    for number in np.flatnonzero(listed.visible).tolist():
        mesh = world.meshes.get(listed.mesh[number])
        if mesh is None or not len(mesh.positions):
            continue
        if node is not None and not hierarchy.is_inside(int(listed.entity[number]), node):
            continue
        low, high = world.mesh_bounds(listed.mesh[number])
        matrix = world.transforms.world[listed.row[number]]
        corners = (low + _CORNERS * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]
        least, greatest = np.minimum(least, corners.min(axis=0)), np.maximum(greatest, corners.max(axis=0))
    return (least, greatest) if np.all(least <= greatest) else None
