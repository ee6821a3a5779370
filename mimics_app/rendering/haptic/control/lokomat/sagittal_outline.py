"""Outline of a hard object in the plane in which a leg moves: the shape in equation (4) of D2.1.

An outline is a chain of edges with outward normals, rounded by a radius r: the surface is all points at distance r from
the chain. A wall is one long edge, a sphere or a cylinder across the plane one edge of length zero, a box, a kerb and a
cut mesh are chains. Rounding makes the distance continuously differentiable where the foot slides from a face over an
edge; its curvature is 0 on a face and 1 / (r + g) around an end of an edge.

Coordinates are x forward and z up [m], origin at the hip, as in `kernels.leg_kinematics`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import OutlineEdgeRecord, OutlineRecord, Table

__all__ = [
    "EDGES",
    "OUTLINE",
    "OUTLINE_EDGE",
    "circle_outline",
    "corner_count",
    "outline_distance",
    "put_box",
    "put_circle",
    "put_kerb",
    "put_polygon",
    "put_wall",
    "wall_outline",
]

EDGES = 16
"""Largest number of edges of an outline."""

OUTLINE_EDGE = np.dtype(
    [("start", np.float64, 2), ("end", np.float64, 2), ("normal", np.float64, 2)],  # [m], [m], unit, outward
    align=True,
)

OUTLINE = np.dtype([("edges", OUTLINE_EDGE, EDGES), ("count", np.int64), ("radius", np.float64)], align=True)
"""Chain of the first `count` edges, rounded by a radius [m]; no edges: no object."""

_ENDLESS = 1e3
"""Half length of the edge of a wall [m]."""

_SMALLEST = 1e-9
"""Distance from an end at which its normal is that of the edge [m]."""

_TIE = 1e-12
"""Relative difference of the squares of two distances that are equal: edges meet in an end."""

_SHARPEST = 0.01
"""Smallest 1 + cosine between the normals of two edges: a corner of 11 degrees [-]."""

_Point = Sequence[float] | NDArray[np.float64]
"""Two numbers, x forward and z up."""


@kernel
def _side(edge: OutlineEdgeRecord, x: float, z: float) -> float:
    """Distance of a point from the line of an edge [m], positive outside."""
    return edge.normal[0] * (x - edge.start[0]) + edge.normal[1] * (z - edge.start[1])


@kernel
def _near_end(edge: OutlineEdgeRecord, x: float, z: float) -> tuple[float, float, bool]:
    """Point of an edge nearest to a point [m], and whether it is one of the ends."""
    along_x, along_z = edge.end[0] - edge.start[0], edge.end[1] - edge.start[1]
    square = along_x * along_x + along_z * along_z
    share = 0.0
    if square > 0.0:
        share = ((x - edge.start[0]) * along_x + (z - edge.start[1]) * along_z) / square
    if share <= 0.0:
        return edge.start[0], edge.start[1], True
    if share >= 1.0:
        return edge.end[0], edge.end[1], True
    return edge.start[0] + share * along_x, edge.start[1] + share * along_z, False


@kernel
def outline_distance(
    edges: Table[OutlineEdgeRecord], count: int, radius: float, x: float, z: float
) -> tuple[float, float, float, float]:
    """Distance of a point from a rounded outline, negative inside, with the gradient and curvature of the distance.

    Args:
        edges: Chain of OUTLINE_EDGE records.
        count: Number of edges in use, >= 1.
        radius: Rounding [m].
        x: Point, forward [m].
        z: Likewise, up.

    Returns:
        Distance g [m], unit normal (x, z) along which it grows, and curvature [1/m] of the surface g = constant.
    """
    nearest, best, best_side = 0, math.inf, 0.0
    for i in range(count):
        near_x, near_z, _ = _near_end(edges[i], x, z)
        square = (x - near_x) * (x - near_x) + (z - near_z) * (z - near_z)
        side = abs(_side(edges[i], x, z))
        tied = i > 0 and abs(square - best) <= _TIE * best
        if (square < best and not tied) or (tied and side > best_side):  # of two edges at a corner, the one faced
            nearest, best, best_side = i, square, side
    edge = edges[nearest]
    near_x, near_z, at_end = _near_end(edge, x, z)
    distance = math.sqrt(best)
    outside = _side(edge, x, z) >= 0.0 or (edge.start[0] == edge.end[0] and edge.start[1] == edge.end[1])
    if not at_end or distance <= _SMALLEST:
        return (distance if outside else -distance) - radius, edge.normal[0], edge.normal[1], 0.0
    sign = 1.0 if outside else -1.0
    return sign * distance - radius, sign * (x - near_x) / distance, sign * (z - near_z) / distance, sign / distance


@kernel
def _put_edge(outline: OutlineRecord, start_x: float, start_z: float, end_x: float, end_z: float) -> None:
    """Append an edge; the object lies on its right."""
    edge = outline.edges[outline.count]
    along_x, along_z = end_x - start_x, end_z - start_z
    length = math.sqrt(along_x * along_x + along_z * along_z)
    edge.start[0], edge.start[1], edge.end[0], edge.end[1] = start_x, start_z, end_x, end_z
    edge.normal[0] = -along_z / length if length > 0.0 else 1.0
    edge.normal[1] = along_x / length if length > 0.0 else 0.0
    outline.count += 1


@kernel
def put_wall(outline: OutlineRecord, x: float, z: float, normal_x: float, normal_z: float) -> None:
    """Set the outline of a wall through a point [m] with a unit normal."""
    outline.count, outline.radius = 0, 0.0
    along_x, along_z = _ENDLESS * normal_z, -_ENDLESS * normal_x
    _put_edge(outline, x - along_x, z - along_z, x + along_x, z + along_z)


@kernel
def put_circle(outline: OutlineRecord, x: float, z: float, radius: float) -> None:
    """Set the outline of a sphere or a cylinder across the plane, by its centre and radius in the plane [m]."""
    outline.count, outline.radius = 0, radius
    _put_edge(outline, x, z, x, z)


@kernel
def put_box(outline: OutlineRecord, x: float, z: float, size_x: float, size_z: float, rounding: float) -> None:
    """Set the outline of a box by its centre, size and rounded edges [m]."""
    outline.count, outline.radius = 0, rounding
    back, front = x - 0.5 * size_x + rounding, x + 0.5 * size_x - rounding
    low, high = z - 0.5 * size_z + rounding, z + 0.5 * size_z - rounding
    _put_edge(outline, back, low, back, high)
    _put_edge(outline, back, high, front, high)
    _put_edge(outline, front, high, front, low)
    _put_edge(outline, front, low, back, low)


@kernel
def put_kerb(outline: OutlineRecord, x: float, z: float, rounding: float) -> None:
    """Set the outline of a kerb whose upper edge is at a point [m]: a face towards the leg, and its top behind."""
    outline.count, outline.radius = 0, rounding
    inner_x, inner_z = x + rounding, z - rounding
    _put_edge(outline, inner_x, inner_z - _ENDLESS, inner_x, inner_z)
    _put_edge(outline, inner_x, inner_z, inner_x + _ENDLESS, inner_z)


@kernel
def corner_count(x: Vec, z: Vec) -> int:
    """Number of corners of a polygon whose last corner is repeated to the end of its arrays."""
    count = 1
    while count < x.shape[0] and (x[count] != x[count - 1] or z[count] != z[count - 1]):
        count += 1
    return count


@kernel
def put_polygon(outline: OutlineRecord, x: Vec, z: Vec, rounding: float) -> None:
    """Set the outline of a polygon by its corners [m], and the radius of its edges [m]; of two corners none is set.

    Args:
        outline: OUTLINE record.
        x: Corners in either order, forward; the last one is repeated to the end. At most EDGES.
        z: Likewise, up.
        rounding: Radius of the edges [m].
    """
    count, area = corner_count(x, z), 0.0
    outline.count, outline.radius = 0, rounding
    for i in range(count):
        k = (i + 1) % count
        area += x[i] * z[k] - x[k] * z[i]
    step = 1 if area < 0.0 else -1  # the object lies on the right
    if count < 3 or area == 0.0:
        return
    last_x, last_z = _rounded_corner(x, z, count, 0, step, rounding)
    first_x, first_z = last_x, last_z
    for i in range(1, count):
        corner_x, corner_z = _rounded_corner(x, z, count, step * i, step, rounding)
        _put_edge(outline, last_x, last_z, corner_x, corner_z)
        last_x, last_z = corner_x, corner_z
    _put_edge(outline, last_x, last_z, first_x, first_z)


@kernel
def _rounded_corner(x: Vec, z: Vec, count: int, i: int, step: int, rounding: float) -> tuple[float, float]:
    """Corner of a polygon moved inwards until both edges are a rounding [m] farther in."""
    at, before, after = i % count, (i - step) % count, (i + step) % count
    in_x, in_z = x[at] - x[before], z[at] - z[before]
    out_x, out_z = x[after] - x[at], z[after] - z[at]
    length_in, length_out = math.sqrt(in_x * in_x + in_z * in_z), math.sqrt(out_x * out_x + out_z * out_z)
    normal_x, normal_z = -in_z / length_in - out_z / length_out, in_x / length_in + out_x / length_out
    half = 0.5 * (normal_x * normal_x + normal_z * normal_z)  # 1 + cosine of the angle between the normals
    share = rounding / max(half, _SHARPEST)
    return x[at] - share * normal_x, z[at] - share * normal_z


def wall_outline(point: _Point, normal: _Point) -> NDArray[Any]:
    """Return the OUTLINE, shape [1], of a wall through a point [m] with an outward normal, shape [2] each."""
    outline, length = np.zeros(1, OUTLINE), math.hypot(normal[0], normal[1])
    put_wall(outline[0], float(point[0]), float(point[1]), normal[0] / length, normal[1] / length)
    return outline


def circle_outline(centre: _Point, radius: float) -> NDArray[Any]:
    """Return the OUTLINE, shape [1], of a sphere or cylinder across the plane by its circle in the plane [m]."""
    outline = np.zeros(1, OUTLINE)
    put_circle(outline[0], float(centre[0]), float(centre[1]), radius)
    return outline
