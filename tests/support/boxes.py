"""Turned boxes as drawn items without a driver, and which of them rays through pixels meet first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.groups.culling import box_items
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.occlusion import Occluders
from mimics_app.rendering.visual.view import View

F8 = NDArray[np.float64]


def as_items(half: F8) -> DrawItems:
    """Boxes of these half sizes [n, 3] about their nodes' origins, each on a node of its own."""
    return box_items(np.arange(len(half), dtype=np.int32), half)


def as_occluders(half: F8) -> Occluders:
    """The same boxes, each filled on its own."""
    count = len(half)
    zeros = np.zeros((count, 3))
    numbers = np.arange(count, dtype=np.int32)
    return Occluders(numbers, zeros, half, zeros, half, np.zeros((0, 4)), np.zeros(count + 1, np.int32))


def first_met(world: F8, half: F8, view: View, offsets: F8) -> NDArray[np.intp]:
    """Which box the ray through each sample meets first, -1: none; float64, by slabs (Kay & Kajiya 1986).

    Args:
        world: T_world_from_node, [n, 4, 4].
        half: Half sizes [m], [n, 3].
        view: From where.
        offsets: Places of the samples in a pixel, [s, 2], 0 to 1.

    Returns:
        Numbers of boxes, [s, height, width], row 0 at the bottom.
    """
    width, height = view.rectangle[2:]
    left, right, bottom, top = view.tangents
    x = (np.arange(width)[None, None, :] + offsets[:, 0, None, None]) / width * (right - left) + left
    y = (np.arange(height)[None, :, None] + offsets[:, 1, None, None]) / height * (top - bottom) + bottom
    x, y = np.broadcast_arrays(x, y)
    rays = np.stack([x, y, -np.ones_like(x)], axis=-1) @ view.world_from_eye[:3, :3].T
    best, number = np.full(x.shape, np.inf), np.full(x.shape, -1, np.intp)
    for box in range(len(half)):
        inverse = np.linalg.inv(world[box])
        eye, turned = inverse[:3, :3] @ view.eye_world + inverse[:3, 3], rays @ inverse[:3, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            one, two = (-half[box] - eye) / turned, (half[box] - eye) / turned
        entered = np.fmin(one, two).max(axis=-1)
        met = (entered <= np.fmax(one, two).min(axis=-1)) & (entered >= view.near) & (entered < best)
        best, number = np.where(met, entered, best), np.where(met, box, number)
    return number
