"""Walls with windows and doors: true openings with reveals, triangulated without a crack."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from assets.builders.kit.sketch import Point, Sketch, Uv
from assets.builders.kit.solids import Axes, Skin, rectangle

__all__ = ["Opening", "Zone", "add_zone", "wall_axes"]


@dataclass(frozen=True)
class Opening:
    """A window or door in a wall.

    Attributes:
        left, right, bottom, top: In the wall's plane [m].
        panel: Skin of the window or door.
        recess: Distance of the panel behind the wall's face [m].
        surround: Width of a frame of `trim` around it, inside of the sizes above [m]; 0: none.
    """

    left: float
    right: float
    bottom: float
    top: float
    panel: Skin
    recess: float = 0.18
    surround: float = 0.0

    @property
    def corners(self) -> list[Uv]:
        """Counter-clockwise from the lower left."""
        return rectangle(self.left, self.right, self.bottom, self.top)


@dataclass(frozen=True)
class Zone:
    """A rectangle of wall [m]; rows of openings from below, each from left to right.

    All rows begin at the same left edge and end at the same right edge: then straight lines part the wall well.
    Openings of a row end at one height; they begin at different ones only where the line below has a corner under
    each of their edges: above a row of the same columns, or on a `footed` border.

    Attributes:
        left, right, bottom, top: Its border.
        rows: Of openings.
        wall: Skin of the wall.
        trim: Skin of frames around openings.
        footed: Whether the lower border has vertices under the edges of the first row.
        roofed: Factor on the colour along the upper border, in the shade of eaves.
    """

    left: float
    right: float
    bottom: float
    top: float
    rows: Sequence[Sequence[Opening]]
    wall: Skin
    trim: Skin
    footed: bool = False
    roofed: float = 1.0

    @property
    def foot(self) -> list[float]:
        """Return the vertices along the lower border, from left to right [m]."""
        edges = [u for opening in self.rows[0] for u in (opening.left, opening.right)] if self.footed else []
        return [self.left, *edges, self.right]


def wall_axes(width: float, depth: float, side: str) -> Axes:
    """The frame of a wall of a box that stands before z = 0: a along it, b up, c outwards; a = 0 at its left end.

    Args:
        width: Of the box, along x, centred [m].
        depth: Along -z [m].
        side: "front", "left", "right" or "back", as seen from the street.
    """
    half = 0.5 * width
    frames: dict[str, tuple[Point, Point, Point]] = {
        "front": ((-half, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        "left": ((-half, 0.0, -depth), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)),
        "right": ((half, 0.0, 0.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)),
        "back": ((half, 0.0, -depth), (-1.0, 0.0, 0.0), (0.0, 0.0, -1.0)),
    }
    origin, along, out = frames[side]
    return Axes(origin, along, (0.0, 1.0, 0.0), out)


def add_zone(sketch: Sketch, axes: Axes, zone: Zone) -> None:
    """Draw a zone; its border has no vertices but its four corners.

    Raises:
        ValueError: the rows do not begin and end at the same edges.
    """
    if not zone.rows:
        corners = rectangle(zone.left, zone.right, zone.bottom, zone.top)
        _face(sketch, axes, zone, zone.wall, corners)
        return
    if len({(row[0].left, row[-1].right) for row in zone.rows}) != 1:
        raise ValueError("rows of a zone must begin and end at the same edges")
    chains = [[(u, zone.bottom) for u in zone.foot]]
    for row in zone.rows:
        chains.append([(u, opening.bottom) for opening in row for u in (opening.left, opening.right)])
        chains.append([(u, opening.top) for opening in row for u in (opening.left, opening.right)])
    chains.append([(zone.left, zone.top), (zone.right, zone.top)])
    for lower, upper in zip(chains[::2], chains[1::2], strict=True):
        _zip(sketch, axes, zone, lower, upper, 0)
    left = [chain[0] for chain in chains[1:-1]]
    right = [chain[-1] for chain in chains[1:-1]]
    _zip(sketch, axes, zone, left, [chains[0][0], chains[-1][0]], 1)
    _zip(sketch, axes, zone, [chains[0][-1], chains[-1][-1]], right, 1)
    for row in zone.rows:
        for before, after in itertools.pairwise(row):
            pier = [
                (before.right, before.bottom),
                (after.left, after.bottom),
                (after.left, after.top),
                (before.right, before.top),
            ]
            _face(sketch, axes, zone, zone.wall, pier)
        for opening in row:
            _add_opening(sketch, axes, zone, opening)


def _add_opening(sketch: Sketch, axes: Axes, zone: Zone, opening: Opening) -> None:
    """Draw the frame, the reveals and the panel of an opening."""
    outer = opening.corners
    s = opening.surround
    inner = rectangle(opening.left + s, opening.right - s, opening.bottom + s, opening.top - s) if s else outer
    deep = -opening.recess
    lining = zone.trim if s else zone.wall
    for number, shade in enumerate((0.95, 0.62, 0.45, 0.62)):  # sill, right jamb, head, left jamb
        following = (number + 1) % 4
        if s:
            frame = [outer[number], outer[following], inner[following], inner[number]]
            _face(sketch, axes, zone, zone.trim, frame)
        (u0, v0), (u1, v1) = inner[number], inner[following]
        # Seen from inside the hole the edge runs from left to right, the panel's side of it lies above.
        corners = [axes.point(u0, v0, 0.0), axes.point(u1, v1, 0.0), axes.point(u1, v1, deep), axes.point(u0, v0, deep)]
        length = abs(u1 - u0) + abs(v1 - v0)
        places = [(0.0, 0.0), (length, 0.0), (length, opening.recess), (0.0, opening.recess)]
        dark = [shade, shade, 0.7 * shade, 0.7 * shade]
        sketch.fan(lining.material, corners, lining.lay(places), [lining.shade * value for value in dark])
    points = [axes.point(u, v, deep) for u, v in inner]
    sketch.fan(opening.panel.material, points, opening.panel.lay(inner), opening.panel.shade)


def _zip(sketch: Sketch, axes: Axes, zone: Zone, first: list[Uv], second: list[Uv], axis: int) -> None:
    """Draw triangles between two lines of points; looking along them, the second is to the left."""
    corners = [*first, *second]
    triangles = []
    i, j = 0, 0
    while i < len(first) - 1 or j < len(second) - 1:
        ahead = j == len(second) - 1 or (i < len(first) - 1 and first[i + 1][axis] <= second[j + 1][axis])
        if ahead:
            triangles.append((i, i + 1, len(first) + j))
            i += 1
        else:
            triangles.append((i, len(first) + j + 1, len(first) + j))
            j += 1
    points = [axes.point(u, v, 0.0) for u, v in corners]
    skin = zone.wall
    sketch.strip(skin.material, points, skin.lay(corners), triangles, _weathered(corners, skin.shade, zone))


def _face(sketch: Sketch, axes: Axes, zone: Zone, skin: Skin, corners: list[Uv]) -> None:
    points = [axes.point(u, v, 0.0) for u, v in corners]
    sketch.fan(skin.material, points, skin.lay(corners), _weathered(corners, skin.shade, zone))


def _weathered(corners: Sequence[Uv], shade: float, zone: Zone) -> list[float]:
    """Splashed and shaded at the foot, shaded under the eaves."""
    return [shade * (0.72 if v < 0.01 else zone.roofed if v == zone.top else 1.0) for _, v in corners]
