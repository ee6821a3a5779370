"""A mesh that a body carries, against everything: what of the other is in it, and the corners of its hull in the other.

Both ways are looked at, for a small box on a large mesh has its own corners in it, and a small mesh on a large box
only those of the mesh. Corners that no hull needs never meet anything flat, so those of the convex hull are tried: by
their height over a wall, the signed distance of another shape, the closest triangle of another mesh. Edges that cross
between their corners are not seen, as with meshes of the static scene.

A point carries the share d / (sum of all d) of the stiffness, but no more than its kind carries elsewhere: a corner a
quarter, an end of a capsule a half, a ball the whole. So a mesh that stands has its whole stiffness however fine it is,
on a corner a quarter as a box has, and a point that dips in brings no step.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.collisions_mesh import depth_in_mesh, points_in_mesh, project_depths
from mimics_app.rendering.haptic.kernels.objects.distances import depth_under, distance_to
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANYWHERE
from mimics_app.rendering.haptic.kernels.objects.triples import (
    Three,
    along,
    axis,
    dot,
    middle,
    minus,
    out_of,
    times,
    unit,
)

__all__ = ["CORNER_SHARE", "touch_carried_mesh"]

Array = NDArray[np.float64]
Indices = NDArray[np.int32]

_WALL = int(ShapeKind.WALL)
_SPHERE = int(ShapeKind.SPHERE)
_MESH = int(ShapeKind.MESH)

CORNER_SHARE = 0.25
"""Most of the stiffness that one corner of a hull carries."""

_ASIDE = 1e-3
"""Most that a corner may stand beside the bounds of a shape and still be held by an edge [m]; see `depth_under`."""


@kernel
def _keep(p: Three, depth: float, n: Three, room: Any, count: int) -> int:
    """Add a point with its normal; in a full table in the place of the shallowest. Returns how many there are."""
    points, normals = room.points, room.normals
    at = count
    if count >= points.shape[0]:
        at = 0
        for k in range(1, count):
            if points[k, 3] < points[at, 3]:
                at = k
        if depth <= points[at, 3]:
            return count
    points[at, 0], points[at, 1], points[at, 2] = p
    points[at, 3], points[at, 4] = depth, CORNER_SHARE
    normals[at, 0], normals[at, 1], normals[at, 2] = n
    return max(count, at + 1)


@kernel
def _thinnest(solid: Any) -> float:
    """Least extent of a shape with bounds along the world's axes [m]."""
    least = math.inf
    for k in range(3):
        least = min(least, solid.high[k] - solid.low[k])
    return least


@kernel
def _is_within(p: Three, solid: Any) -> bool:
    """True for a point within the bounds of a shape that has some, or no farther out than a corner may stand aside."""
    for k in range(3):
        if p[k] < solid.low[k] - _ASIDE or p[k] > solid.high[k] + _ASIDE:
            return False
    return True


@kernel
def _hull_in(
    carried: Any,
    other: Any,
    toward: Three,
    side: float,
    meshes: Any,
    vertices: Array,
    corners: Indices,
    boxes: Array,
    hulls: Array,
    room: Any,
    count: int,
) -> int:
    """Add the corners of a carried mesh's hull that are in another shape.

    Args:
        carried: SOLID of the mesh.
        other: SOLID of the other shape.
        toward: Direction out of it in which its faces look that count; ANYWHERE: all of a mesh.
        side: 1: `other` is the second of the pair, the normals point out of it; -1: it is the first, they point in.
        meshes: MeshTable.rows.
        vertices: MeshTable.vertices.
        corners: MeshTable.corners.
        boxes: MeshTable.boxes.
        hulls: MeshTable.hulls.
        room: SCRATCH.
        count: Points so far.
    """
    mesh, place, reach = meshes[carried.mesh], middle(carried), _thinnest(carried)
    for i in range(mesh.first_hull, mesh.first_hull + mesh.hull_corners):
        p = along(place, 1.0, out_of(carried, (hulls[i, 0], hulls[i, 1], hulls[i, 2])))
        if other.kind == _WALL:
            n = axis(other, 2)
            depth = dot(minus(middle(other), p), n)
        elif other.kind == _MESH:
            depth, n = depth_in_mesh(other, p, 0.0, reach, toward, meshes, vertices, corners, boxes, room)
        elif not _is_within(p, other):
            continue
        elif toward == ANYWHERE:
            far, n = distance_to(other, p, toward)
            depth = -far
        else:
            depth, n = depth_under(other, p, toward)
        if depth > 0.0:
            count = _keep(along(p, 0.5 * depth, n), depth, times(side, n), room, count)
    return count


