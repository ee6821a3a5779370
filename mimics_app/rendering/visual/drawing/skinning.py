"""Skinning of the drawn meshes, once per frame: all views and shadow maps read the same skinned vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.kernels.skin import morph_vertices, skin_dual, skin_linear
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.motion.skinned_body import SkinnedBody
from mimics_app.world.world import World

__all__ = ["BendSource", "ProcessorSkinning", "bend_mesh", "make_source"]


_FLOATS = 8
"""Floats per vertex: position, normal, texture coordinates."""


@dataclass(frozen=True, eq=False)
class BendSource:
    """Constant input of skinning a mesh.

    Attributes:
        mesh: The mesh.
        position_deltas: Position deltas of its morph targets, float32 [targets, n, 3].
        normal_deltas: Normal deltas, float32 [targets, n, 3]; None where no target has any.
    """

    mesh: MeshData
    position_deltas: F4
    normal_deltas: F4 | None


class ProcessorSkinning:
    """Skins meshes in compiled loops and uploads them.

    Attributes:
        vertices: Vertices skinned in the last frame.
    """

    def __init__(self, arena: MeshArena) -> None:
        self._arena = arena
        self._sources: dict[int, BendSource] = {}
        self._streams: dict[str, F4] = {}
        self._done: dict[str, tuple[int, int]] = {}
        self._rebuilt = -1
        self.vertices = 0

    def bend(self, world: World, names: list[str]) -> None:
        """Skin the meshes whose pose changed since they were last drawn.

        Args:
            world: The world, updated.
            names: Keys of the drawn meshes; those without a skinned body are ignored.
        """
        self.vertices = 0
        bodies = world.motion.body_of
        if not bodies:
            return
        if self._rebuilt != self._arena.rebuilt:
            self._rebuilt, self._done, self._streams = self._arena.rebuilt, {}, {}
            shown = {id(mesh) for body in bodies.values() for mesh in body.meshes.values()}
            self._sources = {key: source for key, source in self._sources.items() if key in shown}
        for name in names:
            body = bodies.get(name)
            if body is None or self._done.get(name) == (id(body), body.revision):
                continue
            self._done[name] = id(body), body.revision
            stream = self._stream(name, body.meshes[name])
            bend_mesh(self._source(body.meshes[name]), body, stream)
            self._arena.write_bent(name, stream)
            self.vertices += len(stream)

    def release(self) -> None:
        """Do nothing: no GPU object is owned."""

    def _stream(self, name: str, mesh: MeshData) -> F4:
        if name not in self._streams:
            stream = np.zeros((len(mesh.positions), _FLOATS), np.float32)
            if mesh.uvs is not None:
                stream[:, 6:] = mesh.uvs
            self._streams[name] = stream
        return self._streams[name]

    def _source(self, mesh: MeshData) -> BendSource:
        known = self._sources.get(id(mesh))
        if known is None or known.mesh is not mesh:
            known = self._sources[id(mesh)] = make_source(mesh)
        return known


def make_source(mesh: MeshData) -> BendSource:
    """Return the constant input of skinning a mesh."""
    morphs, shape = mesh.morphs, (len(mesh.morphs), *mesh.positions.shape)
    positions = np.array([morph.positions for morph in morphs], np.float32).reshape(shape)
    if all(morph.normals is None for morph in morphs):
        return BendSource(mesh, positions, None)
    nothing = np.zeros_like(mesh.normals)
    normals = [nothing if morph.normals is None else morph.normals for morph in morphs]
    return BendSource(mesh, positions, np.array(normals, np.float32).reshape(shape))


def bend_mesh(source: BendSource, body: SkinnedBody, out: F4) -> None:
    """Write position and normal of a mesh's skinned vertices into float32 [n, 8]."""
    mesh = source.mesh
    positions, normals = mesh.positions, mesh.normals
    if mesh.morphs and body.weights.any():
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
