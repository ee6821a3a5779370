"""MeshBuffer: vertex and index buffers of a dynamic mesh, updated range by range."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from mimics_app.contracts.arrays import F4, U4
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.vertex_declaration import (
    COLOUR_DECLARATION,
    SECOND_UV_DECLARATION,
    VERTEX_DECLARATION,
    VertexDeclaration,
)

__all__ = ["MeshBuffer", "MeshChange"]


_REMEMBERED = 64
"""Length of the history of changes; a reader that is further behind reads the whole mesh."""

MeshChange = tuple[int, Literal["vertices", "indices"], int, int]
"""Revision of the mesh after the change, buffer, first element, count."""


class MeshBuffer:
    """The vertex and index buffers of one mesh, of constant size.

    Write into the arrays, then name the range that was written: `buffer.positions[4:8] += up; buffer.update(4, 4)`.

    Args:
        mesh: Initial content, copied.
        revision: Revision of the mesh in its world once this replaces it.
        publish: Called with the buffer after every change; returns the mesh's revision then.

    Attributes:
        mesh: The same arrays as a mesh of the world; a new object after every change.
        positions, normals: Object frame [m] and unit, float32 [n, 3].
        uvs: Texture coordinates, float32 [n, 2], or None where the mesh has none.
        colours: Linear RGBA, float32 [n, 4], or None.
        second_uvs: Second texture coordinates, float32 [n, 2], or None.
        indices: Three per triangle, uint32 [m].
    """

    def __init__(self, mesh: MeshData, revision: int, publish: Callable[[MeshBuffer], int]) -> None:
        own = mesh.validated()
        self.positions: F4 = own.positions.copy()
        self.normals: F4 = own.normals.copy()
        self.uvs: F4 | None = None if own.uvs is None else own.uvs.copy()
        self.colours: F4 | None = None if own.colours is None else own.colours.copy()
        self.second_uvs: F4 | None = None if own.second_uvs is None else own.second_uvs.copy()
        self.indices: U4 = own.indices.copy()
        self._publish = publish
        self._changes: deque[MeshChange] = deque(maxlen=_REMEMBERED)
        self.mesh = self._as_mesh()
        self._first = revision

    @property
    def declarations(self) -> tuple[VertexDeclaration, ...]:
        """Layout of the vertex buffers."""
        more = ((self.colours, COLOUR_DECLARATION), (self.second_uvs, SECOND_UV_DECLARATION))
        return (VERTEX_DECLARATION, *(each for array, each in more if array is not None))

    def _as_mesh(self) -> MeshData:
        arrays = (self.positions, self.normals, self.indices, self.uvs, self.colours)
        return MeshData(*arrays, second_uvs=self.second_uvs)

    def update(self, first: int = 0, count: int | None = None) -> None:
        """Publish written vertices; the mesh's bounds are recomputed.

        Args:
            first: First element written.
            count: Number of elements; None: all from `first`.

        Raises:
            ValueError: the range is not inside, or a number in it is not finite.
        """
        end = self._end(first, count, len(self.positions), "vertices")
        for array in (self.positions, self.normals, self.uvs, self.colours, self.second_uvs):
            if array is not None and not np.isfinite(array[first:end]).all():
                raise ValueError(f"vertices {first} to {end - 1}: not all numbers are finite")
        self._note_change("vertices", first, end - first)

    def update_indices(self, first: int = 0, count: int | None = None) -> None:
        """Publish written indices.

        Args:
            first: First element written.
            count: Number of elements; None: all from `first`.

        Raises:
            ValueError: the range is not inside, or an index in it points past the vertices.
        """
        end = self._end(first, count, len(self.indices), "indices")
        largest = int(self.indices[first:end].max(initial=0))
        if largest >= len(self.positions):
            raise ValueError(f"indices: {largest} points past the {len(self.positions)} vertices")
        self._note_change("indices", first, end - first)

    def changes_since(self, revision: int) -> list[MeshChange] | None:
        """Return the changes after a revision of the mesh, oldest first; None beyond the history."""
        known = self._first if len(self._changes) < _REMEMBERED else self._changes[0][0] - 1
        return [change for change in self._changes if change[0] > revision] if revision >= known else None

    def _note_change(self, what: Literal["vertices", "indices"], first: int, count: int) -> None:
        # A new mesh object with the same arrays drops cached bounds and other derived values.
        self.mesh = replace(self.mesh)
        self._changes.append((self._publish(self), what, first, count))

    def _end(self, first: int, count: int | None, size: int, what: str) -> int:
        end = size if count is None else first + count
        if not 0 <= first <= end <= size:
            raise ValueError(f"{what} {first} to {end - 1} are not among the {size} there are")
        return end
