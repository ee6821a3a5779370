"""Which triangles of a mesh are drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1, U2

if TYPE_CHECKING:
    from mimics_app.rendering.visual.drawing.draw_items import DrawItems
    from mimics_app.rendering.visual.drawing.mesh_arena import MeshRange
    from mimics_app.rendering.visual.drawing.occlusion import Raster
    from mimics_app.rendering.visual.drawing.skinning import SkinnedMeshes
    from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["SeenItems", "TriangleLists"]

_NONE: U2 = np.zeros(0, np.uint16)


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
    items: DrawItems
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

    def __init__(self, meshes: Mapping[str, MeshData], ranges: Mapping[str, MeshRange]) -> None:
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
        self, seen: SeenItems, raster: Raster, samples: int, nearness: F8, bent: SkinnedMeshes | None, parts: I4
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
