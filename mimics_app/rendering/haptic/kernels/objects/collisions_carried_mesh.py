"""A mesh that a body carries, against everything: what of the other is in it, its corners and edges in the other.

Both ways are looked at, for a small box on a large mesh has its own corners in it, and a small mesh on a large box
only those of the mesh. Corners that no hull needs never meet anything flat, so those of the convex hull are tried: by
their height over a wall, the signed distance of another shape, the closest triangle of another mesh. Sharp edges that
pass through the other shape between their corners are met by `collisions_edges`.

A point carries the share d / (sum of all d) of the stiffness, but no more than its kind carries elsewhere: a corner a
quarter, an end of a capsule a half, a ball the whole. So a mesh that stands has its whole stiffness however fine it is,
on a corner a quarter as a box has, and a point that dips in brings no step. Two meshes that both have edges meet each
crossing twice, once from each side, with half a quarter each.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.collisions_edges import chord_in, deepest_between, may_pass
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

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import MeshTable, ScratchRecord, SolidRecord

__all__ = ["CORNER_SHARE", "depth_of", "edge_in", "keep_point", "touch_carried_mesh"]


CORNER_SHARE = 0.25
"""Most of the stiffness that one corner of a hull carries."""

_LEVEL = 0.05
"""Sine of the angle between an edge and a face from which on the place where it passes through counts in full."""

_ASIDE = 1e-3
"""Most that a corner may stand beside the bounds of a shape and still be held by an edge [m]; see `depth_under`."""


@kernel
def keep_point(p: Three, depth: float, n: Three, share: float, room: ScratchRecord, count: int) -> int:
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
    points[at, 3], points[at, 4] = depth, share
    normals[at, 0], normals[at, 1], normals[at, 2] = n
    return max(count, at + 1)


@kernel
def _thinnest(solid: SolidRecord) -> float:
    """Least extent of a shape with bounds along the world's axes [m]."""
    least = math.inf
    for k in range(3):
        least = min(least, solid.high[k] - solid.low[k])
    return least


@kernel
def _is_within(p: Three, solid: SolidRecord) -> bool:
    """True for a point within the bounds of a shape that has some, or no farther out than a corner may stand aside."""
    for k in range(3):
        if p[k] < solid.low[k] - _ASIDE or p[k] > solid.high[k] + _ASIDE:
            return False
    return True


@kernel
def depth_of(
    p: Three, other: SolidRecord, toward: Three, reach: float, table: MeshTable, room: ScratchRecord
) -> tuple[float, Three]:
    """Depth of a point in a shape by the faces that look along `toward`, 0 or less outside; normal out of them."""
    if other.kind == ShapeKind.WALL:
        n = axis(other, 2)
        return dot(minus(middle(other), p), n), n
    if other.kind == ShapeKind.MESH:
        return depth_in_mesh(
            other, p, 0.0, reach, toward, table.rows, table.vertices, table.corners, table.boxes, room
        )  # fmt: skip
    if not _is_within(p, other):
        return 0.0, toward
    if toward == ANYWHERE:
        far, n = distance_to(other, p, toward)
        return -far, n
    return depth_under(other, p, toward)


@kernel
def _corners_in(
    carried: SolidRecord,
    other: SolidRecord,
    toward: Three,
    side: float,
    table: MeshTable,
    room: ScratchRecord,
    count: int,
) -> int:
    """Add the corners of a carried mesh's hull that are in another shape.

    Args:
        carried: SOLID of the mesh.
        other: SOLID of the other shape.
        toward: Direction out of it in which its faces look that count; ANYWHERE: all of a mesh.
        side: 1: `other` is the second of the pair, the normals point out of it; -1: it is the first, they point in.
        table: MeshTable.
        room: SCRATCH.
        count: Points so far.
    """
    mesh, place, reach = table.rows[carried.mesh], middle(carried), _thinnest(carried)
    for i in range(mesh.first_hull, mesh.first_hull + mesh.hull_corners):
        p = along(place, 1.0, out_of(carried, (table.hulls[i, 0], table.hulls[i, 1], table.hulls[i, 2])))
        depth, n = depth_of(p, other, toward, reach, table, room)
        if depth > 0.0:
            count = keep_point(along(p, 0.5 * depth, n), depth, times(side, n), CORNER_SHARE, room, count)
    return count


@kernel
def _weight(n: Three, direction: Three, from_corner: float) -> float:
    """How much the end of a chord counts, 0 to 1.

    Nothing where the edge lies in the face, whose crossing then is anywhere, nor at the edge's own corner, which counts
    itself and may stand a little aside.

    Args:
        n: Normal of the face.
        direction: Of the whole edge, as long as it [m].
        from_corner: Share of it from the end of the chord to the corner outside.
    """
    length = math.sqrt(dot(direction, direction))
    steep = abs(dot(n, direction)) / (_LEVEL * length) - 1.0
    clear = from_corner * length / _ASIDE - 1.0
    return min(max(min(steep, clear), 0.0), 1.0)


