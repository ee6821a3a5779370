"""Takes out of a view what is behind something solid: exact, in that not one pixel of the picture is another."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.kernels.occluders import draw_occluders, pick_occluders
from mimics_app.rendering.visual.kernels.occlusion import MARGIN_PX, remove_hidden
from mimics_app.rendering.visual.settings import Occlusion
from mimics_app.rendering.visual.view import View
from mimics_app.world.world import World

__all__ = ["LEAST_ITEMS", "Occluders", "OcclusionPass", "gather_occluders"]


LEAST_ITEMS = 64
"""Sub-entities from which a world is worth the trouble."""

_MOST_OCCLUDERS = 64
_BLOCKS_ACROSS = 160
_DEPTH_STEPS = 64.0 / 2.0**24
"""Of a 24-bit depth buffer, by which things are distinguished for certain."""

_NEAR_MARGIN = 1.001


@dataclass(frozen=True, eq=False)
class Occluders:
    """Boxes that hide what is behind them, in the frames of their nodes [m].

    Attributes:
        of_item: Number of each item's box, -1: none; int32 [n].
        inner_middle: Of the boxes, float64 [boxes, 3].
        inner_half: Their half sizes, [boxes, 3].
        whole_middle: Of the boxes about the whole bodies, [boxes, 3].
        whole_half: Their half sizes, [boxes, 3].
        caps: Planes an eye has to be behind, normal and offset, [.., 4].
        caps_from: First plane of each box, and the one past the last, int32 [boxes + 1].
    """

    of_item: I4
    inner_middle: F8
    inner_half: F8
    whole_middle: F8
    whole_half: F8
    caps: F8
    caps_from: I4


def gather_occluders(world: World, items: DrawItems, arena: MeshArena, wanted: Occlusion) -> Occluders:
    """The boxes of a world's items.

    Args:
        world: After its update.
        items: Its sub-entities.
        arena: With the boxes found inside meshes.
        wanted: Which ones.
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
                middle, half = 0.5 * (solid.least + solid.greatest), 0.5 * (solid.greatest - solid.least)
                boxes.append((middle, half, items.local[item, :3], items.half[item], solid.caps))
            of_item[item] = number[name]
    if wanted in ("authored", "all"):
        _add_authored(world, items, of_item, boxes)
    return _pack(of_item, boxes)


class OcclusionPass:
    """Finds what is hidden, with memory kept from frame to frame."""

    def __init__(self, occluders: Occluders) -> None:
        self._occluders = occluders
        self._chosen, self._score = np.zeros(_MOST_OCCLUDERS, np.int32), np.zeros(_MOST_OCCLUDERS)
        self._nearness: F8 = np.zeros((1, 1))

    def remove_hidden(
        self,
        picked: I4,
        count: int,
        view: View,
        size: tuple[int, int],
        samples: int,
        items: DrawItems,
        world: F8,
        centres: F8,
        radii: F8,
    ) -> int:
        """Take out of the items of a view those that cannot be seen.

        Args:
            picked: Numbers of items in the frustum, [>= count], changed.
            count: How many.
            view: From where.
            size: Of the picture drawn [px].
            samples: Per pixel, 0 or 1: its middle.
            items: What the numbers mean.
            world: T_world_from_node per row, [rows, 4, 4].
            centres: Of the items' spheres, world [m], [n, 3].
            radii: Of the same [m], [n].

        Returns:
            How many stay.
        """
        able = picked[:count] if view.clip_plane is None else _before(picked[:count], view.clip_plane, centres, radii)
        chosen = self._choose(able, np.ascontiguousarray(view.eye_world), items, world, centres)
        if not len(chosen):
            return count
        raster = _raster(view, size, samples)
        self._draw(chosen, raster, items, world)
        eye, near, (width, height) = raster.eye, raster.near, size
        raster_figures = (eye, raster.screen, near, raster.step, raster.block, raster.reach, width, height)
        bodies = (items.rows, world, items.local, items.half)
        return remove_hidden(picked, count, *raster_figures, *bodies, self._nearness)

    def _choose(self, able: I4, eye: F8, items: DrawItems, world: F8, centres: F8) -> I4:
        """Those of some items that hide most, at most `_MOST_OCCLUDERS`."""
        box = (self._occluders.of_item, self._occluders.inner_half)
        found = pick_occluders(able, len(able), eye, *box, items.rows, world, centres, self._chosen, self._score)
        return self._chosen[:found]

    def _draw(self, chosen: I4, raster: _Raster, items: DrawItems, world: F8) -> None:
        """Fill the coarse picture of how near what hides is."""
        if self._nearness.shape != raster.shape:
            self._nearness = np.zeros(raster.shape)
        known = self._occluders
        seen_by = (raster.eye, raster.window, raster.screen, raster.rays, raster.near, raster.block, raster.reach)
        boxes = (known.of_item, known.whole_middle, known.whole_half, known.inner_middle, known.inner_half)
        caps = (known.caps, known.caps_from)
        draw_occluders(chosen, len(chosen), *seen_by, items.rows, world, *boxes, *caps, self._nearness)


