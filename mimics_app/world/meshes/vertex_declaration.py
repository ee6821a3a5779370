"""What one vertex consists of, as it lies in a vertex buffer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["COLOUR_DECLARATION", "VERTEX_DECLARATION", "VertexDeclaration", "VertexElement", "declare"]


@dataclass(frozen=True, slots=True)
class VertexElement:
    """One attribute of a vertex.

    Attributes:
        name: Of the array in `MeshData` and `MeshBuffer`: "positions", "normals", "uvs", "colours".
        attribute: As shaders call it.
        format: Of one component, as numpy writes it: "f4".
        components: How many.
        offset: From the beginning of the vertex [bytes].
    """

    name: str
    attribute: str
    format: str
    components: int
    offset: int


@dataclass(frozen=True, slots=True)
class VertexDeclaration:
    """The attributes of a vertex in one buffer, in order, without holes.

    Attributes:
        elements: In the order they lie in.
        stride: From one vertex to the next [bytes].
    """

    elements: tuple[VertexElement, ...]
    stride: int

    @property
    def dtype(self) -> np.dtype[np.void]:
        """One vertex as a numpy record, its fields named as shaders call them."""
        return np.dtype([(each.attribute, each.format, (each.components,)) for each in self.elements])


def declare(*elements: tuple[str, str, int]) -> VertexDeclaration:
    """A declaration out of (name, attribute, components), all of them float32."""
    offset, declared = 0, []
    for name, attribute, components in elements:
        declared.append(VertexElement(name, attribute, "f4", components, offset))
        offset += 4 * components
    return VertexDeclaration(tuple(declared), offset)


VERTEX_DECLARATION = declare(("positions", "in_position", 3), ("normals", "in_normal", 3), ("uvs", "in_uv", 2))
"""What every mesh has."""

COLOUR_DECLARATION = declare(("colours", "in_colour", 4))
"""A buffer of its own beside it, where a mesh of the world has colours."""
