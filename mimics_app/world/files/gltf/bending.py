"""Animators and deformable bodies of instances of a glTF model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.content.motion.skinned_body import SkinnedBody, bind
from mimics_app.world.files.gltf.file import GltfDocument
from mimics_app.world.files.gltf.nodes import GltfNode
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["bind_body", "make_animator", "missing_joints", "unbent_meshes"]

Made = Mapping[int, SceneNode]
"""Nodes of the world by number of the node of the file, parents first."""


def unbent_meshes(model: GltfDocument) -> set[int]:
    """Return the meshes that are shown undeformed, or by no node."""
    nodes = model.nodes
    bending = [node for index, node in enumerate(nodes) if model.bends(index)]
    levels = {level for node in bending for level in node.levels}
    bent = {node.mesh for node in bending} | {nodes[level].mesh for level in levels}
    shown = {node.mesh for i, node in enumerate(nodes) if i not in levels and not model.bends(i)}
    return {mesh for mesh in range(len(model.meshes)) if mesh in shown or mesh not in bent}


def missing_joints(model: GltfDocument, made: Made) -> list[int]:
    """Return joints of an instance's skins, and their ancestors, that are outside the part shown."""
    skins = {model.nodes[index].skin for index in made if model.bends(index)}
    wanted: dict[int, None] = {}
    for skin in skins:
        for joint in model.skins[skin].joints if skin is not None else ():
            chain, at = list[int](), joint
            while at not in made and at not in wanted:
                chain.append(at)
                above = model.nodes[at].parent
                if above is None:
                    break
                at = above
            wanted |= dict.fromkeys(reversed(chain))
    return list(wanted)


def make_animator(model: GltfDocument, made: Made, placed: int | None) -> Animator | None:
    """Create the animator of an instance; None for a model without clips and deformable bodies.

    Args:
        model: The file.
        made: Nodes of the instance.
        placed: Node of the file that the scene places, and that clips therefore do not move.
    """
    slots = [index for index in made if index != placed]
    if not (model.clips or any(model.bends(index) for index in made)):
        return None
    slots = slots if placed is None or not model.bends(placed) else [placed, *slots]
    number = {index: slot for slot, index in enumerate(slots)}
    slot_of = np.full(len(model.nodes), -1, np.int32)
    slot_of[slots] = np.arange(len(slots))
    if placed is not None:
        slot_of[placed] = -1
    nodes = [model.nodes[index] for index in slots]
    first, names = _morph_slots(model, nodes)
    rest = Pose(
        np.array([node.translation for node in nodes]).reshape(-1, 3),
        np.array([node.rotation for node in nodes]).reshape(-1, 4),
        np.array([node.scale for node in nodes]).reshape(-1, 3),
        _morph_weights(model, nodes),
    )
    parents = [number.get(-1 if node.parent is None else node.parent, -1) for node in nodes]
    entities = np.array([made[index].index for index in slots], np.int32)
    fixed = int(bool(slots) and slots[0] == placed)
    bones = {bone: number[index] for bone, index in model.bones.items() if index in number}
    slots_above = np.array(parents, np.int32)
    rig = Rig(tuple(node.name for node in nodes), entities, slots_above, rest, first, names, fixed, bones)
    clips = [clip.aimed(slot_of) for clip in model.clips]
    return Animator(rig, [clip for clip in clips if len(clip.tracks)])


def bind_body(
    model: GltfDocument, index: int, made: Made, animator: Animator, key: Callable[[int, int], str]
) -> SkinnedBody:
    """Create the deformable body of a node.

    Args:
        model: The file.
        index: The node.
        made: All nodes of the instance.
        animator: Animator of the instance, whose pose has the morph weights.
        key: Mesh key in the world of (mesh, primitive).
    """
    node, entity = model.nodes[index], made[index].index
    numbers = [node.mesh, *(model.nodes[level].mesh for level in node.levels)]
    meshes = {
        key(mesh, k): part.mesh
        for mesh in numbers
        if mesh is not None
        for k, part in enumerate(model.meshes[mesh].primitives)
    }
    binding = None
    if node.skin is not None:
        skin = model.skins[node.skin]
        joints = np.array([made[joint].index for joint in skin.joints], np.int32)
        if _is_mirrored(skin.inverse_bind, skin.joints, made, made[index]):
            meshes = {name: _with_flipped_triangles(mesh) for name, mesh in meshes.items()}
        binding = bind(joints, skin.inverse_bind, list(meshes.values()))
    slot = int(np.flatnonzero(animator.rig.entities == entity)[0])
    first, end = animator.rig.morph_first[slot : slot + 2].tolist()
    return SkinnedBody(entity, meshes, binding, animator.pose.morphs[first:end], "linear")


def _morph_slots(model: GltfDocument, nodes: list[GltfNode]) -> tuple[NDArray[np.int32], tuple[str, ...]]:
    counts = [0 if node.mesh is None else model.meshes[node.mesh].morphs for node in nodes]
    names: list[str] = []
    for node in nodes:
        if node.mesh is not None and model.meshes[node.mesh].primitives:
            names += [morph.name for morph in model.meshes[node.mesh].primitives[0].mesh.morphs]
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int32), tuple(names)


def _morph_weights(model: GltfDocument, nodes: list[GltfNode]) -> F8:
    found: list[float] = []
    for node in nodes:
        if node.mesh is not None:
            found += node.morph_weights or model.meshes[node.mesh].morph_weights
    return np.array(found, np.float64)


def _is_mirrored(inverse_bind: F8, joints: tuple[int, ...], made: Made, body: SceneNode) -> bool:
    """True when joints mirror the mesh and its node does not, or the reverse.

    The node's determinant sets the front side of triangles, but only the joints place the vertices of a skin.
    """
    by_joints = np.linalg.det(made[joints[0]].world_matrix()[:3, :3] @ inverse_bind[0, :3, :3])
    return bool(by_joints * np.linalg.det(body.world_matrix()[:3, :3]) < 0.0)


def _with_flipped_triangles(mesh: MeshData) -> MeshData:
    return replace(mesh, indices=np.ascontiguousarray(mesh.indices.reshape(-1, 3)[:, ::-1]).reshape(-1))
