"""Occlusion culling of a view, conservative: not one pixel of the picture changes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.kernels.occluders import (
    ItemPlaces,
    Occluders,
    OccluderView,
    draw_occluders,
    pick_occluders,
)
from mimics_app.rendering.visual.kernels.occlusion import MARGIN_PX, CoarseDepth, ItemBoxes, remove_hidden
from mimics_app.rendering.visual.settings import Occlusion
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World

__all__ = ["MIN_ITEMS", "NO_OCCLUDER", "Occluders", "OcclusionPass", "Raster", "gather_occluders", "make_raster"]


MIN_ITEMS = 64
"""Number of sub-entities from which occlusion culling pays off."""

NO_OCCLUDER: F8 = np.zeros((0, 0))
"""A depth buffer without blocks, which hides nothing."""

_MAX_OCCLUDERS = 256
_BLOCKS_ACROSS = 320
_LEAST_BLOCKS = 2.0
"""Half diagonal of a box that is worth being drawn as an occluder [blocks]."""
_DEPTH_STEPS = 64.0 / 2.0**24
"""Depth difference that a 24-bit depth buffer resolves for certain."""

_NEAR_MARGIN = 1.001


def gather_occluders(world: World, items: DrawItems, arena: MeshArena, wanted: Occlusion) -> Occluders:
    """Return the occluder boxes of a world's items.

    Args:
        world: The world, updated.
        items: Its sub-entities.
        arena: Mesh arena, with the boxes derived from meshes.
        wanted: Boxes to use.
    """
    listed = world.subentities()
    of_item = np.full(len(items.rows), -1, np.int32)
    boxes: list[tuple[F8, F8, F8, F8, F8]] = []
    number: dict[object, int] = {}
    if wanted in ("derived", "all"):
        for item in np.flatnonzero(items.solid).tolist():
            name = listed.mesh[item]
            solid = arena.solids.get(name)
            if solid is None:
                continue
            if name not in number:
                number[name] = len(boxes)
                centre, half = 0.5 * (solid.lower + solid.upper), 0.5 * (solid.upper - solid.lower)
                boxes.append((centre, half, items.local[item, :3], items.half[item], solid.caps))
            of_item[item] = number[name]
    if wanted in ("authored", "all"):
        _add_authored(world, items, of_item, boxes)
    return _pack(of_item, boxes)


class OcclusionPass:
    """Occlusion culling, with scratch memory kept from frame to frame.

    Attributes:
        nearness: 1/w of the nearest occluder per block of the last view, 0: none [1/m], [rows, columns]; `NO_OCCLUDER`
            where nothing was worth drawing.
    """

    def __init__(self, occluders: Occluders) -> None:
        self._occluders = occluders
        self._chosen, self._score = np.zeros(_MAX_OCCLUDERS, np.int32), np.zeros(_MAX_OCCLUDERS)
        self._blocks: F8 = np.zeros((1, 1))
        self.nearness = NO_OCCLUDER

    def remove_hidden(
        self,
        picked: I4,
        count: int,
        view: View,
        raster: Raster,
        items: DrawItems,
        world: F8,
        centres: F8,
        radii: F8,
    ) -> int:
        """Remove the occluded items of a view.

        Args:
            picked: Numbers of items in the frustum, [>= count], changed.
            count: Number of items.
            view: The view.
            raster: Its projection.
            items: The draw items.
            world: T_world_from_node per row, [rows, 4, 4].
            centres: Centres of the items' spheres, world [m], [n, 3].
            radii: Their radii [m], [n].

        Returns:
            How many remain.
        """
        able = picked[:count] if view.clip_plane is None else _before(picked[:count], view.clip_plane, centres, radii)
        chosen = self._choose(able, raster, items, world, centres)
        if not len(chosen):
            self.nearness = NO_OCCLUDER
            return count
        self._draw(chosen, raster, items, world)
        depth = CoarseDepth(self.nearness, raster.block, *raster.size, raster.near, raster.step)
        boxes = ItemBoxes(items.rows, world, items.local, items.half)
        return remove_hidden(picked, count, raster.eye, raster.screen, depth, raster.reach, boxes)

    def _choose(self, able: I4, raster: Raster, items: DrawItems, world: F8, centres: F8) -> I4:
        """Return the items whose boxes are the best occluders, at most `_MAX_OCCLUDERS`."""
        least = _LEAST_BLOCKS * raster.block / raster.focal
        placed = ItemPlaces(items.rows, world, centres)
        found = pick_occluders(able, raster.eye, least, self._occluders, placed, self._chosen, self._score)
        return self._chosen[:found]

    def _draw(self, chosen: I4, raster: Raster, items: DrawItems, world: F8) -> None:
        """Rasterise the chosen occluders into the coarse depth buffer."""
        if self._blocks.shape != raster.shape:
            self._blocks = np.zeros(raster.shape)
        self.nearness = self._blocks
        camera = (raster.eye, raster.window, raster.screen, raster.rays, raster.near, raster.block, raster.reach)
        draw_occluders(chosen, OccluderView(*camera), self._occluders, items.rows, world, self.nearness)


@dataclass(frozen=True, eq=False)
class Raster:
    """Projection of a view to the coarse depth buffer.

    Attributes:
        eye: Position of the camera, world [m], [3].
        near: Distance of the near plane [m].
        screen: Matrix from world vectors to X w, Y w, w, [3, 3].
        rays: World directions of w = 1 per pixel to the right, per pixel up, and at pixel (0, 0); [3, 3].
        window: Corners of the near plane's window relative to the camera [m], [4, 3].
        block: Width of a square block [px].
        shape: Rows and columns of blocks.
        reach: Largest offset of a sample from its pixel's centre, with the margin [px].
        step: Difference of 1/w that the depth buffer resolves [1/m].
        size: Size of the picture as drawn [px].
        focal: Smaller number of pixels per unit of a slope.
    """

    eye: F8
    near: float
    screen: F8
    rays: F8
    window: F8
    block: int
    shape: tuple[int, int]
    reach: float
    step: float
    size: tuple[int, int]
    focal: float


@lru_cache(maxsize=8)
def make_raster(view: View, size: tuple[int, int], samples: int) -> Raster:
    """Return the projection of a view, which lasts while a camera rests.

    Args:
        view: The view.
        size: Size of the picture as drawn [px].
        samples: Samples per pixel, 0 or 1: the pixel's centre.
    """
    low_x, high_x, low_y, high_y = view.tangents
    block = max(1, -(-size[0] // _BLOCKS_ACROSS))
    # Depth is linear in 1/w with this factor, for an oblique near plane too.
    step = _DEPTH_STEPS * 2.0 / abs(float(view.clip_from_eye[2, 3]))
    return Raster(
        np.ascontiguousarray(view.eye_world),
        view.near,
        *_screen(view, size),
        block,
        (-(-size[1] // block), -(-size[0] // block)),
        MARGIN_PX + (0.5 if samples > 1 else 0.0),
        step,
        size,
        min(size[0] / (high_x - low_x), size[1] / (high_y - low_y)),
    )


def _before(picked: I4, plane: F8, centres: F8, radii: F8) -> I4:
    """Return the items wholly in front of a clip plane, which removes none of their front faces."""
    whole = centres[picked] @ plane[:3] + plane[3] >= radii[picked]
    return np.ascontiguousarray(picked[whole])


def _screen(view: View, size: tuple[int, int]) -> tuple[F8, F8, F8]:
    """Return `screen`, `rays` and `window` of a `Raster`."""
    low_x, high_x, low_y, high_y = view.tangents
    across, along = size[0] / (high_x - low_x), size[1] / (high_y - low_y)
    near = _NEAR_MARGIN * view.near
    screen = ((across, 0.0, low_x * across), (0.0, along, low_y * along), (0.0, 0.0, -1.0))
    rays = ((1.0 / across, 0.0, 0.0), (0.0, 1.0 / along, 0.0), (low_x, low_y, -1.0))
    corners = [(x * near, y * near, -near) for x in (low_x, high_x) for y in (low_y, high_y)]
    # Of right, up and back in one product: a frame has four of these, and each small array costs as much as all.
    found = np.array([*screen, *rays, *corners]) @ view.world_from_eye[:3, :3].T
    return found[:3], found[3:6], found[6:]


def _add_authored(world: World, items: DrawItems, of_item: I4, boxes: list[tuple[F8, F8, F8, F8, F8]]) -> None:
    """Add the boxes authored in models: each belongs to the first solid sub-entity of its body."""
    table, entities = world.content.occluders, world.subentities().entity
    seen: set[int] = set()
    for item in np.flatnonzero(items.solid & np.isin(entities, table.entities)).tolist():
        entity = int(entities[item])
        if entity not in seen:
            seen.add(entity)
            row = table.row(entity)
            centre, half = table.column("centre")[row].copy(), 0.5 * table.column("size")[row]
            of_item[item] = len(boxes)
            boxes.append((centre, half, centre, half, np.zeros((0, 4))))


def _pack(of_item: I4, boxes: Sequence[tuple[F8, F8, F8, F8, F8]]) -> Occluders:
    columns: Iterable[F8] = (np.array([box[k] for box in boxes]).reshape(-1, 3) for k in range(4))
    inner_centre, inner_half, whole_centre, whole_half = columns
    caps = np.concatenate([np.zeros((0, 4)), *(box[4] for box in boxes)])
    ends = np.cumsum([0, *(len(box[4]) for box in boxes)]).astype(np.int32)
    return Occluders(of_item, inner_centre, inner_half, whole_centre, whole_half, caps, ends)
