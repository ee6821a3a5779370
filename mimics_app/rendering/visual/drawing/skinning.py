"""Skinning of the drawn meshes, once per frame: all views and shadow maps read the same skinned vertices."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.kernels.skin import morph_vertices, skin_dual, skin_linear
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.skinned_body import SkinnedBody
from mimics_app.world.content.world import World

__all__ = ["ProcessorSkinning", "SkinSource", "SkinnedMeshes", "make_source", "skin_mesh"]


_FLOATS = 8
"""Floats per vertex: position, normal, texture coordinates."""


@dataclass(frozen=True, eq=False)
class SkinSource:
    """Constant input of skinning a mesh.

    Attributes:
        mesh: The mesh.
        position_deltas: Position deltas of its morph targets, float32 [targets, n, 3].
        normal_deltas: Normal deltas, float32 [targets, n, 3]; None where no target has any.
    """

    mesh: MeshData
    position_deltas: F4
    normal_deltas: F4 | None


@dataclass(slots=True, eq=False)
class _Skinned:
    """A mesh of a body: constant input, skinned vertices [n, 8], and the revision of the body they are of."""

    source: SkinSource
    stream: F4
    revision: int = -1


class SkinnedMeshes:
    """Skinned meshes: each is skinned once a frame, for the first who asks."""

    def __init__(self) -> None:
        self._bent = WeakKeyDictionary[SkinnedBody, dict[str, _Skinned]]()

    def of(self, body: SkinnedBody, name: str) -> F4:
        """Return the vertices of a body's mesh, skinned as the body is now: float32 [n, 8], kept until it bends."""
        meshes, mesh = self._bent.get(body), body.meshes[name]
        if meshes is None:
            meshes = self._bent[body] = {}
        bent = meshes.get(name)
        if bent is None or bent.source.mesh is not mesh:
            stream = np.zeros((len(mesh.positions), _FLOATS), np.float32)
            if mesh.uvs is not None:
                stream[:, 6:] = mesh.uvs
            bent = meshes[name] = _Skinned(make_source(mesh), stream)
        if bent.revision != body.revision:
            bent.revision = body.revision
            skin_mesh(bent.source, body, bent.stream)
        return bent.stream


class ProcessorSkinning:
    """Skins meshes in compiled loops and uploads them.

    Args:
        arena: Buffers of the meshes.
        bent: The skinned meshes.
    """

    def __init__(self, arena: MeshArena, bent: SkinnedMeshes) -> None:
        self._arena, self._bent = arena, bent
        self._sent: dict[str, tuple[SkinnedBody, MeshData, int]] = {}
        self._rebuilt = -1

    def skin(self, world: World, names: list[str]) -> int:
        """Skin the meshes whose pose changed since they were last drawn; return the number of their vertices.

        Args:
            world: The world, updated.
            names: Keys of the drawn meshes; those without a skinned body are ignored.
        """
        bodies, vertices = world.motion.body_of, 0
        if self._rebuilt != self._arena.rebuilt:
            self._rebuilt, self._sent = self._arena.rebuilt, {}
        for name in names:
            body = bodies.get(name)
            if body is None:
                continue
            present = body, body.meshes[name], body.revision
            if self._sent.get(name) != present:
                self._sent[name] = present
                stream = self._bent.of(body, name)
                self._arena.write_skinned(name, stream)
                vertices += len(stream)
        return vertices

    def release(self) -> None:
        """Do nothing: no GPU object is owned."""


def make_source(mesh: MeshData) -> SkinSource:
    """Return the constant input of skinning a mesh."""
    morphs, shape = mesh.morphs, (len(mesh.morphs), *mesh.positions.shape)
    positions = np.array([morph.positions for morph in morphs], np.float32).reshape(shape)
    if all(morph.normals is None for morph in morphs):
        return SkinSource(mesh, positions, None)
    nothing = np.zeros_like(mesh.normals)
    normals = [nothing if morph.normals is None else morph.normals for morph in morphs]
    return SkinSource(mesh, positions, np.array(normals, np.float32).reshape(shape))


def skin_mesh(source: SkinSource, body: SkinnedBody, out: F4) -> None:
    """Write position and normal of a mesh's skinned vertices into float32 [n, 8]."""
    mesh = source.mesh
    positions, normals = mesh.positions, mesh.normals
    if mesh.morphs and body.morphed:
        positions, base = np.empty_like(positions), positions
        morph_vertices(base, source.position_deltas, body.weights, positions)
        if source.normal_deltas is not None:
            normals, base = np.empty_like(normals), normals
            morph_vertices(base, source.normal_deltas, body.weights, normals)
    weights = mesh.weights
    if body.binding is None or weights is None:
        out[:, :3], out[:, 3:6] = positions, normals
        return
    bound = (positions, normals, weights.joints, weights.weights)
    if body.method == "dual":
        skin_dual(*bound, body.duals, out)
    else:
        skin_linear(*bound, body.rows, body.stretched, out)
