"""World poses of a scene's entities before a world is built: products of their parents' transforms."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.errors import SceneError
from mimics_app.maths.decompose import decompose_trs
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.files.gltf.nodes import GltfNode
from mimics_app.world.files.scene.assets import ModelPart, find_in_model
from mimics_app.world.files.scene.scene import Scene, SceneEntity
from mimics_app.world.files.scene.spec import TransformSpec

__all__ = ["model_matrix", "node_matrix", "pose_of", "stands_somewhere", "world_matrix"]


_SCALE_TOLERANCE = 1e-6


def stands_somewhere(scene: Scene, name: str) -> bool:
    """True when an entity has a pose: its parents exist, form no loop, and no rotation is zero."""
    by_id = scene.by_id
    seen: set[str] = set()
    step: str | None = name
    while step is not None:
        if step in seen or step not in by_id or not any(by_id[step].transform.rotation):
            return False
        seen.add(step)
        step = by_id[step].parent
    return True


def pose_of(scene: Scene, name: str) -> tuple[F8, F8]:
    """Return position [m] and unit quaternion xyzw of an entity in the world.

    Raises:
        SceneError: it, or an ancestor, is scaled: a haptic shape has its size in metres.
    """
    entity = scene.entity(name)
    translation, rotation, scale, shear = decompose_trs(world_matrix(scene, entity))
    if np.abs(scale - 1.0).max() > _SCALE_TOLERANCE or shear > _SCALE_TOLERANCE:
        factors = ", ".join(f"{factor:.4g}" for factor in scale)
        what = f'"{name}" is scaled by {factors}; an object that can be touched has its size in metres'
        fix = f'scale 1 here; move its mesh to an entity with "parent": "{name}" and scale that one'
        raise SceneError(scene.issue(f"{entity.pointer}/transform/scale", what, fix))
    return translation, rotation


def world_matrix(scene: Scene, entity: SceneEntity) -> F8:
    """Return T_world_from_entity, shape [4, 4]; parents must form no loop."""
    own = _local_matrix(scene, entity)
    if entity.parent is None:
        return own
    above: F8 = world_matrix(scene, scene.entity(entity.parent)) @ own
    return above


def model_matrix(part: ModelPart, index: int) -> F8:
    """Return T_entity_from_node of a node of an entity's model, shape [4, 4]."""
    node = part.model.nodes[index]
    if index == part.node:
        return np.eye(4)
    own = node_matrix(node)
    return own if node.parent is None else model_matrix(part, node.parent) @ own


def node_matrix(node: GltfNode) -> F8:
    """Return T_parent_from_node of a node of a model, shape [4, 4]."""
    return _compose(node.translation, node.rotation, node.scale)


def _local_matrix(scene: Scene, entity: SceneEntity) -> F8:
    if entity.in_model and entity.parent is not None and entity.transform == TransformSpec():
        mesh = scene.entity(entity.parent).components.get("mesh")
        if isinstance(mesh, MeshComponent) and mesh.source is not None:
            part = find_in_model(scene.assets, mesh.source)
            return model_matrix(part, part.model.find_node(entity.id.removeprefix(f"{entity.parent}/")))
    own = entity.transform
    return _compose(own.translation, own.rotation, own.scale)


def _compose(translation: Vec3, rotation: tuple[float, ...], scale: Vec3) -> F8:
    from mimics_app.maths.mat import compose  # compiled: reading a scene without objects does not need it

    return compose(translation, rotation, scale)
