"""Lines in the world as one array, and figures made of them: boxes, circles, arrows."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.visual.figures.hud import Colour

__all__ = ["LINE_ROW", "LineSet", "box_lines", "circle_lines"]


LINE_ROW = np.dtype([("begin", "f4", (3,)), ("end", "f4", (3,)), ("tint", "f4", (4,)), ("widths", "f4", (2,))])
"""One line, as read by shaders/overlay/lines.vert."""

_CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
_EDGES = np.array([(a, b) for a, b in itertools.combinations(range(8), 2) if bin(a ^ b).count("1") == 1])
_STEPS = 32
_ROUND = np.linspace(0.0, 2.0 * np.pi, _STEPS + 1)

_WIDTH = 1.6
_SHAFT, _HEAD = 3.4, 13.0
"""Widths of an arrow's shaft and head [px]."""
_HEAD_SHARE = 0.28
"""Length of an arrow's head over that of the arrow."""


class LineSet:
    """Collects lines; ends are world positions [m] in float64."""

    def __init__(self) -> None:
        self._ends: list[F8] = []
        self._rest: list[F4] = []

    def __len__(self) -> int:
        """Return the number of lines."""
        return sum(len(part) for part in self._ends)

    def clear(self) -> None:
        """Remove all lines."""
        self._ends.clear()
        self._rest.clear()

    def add(self, ends: F8, tint: Colour, width: float | tuple[float, float] = _WIDTH) -> None:
        """Add lines of one colour.

        Args:
            ends: Ends of the lines, world [m], [n, 2, 3].
            tint: Display values, straight alpha.
            width: Width, or widths at both ends [px].
        """
        ends = np.asarray(ends, np.float64).reshape(-1, 2, 3)
        widths = (width, width) if isinstance(width, float | int) else width
        self._ends.append(ends)
        self._rest.append(np.tile(np.array([*tint, *widths], np.float32), (len(ends), 1)))

    def arrow(self, origin: F8, vector: F8, tint: Colour, width: float = _SHAFT) -> None:
        """Add an arrow from a point along a vector, world [m]."""
        tip = np.asarray(origin, np.float64) + vector
        neck = tip - _HEAD_SHARE * np.asarray(vector)
        self.add(np.stack([origin, neck])[None], tint, width)
        self.add(np.stack([neck, tip])[None], tint, (_HEAD * width / _SHAFT, 0.0))

    def rows(self, eye_world: F8) -> NDArray[Any]:
        """Return the lines relative to the camera, subtracted in float64, LINE_ROW [n]."""
        rows = np.zeros(len(self), LINE_ROW)
        if self._ends:
            ends, rest = np.concatenate(self._ends) - eye_world, np.concatenate(self._rest)
            rows["begin"], rows["end"] = ends[:, 0], ends[:, 1]
            rows["tint"], rows["widths"] = rest[:, :4], rest[:, 4:]
        return rows


def box_lines(matrices: F8, centres: F8, halves: F8) -> F8:
    """Return the edges of boxes, [12 n, 2, 3].

    Args:
        matrices: T_world_from_box, [n, 4, 4].
        centres: Centres in the boxes' frames [m], [n, 3].
        halves: Half extents [m], [n, 3].
    """
    local = centres[:, None] + _CORNERS * halves[:, None]
    corners = np.einsum("nij,nkj->nki", matrices[:, :3, :3], local) + matrices[:, None, :3, 3]
    return np.asarray(corners[:, _EDGES].reshape(-1, 2, 3))


def circle_lines(centres: F8, right: F8, up: F8) -> F8:
    """Return the segments of circles or ellipses, [32 n, 2, 3].

    Args:
        centres: Centres, world [m], [n, 3].
        right: First semi-axis [m], [n, 3].
        up: Second semi-axis [m], [n, 3].
    """
    offsets = np.cos(_ROUND)[:, None] * right[:, None] + np.sin(_ROUND)[:, None] * up[:, None]
    points = centres[:, None] + offsets
    return np.stack([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 2, 3)
