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

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import OutlineEdgeRecord, OutlineRecord, Table

__all__ = [
    "EDGES",
    "OUTLINE",
    "OUTLINE_EDGE",
    "box_outline",
    "circle_outline",
    "kerb_outline",
    "mesh_outline",
    "outline_distance",
    "put_box",
    "put_circle",
    "put_kerb",
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


def wall_outline(point: _Point, normal: _Point) -> NDArray[Any]:
    """Return the OUTLINE, shape [1], of a wall through a point [m] with an outward normal, shape [2] each."""
    outline, length = np.zeros(1, OUTLINE), math.hypot(normal[0], normal[1])
    put_wall(outline[0], float(point[0]), float(point[1]), normal[0] / length, normal[1] / length)
    return outline


def circle_outline(centre: _Point, radius: float, off_plane: float = 0.0) -> NDArray[Any]:
    """Return the OUTLINE of a sphere, or of a cylinder across the plane.

    Args:
        centre: Centre in the plane [m], shape [2].
        radius: Its radius [m].
        off_plane: Distance of a sphere's centre from the plane [m]; 0 for a cylinder.

    Raises:
        ValueError: The plane misses the sphere.
    """
    if not abs(off_plane) < radius:
        raise ValueError(
            f"the plane of the leg passes the sphere at {off_plane:g} m, beyond its radius of {radius:g} m"
        )
    outline = np.zeros(1, OUTLINE)
    put_circle(outline[0], float(centre[0]), float(centre[1]), math.sqrt(radius * radius - off_plane * off_plane))
    return outline


def box_outline(centre: _Point, size: _Point, rounding: float) -> NDArray[Any]:
    """Return the OUTLINE of a box, or of an upright cylinder by its cut: size along x and z [m], with rounded edges."""
    if not min(size[0], size[1]) > 2.0 * rounding:
        raise ValueError(f"a rounding of {rounding:g} m leaves nothing of a box of {size[0]:g} by {size[1]:g} m")
    outline = np.zeros(1, OUTLINE)
    put_box(outline[0], float(centre[0]), float(centre[1]), float(size[0]), float(size[1]), rounding)
    return outline


def kerb_outline(edge: _Point, rounding: float) -> NDArray[Any]:
    """Return the OUTLINE of a kerb, see `put_kerb`."""
    outline = np.zeros(1, OUTLINE)
    put_kerb(outline[0], float(edge[0]), float(edge[1]), rounding)
    return outline


def mesh_outline(vertices: NDArray[np.float64], faces: NDArray[np.integer[Any]], y: float) -> NDArray[Any]:
    """Return the OUTLINE of a closed triangle mesh cut by the plane of a leg, without rounding.

    Args:
        vertices: Shape [n, 3], x forward, y to the left, z up [m].
        faces: Shape [m, 3], counter-clockwise from outside.
        y: Plane of the leg [m].

    Raises:
        ValueError: The plane misses the mesh, or the cut has more than EDGES edges.
    """
    triangles = np.asarray(vertices, np.float64)[faces]
    height = triangles[:, :, 1] - y
    outline, count = np.zeros(1, OUTLINE), 0
    for corners, above in zip(triangles, height, strict=True):
        ends = [
            a + ha / (ha - hb) * (b - a)
            for a, b, ha, hb in zip(corners, np.roll(corners, -1, 0), above, np.roll(above, -1), strict=True)
            if (ha < 0.0) != (hb < 0.0)
        ]
        if len(ends) != 2 or np.allclose(ends[0], ends[1]):
            continue
        if count == EDGES:
            raise ValueError(f"the cut through the mesh has more than {EDGES} edges: simplify the mesh")
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])[[0, 2]]
        edge = outline["edges"][0, count]
        edge["start"], edge["end"], edge["normal"] = ends[0][[0, 2]], ends[1][[0, 2]], normal / math.hypot(*normal)
        count += 1
    if count == 0:
        raise ValueError(f"the plane of the leg, at y = {y:g} m, misses the mesh")
    outline["count"] = count
    return outline
