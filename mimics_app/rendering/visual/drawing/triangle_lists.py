"""Which triangles of a mesh are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4, U1, U2

if TYPE_CHECKING:
    from mimics_app.world.content.meshes.mesh import MeshData
    from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["ListedItems", "MeshPlace", "Projection", "SeenItems", "SkinnedVertices", "TriangleLists"]

_NONE: U2 = np.zeros(0, np.uint16)


class MeshPlace(Protocol):
    """Location of a mesh in the buffers (`MeshRange`)."""

    @property
    def first(self) -> int:
        """Its first index."""
        ...

    @property
    def count(self) -> int:
        """Number of its indices."""
        ...

    @property
    def base_vertex(self) -> int:
        """Number of its first vertex."""
        ...

    @property
    def vertices(self) -> int:
        """Number of its vertices."""
        ...

    @property
    def wide(self) -> bool:
        """True where its indices have 32 bits."""
        ...


class Projection(Protocol):
    """Projection of a view (`Raster`)."""

    @property
    def eye(self) -> F8:
        """Position of the camera, world [m], [3]."""
        ...

    @property
    def near(self) -> float:
        """Distance of the near plane [m]."""
        ...

    @property
    def screen(self) -> F8:
        """Matrix from world vectors to X w, Y w, w, [3, 3]."""
        ...

    @property
    def block(self) -> int:
        """Width of a block of the depth buffer [px]."""
        ...

    @property
    def step(self) -> float:
        """Difference of 1/w that the depth buffer resolves [1/m]."""
        ...

    @property
    def size(self) -> tuple[int, int]:
        """Size of the picture [px]."""
        ...

    @property
    def focal(self) -> float:
        """Smaller number of pixels per unit of a slope."""
        ...


class SkinnedVertices(Protocol):
    """Meshes that are skinned on the processor."""

    def of(self, body: SkinnedBody, name: str) -> F4:
        """Return the vertices of a body's mesh, skinned as the body is now, float32 [n, 8]."""
        ...


class ListedItems(Protocol):
    """Draw items (`DrawItems`), which says what each is."""

    @property
    def rows(self) -> I4:
        """Row of each item's node, [n]."""
        ...

    @property
    def meshes(self) -> I4:
        """Number of the mesh of each item, [n]."""
        ...

    @property
    def ranges(self) -> I4:
        """First index, count and base vertex per mesh, [meshes, 3]."""
        ...

    @property
    def listed(self) -> I4:
        """Line of each mesh, see `TriangleLists.line`, [meshes, 2]."""
        ...

    @property
    def one_sided(self) -> U1:
        """1 where only front faces are drawn, [n]."""
        ...

    @property
    def bodies(self) -> Mapping[int, SkinnedBody]:
        """Skinned bodies by number of their mesh."""
        ...

    @property
    def mesh_names(self) -> Sequence[str]:
        """Key of each mesh."""
        ...


@dataclass(frozen=True, eq=False)
class SeenItems:
    """Items that a view may show.

    Attributes:
        picked: Their numbers, [k].
        items: All draw items.
        world: T_world_from_node per row, [rows, 4, 4].
        centres: Centres of all items' spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        mirrored: 1 where the winding of an item's faces is reversed, [n].
    """

    picked: I4
    items: ListedItems
    world: F8
    centres: F8
    radii: F8
    mirrored: U1


class TriangleLists:
    """Lists of indices for the triangles that a picture shows; a graphics card draws all triangles without any.

    Attributes:
        first: Index at which the lists begin in the buffer of 16-bit indices, after those of the meshes.
        room: Number of indices that they take at most.

    Args:
        meshes: All meshes of the arena, in order.
        ranges: Location of each.
    """

    first = room = 0

    def __init__(self, meshes: Mapping[str, MeshData], ranges: Mapping[str, MeshPlace]) -> None:
        """Keep nothing."""

    def begin(self) -> None:
        """Discard the lists of the last frame."""

    @property
    def indices(self) -> U2:
        """The lists of this frame."""
        return _NONE

    def line(self, name: str, *, bent: bool) -> tuple[int, int]:
        """Return the line of a mesh in `DrawItems.listed`.

        Args:
            name: Its key.
            bent: Whether it is skinned.

        Returns:
            Its number of vertices, 0 where it is always drawn as a whole, and a number for the lists' own use.
        """
        return 0, 0

    def pick(
        self, seen: SeenItems, raster: Projection, samples: int, nearness: F8, bent: SkinnedVertices | None, parts: I4
    ) -> bool:
        """List the triangles of some items that a view may show.

        Args:
            seen: The items.
            raster: Projection of the view.
            samples: Samples per pixel.
            nearness: 1/w of its nearest occluder per block [1/m], [rows, columns].
            bent: The skinned meshes; None where they are not skinned on the processor.
            parts: Written: first index and number of indices of each item's triangles, -1 for all of them; [n, 2].

        Returns:
            Whether `parts` was written.
        """
        return False
