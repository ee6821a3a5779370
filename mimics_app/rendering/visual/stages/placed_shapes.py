"""Shapes of a frame where they are: several boxes for each of a few, one for each item of many."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import B1, F8, I4
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.kernels.voxels import place_boxes
from mimics_app.rendering.visual.stages.shape_boxes import ShapeBoxes
from mimics_app.world.motion.skinned_body import SkinnedBody

__all__ = ["PlacedItems", "Shapes", "place_items", "shapes_of"]

_MAX_NODES = 64
"""Number of changed nodes up to which several boxes for each of them pay off."""


@dataclass(frozen=True, eq=False)
class PlacedItems:
    """Where the items of a frame are.

    Attributes:
        items: The items.
        shown: Items that may be drawn, [n].
        world: T_world_from_node of each, float64 [n, 4, 4].
        boxes: Least and greatest corner of each in the node's frame [m], float64 [n, 2, 3].
        revisions: Revisions of the deformable bodies.
    """

    items: DrawItems
    shown: B1
    world: F8
    boxes: F8
    revisions: Mapping[SkinnedBody, int]


@dataclass(frozen=True, eq=False)
class Shapes:
    """Shapes as boxes in the world.

    Attributes:
        corners: Corners of the boxes [m], float64 [boxes, 8, 3].
        starts: First box of each shape, and the number of boxes, int32 [n + 1].
        casting: Shapes that cast shadows, [n].
    """

    corners: F8
    starts: I4
    casting: B1


def place_items(listed: DrawList, shapes: ShapeBoxes) -> PlacedItems:
    """Copy where the items of a draw list are."""
    items = listed.items
    middle = items.local[:, :3]
    boxes = np.stack([middle - items.half, middle + items.half], axis=1)
    return PlacedItems(items, listed.shown, listed.matrices[items.rows], boxes, shapes.revisions())


def shapes_of(placed: PlacedItems, which: B1, rewritten: B1, shapes: ShapeBoxes) -> Shapes:
    """Return the shapes of some items, all items of a node together where there are few nodes.

    Args:
        placed: The items.
        which: The items, [n].
        rewritten: Items whose meshes were rewritten, which have one box each, [n].
        shapes: Boxes of the shapes of the world.
    """
    items, numbers = placed.items, np.flatnonzero(which).astype(np.int32)
    rows = np.unique(items.rows[numbers])
    if len(rows) > _MAX_NODES:
        corners = _corners_of(placed, placed.boxes[numbers], numbers)
        return Shapes(corners, np.arange(len(numbers) + 1, dtype=np.int32), items.casting[numbers])
    found, nodes, casting = [placed.boxes[:0]], [numbers[:0]], []
    for row in rows.tolist():
        hung = numbers[items.rows[numbers] == row]
        names = [items.mesh_names[mesh] for mesh in items.meshes[hung].tolist()]
        known = None if rewritten[hung].any() else shapes.of(names, placed.revisions)
        found.append(placed.boxes[hung] if known is None else known)
        nodes.append(np.full(len(found[-1]), hung[0], np.int32))
        casting.append(bool(items.casting[hung].any()))
    starts = np.cumsum([0, *map(len, found[1:])], dtype=np.int32)
    corners = _corners_of(placed, np.concatenate(found), np.concatenate(nodes))
    return Shapes(corners, starts, np.array(casting, np.bool_))


def _corners_of(placed: PlacedItems, boxes: F8, numbers: I4) -> F8:
    """Return the corners of boxes in the frames of some items' nodes, world [m], [n, 8, 3]."""
    corners = np.empty((len(boxes), 8, 3))
    place_boxes(np.ascontiguousarray(boxes), numbers, placed.world, corners)
    return corners
