"""Extent of a world: the bounding box of its visible bodies."""

from __future__ import annotations

import itertools

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.world import World

__all__ = ["Extent", "world_extent"]

Extent = tuple[F8, F8]
"""Minimum and maximum of an axis-aligned box, world [m], float64 [3] each."""

_CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))


def world_extent(world: World, node: int | None = None) -> Extent | None:
    """Return the AABB of all that is visible; None where nothing is.

    It bounds the transformed corners of each mesh's own box, so it may be larger than the tightest box.

    Args:
        world: The world, updated.
        node: Entity index of the node whose subtree counts; None: everything.
    """
    listed, hierarchy = world.subentities(), world.graph.hierarchy
    low_world, high_world = np.full(3, np.inf), np.full(3, -np.inf)
    for number in np.flatnonzero(listed.visible).tolist():
        mesh = world.meshes.get(listed.mesh[number])
        if mesh is None or not len(mesh.positions):
            continue
        if node is not None and not hierarchy.is_inside(int(listed.entity[number]), node):
            continue
        low, high = world.mesh_bounds(listed.mesh[number])
        matrix = world.transforms.world[listed.row[number]]
        corners = (low + _CORNERS * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]
        low_world, high_world = np.minimum(low_world, corners.min(axis=0)), np.maximum(high_world, corners.max(axis=0))
    return (low_world, high_world) if np.all(low_world <= high_world) else None
