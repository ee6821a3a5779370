"""All meshes of a world in shared vertex and index buffers, so that one draw call draws any number of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from operator import is_
from typing import TYPE_CHECKING
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.visual.drawing.occluder_boxes import Solid, find_solid
from mimics_app.rendering.visual.drawing.triangle_lists import TriangleLists
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.surfaces.raw_gl import RawGL
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.mesh_buffer import MeshChange
from mimics_app.world.content.meshes.vertex_declaration import (
    COLOUR_DECLARATION,
    SECOND_UV_DECLARATION,
    VERTEX_DECLARATION,
)
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

__all__ = ["COMMAND_WORDS", "MeshArena", "MeshRange", "is_rewritten"]

_VERTEX, _COLOUR = VERTEX_DECLARATION.dtype, COLOUR_DECLARATION.dtype
_SECOND_UV = SECOND_UV_DECLARATION.dtype
_INSTANCE = np.dtype(
    [("eye_row0", "f4", (4,)), ("eye_row1", "f4", (4,)), ("eye_row2", "f4", (4,)), ("instance_params", "f4", (4,))]
)

COMMAND_WORDS = 5
"""32-bit words of a command of glMultiDrawElementsIndirect: indices, instances, first index, base vertex, base
instance."""

_SHORT_VERTICES = 65_536
"""Maximum number of vertices with 16-bit indices; a larger mesh has 32-bit ones."""


_MAX_SOLIDS = 512
"""Maximum number of meshes that are searched for occluder boxes; each takes some milliseconds."""


@dataclass(frozen=True, slots=True)
class MeshRange:
    """Location of one mesh in the arena.

    Attributes:
        first: Its first index, in the buffer of its index width.
        count: Number of indices.
        base_vertex: Number of its first vertex.
        vertices: Number of vertices.
        wide: True where its indices have 32 bits.
        coloured: True where its vertices have colours.
        twice: True where they have second texture coordinates.
    """

    first: int
    count: int
    base_vertex: int
    vertices: int
    wide: bool
    coloured: bool
    twice: bool


class MeshArena:
    """Uploads meshes as the world changes them, and makes the vertex arrays that read them.

    Attributes:
        ranges: Location of each mesh of the world.
        solids: Meshes with an occluder box inside.
        lists: Lists of the triangles that pictures show.
        rewritten: Meshes whose vertices or indices were rewritten in place in the last update.
        uploaded: Bytes of vertices and indices uploaded in the last update.
        rebuilt: Number of times the buffers were rebuilt; skinned vertices are lost each time.
        arrays: Vertex arrays by program, by whether indices have 32 bits instead of 16, and by the number of successive
            instances, one per eye, that share the same instance attributes.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._lists = rasteriser_of(ctx).member(TriangleLists)
        self.lists = self._lists({}, {})
        self.ranges: dict[str, MeshRange] = {}
        self.solids: dict[str, Solid] = {}
        self.rewritten: list[str] = []
        self.uploaded = 0
        self.rebuilt = 0
        self._solid = False
        self._of: Callable[[], World | None] = lambda: None
        self._seen: dict[str, tuple[int, int]] = {}
        self._held: tuple[int, list[str], list[MeshData]] = (0, [], [])
        self._vertices = ctx.buffer(reserve=_VERTEX.itemsize)
        self._colours = ctx.buffer(reserve=_COLOUR.itemsize)
        self._second_uvs = ctx.buffer(reserve=_SECOND_UV.itemsize)
        self._indices = {wide: ctx.buffer(reserve=4) for wide in (False, True)}
        self._instances = ctx.buffer(reserve=_INSTANCE.itemsize)
        self._raw: RawGL | None = None
        self.arrays = VertexArrays(self._vertex_array)

    def update(self, world: World, *, solid: bool = False) -> bool:
        """Upload the world's meshes where they changed.

        Args:
            world: The world.
            solid: True searches the meshes for occluder boxes, and removes the T-junctions of those that have one.

        Returns:
            True when the buffers were rebuilt; False where meshes were only `rewritten`.
        """
        self.rewritten, self.uploaded = [], 0
        if solid != self._solid or self._of() is not world:
            # The revisions and ranges of another world say nothing of the meshes that are here.
            self._solid, self._of, self._seen = solid, ref(world), {}
        elif self._is_unchanged(world):
            return False
        self._held = world.meshes_published, list(world.meshes), list(world.meshes.values())
        wanted = {name: (world.mesh_revision(name), id(mesh)) for name, mesh in world.meshes.items()}
        if wanted == self._seen:
            return False
        changed = [name for name, revision in wanted.items() if self._seen.get(name) != revision]
        fits = wanted.keys() == self._seen.keys() and all(self._fits(name, world.meshes[name]) for name in changed)
        if fits:
            for name in changed:
                self._rewrite(name, world)
            self.rewritten = changed
        else:
            self.solids = _find_solids(world) if solid else {}
            found = self.solids
            self._rebuild({name: found[name].mesh if name in found else mesh for name, mesh in world.meshes.items()})
        self._seen = wanted
        return not fits

    def _is_unchanged(self, world: World) -> bool:
        """Whether every mesh is the same object as in the last update; called every frame, so it must be cheap."""
        published, names, meshes = self._held
        if published != world.meshes_published or len(meshes) != len(world.meshes):
            return False
        return all(map(is_, meshes, world.meshes.values())) and names == list(world.meshes)

    def write_instances(self, rows: F4, first: int) -> None:
        """Upload the instances of a frame from the first one on that was not uploaded yet.

        Args:
            rows: All instances, float32 [n, 4, 4], contiguous.
            first: Number of the first new one.
        """
        if rows.nbytes > self._instances.size:
            self.arrays.release()
            self._instances.release()
            self._instances, first = self._ctx.buffer(reserve=2 * rows.nbytes), 0
        if first == 0:
            self._instances.orphan()
        self._instances.write(rows[first:], offset=first * _INSTANCE.itemsize)

    def write_lists(self) -> None:
        """Upload the triangles listed for a frame."""
        listed = self.lists.indices
        if len(listed):
            self._indices[False].write(listed, offset=listed.itemsize * self.lists.first)

    def write_skinned(self, name: str, packed: F4) -> None:
        """Overwrite the vertices of a mesh with its skinned ones, float32 [n, 8]."""
        self._vertices.write(packed, offset=self.ranges[name].base_vertex * _VERTEX.itemsize)
        self.uploaded += packed.nbytes

    @property
    def vertices(self) -> moderngl.Buffer:
        """The vertex buffer; another one after a rebuild."""
        return self._vertices

    def _vertex_array(self, shader: ShaderProgram, wide: bool, eyes: int) -> moderngl.VertexArray:
        program = shader.program
        content = [
            _describe(self._vertices, _VERTEX, program, ""),
            _describe(self._instances, _INSTANCE, program, "/i"),
        ]
        if "in_colour" in program:
            content.append(_describe(self._colours, _COLOUR, program, ""))
        if "in_second_uv" in program:
            content.append(_describe(self._second_uvs, _SECOND_UV, program, ""))
        size = 4 if wide else 2
        array = self._ctx.vertex_array(program, content, self._indices[wide], index_element_size=size)
        if eyes > 1:
            self._share_instances(array, program, eyes)
        return array

    def _share_instances(self, array: moderngl.VertexArray, program: moderngl.Program, eyes: int) -> None:
        """Let successive instances, one per eye, read the same instance attributes."""
        if self._raw is None:
            self._raw = RawGL(self._ctx)
        self._raw.set_divisor(array.glo, _locations(program, _INSTANCE), eyes)

    def release(self) -> None:
        """Free all buffers."""
        self.arrays.release()
        for buffer in (self._vertices, self._colours, self._second_uvs, *self._indices.values(), self._instances):
            buffer.release()

    def _fits(self, name: str, mesh: MeshData) -> bool:
        known = self.ranges[name]
        if name in self.solids:
            return False
        same = known.count == mesh.indices.size and known.vertices == len(mesh.positions)
        kinds = (mesh.colours is not None, mesh.second_uvs is not None)
        return same and (known.coloured, known.twice) == kinds

    def _rewrite(self, name: str, world: World) -> None:
        """Upload the changed ranges of a mesh, or all of it where they are unknown."""
        mesh, buffer = world.meshes[name], world.opened_mesh(name)
        whole: list[MeshChange] = [(0, "vertices", 0, len(mesh.positions)), (0, "indices", 0, mesh.indices.size)]
        changes = None if buffer is None else buffer.changes_since(self._seen[name][0])
        for _, what, first, count in whole if changes is None else changes:
            if what == "vertices":
                self._write_vertices(name, mesh, first, count)
            else:
                self._write_indices(name, mesh, first, count)

    def _write_vertices(self, name: str, mesh: MeshData, first: int, count: int) -> None:
        at = self.ranges[name].base_vertex + first
        packed = _pack(mesh, first, count)
        self._vertices.write(packed, offset=at * _VERTEX.itemsize)
        self.uploaded += packed.nbytes
        if mesh.colours is not None:
            colours = np.ascontiguousarray(mesh.colours[first : first + count], np.float32)
            self._colours.write(colours, offset=at * _COLOUR.itemsize)
            self.uploaded += colours.nbytes
        if mesh.second_uvs is not None:
            second = np.ascontiguousarray(mesh.second_uvs[first : first + count], np.float32)
            self._second_uvs.write(second, offset=at * _SECOND_UV.itemsize)
            self.uploaded += second.nbytes

    def _write_indices(self, name: str, mesh: MeshData, first: int, count: int) -> None:
        known = self.ranges[name]
        indices = _indices(mesh)[first : first + count]
        self._indices[known.wide].write(indices, offset=indices.itemsize * (known.first + first))
        self.uploaded += indices.nbytes

    def _rebuild(self, meshes: dict[str, MeshData]) -> None:
        self.ranges, base_vertex = {}, 0
        self.rebuilt += 1
        first = {False: 0, True: 0}
        for name, mesh in meshes.items():
            wide, count = len(mesh.positions) > _SHORT_VERTICES, mesh.indices.size
            kinds = (mesh.colours is not None, mesh.second_uvs is not None)
            self.ranges[name] = MeshRange(first[wide], count, base_vertex, len(mesh.positions), wide, *kinds)
            first[wide], base_vertex = first[wide] + count, base_vertex + len(mesh.positions)
        self.arrays.release()
        self.lists = self._lists(meshes, self.ranges)
        self._vertices = self._upload(self._vertices, [_pack(mesh) for mesh in meshes.values()], _VERTEX.itemsize)
        self._colours = self._upload(self._colours, self._all_colours(meshes), _COLOUR.itemsize)
        second = self._all_second_uvs(meshes)
        self._second_uvs = self._upload(self._second_uvs, second, base_vertex * _SECOND_UV.itemsize)
        for wide in (False, True):
            parts = [_indices(mesh) for name, mesh in meshes.items() if self.ranges[name].wide == wide]
            spare = [np.zeros(self.lists.room, np.uint16)] if not wide else []
            self._indices[wide] = self._upload(self._indices[wide], [*parts, *spare], 4)

    def _all_colours(self, meshes: dict[str, MeshData]) -> Iterable[F4]:
        """Return a colour for every vertex of the arena; empty where no mesh has colours."""
        if not any(known.coloured for known in self.ranges.values()):
            return []
        return [
            np.ones((len(mesh.positions), 4), np.float32)
            if mesh.colours is None
            else np.ascontiguousarray(mesh.colours, np.float32)
            for mesh in meshes.values()
        ]

    def _all_second_uvs(self, meshes: dict[str, MeshData]) -> Iterable[F4]:
        """Return second texture coordinates for every vertex of the arena; empty where no mesh has any."""
        if not any(known.twice for known in self.ranges.values()):
            return []
        return [
            np.zeros((len(mesh.positions), 2), np.float32)
            if mesh.second_uvs is None
            else np.ascontiguousarray(mesh.second_uvs, np.float32)
            for mesh in meshes.values()
        ]

    def _upload(self, old: moderngl.Buffer, parts: Iterable[NDArray[np.generic]], min_bytes: int) -> moderngl.Buffer:
        old.release()
        data = b"".join(part.tobytes() for part in parts)
        self.uploaded += len(data)
        return self._ctx.buffer(data or bytes(min_bytes))


