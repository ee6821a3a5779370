"""Skinning on the GPU: transform feedback into the vertex buffer that every pass draws from."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.drawing.skinning import SkinSource, make_source, skin_mesh
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.skinned_body import SkinnedBody
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["FeedbackSkinning"]


_VARYINGS = ("bent_position", "bent_normal", "bent_uv")
_VERTEX_BYTES = 32
_PALETTE_BYTES = 65_536
"""Size of the palette's uniform block, which every driver offers: 4,096 rows [bytes]."""
_BINDING, _TEXTURE_UNIT = 11, 24
"""Bindings of the palette and of the morph deltas in skin.vert."""
_DELTAS_WIDTH = 2048
"""Width of the texture of morph deltas [texel]."""
_MAX_MORPHS = 64
"""Maximum number of active morph targets; a mesh with more is skinned on the processor."""


class _Held:
    """GPU objects of a mesh: vertices with joints and weights, and deltas of morph targets."""

    def __init__(self, ctx: moderngl.Context, source: SkinSource) -> None:
        mesh = source.mesh
        assert mesh.weights is not None
        self.source = source
        self.count, self.sets = len(mesh.positions), -(-mesh.weights.influences // 4)
        self.buffer = ctx.buffer(_pack(mesh, self.sets).tobytes())
        self.deltas = _upload_deltas(ctx, source) if mesh.morphs else None
        self.arrays = VertexArrays(partial(_vertex_array, ctx, self.buffer, self.sets))

    def release(self) -> None:
        self.arrays.release()
        self.buffer.release()
        if self.deltas is not None:
            self.deltas.release()


class FeedbackSkinning:
    """Skins meshes by transform feedback."""

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, arena: MeshArena) -> None:
        self._ctx, self._shaders, self._arena = ctx, shaders, arena
        self._held: dict[int, _Held] = {}
        self._done: dict[str, tuple[int, int]] = {}
        self._rebuilt = -1
        self._palette = ctx.buffer(reserve=_PALETTE_BYTES)
        # Without a complete framebuffer a driver writes no feedback, and reports no error.
        self._dummy = ctx.framebuffer([ctx.renderbuffer((1, 1))])

    def skin(self, world: World, names: list[str]) -> int:
        """Skin the drawn meshes that changed; see `ProcessorSkinning.skin`."""
        bodies, vertices = world.motion.body_of, 0
        if self._rebuilt != self._arena.rebuilt:
            self._rebuilt, self._done = self._arena.rebuilt, {}
            self._forget({id(mesh) for body in bodies.values() for mesh in body.meshes.values()})
        body_sent: SkinnedBody | None = None
        for name in names:
            body = bodies.get(name)
            if body is None or self._done.get(name) == (id(body), body.revision):
                continue
            if not vertices:
                self._dummy.use()
            self._done[name] = id(body), body.revision
            mesh = body.meshes[name]
            if mesh.weights is None or body.binding is None or int(np.count_nonzero(body.weights)) > _MAX_MORPHS:
                self._bend_on_processor(name, mesh, body)
            else:
                if body is not body_sent:
                    self._send_palette(body)
                    body_sent = body
                self._feed_back(name, mesh, body)
            vertices += len(mesh.positions)
        return vertices

    def release(self) -> None:
        """Free all buffers."""
        self._forget(set())
        self._palette.release()
        self._dummy.release()

    def _bend_on_processor(self, name: str, mesh: MeshData, body: SkinnedBody) -> None:
        """Deform a mesh without joints, or with too many active morph targets."""
        stream = np.zeros((len(mesh.positions), 8), np.float32)
        if mesh.uvs is not None:
            stream[:, 6:] = mesh.uvs
        skin_mesh(make_source(mesh), body, stream)
        self._arena.write_skinned(name, stream)

    def _send_palette(self, body: SkinnedBody) -> None:
        rows = body.duals if body.method == "dual" else body.rows
        self._palette.orphan()
        self._palette.write(np.ascontiguousarray(rows))
        self._palette.bind_to_uniform_block(_BINDING)

    def _feed_back(self, name: str, mesh: MeshData, body: SkinnedBody) -> None:
        held = self._hold(mesh)
        defines = [f"SETS={held.sets}"]
        defines += ["DUAL"] if body.method == "dual" else []
        morphed = held.deltas is not None and body.morphed
        defines += ["MORPHS"] if morphed else []
        shader = self._shaders.feedback("skin/skin.vert", _VARYINGS, tuple(defines))
        if morphed:
            self._set_morphs(shader, held, body.weights)
        first = self._arena.ranges[name].base_vertex
        array = held.arrays.of(shader)
        array.transform(self._arena.vertices, vertices=held.count, buffer_offset=first * _VERTEX_BYTES)

    def _set_morphs(self, shader: ShaderProgram, held: _Held, weights: F4) -> None:
        assert held.deltas is not None
        moved = np.flatnonzero(weights)
        listed = np.zeros((_MAX_MORPHS, 2), np.float32)
        listed[: len(moved), 0], listed[: len(moved), 1] = moved, weights[moved]
        held.deltas.use(_TEXTURE_UNIT)
        shader.set_number("vertices", held.count)
        shader.set_number("moved", len(moved))
        shader.set_array("morphs", listed)

    def _hold(self, mesh: MeshData) -> _Held:
        known = self._held.get(id(mesh))
        if known is None:
            known = self._held[id(mesh)] = _Held(self._ctx, make_source(mesh))
        return known

    def _forget(self, wanted: set[int]) -> None:
        for key in [key for key in self._held if key not in wanted]:
            self._held.pop(key).release()