@kernel
def _gather(
    a: Any,
    b: Any,
    n: Three,
    meshes: Any,
    vertices: Array,
    corners: Indices,
    boxes: Array,
    hulls: Array,
    room: Any,
) -> tuple[int, float]:
    """Points of both in each other whose faces look along the normal n from a to b, and the sum of their depths."""
    count, out = 0, times(-1.0, n)
    if a.kind == _MESH:
        count = _hull_in(a, b, out, 1.0, meshes, vertices, corners, boxes, hulls, room, 0)
    else:
        count, _ = points_in_mesh(a, b, out, meshes, vertices, corners, boxes, room)
    if b.kind == _MESH and a.kind != _SPHERE:  # a ball is exact by its middle
        count = _hull_in(b, a, n, -1.0, meshes, vertices, corners, boxes, hulls, room, count)
    total = 0.0
    for k in range(count):
        total += room.points[k, 3]
    return count, total


@kernel
def _least_overlap(a: Any, b: Any) -> Three:
    """The world axis along which the bounds of two shapes overlap least, from a to b."""
    least, n = math.inf, (0.0, 0.0, 0.0)
    for k in range(3):
        upward, downward = a.high[k] - b.low[k], b.high[k] - a.low[k]
        if min(upward, downward) < least:
            least = min(upward, downward)
            sign = 1.0 if upward < downward else -1.0
            n = (sign if k == 0 else 0.0, sign if k == 1 else 0.0, sign if k == 2 else 0.0)
    return n


@kernel
def _share_out(count: int, room: Any) -> None:
    """Spread the stiffness over the points by their depth; none gets more than it came with."""
    points, total = room.points, 0.0
    for k in range(count):
        total += points[k, 3]
    for k in range(count):
        points[k, 4] = min(points[k, 4], points[k, 3] / total) if total > 0.0 else 0.0


@kernel
def touch_carried_mesh(
    a: Any,
    b: Any,
    last: Three,
    meshes: Any,
    vertices: Array,
    corners: Indices,
    boxes: Array,
    hulls: Array,
    room: Any,
) -> tuple[int, Three]:
    """Contact points of a pair of which one is a mesh that a body carries, the other anything.

    The faces that count are those which look along the normal of the contact. A new contact takes the deeper of two:
    the nearest faces of all points, or those along the axis on which the two overlap least. Equal blocks that stand on
    each other, corner upon corner, have no nearest face that means anything; in a hollow the bounds mean nothing.

    Args:
        a: SOLID of any shape but a wall.
        b: SOLID of a wall or a mesh; one of the two is a carried mesh.
        last: Normal of the last tick from a to b while they touch, else zero.
        meshes: MeshTable.rows.
        vertices: MeshTable.vertices.
        corners: MeshTable.corners.
        boxes: MeshTable.boxes.
        hulls: MeshTable.hulls.
        room: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    if b.kind != _WALL and last == ANYWHERE:
        last = _least_overlap(a, b)
        _, along_axis = _gather(a, b, last, meshes, vertices, corners, boxes, hulls, room)
        _, nearest = _gather(a, b, ANYWHERE, meshes, vertices, corners, boxes, hulls, room)
        if nearest >= along_axis:
            last = ANYWHERE
    count, _ = _gather(a, b, last, meshes, vertices, corners, boxes, hulls, room)
    if count == 0:
        return 0, last
    mean, normals = (0.0, 0.0, 0.0), room.normals
    for k in range(count):
        mean = along(mean, room.points[k, 3], (normals[k, 0], normals[k, 1], normals[k, 2]))
    up = unit(mean, times(-1.0, last))
    project_depths(up, count, room)
    _share_out(count, room)
    return count, times(-1.0, up)
