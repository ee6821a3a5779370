"""Spatial extent of a scene's shadow casters, before a world is built."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from weakref import WeakKeyDictionary

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.files.scene.assets import ModelPart, find_in_model
from mimics_app.world.files.scene.placing import node_matrix, world_matrix
from mimics_app.world.files.scene.scene import Scene

__all__ = ["ENOUGH", "spread_of_casters"]


_FLAT = 0.02
"""Height over width below which a body counts as a floor, which casts no shadow on anything."""

_CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))

ENOUGH = 50.0
"""Extent at which the search ends [m]: a scene of 100,000 bodies reaches it after a few."""

_known: WeakKeyDictionary[Scene, float] = WeakKeyDictionary()


def spread_of_casters(scene: Scene) -> float:
    """Return half the diagonal of the bounding box of all shadow casters but floors [m], at most `ENOUGH`.

    Bodies of a model count with their boxes, primitives with their positions. 0 without casters. Computed once a scene.
    """
    if scene not in _known:
        _known[scene] = _measure(scene)
    return _known[scene]


def _measure(scene: Scene) -> float:
    low, high, spread = np.full(3, np.inf), np.full(3, -np.inf), 0.0
    for points in _points(scene):
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
        spread = 0.5 * float(np.linalg.norm(high - low))
        if spread > ENOUGH:
            return ENOUGH
    return spread


def _points(scene: Scene) -> Iterator[F8]:
    """Yield corners of the boxes of shadow casters, world [m], [n, 3] each."""
    for entity in scene.entities:
        mesh = entity.components.get("mesh")
        if entity.in_model or not isinstance(mesh, MeshComponent) or not (mesh.visible and mesh.casts_shadow):
            continue
        matrix = world_matrix(scene, entity)
        if mesh.source is None:
            yield matrix[None, :3, 3]
        else:
            yield from _model_points(find_in_model(scene.assets, mesh.source), matrix)


def _model_points(part: ModelPart, world_from_entity: F8) -> Iterator[F8]:
    """Yield the corners of the bodies of a model, likewise."""
    model = part.model
    if part.mesh is not None:
        yield from _corners(part, part.mesh, world_from_entity)
        return
    matrices: dict[int | None, F8] = {}
    for index in part.members:
        node = model.nodes[index]
        above = matrices.get(node.parent, world_from_entity)
        matrices[index] = above if index == part.node else above @ node_matrix(node)
        if node.mesh is not None and node.visible:
            yield from _corners(part, node.mesh, matrices[index])


def _corners(part: ModelPart, mesh: int, matrix: F8) -> Iterator[F8]:
    """Yield the corners of the boxes of a mesh's primitives, floors left out."""
    for primitive in part.model.meshes[mesh].primitives:
        low, high = primitive.mesh.bounds
        corners = (low + _CORNERS * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]
        size = np.ptp(corners, axis=0)
        if size[1] > _FLAT * max(size[0], size[2]):
            yield corners
