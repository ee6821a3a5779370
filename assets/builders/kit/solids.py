"""Closed solids for sketches: prisms over any outline, tapered columns, blobs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from assets.builders.kit.sketch import Point, Sketch, Uv

__all__ = ["ALONG_X", "UPRIGHT", "Axes", "Skin", "add_column", "add_prism", "circle", "rectangle"]

Outline = Sequence[Uv]


@dataclass(frozen=True)
class Axes:
    """A frame on an object; `a`, `b` and `c` are right-handed and unit.

    Attributes:
        origin: [m].
        a, b, c: Axes in the object frame.
    """

    origin: Point = (0.0, 0.0, 0.0)
    a: Point = (1.0, 0.0, 0.0)
    b: Point = (0.0, 1.0, 0.0)
    c: Point = (0.0, 0.0, 1.0)

    def point(self, a: float, b: float, c: float) -> Point:
        """Return a point of this frame in the object frame."""
        o, p, q, r = self.origin, self.a, self.b, self.c
        return (
            o[0] + a * p[0] + b * q[0] + c * r[0],
            o[1] + a * p[1] + b * q[1] + c * r[1],
            o[2] + a * p[2] + b * q[2] + c * r[2],
        )


@dataclass(frozen=True)
class Skin:
    """Cover of a face: a material and the layout of its texture.

    Attributes:
        material: Name of the material.
        tile: Size of one repetition of the texture, along and up [m].
        cell: Rectangle of the texture (left, top, right, bottom) that is stretched over the face instead.
        shade: Factor on the colour.
    """

    material: str
    tile: Uv = (1.0, 1.0)
    cell: tuple[float, float, float, float] | None = None
    shade: float = 1.0

    def lay(self, places: Sequence[Uv]) -> list[Uv]:
        """Return texture coordinates of points on a face, along and up [m]."""
        if self.cell is None:
            return [(s / self.tile[0], -t / self.tile[1]) for s, t in places]
        left, top, right, bottom = self.cell
        s0, t0 = min(s for s, _ in places), min(t for _, t in places)
        wide, high = max(s for s, _ in places) - s0, max(t for _, t in places) - t0
        return [(left + (s - s0) / wide * (right - left), bottom + (t - t0) / high * (top - bottom)) for s, t in places]


def add_prism(
    sketch: Sketch,
    axes: Axes,
    outline: Outline,
    low: float,
    high: float,
    caps: tuple[Skin, Skin],
    sides: Sequence[Skin],
) -> None:
    """Add a closed prism: a convex outline in the a-b plane, extruded along c.

    Args:
        sketch: Receives the faces.
        axes: Its frame.
        outline: Counter-clockwise seen against c [m].
        low: Begin along c [m].
        high: End along c [m].
        caps: Skins at `low` and `high`.
        sides: One per edge, from each corner of the outline to the next; or one for all.
    """
    for skin, c, corners in ((caps[0], low, outline[::-1]), (caps[1], high, outline)):
        points = [axes.point(a, b, c) for a, b in corners]
        sketch.fan(skin.material, points, skin.lay(corners), skin.shade)
    for number, (first, second) in enumerate(zip(outline, [*outline[1:], outline[0]], strict=True)):
        skin = sides[number % len(sides)]
        length = math.sqrt((second[0] - first[0]) ** 2 + (second[1] - first[1]) ** 2)
        points = [
            axes.point(*first, high),
            axes.point(*first, low),
            axes.point(*second, low),
            axes.point(*second, high),
        ]
        sketch.fan(skin.material, points, skin.lay(_side_places(axes, first, second, (low, high), length)), skin.shade)


def _side_places(axes: Axes, first: Uv, second: Uv, reach: Uv, length: float) -> list[Uv]:
    """Places on a side for its picture: upright on walls, where up is c; on roofs up is where the edge climbs."""
    low, high = reach
    if axes.c[1] > 0.9:
        return [(0.0, high), (0.0, low), (length, low), (length, high)]
    begin, end = (0.0, length) if second[1] >= first[1] else (length, 0.0)
    return [(high, begin), (low, begin), (low, end), (high, end)]


ALONG_X = Axes(a=(0.0, 0.0, -1.0), b=(0.0, 1.0, 0.0), c=(1.0, 0.0, 0.0))
"""For outlines in depth and height that are drawn along x."""

UPRIGHT = Axes(a=(0.0, 0.0, 1.0), b=(1.0, 0.0, 0.0), c=(0.0, 1.0, 0.0))
"""For outlines on the ground that are drawn upwards: a is z, b is x."""


def rectangle(left: float, right: float, bottom: float, top: float) -> list[Uv]:
    """An outline, counter-clockwise from the lower left [m]."""
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def circle(sides: int, radius: float) -> list[Uv]:
    """A regular outline about the origin, counter-clockwise [m]."""
    turns = [2.0 * math.pi * (number + 0.5) / sides for number in range(sides)]
    return [(radius * math.cos(turn), radius * math.sin(turn)) for turn in turns]


def add_column(
    sketch: Sketch,
    foot: Point,
    top: Point,
    radii: Uv,
    sides: int,
    skin: Skin,
    *,
    bulge: float = 0.0,
    open_foot: bool = False,
) -> None:
    """A tapered round column with smooth sides; closed, but for the foot where it stands in something.

    Args:
        sketch: Receives it.
        foot: Middle of its lower end [m].
        top: Middle of its upper end [m].
        radii: Below and above [m]; above 0 makes a point.
        sides: Facets, three or more.
        skin: `tile` is metres round and along it, or `cell` its one colour.
        bulge: Turn of the facets [rad].
        open_foot: Leave the lower end open.
    """
    turns = [2.0 * math.pi * number / sides + bulge for number in range(sides)]
    around = [(math.cos(turn), -math.sin(turn)) for turn in turns]  # counter-clockwise seen from above
    lower = [(foot[0] + radii[0] * x, foot[1], foot[2] + radii[0] * z) for x, z in around]
    upper = [(top[0] + radii[1] * x, top[1], top[2] + radii[1] * z) for x, z in around]
    height = math.sqrt(sum((t - f) ** 2 for t, f in zip(top, foot, strict=True)))
    rise = (radii[0] - radii[1]) / height
    lean = math.sqrt(1.0 + rise * rise)
    normals = [(x / lean, rise / lean, z / lean) for x, z in around]
    step = 2.0 * math.pi * radii[0] / sides
    for number in range(sides):
        following = (number + 1) % sides
        places = [
            (number * step, 0.0),
            ((number + 1) * step, 0.0),
            ((number + 1) * step, height),
            (number * step, height),
        ]
        corners = [lower[number], lower[following], upper[following], upper[number]]
        smooth = [normals[number], normals[following], normals[following], normals[number]]
        if radii[1] == 0.0:
            corners, smooth, places = corners[:3], smooth[:3], places[:3]
        sketch.fan(skin.material, corners, skin.lay(places), skin.shade, smooth)
    if radii[1] > 0.0:
        sketch.fan(skin.material, upper, skin.lay([(x, -z) for x, z in around]), skin.shade)
    if not open_foot:
        sketch.fan(skin.material, lower[::-1], skin.lay([(x, -z) for x, z in around[::-1]]), skin.shade * 0.6)