def _pack(mesh: MeshData, sets: int) -> NDArray[np.void]:
    """Return the vertices in the shader's layout; missing influences have weight 0."""
    assert mesh.weights is not None
    fields: list[tuple[str, str, tuple[int, ...]]] = [
        ("position", "f4", (3,)),
        ("normal", "f4", (3,)),
        ("uv", "f4", (2,)),
    ]
    for number in range(sets):
        fields += [(f"joints{number}", "u2", (4,)), (f"weights{number}", "f4", (4,))]
    packed = np.zeros(len(mesh.positions), np.dtype(fields))
    packed["position"], packed["normal"] = mesh.positions, mesh.normals
    if mesh.uvs is not None:
        packed["uv"] = mesh.uvs
    for k in range(mesh.weights.influences):
        packed[f"joints{k // 4}"][:, k % 4] = mesh.weights.joints[:, k]
        packed[f"weights{k // 4}"][:, k % 4] = mesh.weights.weights[:, k]
    return packed


def _vertex_array(
    ctx: moderngl.Context, buffer: moderngl.Buffer, sets: int, shader: ShaderProgram
) -> moderngl.VertexArray:
    """Return the vertex array of packed vertices."""
    parts = [("3f", "in_position"), ("3f", "in_normal"), ("2f", "in_uv")]
    for number in range(sets):
        parts += [("4u2", f"in_joints{number}"), ("4f", f"in_weights{number}")]
    content = (buffer, " ".join(kind for kind, _ in parts), *(name for _, name in parts))
    return ctx.vertex_array(shader.program, [content], mode=ctx.POINTS)


def _upload_deltas(ctx: moderngl.Context, source: SkinSource) -> moderngl.Texture:
    """Upload the deltas of positions and of normals alternately, target by target, in rows of a texture."""
    both = np.zeros((len(source.position_deltas), 2, len(source.mesh.positions), 4), np.float32)
    both[:, 0, :, :3] = source.position_deltas
    if source.normal_deltas is not None:
        both[:, 1, :, :3] = source.normal_deltas
    flat = both.reshape(-1, 4)
    across = min(_DELTAS_WIDTH, len(flat))
    filled = np.zeros((-(-len(flat) // across) * across, 4), np.float32)
    filled[: len(flat)] = flat
    texture = ctx.texture((across, len(filled) // across), 4, filled.tobytes(), dtype="f4")
    texture.filter = (ctx.NEAREST, ctx.NEAREST)
    return texture
