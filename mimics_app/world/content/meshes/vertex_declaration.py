"""Vertex declarations: layout of vertex buffers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["COLOUR_DECLARATION", "SECOND_UV_DECLARATION", "VERTEX_DECLARATION", "VertexDeclaration", "VertexElement"]


@dataclass(frozen=True, slots=True)
class VertexElement:
    """One attribute of a vertex.

    Attributes:
        name: Array of `MeshData` and `MeshBuffer`: "positions", "normals", "uvs", "colours" or "second_uvs".
        attribute: Name in shaders.
        format: Type of one component in numpy's notation: "f4".
        components: Number of components.
        offset: Offset in the vertex [bytes].
    """

    name: str
    attribute: str
    format: str
    components: int
    offset: int


@dataclass(frozen=True, slots=True)
class VertexDeclaration:
    """Attributes of a vertex in one buffer, tightly packed.

    Attributes:
        elements: Attributes in memory order.
        stride: Distance of successive vertices [bytes].
    """

    elements: tuple[VertexElement, ...]
    stride: int

    @property
    def dtype(self) -> np.dtype[np.void]:
        """One vertex as a numpy record, with the names of the shaders."""
        return np.dtype([(each.attribute, each.format, (each.components,)) for each in self.elements])


def _declare(*elements: tuple[str, str, int]) -> VertexDeclaration:
    """Create a declaration from (name, attribute, components), all of them float32."""
    offset, declared = 0, []
    for name, attribute, components in elements:
        declared.append(VertexElement(name, attribute, "f4", components, offset))
        offset += 4 * components
    return VertexDeclaration(tuple(declared), offset)


VERTEX_DECLARATION = _declare(("positions", "in_position", 3), ("normals", "in_normal", 3), ("uvs", "in_uv", 2))
"""Layout of the main vertex buffer of every mesh."""

COLOUR_DECLARATION = _declare(("colours", "in_colour", 4))
"""Layout of the second vertex buffer of a mesh with colours."""

SECOND_UV_DECLARATION = _declare(("second_uvs", "in_second_uv", 2))
"""Layout of a further vertex buffer of a mesh with second texture coordinates."""
