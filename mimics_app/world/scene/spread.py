"""How far the bodies of a scene are spread, before there is a world."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from weakref import WeakKeyDictionary

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.scene.assets import ModelPart, find_in_model
from mimics_app.world.scene.placing import local_matrix, node_matrix
from mimics_app.world.scene.scene import Scene, SceneEntity

__all__ = ["ENOUGH", "spread_of_casters"]


_FLAT = 0.02
"""Height over width of a body that is taken for a floor: what lies flat casts a shadow on nothing."""

_CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))

ENOUGH = 50.0
"""Beyond this nothing more is counted [m]: a scene of 100,000 bodies is known to be wide after a few."""

_known: WeakKeyDictionary[Scene, float] = WeakKeyDictionary()


def spread_of_casters(scene: Scene) -> float:
    """Half the diagonal of the box about what casts shadows [m], floors left out; no more than `ENOUGH` is counted.

    Bodies of a model count with their boxes, shapes with their places. 0 where nothing casts. Computed once a scene.
    """
    if scene not in _known:
        _known[scene] = _measure(scene)
    return _known[scene]


def _measure(scene: Scene) -> float:
    least, greatest, spread = np.full(3, np.inf), np.full(3, -np.inf), 0.0
    for points in _points(scene):
        least, greatest = np.minimum(least, points.min(axis=0)), np.maximum(greatest, points.max(axis=0))
        spread = 0.5 * float(np.linalg.norm(greatest - least))
        if spread > ENOUGH:
            return ENOUGH
    return spread


def _points(scene: Scene) -> Iterator[F8]:
    """Corners of what casts shadows, world [m], [n, 3] each."""
    by_id = {entity.id: entity for entity in scene.entities}
    matrices: dict[str, F8] = {}
    for entity in scene.entities:
        mesh = entity.components.get("mesh")
        if entity.in_model or not isinstance(mesh, MeshComponent) or not (mesh.visible and mesh.casts_shadow):
            continue
        matrix = _world_matrix(entity, by_id, matrices)
        if mesh.source is None:
            yield matrix[None, :3, 3]
        else:
            yield from _model_points(find_in_model(scene.assets, mesh.source), matrix)


def _world_matrix(entity: SceneEntity, by_id: dict[str, SceneEntity], matrices: dict[str, F8]) -> F8:
    """T_world_from_entity, [4, 4]; those of parents are kept, so that every one is computed once."""
    chain = []
    step: SceneEntity | None = entity
    while step is not None and step.id not in matrices:
        chain.append(step)
        step = None if step.parent is None else by_id[step.parent]
    above = np.eye(4) if step is None else matrices[step.id]
    for each in reversed(chain):
        above = above @ local_matrix(each.transform)
        matrices[each.id] = above
    return above


def _model_points(part: ModelPart, world_from_entity: F8) -> Iterator[F8]:
    """The same of a model's bodies."""
    model = part.model
    if part.mesh is not None:
        yield from _corners(part, part.mesh, world_from_entity)
        return
    matrices: dict[int, F8] = {}
    for top in part.nodes if part.node is None else (part.node,):
        for index in model.subtree(top):
            node = model.nodes[index]
            above = world_from_entity if index == top else matrices[node.parent if node.parent is not None else top]
            matrices[index] = above if index == part.node else above @ node_matrix(node)
            if node.mesh is not None and node.visible:
                yield from _corners(part, node.mesh, matrices[index])


def _corners(part: ModelPart, mesh: int, matrix: F8) -> Iterator[F8]:
    """Corners of the boxes of a mesh's parts that are no floors."""
    for primitive in part.model.meshes[mesh].primitives:
        least, greatest = primitive.mesh.bounds
        corners = (least + _CORNERS * (greatest - least)) @ matrix[:3, :3].T + matrix[:3, 3]
        size = np.ptp(corners, axis=0)
        if size[1] > _FLAT * max(size[0], size[2]):
            yield corners
