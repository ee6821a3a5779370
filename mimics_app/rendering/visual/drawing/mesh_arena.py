"""All meshes of a world in shared vertex and index buffers, so that any number of them is one draw call."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from operator import is_
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.drawing.solids import Solid, find_solid
from mimics_app.rendering.visual.surfaces.raw_gl import RawGL
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.meshes.mesh_buffer import MeshChange
from mimics_app.world.meshes.vertex_declaration import COLOUR_DECLARATION, VERTEX_DECLARATION
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

__all__ = ["COMMAND_WORDS", "MeshArena", "MeshRange"]

_VERTEX, _COLOUR = VERTEX_DECLARATION.dtype, COLOUR_DECLARATION.dtype
_INSTANCE = np.dtype(
    [("eye_row0", "f4", (4,)), ("eye_row1", "f4", (4,)), ("eye_row2", "f4", (4,)), ("paint", "f4", (4,))]
)

COMMAND_WORDS = 5
"""32-bit words of one indirect draw, as glMultiDrawElementsIndirect reads it: indices, instances, first index, base
vertex, base instance."""

_SHORT_VERTICES = 65_536
"""Vertices that 16-bit indices reach; a mesh of more has 32-bit ones."""


_MOST_SOLIDS = 512
"""Meshes that are looked into; each takes some milliseconds."""


@dataclass(frozen=True, slots=True)
class MeshRange:
    """Where one mesh lies in the arena.

    Attributes:
        first: Its first index, in the buffer of its width.
        count: Number of indices.
        base_vertex: Number of its first vertex.
        vertices: Number of vertices.
        wide: True where its indices have 32 bits.
        coloured: True where its vertices have colours.
    """

    first: int
    count: int
    base_vertex: int
    vertices: int
    wide: bool
    coloured: bool


class MeshArena:
    """Uploads meshes as the world changes them, and makes the vertex arrays that read them.

    Attributes:
        ranges: Where each mesh of the world lies.
        solids: Meshes that have a box inside.
        rewritten: Meshes whose numbers changed in the last update, their places in the buffers staying.
        uploaded: Bytes of vertices and indices sent in the last update.
        rebuilt: How often all of it was made anew, so that what others wrote is lost.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self.ranges: dict[str, MeshRange] = {}
        self.solids: dict[str, Solid] = {}
        self.rewritten: list[str] = []
        self.uploaded = 0
        self.rebuilt = 0
        self._solid = False
        self._seen: dict[str, tuple[int, int]] = {}
        self._held: tuple[int, list[str], list[MeshData]] = (0, [], [])
        self._vertices = ctx.buffer(reserve=_VERTEX.itemsize)
        self._colours = ctx.buffer(reserve=_COLOUR.itemsize)
        self._indices = {wide: ctx.buffer(reserve=4) for wide in (False, True)}
        self._instances = ctx.buffer(reserve=_INSTANCE.itemsize)
        self._raw: RawGL | None = None
        self._arrays: dict[tuple[ShaderProgram, bool, int], tuple[int, moderngl.VertexArray]] = {}

    def update(self, world: World, *, solid: bool = False) -> bool:
        """Bring the buffers up to the world's meshes.

        Args:
            world: Whose meshes.
            solid: Look for boxes inside the meshes, and seal the cracks of those that have one.

        Returns:
            True when meshes lie elsewhere now; not for those only `rewritten`.
        """
        self.rewritten, self.uploaded = [], 0
        if solid != self._solid:
            self._solid, self._seen = solid, {}
        elif self._stands(world):
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

    def _stands(self, world: World) -> bool:
        """Whether every mesh is the very one of the last update: asked each frame, so nothing is made for it."""
        published, names, meshes = self._held
        if published != world.meshes_published or len(meshes) != len(world.meshes):
            return False
        return all(map(is_, meshes, world.meshes.values())) and names == list(world.meshes)

    def write_instances(self, rows: NDArray[np.float32]) -> None:
        """Upload the instances of a frame, float32 [n, 4, 4], contiguous."""
        if rows.nbytes > self._instances.size:
            self._drop_arrays()
            self._instances.release()
            self._instances = self._ctx.buffer(reserve=2 * rows.nbytes)
        if rows.nbytes:
            self._instances.orphan()
            self._instances.write(rows)

    def write_bent(self, name: str, packed: NDArray[np.float32]) -> None:
        """Put the vertices of a mesh as they are bent in this frame, float32 [n, 8], where its own lie."""
        self._vertices.write(packed, offset=self.ranges[name].base_vertex * _VERTEX.itemsize)
        self.uploaded += packed.nbytes

    @property
    def vertices(self) -> moderngl.Buffer:
        """The buffer all vertices lie in; another one after meshes came or went."""
        return self._vertices

    def vertex_array(self, shader: ShaderProgram, *, wide: bool = False, eyes: int = 1) -> moderngl.VertexArray:
        """The arena as a program reads it; made again when the program was reloaded.

        Args:
            shader: Which program.
            wide: True for indices of 32 bits, else 16.
            eyes: How many instances that follow each other read the same numbers.
        """
        known = self._arrays.get((shader, wide, eyes))
        if known and known[0] == shader.revision:
            return known[1]
        program = shader.program
        content = [
            _describe(self._vertices, _VERTEX, program, ""),
            _describe(self._instances, _INSTANCE, program, "/i"),
        ]
        if "in_colour" in program:
            content.append(_describe(self._colours, _COLOUR, program, ""))
        size = 4 if wide else 2
        array = self._ctx.vertex_array(program, content, self._indices[wide], index_element_size=size)
        if eyes > 1:
            self._share_instances(array, program, eyes)
        self._arrays[shader, wide, eyes] = (shader.revision, array)
        return array

    def _share_instances(self, array: moderngl.VertexArray, program: moderngl.Program, eyes: int) -> None:
        """Have so many instances that follow each other read the same numbers."""
        if self._raw is None:
            self._raw = RawGL(self._ctx)
        self._raw.set_divisor(array.glo, _locations(program, _INSTANCE), eyes)

    def release(self) -> None:
        """Free all buffers."""
        self._drop_arrays()
        for buffer in (self._vertices, self._colours, *self._indices.values(), self._instances):
            buffer.release()

    def _fits(self, name: str, mesh: MeshData) -> bool:
        known = self.ranges[name]
        if name in self.solids:
            return False
        same = known.count == mesh.indices.size and known.vertices == len(mesh.positions)
        return same and known.coloured == (mesh.colours is not None)

    def _rewrite(self, name: str, world: World) -> None:
        """Send what changed of a mesh: the ranges that were named, or all of it."""
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
            coloured = mesh.colours is not None
            self.ranges[name] = MeshRange(first[wide], count, base_vertex, len(mesh.positions), wide, coloured)
            first[wide], base_vertex = first[wide] + count, base_vertex + len(mesh.positions)
        self._drop_arrays()
        self._vertices = self._upload(self._vertices, [_pack(mesh) for mesh in meshes.values()], _VERTEX.itemsize)
        self._colours = self._upload(self._colours, self._all_colours(meshes), _COLOUR.itemsize)
        for wide in (False, True):
            parts = [_indices(mesh) for name, mesh in meshes.items() if self.ranges[name].wide == wide]
            self._indices[wide] = self._upload(self._indices[wide], parts, 4)

    def _all_colours(self, meshes: dict[str, MeshData]) -> Iterable[NDArray[np.float32]]:
        """One colour for every vertex of the arena, or none where no mesh has any."""
        if not any(known.coloured for known in self.ranges.values()):
            return []
        return [
            np.ones((len(mesh.positions), 4), np.float32)
            if mesh.colours is None
            else np.ascontiguousarray(mesh.colours, np.float32)
            for mesh in meshes.values()
        ]

    def _upload(self, old: moderngl.Buffer, parts: Iterable[NDArray[np.generic]], least: int) -> moderngl.Buffer:
        old.release()
        data = b"".join(part.tobytes() for part in parts)
        self.uploaded += len(data)
        return self._ctx.buffer(data or bytes(least))

    def _drop_arrays(self) -> None:
        for _, array in self._arrays.values():
            array.release()
        self._arrays.clear()


