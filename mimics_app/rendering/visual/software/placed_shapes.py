"""Shapes of a world's items where they are: several boxes for each, computed when a search misses them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import B1, F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.software.kernels.shape_places import (
    KNOWN,
    MISSED,
    FoundShapes,
    ItemsOfFrame,
    ShapeTable,
    place_shapes,
)
from mimics_app.rendering.visual.software.shape_boxes import ShapeBoxes
from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["PlacedItems", "PlacedShapes", "Shapes", "place_items"]

_MAX_SHAPES = 64
"""Number of changed shapes up to which several boxes for each of them pay off."""

_MOST_COMPUTED = 4
"""Number of shapes whose boxes are computed in one frame, each in up to 6 ms; the others have one box meanwhile."""


@dataclass(frozen=True, eq=False)
class PlacedItems:
    """Where the items of a frame are.

    Attributes:
        items: The items.
        shown: Items of the levels of detail that are drawn, [n].
        boxes: Least and greatest corner of each in the node's frame [m], float64 [n, 2, 3].
        world: T_world_from_node per row, float64 [rows, 4, 4].
    """

    items: DrawItems
    shown: B1
    boxes: F8
    world: F8

    @property
    def compiled(self) -> ItemsOfFrame:
        """The same for compiled code."""
        return ItemsOfFrame(self.shown, self.boxes, self.world)


@dataclass(frozen=True, eq=False)
class Shapes:
    """Shapes that changed, as boxes in the world.

    Attributes:
        corners: Corners of the boxes before and after [m], float64 [boxes, 8, 3].
        starts: First box of each shape, and the number of boxes, int32 [n + 1].
        casting: Shapes that cast shadows, [n].
    """

    corners: F8
    starts: I4
    casting: B1


@dataclass(eq=False)
class _Bent:
    """Boxes of some meshes of a deformable body.

    Attributes:
        body: The body.
        names: Keys of the meshes.
        span: First and end of the boxes in `PlacedShapes.boxes`.
        revision: Revision of the body's pose that the boxes were computed for.
    """

    body: SkinnedBody
    names: list[str]
    span: tuple[int, int]
    revision: int


def place_items(listed: DrawList, shown: B1) -> PlacedItems:
    """Copy where the items of a draw list are, some of which are shown."""
    items = listed.items
    middle = items.local[:, :3]
    boxes = np.empty((len(middle), 2, 3))
    np.subtract(middle, items.half, out=boxes[:, 0])
    np.add(middle, items.half, out=boxes[:, 1])
    return PlacedItems(items, shown, boxes, listed.matrices.copy())


class PlacedShapes:
    """The shapes of some items: all items of a node are one shape.

    Boxes of a deformable body are those of its drawn meshes: bending all levels of detail would cost more. Each choice
    of meshes has a range of its own; in the frame of another choice a shape was where its items' boxes are.

    Attributes:
        items: The items.
        shapes: Shape of each item, int32 [n].
        spans: First and end of each shape in `boxes`; equal where they are not known, int32 [shapes, 2].
        boxes: Least and greatest corner in the frame of the node [m], float64 [boxes, 2, 3].
        missed: 0, `MISSED` or `KNOWN` by shape, uint8 [shapes]; see `place_shapes`.

    Args:
        items: The items.
        known: Boxes of the shapes of the world.
    """

    def __init__(self, items: DrawItems, known: ShapeBoxes) -> None:
        self.items = items
        self._known = known
        rows, numbers = np.unique(items.rows, return_inverse=True)
        self.shapes = numbers.astype(np.int32)
        self._order = np.argsort(self.shapes, kind="stable").astype(np.int32)
        self._firsts = np.searchsorted(self.shapes[self._order], np.arange(len(rows) + 1)).astype(np.int32)
        self.spans = np.zeros((len(rows), 2), np.int32)
        self.missed, self._placed = np.zeros(len(rows), np.uint8), np.zeros(len(rows), np.uint8)
        self.boxes, self._corners = np.zeros((0, 2, 3)), np.zeros((0, 8, 3))
        self._starts, self._casts = np.zeros(len(rows) + 1, np.int32), np.zeros(len(rows), np.bool_)
        self._drawn: dict[int, bytes] = {}
        self._bent: dict[tuple[int, bytes], _Bent] = {}
        self._rewritten = 0

    def follow(self, shown: B1, rewritten: B1) -> None:
        """Bend the boxes of deformable bodies, those of their shown meshes, and discard others.

        Args:
            shown: Items of the levels of detail that are drawn, [n].
            rewritten: Items whose meshes were ever rewritten: their boxes are discarded, [n].
        """
        for shape, before in self._drawn.items():
            drawn = self._drawn[shape] = shown[self._items_of(shape)].tobytes()
            bent = self._bent.get((shape, drawn))
            if drawn != before:
                self.spans[shape] = (0, 0) if bent is None else bent.span
                self._placed[shape], self.missed[shape] = 0, 0 if bent is None else KNOWN
            if bent is not None and bent.revision != bent.body.revision:
                bent.revision = bent.body.revision
                self._known.bend(bent.body, bent.names, self.boxes[slice(*bent.span)])
        count = int(np.count_nonzero(rewritten))
        if count > self._rewritten:
            self._rewritten = count
            for shape in np.unique(self.shapes[rewritten]).tolist():
                self._discard(shape)

    @property
    def table(self) -> ShapeTable:
        """The shapes, for compiled code."""
        by_shape = (self._order, self._firsts, self.spans, self.boxes, self._corners)
        return ShapeTable(self.items.rows, self.shapes, *by_shape, self._placed, self.missed)

    def place(self, was: PlacedItems, now: PlacedItems, changed: B1, hulls: F8) -> Shapes | None:
        """Return the shapes of changed items, in some memory for corners [m, 8, 3]; None: it is too small."""
        casting = was.items.casting | now.items.casting
        out = FoundShapes(hulls, self._starts, self._casts)
        count, boxes = place_shapes(changed, was.compiled, now.compiled, casting, self.table, _MAX_SHAPES, out)
        if boxes > len(hulls):
            self._placed[:] = 0
            return None
        return Shapes(hulls[:boxes], self._starts[: count + 1], self._casts[:count])

    def compute_missed(self, shown: B1) -> None:
        """Compute the boxes that were missed: of a few shapes a frame, and of all that were computed before.

        Args:
            shown: Items of the levels of detail that are drawn, [n].
        """
        computed = 0
        for shape in np.flatnonzero(self.missed == MISSED).tolist():
            items = self._items_of(shape)
            body = self._known.body_of(self._names_of(items))
            if body is not None:
                self._drawn[shape] = shown[items].tobytes()
                items = items[shown[items]]
            names = self._names_of(items)
            computed += not self._known.has(names)
            if computed > _MOST_COMPUTED:
                return
            self.missed[shape], boxes = KNOWN, self._known.of(names)
            if boxes is not None:
                self._keep(shape, names, boxes, body)

    def _items_of(self, shape: int) -> I4:
        return self._order[self._firsts[shape] : self._firsts[shape + 1]]

    def _names_of(self, items: I4) -> list[str]:
        return [self.items.mesh_names[mesh] for mesh in self.items.meshes[items].tolist()]

    def _keep(self, shape: int, names: list[str], boxes: F8, body: SkinnedBody | None) -> None:
        span = self.spans[shape] = len(self.boxes), len(self.boxes) + len(boxes)
        self.boxes = np.concatenate([self.boxes, boxes])
        self._corners = np.concatenate([self._corners, np.empty((len(boxes), 8, 3))])
        if body is not None:
            self._bent[shape, self._drawn[shape]] = _Bent(body, names, span, body.revision)

    def _discard(self, shape: int) -> None:
        """Use the items' own boxes from now on."""
        self.spans[shape], self._placed[shape], self.missed[shape] = 0, 0, KNOWN
        self._drawn.pop(shape, None)