@kernel
def edge_in(
    p: Three,
    q: Three,
    other: SolidRecord,
    toward: Three,
    side: float,
    share: float,
    reach: float,
    table: MeshTable,
    room: ScratchRecord,
    count: int,
) -> int:
    """Add what of one edge is in another shape: between its two faces, and the ends of its chord under others."""
    chord = chord_in(other, p, q, table, room)
    found, t0, t1, n0, n1 = chord
    if not found:
        return count
    direction = minus(q, p)
    if n0 != ANYWHERE and n1 != ANYWHERE:
        depth, n, at = deepest_between(other, p, q, chord, toward, table, room)
        if depth > 0.0:
            count = keep_point(along(at, 0.5 * depth, n), depth, times(side, n), share, room, count)
    if toward == ANYWHERE:
        return count
    for k in range(2):
        t, face, outside = (t0, n0, t0) if k == 0 else (t1, n1, 1.0 - t1)
        weight = _weight(face, direction, outside)
        if weight > 0.0:
            at = along(p, t, direction)
            depth, n = depth_of(at, other, toward, reach, table, room)
            if depth > 0.0:
                count = keep_point(along(at, 0.5 * depth, n), weight * depth, times(side, n), share, room, count)
    return count


@kernel
def _edges_in(
    carried: SolidRecord,
    other: SolidRecord,
    toward: Three,
    side: float,
    table: MeshTable,
    room: ScratchRecord,
    count: int,
) -> int:
    """Add what of the sharp edges of a carried mesh is in another shape; arguments as `_corners_in`."""
    if other.kind == ShapeKind.WALL or other.kind == ShapeKind.SPHERE:  # their corners and middle say all
        return count
    mesh, place, reach, edges = table.rows[carried.mesh], middle(carried), _thinnest(carried), table.edges
    meets_twice = other.kind == ShapeKind.MESH and table.rows[other.mesh].edges > 0
    share = 0.5 * CORNER_SHARE if meets_twice else CORNER_SHARE
    for i in range(mesh.first_edge, mesh.first_edge + mesh.edges):
        p = along(place, 1.0, out_of(carried, (edges[i, 0], edges[i, 1], edges[i, 2])))
        q = along(place, 1.0, out_of(carried, (edges[i, 3], edges[i, 4], edges[i, 5])))
        if may_pass(p, q, other):
            count = edge_in(p, q, other, toward, side, share, reach, table, room, count)
    return count


@kernel
def _gather(a: SolidRecord, b: SolidRecord, n: Three, table: MeshTable, room: ScratchRecord) -> tuple[int, float]:
    """Points of both in each other whose faces look along the normal n from a to b, and the sum of their depths."""
    count, out = 0, times(-1.0, n)
    if a.kind == ShapeKind.MESH:
        count = _corners_in(a, b, out, 1.0, table, room, 0)
        count = _edges_in(a, b, out, 1.0, table, room, count)
    else:
        count, _ = points_in_mesh(a, b, out, table.rows, table.vertices, table.corners, table.boxes, room)
    if b.kind == ShapeKind.MESH and a.kind != ShapeKind.SPHERE:  # a ball is exact by its middle
        count = _corners_in(b, a, n, -1.0, table, room, count)
        count = _edges_in(b, a, n, -1.0, table, room, count)
    total = 0.0
    for k in range(count):
        total += room.points[k, 3]
    return count, total


@kernel
def _least_overlap(a: SolidRecord, b: SolidRecord) -> Three:
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
def _share_out(count: int, room: ScratchRecord) -> None:
    """Spread the stiffness over the points by their depth; none gets more than it came with."""
    points, total = room.points, 0.0
    for k in range(count):
        total += points[k, 3]
    for k in range(count):
        points[k, 4] = min(points[k, 4], points[k, 3] / total) if total > 0.0 else 0.0


@kernel
def touch_carried_mesh(
    a: SolidRecord, b: SolidRecord, last: Three, table: MeshTable, room: ScratchRecord
) -> tuple[int, Three]:
    """Contact points of a pair of which one is a mesh that a body carries, the other anything.

    The faces that count are those which look along the normal of the contact. A new contact takes the deeper of two:
    the nearest faces of all points, or those along the axis on which the two overlap least. Equal blocks that stand on
    each other, corner upon corner, have no nearest face that means anything; in a hollow the bounds mean nothing.

    Args:
        a: SOLID of any shape but a wall.
        b: SOLID of a wall or a mesh; one of the two is a carried mesh.
        last: Normal of the last tick from a to b while they touch, else zero.
        table: MeshTable.
        room: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    if b.kind != ShapeKind.WALL and last == ANYWHERE:
        last = _least_overlap(a, b)
        _, along_axis = _gather(a, b, last, table, room)
        _, nearest = _gather(a, b, ANYWHERE, table, room)
        if nearest >= along_axis:
            last = ANYWHERE
    count, _ = _gather(a, b, last, table, room)
    if count == 0:
        return 0, last
    mean, normals = (0.0, 0.0, 0.0), room.normals
    for k in range(count):
        mean = along(mean, room.points[k, 3], (normals[k, 0], normals[k, 1], normals[k, 2]))
    up = unit(mean, times(-1.0, last))
    project_depths(up, count, room)
    _share_out(count, room)
    return count, times(-1.0, up)
