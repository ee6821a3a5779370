"""Small boxes that together hold what hangs at a node: on the screen they cover much less than one around all of it."""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.kernels.voxels import voxelise
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.motion.kernels.skinning_palette import bound_blends
from mimics_app.world.motion.skinned_body import SkinnedBody
from mimics_app.world.world import World

__all__ = ["ShapeBoxes"]

_DIVISIONS = 8
"""Boxes along the longest side of a rigid shape."""


class ShapeBoxes:
    """Boxes of the shapes of a world by their meshes, computed when they are first asked for.

    Attributes:
        world: The world.

    Args:
        world: The world.
    """

    def __init__(self, world: World) -> None:
        self.world = world
        self._rigid: dict[tuple[str, ...], tuple[list[tuple[int, MeshData]], F8]] = {}
        self._sets = WeakKeyDictionary[SkinnedBody, tuple[I4, F8]]()

    def of(self, meshes: Sequence[str]) -> F8 | None:
        """Return boxes in the frame of the node that carries some meshes; None where they are not known.

        Args:
            meshes: Keys of all meshes at the node.

        Returns:
            Least and greatest corner of each [m], [n, 2, 3].
        """
        bodies = {self.world.motion.body_of.get(name) for name in meshes}
        if bodies == {None}:
            return self._of_rigid(tuple(meshes))
        body = self.body_of(meshes)
        if body is None or not _is_plain(body):
            return None
        bent = np.empty_like(self._sets_of(body)[1])
        self.bend(body, bent)
        return bent

    def has(self, meshes: Sequence[str]) -> bool:
        """Whether boxes of some meshes were computed before; those of a mesh that was replaced take time again."""
        return tuple(meshes) in self._rigid or self.body_of(meshes) in self._sets

    def body_of(self, meshes: Sequence[str]) -> SkinnedBody | None:
        """Return the one deformable body that all of some meshes are of."""
        bodies = {self.world.motion.body_of.get(name) for name in meshes}
        return bodies.pop() if len(bodies) == 1 else None

    def bend(self, body: SkinnedBody, boxes: F8) -> bool:
        """Write the boxes of a body's sets of vertices with the same joints, as deformed [m], [n, 2, 3].

        Returns:
            False, and nothing is written, where dual quaternions may leave such boxes.
        """
        if not _is_plain(body):
            return False
        joints, modelled = self._sets_of(body)
        bound_blends(body.rows, joints, modelled, body.margin, boxes)
        return True

    def _of_rigid(self, names: tuple[str, ...]) -> F8:
        meshes = [(self.world.mesh_revision(name), self.world.meshes[name]) for name in names]
        if names not in self._rigid or self._rigid[names][0] != meshes:
            self._rigid[names] = meshes, _divide([mesh for _, mesh in meshes])
        return self._rigid[names][1]

    def _sets_of(self, body: SkinnedBody) -> tuple[I4, F8]:
        if body not in self._sets:
            self._sets[body] = _find_sets(list(body.meshes.values()))
        return self._sets[body]


def _is_plain(body: SkinnedBody) -> bool:
    """Whether each vertex of a body is a linear blend of what its joints do with it."""
    return body.method == "linear" and all(mesh.weights is not None for mesh in body.meshes.values())


def _divide(meshes: Sequence[MeshData]) -> F8:
    """Return boxes of what meshes have in the cells of a grid, [n, 2, 3]."""
    filled = [mesh for mesh in meshes if mesh.triangle_count]
    if not filled:
        return np.zeros((0, 2, 3))
    least = np.min([mesh.bounds[0] for mesh in filled], axis=0)
    extent = np.max([mesh.bounds[1] for mesh in filled], axis=0) - least
    cell = max(float(extent.max()) / _DIVISIONS, 1e-9)
    counts = np.minimum(extent // cell, _DIVISIONS - 1).astype(int) + 1
    cells = np.empty((*counts, 2, 3))
    cells[..., 0, :], cells[..., 1, :] = np.inf, -np.inf
    for mesh in filled:
        voxelise(mesh.positions, mesh.indices, least, cell, cells)
    boxes = cells.reshape(-1, 2, 3)
    return np.ascontiguousarray(boxes[boxes[:, 0, 0] <= boxes[:, 1, 0]])


def _find_sets(meshes: Sequence[MeshData]) -> tuple[I4, F8]:
    """Return the sets of joints that move vertices, -1: fewer, [n, k], and boxes of their vertices, [n, 2, 3]."""
    most = max(mesh.weights.influences for mesh in meshes if mesh.weights is not None)
    joints, places = [], []
    for mesh in meshes:
        if mesh.weights is not None:
            moving = np.where(mesh.weights.weights > 0.0, mesh.weights.joints.astype(np.int32), -1)
            moving = np.pad(moving, ((0, 0), (0, most - moving.shape[1])), constant_values=-1)
            joints.append(np.sort(moving, axis=1))
            places.append(mesh.positions.astype(np.float64))
    sets, numbers = np.unique(np.concatenate(joints), axis=0, return_inverse=True)
    positions = np.concatenate(places)
    return np.ascontiguousarray(sets), _gather(positions, positions, numbers.reshape(-1).astype(np.int32))


def _gather(low: F8, high: F8, numbers: I4) -> F8:
    """Return the boxes around the boxes of the same number, in the order of the numbers, [n, 2, 3]."""
    order = np.argsort(numbers, kind="stable")
    starts = np.flatnonzero(np.diff(numbers[order], prepend=-1))
    least, greatest = np.minimum.reduceat(low[order], starts), np.maximum.reduceat(high[order], starts)
    return np.ascontiguousarray(np.stack([least, greatest], axis=1))
