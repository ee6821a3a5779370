"""All meshes of a world in one vertex buffer and one index buffer, so that any number of them is one draw call."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.mesh import MeshData
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.shader_library import ShaderProgram

__all__ = ["COMMAND", "INSTANCE_FLOATS", "MeshArena", "MeshRange"]

_VERTEX = np.dtype(
    [("in_position", "f4", (3,)), ("in_normal", "f4", (3,)), ("in_uv", "f4", (2,)), ("in_colour", "f4", (4,))]
)
_INSTANCE = np.dtype([("eye_row0", "f4", (4,)), ("eye_row1", "f4", (4,)), ("eye_row2", "f4", (4,))])

INSTANCE_FLOATS = 12
"""Floats of one instance: the three rows of eye_from_object."""

COMMAND = np.dtype([("count", "u4"), ("instances", "u4"), ("first", "u4"), ("base_vertex", "i4"), ("base", "u4")])
"""One indirect draw, as glMultiDrawElementsIndirect reads it."""


@dataclass(frozen=True, slots=True)
class MeshRange:
    """Where one mesh lies in the arena: first index, number of indices, number of its first vertex."""

    first: int
    count: int
    base_vertex: int
    vertices: int


class MeshArena:
    """Uploads meshes as the world changes them, and makes the vertex arrays that read them.

    Attributes:
        ranges: Where each mesh of the world lies.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self.ranges: dict[str, MeshRange] = {}
        self._seen: dict[str, tuple[int, int]] = {}
        self._vertices = ctx.buffer(reserve=_VERTEX.itemsize)
        self._indices = ctx.buffer(reserve=4)
        self._instances = ctx.buffer(reserve=_INSTANCE.itemsize)
        self._arrays: dict[ShaderProgram, tuple[int, moderngl.VertexArray]] = {}

    def update(self, world: World) -> bool:
        """Bring the buffers up to the world's meshes.

        Returns:
            True when a mesh came, went or changed.
        """
        wanted = {name: (world.mesh_revision(name), id(mesh)) for name, mesh in world.meshes.items()}
        if wanted == self._seen:
            return False
        changed = [name for name, revision in wanted.items() if self._seen.get(name) != revision]
        if wanted.keys() == self._seen.keys() and all(self._fits(name, world.meshes[name]) for name in changed):
            for name in changed:
                self._overwrite(name, world.meshes[name])
        else:
            self._rebuild(world.meshes)
        self._seen = wanted
        return True

    def write_instances(self, rows: NDArray[np.float32]) -> None:
        """Upload the instances of a frame, float32 [n, 3, 4]."""
        data = np.ascontiguousarray(rows, np.float32)
        if data.nbytes > self._instances.size:
            self._drop_arrays()
            self._instances.release()
            self._instances = self._ctx.buffer(reserve=2 * data.nbytes)
        if data.nbytes:
            self._instances.orphan()
            self._instances.write(data)

    def vertex_array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        """The arena as a program reads it; made again when the program was reloaded."""
        known = self._arrays.get(shader)
        if known and known[0] == shader.revision:
            return known[1]
        content = [
            _describe(self._vertices, _VERTEX, shader.program, ""),
            _describe(self._instances, _INSTANCE, shader.program, "/i"),
        ]
        array = self._ctx.vertex_array(shader.program, content, self._indices, index_element_size=4)
        self._arrays[shader] = (shader.revision, array)
        return array

    def release(self) -> None:
        """Free all buffers."""
        self._drop_arrays()
        for buffer in (self._vertices, self._indices, self._instances):
            buffer.release()

    def _fits(self, name: str, mesh: MeshData) -> bool:
        known = self.ranges[name]
        return known.count == mesh.indices.size and known.vertices == len(mesh.positions)

    def _overwrite(self, name: str, mesh: MeshData) -> None:
        known = self.ranges[name]
        self._vertices.write(_pack(mesh), offset=known.base_vertex * _VERTEX.itemsize)
        self._indices.write(np.ascontiguousarray(mesh.indices, np.uint32), offset=4 * known.first)

    def _rebuild(self, meshes: dict[str, MeshData]) -> None:
        self.ranges, first, base_vertex = {}, 0, 0
        for name, mesh in meshes.items():
            self.ranges[name] = MeshRange(first, mesh.indices.size, base_vertex, len(mesh.positions))
            first, base_vertex = first + mesh.indices.size, base_vertex + len(mesh.positions)
        self._drop_arrays()
        self._vertices.release()
        self._indices.release()
        packed = [_pack(mesh) for mesh in meshes.values()] or [np.zeros(1, _VERTEX)]
        indices = [np.asarray(mesh.indices, np.uint32) for mesh in meshes.values()]
        self._vertices = self._ctx.buffer(np.concatenate(packed).tobytes() or bytes(_VERTEX.itemsize))
        self._indices = self._ctx.buffer((np.concatenate(indices).tobytes() if indices else b"") or bytes(4))

    def _drop_arrays(self) -> None:
        for _, array in self._arrays.values():
            array.release()
        self._arrays.clear()


def _pack(mesh: MeshData) -> NDArray[np.void]:
    packed = np.zeros(len(mesh.positions), _VERTEX)
    packed["in_position"], packed["in_normal"], packed["in_colour"] = mesh.positions, mesh.normals, 1.0
    if mesh.uvs is not None:
        packed["in_uv"] = mesh.uvs
    if mesh.colours is not None:
        packed["in_colour"] = mesh.colours
    return packed


def _describe(
    buffer: moderngl.Buffer, layout: np.dtype[np.void], program: moderngl.Program, divisor: str
) -> tuple[object, ...]:
    """A buffer's layout in moderngl's words; what the compiler found unused is skipped over."""
    parts, names = [], []
    for name in layout.names or ():
        width = layout[name].shape[0]
        if name in program:
            parts.append(f"{width}f")
            names.append(name)
        else:
            parts.append(f"{4 * width}x")
    return (buffer, " ".join(parts) + divisor, *names)