def _find_solids(world: World) -> dict[str, Solid]:
    """Boxes inside those of the world's meshes that are not changed all the time, of the largest first."""
    bending = world.motion.body_of
    still = [
        name
        for name in world.meshes
        if world.mesh_revision(name) <= 1 and world.opened_mesh(name) is None and name not in bending
    ]
    largest = sorted(still, key=lambda name: -world.meshes[name].radius)[:_MOST_SOLIDS]
    found = {name: find_solid(world.meshes[name]) for name in largest}
    return {name: solid for name, solid in found.items() if solid is not None}


def _indices(mesh: MeshData) -> NDArray[np.unsignedinteger]:
    return mesh.indices.astype(np.uint32 if len(mesh.positions) > _SHORT_VERTICES else np.uint16)


def _pack(mesh: MeshData, first: int = 0, count: int | None = None) -> NDArray[np.void]:
    """Vertices as they lie in the buffer; what a mesh does not have is zero."""
    end = len(mesh.positions) if count is None else first + count
    packed = np.zeros(end - first, _VERTEX)
    for element in VERTEX_DECLARATION.elements:
        values = getattr(mesh, element.name)
        if values is not None:
            packed[element.attribute] = values[first:end]
    return packed


def _locations(program: moderngl.Program, layout: np.dtype[np.void]) -> list[int]:
    """Where a program reads the elements of a layout that it reads at all."""
    import moderngl

    read = (program[name] for name in layout.names or () if name in program)
    return [each.location for each in read if isinstance(each, moderngl.Attribute)]


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