@dataclass(frozen=True, eq=False)
class _Raster:
    """How a view looks at the coarse picture of what hides.

    Attributes:
        eye: World [m], [3].
        near: Distance of the near plane [m].
        screen: World to X w, Y w, w, [3, 3].
        rays: Per pixel, [3, 3].
        window: Corners of the near window from the eye, [4, 3].
        block: Pixels along a side of one of its squares.
        shape: Its rows and columns.
        reach: How far from its middle a pixel may be asked [px].
        step: Of nearness, by which things are distinguished.
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


def _raster(view: View, size: tuple[int, int], samples: int) -> _Raster:
    block = max(1, -(-size[0] // _BLOCKS_ACROSS))
    # Depth is linear in 1/w with this factor, whichever way the near plane lies.
    step = _DEPTH_STEPS * 2.0 / abs(float(view.clip_from_eye[2, 3]))
    return _Raster(
        np.ascontiguousarray(view.eye_world),
        view.near,
        *_screen(view, size),
        block,
        (-(-size[1] // block), -(-size[0] // block)),
        MARGIN_PX + (0.5 if samples > 1 else 0.0),
        step,
    )


def _before(picked: I4, plane: F8, centres: F8, radii: F8) -> I4:
    """Those wholly before a plane, whose front faces it does not cut away."""
    whole = centres[picked] @ plane[:3] + plane[3] >= radii[picked]
    return np.ascontiguousarray(picked[whole])


def _screen(view: View, size: tuple[int, int]) -> tuple[F8, F8, F8]:
    """World to X w, Y w, w [3, 3]; rays per pixel [3, 3]; corners of the near window from the eye [4, 3]."""
    right, up, back = view.world_from_eye[:3, :3].T
    low_x, high_x, low_y, high_y = view.tangents
    across, along = size[0] / (high_x - low_x), size[1] / (high_y - low_y)
    screen = np.stack([(right + low_x * back) * across, (up + low_y * back) * along, -back])
    rays = np.stack([right / across, up / along, low_x * right + low_y * up - back])
    corners = [x * right + y * up - back for x in (low_x, high_x) for y in (low_y, high_y)]
    return screen, rays, _NEAR_MARGIN * view.near * np.stack(corners)


def _add_authored(world: World, items: DrawItems, of_item: I4, boxes: list[tuple[F8, F8, F8, F8, F8]]) -> None:
    """Boxes written into models: each counts for the first solid part of its body."""
    table, entities = world.content.occluders, world.subentities().entity
    seen: set[int] = set()
    for item in np.flatnonzero(items.solid & np.isin(entities, table.entities)).tolist():
        entity = int(entities[item])
        if entity not in seen:
            seen.add(entity)
            row = table.row(entity)
            middle, half = table.column("centre")[row].copy(), 0.5 * table.column("size")[row]
            of_item[item] = len(boxes)
            boxes.append((middle, half, middle, half, np.zeros((0, 4))))


def _pack(of_item: I4, boxes: Sequence[tuple[F8, F8, F8, F8, F8]]) -> Occluders:
    columns: Iterable[F8] = (np.array([box[k] for box in boxes]).reshape(-1, 3) for k in range(4))
    inner_middle, inner_half, whole_middle, whole_half = columns
    caps = np.concatenate([np.zeros((0, 4)), *(box[4] for box in boxes)])
    ends = np.cumsum([0, *(len(box[4]) for box in boxes)]).astype(np.int32)
    return Occluders(of_item, inner_middle, inner_half, whole_middle, whole_half, caps, ends)
