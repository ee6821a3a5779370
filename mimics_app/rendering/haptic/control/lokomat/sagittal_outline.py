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
    from mimics_app.rendering.haptic.record_types import OutlineEdgeRecord, Table

__all__ = [
    "EDGES",
    "OUTLINE",
    "OUTLINE_EDGE",
    "box_outline",
    "circle_outline",
    "kerb_outline",
    "mesh_outline",
    "outline_distance",
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


def _chain(points: NDArray[np.float64], radius: float, closed: bool) -> NDArray[Any]:
    """Outline of a chain of points, the object on the right of each edge."""
    outline = np.zeros(1, OUTLINE)
    ends = np.vstack([points[1:], points[:1]]) if closed else points[1:]
    starts = points[: len(ends)]
    if len(starts) > EDGES:
        raise ValueError(f"an outline has at most {EDGES} edges, not {len(starts)}")
    outline["count"], outline["radius"] = len(starts), radius
    for edge, start, end in zip(outline["edges"][0], starts, ends, strict=False):
        along = end - start
        length = math.hypot(*along)
        edge["start"], edge["end"] = start, end
        edge["normal"] = (-along[1] / length, along[0] / length) if length > 0.0 else (1.0, 0.0)
    return outline


def wall_outline(point: _Point, normal: _Point) -> NDArray[Any]:
    """Return the OUTLINE, shape [1], of a wall through a point [m] with an outward normal, shape [2] each."""
    n = np.asarray(normal, np.float64) / math.hypot(normal[0], normal[1])
    along = _ENDLESS * np.array([n[1], -n[0]])
    return _chain(np.asarray(point, np.float64) + np.array([-along, along]), 0.0, closed=False)


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
    points = np.array([centre, centre], np.float64)
    return _chain(points, math.sqrt(radius * radius - off_plane * off_plane), closed=False)


def box_outline(centre: _Point, size: _Point, rounding: float) -> NDArray[Any]:
    """Return the OUTLINE of a box, or of an upright cylinder by its cut: size along x and z [m], with rounded edges."""
    half = 0.5 * np.asarray(size, np.float64) - rounding
    if not half.min() > 0.0:
        raise ValueError(f"a rounding of {rounding:g} m leaves nothing of a box of {size[0]:g} by {size[1]:g} m")
    corners = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)]) * half + centre
    return _chain(corners, rounding, closed=True)


def kerb_outline(edge: _Point, rounding: float) -> NDArray[Any]:
    """Return the OUTLINE of a kerb whose upper edge is at a point [m]: a face towards the leg, and its top behind."""
    inner = np.asarray(edge, np.float64) + (rounding, -rounding)
    points = np.array([inner - (0.0, _ENDLESS), inner, inner + (_ENDLESS, 0.0)])
    return _chain(points, rounding, closed=False)


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
