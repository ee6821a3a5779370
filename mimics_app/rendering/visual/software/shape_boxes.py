"""Small boxes that together hold what hangs at a node: on the screen they cover much less than one around all of it."""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4
from mimics_app.rendering.visual.drawing.skinning import SkinnedMeshes
from mimics_app.rendering.visual.software.kernels.voxels import bound_clusters, voxelise
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.skinned_body import SkinnedBody
from mimics_app.world.content.world import World

__all__ = ["ShapeBoxes"]

_DIVISIONS = 8
"""Boxes along the longest side of a shape."""


class ShapeBoxes:
    """Boxes of the shapes of a world by their meshes, computed when they are first asked for.

    Attributes:
        world: The world.

    Args:
        world: The world.
        bent: Its skinned meshes.
    """

    def __init__(self, world: World, bent: SkinnedMeshes) -> None:
        self.world, self._bent = world, bent
        self._rigid: dict[tuple[str, ...], tuple[list[tuple[int, MeshData]], F8]] = {}
        self._clusters = WeakKeyDictionary[SkinnedBody, dict[tuple[str, ...], _Clusters]]()

    def of(self, meshes: Sequence[str]) -> F8 | None:
        """Return boxes in the frame of the node that carries some meshes; None where they are not known.

        Args:
            meshes: Keys of meshes at the node.

        Returns:
            Least and greatest corner of each [m], [n, 2, 3].
        """
        bodies = {self.world.motion.body_of.get(name) for name in meshes}
        if bodies == {None}:
            return self._of_rigid(tuple(meshes))
        body = self.body_of(meshes)
        if body is None:
            return None
        boxes = np.empty((self._clusters_of(body, meshes).count, 2, 3))
        self.bend(body, meshes, boxes)
        return boxes

    def has(self, meshes: Sequence[str]) -> bool:
        """Whether boxes of some meshes were computed before; those of a mesh that was replaced take time again."""
        names, body = tuple(meshes), self.body_of(meshes)
        return names in (self._rigid if body is None else self._clusters.get(body, ()))

    def body_of(self, meshes: Sequence[str]) -> SkinnedBody | None:
        """Return the one deformable body that all of some meshes are of."""
        bodies = {self.world.motion.body_of.get(name) for name in meshes}
        return bodies.pop() if len(bodies) == 1 else None

    def bend(self, body: SkinnedBody, meshes: Sequence[str], boxes: F8) -> None:
        """Write the boxes of some of a body's meshes as deformed, as many as `of` returned [m], [n, 2, 3]."""
        self._clusters_of(body, meshes).bound([self._bent.of(body, name) for name in meshes], boxes)

    def _of_rigid(self, names: tuple[str, ...]) -> F8:
        meshes = [(self.world.mesh_revision(name), self.world.meshes[name]) for name in names]
        if names not in self._rigid or self._rigid[names][0] != meshes:
            self._rigid[names] = meshes, _divide([mesh for _, mesh in meshes])
        return self._rigid[names][1]

    def _clusters_of(self, body: SkinnedBody, names: Sequence[str]) -> _Clusters:
        known, meshes = self._clusters.setdefault(body, {}), [body.meshes[name] for name in names]
        if tuple(names) not in known or known[tuple(names)].meshes != meshes:
            known[tuple(names)] = _Clusters(meshes)
        return known[tuple(names)]


class _Clusters:
    """Triangles of a deformable body that follow the same joint and are in the same cell of a grid at rest.

    Attributes:
        meshes: Meshes of the body.
        count: Number of clusters.

    Args:
        meshes: Meshes of the body.
    """

    def __init__(self, meshes: Sequence[MeshData]) -> None:
        self.meshes = meshes
        self._vertices: F4 = np.zeros((sum(len(mesh.positions) for mesh in meshes), 8), np.float32)
        self._members, self._starts = _gather(meshes)
        self.count = len(self._starts) - 1

    def bound(self, bent: Sequence[F4], boxes: F8) -> None:
        """Write the box of each cluster [m], [n, 2, 3], of the skinned vertices of each mesh, [n, 8]."""
        np.concatenate(bent, out=self._vertices)
        bound_clusters(self._vertices, self._members, self._starts, boxes)


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


def _gather(meshes: Sequence[MeshData]) -> tuple[I4, I4]:
    """Return the vertices of each cluster, numbered through all meshes, and where each cluster begins and ends."""
    positions = np.concatenate([mesh.positions for mesh in meshes])
    least, greatest = positions.min(axis=0), positions.max(axis=0)
    cell = max(float((greatest - least).max()) / _DIVISIONS, 1e-9)
    keys = np.column_stack([np.concatenate([_leaders(mesh) for mesh in meshes]), (positions - least) // cell])
    first = np.cumsum([0, *(len(mesh.positions) for mesh in meshes[:-1])])
    triangles = np.concatenate([mesh.indices.reshape(-1, 3) + start for mesh, start in zip(meshes, first, strict=True)])
    _, numbers = np.unique(keys[triangles[:, 0]], axis=0, return_inverse=True)
    count = len(positions)
    held = np.unique(numbers.reshape(-1, 1).astype(np.int64) * count + triangles)
    starts = np.flatnonzero(np.diff(held // count, prepend=-1, append=-1))
    return (held % count).astype(np.int32), starts.astype(np.int32)


def _leaders(mesh: MeshData) -> I4:
    """Return the joint with the largest weight of each vertex, -1: none, [n]."""
    if mesh.weights is None:
        return np.full(len(mesh.positions), -1, np.int32)
    return mesh.weights.joints[:, 0].astype(np.int32)
