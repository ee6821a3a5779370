"""From a point of the window to the cursor, so that the whole reach of the hand lies inside the window."""

from __future__ import annotations

import math
from itertools import pairwise

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.ports.input_port import RayFromWindow
from mimics_app.inputs.interaction.plane import FrontalPlane

__all__ = ["EDGE", "levered", "pointed"]

Flat = tuple[float, float]
"""Right and up of a plane's centre [m]."""

EDGE = 0.9
"""Share of the window's half width and half height within which the whole reach of the hand lies."""
_LEAST_SHARE = 0.1
"""Smallest share of the reach that may be seen on one side of its middle; with less the window is a lever."""
_CORNERS = ((-EDGE, -EDGE), (EDGE, -EDGE), (EDGE, EDGE), (-EDGE, EDGE))


def levered(plane: FrontalPlane, right: float, up: float) -> Vec3:
    """Return the cursor of a lever: its middle is the centre of the window, its ends lie at `EDGE` of the window.

    The view has no part in it, so that a hand that turns or moves the view does not move itself.

    Args:
        plane: Reach of the hand.
        right: Point of the window, -1 to 1.
        up: Likewise.
    """
    return plane.clamp(plane.at(right / EDGE * plane.half_width, up / EDGE * plane.half_height))


def pointed(plane: FrontalPlane, ray: RayFromWindow, right: float, up: float) -> Vec3 | None:
    """Return the cursor under a point of the window; None where the ray misses the plane.

    Where a part of the reach lies outside the window, the way from the middle of the reach is stretched until all of
    it lies inside; where its middle is outside, the window is a lever.

    Args:
        plane: Reach of the hand.
        ray: Ray of the view through a point of the window.
        right: Point of the window, -1 to 1.
        up: Likewise.
    """
    corners = [plane.crossing(ray(x, y)) for x, y in _CORNERS]
    seen = [corner for corner in corners if corner is not None]
    if len(seen) < len(_CORNERS):
        return plane.meet(ray(right, up))
    stretch = _stretch(seen, plane.half_width, plane.half_height)
    if stretch is None:
        return levered(plane, right, up)
    here = plane.crossing(ray(right, up))
    return None if here is None else plane.clamp(plane.at(stretch * here[0], stretch * here[1]))


def _stretch(corners: list[Flat], half_width: float, half_height: float) -> float | None:
    """Return the smallest factor, 1 or more, by which a seen quadrilateral about the middle covers a rectangle.

    None where the middle is not well inside of it.
    """
    ends = [(x * half_width, y * half_height) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    turn = math.copysign(1.0, _area(corners))
    stretch = 1.0
    for (x0, y0), (x1, y1) in pairwise([*corners, corners[0]]):
        length = math.hypot(x1 - x0, y1 - y0)
        if length == 0.0:
            return None
        across = turn * (y1 - y0) / length, turn * (x0 - x1) / length  # out of the quadrilateral
        room = across[0] * x0 + across[1] * y0
        need = max(across[0] * x + across[1] * y for x, y in ends)
        if room <= _LEAST_SHARE * need:
            return None
        stretch = max(stretch, need / room)
    return stretch


def _area(corners: list[Flat]) -> float:
    return 0.5 * sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise([*corners, corners[0]]))