def is_rewritten(world: World, name: str) -> bool:
    """Whether the vertices and indices of a mesh may be others than it came with."""
    return world.mesh_revision(name) > 1 or world.opened_mesh(name) is not None


def _find_solids(world: World) -> dict[str, Solid]:
    """Return the occluder boxes inside the world's static meshes, the largest meshes first."""
    bodies = world.motion.body_of
    still = [name for name in world.meshes if name not in bodies and not is_rewritten(world, name)]
    largest = sorted(still, key=lambda name: -world.meshes[name].radius)[:_MAX_SOLIDS]
    found = {name: find_solid(world.meshes[name]) for name in largest}
    return {name: solid for name, solid in found.items() if solid is not None}


def _indices(mesh: MeshData) -> NDArray[np.unsignedinteger]:
    return mesh.indices.astype(np.uint32 if len(mesh.positions) > _SHORT_VERTICES else np.uint16)


def _pack(mesh: MeshData, first: int = 0, count: int | None = None) -> NDArray[np.void]:
    """Return vertices in the buffer's layout; missing attributes are zero."""
    end = len(mesh.positions) if count is None else first + count
    packed = np.zeros(end - first, _VERTEX)
    for element in VERTEX_DECLARATION.elements:
        values = getattr(mesh, element.name)
        if values is not None:
            packed[element.attribute] = values[first:end]
    return packed


def _locations(program: moderngl.Program, layout: np.dtype[np.void]) -> list[int]:
    """Return the attribute locations of the elements of a layout that a program reads."""
    import moderngl

    read = (program[name] for name in layout.names or () if name in program)
    return [each.location for each in read if isinstance(each, moderngl.Attribute)]


def _describe(
    buffer: moderngl.Buffer, layout: np.dtype[np.void], program: moderngl.Program, divisor: str
) -> tuple[object, ...]:
    """Return a buffer's layout in moderngl's notation; attributes that the program does not read are padding."""
    parts, names = [], []
    for name in layout.names or ():
        width = layout[name].shape[0]
        if name in program:
            parts.append(f"{width}f")
            names.append(name)
        else:
            parts.append(f"{4 * width}x")
    return (buffer, " ".join(parts) + divisor, *names)
