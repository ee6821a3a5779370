"""Contact of a mesh carried by a body with any shape: samples of each shape in the other, and crossed edges.

Both directions are tested: a small box on a large mesh has its own corners in it, a small mesh on a large box only
those of the mesh. Vertices inside the convex hull never touch a flat face, so those of the hull are tested: by their
height above a wall, the signed distance of another shape, or the closest triangle of another mesh. Sharp edges that
pass through the other shape between their ends are tested by `collisions_edges`.

A point has the share d / (sum of all d) of the stiffness, limited as elsewhere: a corner to a quarter, an end of a
capsule to a half, a sphere to the whole. So a mesh at rest has its whole stiffness at any resolution, on a corner a
quarter like a box, and a point that begins to touch causes no step. Two meshes with edges find each crossing twice,
once from each side, with half a quarter each.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import along, minus, times, unit
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.collisions_edges import chord_in, deepest_between, may_pass
from mimics_app.rendering.haptic.kernels.objects.collisions_mesh import depth_in_mesh, points_in_mesh, project_depths
from mimics_app.rendering.haptic.kernels.objects.distances import depth_under, distance_to
from mimics_app.rendering.haptic.kernels.objects.manifold import CORNER_SHARE
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANY_DIRECTION
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of, to_world

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import MeshTable, ScratchRecord, SolidRecord

__all__ = ["Target", "depth_of", "edge_in", "keep_point", "touch_carried_mesh"]


_LEVEL = 0.05
"""Sine of the angle between an edge and a face from which their crossing begins to count [-]; fully at twice that."""

_ASIDE = 1e-3
"""Largest distance of a corner beside the bounds of a shape at which its edge supports it [m]; see `depth_under`."""


class Target(NamedTuple):
    """Shape in which points and edges of the other shape of a pair are searched.

    Attributes:
        solid: SOLID of the shape.
        toward: Direction that its faces must face; ANY_DIRECTION: all faces count for a point, none for the ends of
            a chord.
        side: 1: it is the second of the pair, the normals point out of it; -1: it is the first, they point in.
    """

    solid: SolidRecord
    toward: Vec3
    side: float


@kernel
def keep_point(p: Vec3, depth: float, n: Vec3, share: float, scratch: ScratchRecord, count: int) -> int:
    """Add a point with its normal; in a full table it replaces the shallowest. Return the number of points."""
    points, normals = scratch.points, scratch.normals
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
    """Smallest extent of a bounded shape along the world's axes [m]."""
    least = math.inf
    for k in range(3):
        least = min(least, solid.high[k] - solid.low[k])
    return least


@kernel
def _is_within(p: Vec3, solid: SolidRecord) -> bool:
    """True for a point within the bounds of a bounded shape, enlarged by `_ASIDE`."""
    for k in range(3):
        if p[k] < solid.low[k] - _ASIDE or p[k] > solid.high[k] + _ASIDE:
            return False
    return True


@kernel
def depth_of(p: Vec3, target: Target, reach: float, table: MeshTable, scratch: ScratchRecord) -> tuple[float, Vec3]:
    """Depth of a point in a target by the faces that count, <= 0 outside, and their outward normal."""
    other, toward = target.solid, target.toward
    if other.kind == ShapeKind.WALL:
        n = axis(other, 2)
        return dot(minus(position_of(other), p), n), n
    if other.kind == ShapeKind.MESH:
        return depth_in_mesh(other, p, 0.0, reach, toward, table, scratch)
    if not _is_within(p, other):
        return 0.0, toward
    if toward == ANY_DIRECTION:
        far, n = distance_to(other, p, toward)
        return -far, n
    return depth_under(other, p, toward)


@kernel
def _corners_in(carried: SolidRecord, target: Target, table: MeshTable, scratch: ScratchRecord, count: int) -> int:
    """Add the vertices of a carried mesh's hull that are inside another shape; return the number of points.

    Args:
        carried: SOLID of the mesh.
        target: The other shape.
        table: MeshTable.
        scratch: SCRATCH.
        count: Number of points so far.
    """
    mesh, place, reach = table.rows[carried.mesh], position_of(carried), _thinnest(carried)
    for i in range(mesh.first_hull, mesh.first_hull + mesh.hull_corners):
        p = along(place, 1.0, to_world(carried, (table.hulls[i, 0], table.hulls[i, 1], table.hulls[i, 2])))
        depth, n = depth_of(p, target, reach, table, scratch)
        if depth > 0.0:
            count = keep_point(along(p, 0.5 * depth, n), depth, times(target.side, n), CORNER_SHARE, scratch, count)
    return count


@kernel
def _weight(n: Vec3, direction: Vec3, from_corner: float) -> float:
    """Weight 0-1 of the end of a chord as a contact point.

    It is 0 where the edge is nearly parallel to the face, as their crossing is ill-defined, and near the vertex of the
    edge, which is a contact point itself.

    Args:
        n: Normal of the face.
        direction: Vector of the whole edge [m].
        from_corner: Share of the edge between the end of the chord and the vertex outside.
    """
    length = math.sqrt(dot(direction, direction))
    steep = abs(dot(n, direction)) / (_LEVEL * length) - 1.0
    clear = from_corner * length / _ASIDE - 1.0
    return min(max(min(steep, clear), 0.0), 1.0)


@kernel
def edge_in(
    p: Vec3,
    q: Vec3,
    target: Target,
    share: float,
    reach: float,
    table: MeshTable,
    scratch: ScratchRecord,
    count: int,
) -> int:
    """Add the contacts of one edge with another shape: between two faces, and the ends of its chord under other faces.

    Args:
        p: Start of the edge, world [m].
        q: End of the edge [m].
        target: The other shape.
        share: Largest share of the stiffness of a point.
        reach: Largest depth of an end of the chord in a mesh [m].
        table: MeshTable.
        scratch: SCRATCH.
        count: Number of points so far.

    Returns:
        Number of points.
    """
    other, toward, side = target.solid, target.toward, target.side
    chord = chord_in(other, p, q, table, scratch)
    found, t0, t1, n0, n1 = chord
    if not found:
        return count
    direction = minus(q, p)
    if n0 != ANY_DIRECTION and n1 != ANY_DIRECTION:
        depth, n, at = deepest_between(other, p, q, chord, toward, table, scratch)
        if depth > 0.0:
            count = keep_point(along(at, 0.5 * depth, n), depth, times(side, n), share, scratch, count)
    if toward == ANY_DIRECTION:
        return count
    for k in range(2):
        t, face, outside = (t0, n0, t0) if k == 0 else (t1, n1, 1.0 - t1)
        weight = _weight(face, direction, outside)
        if weight > 0.0:
            at = along(p, t, direction)
            depth, n = depth_of(at, target, reach, table, scratch)
            if depth > 0.0:
                count = keep_point(along(at, 0.5 * depth, n), weight * depth, times(side, n), share, scratch, count)
    return count


@kernel
def _edges_in(carried: SolidRecord, target: Target, table: MeshTable, scratch: ScratchRecord, count: int) -> int:
    """Add the contacts of a carried mesh's sharp edges with another shape; arguments as `_corners_in`."""
    other = target.solid
    if other.kind == ShapeKind.WALL or other.kind == ShapeKind.SPHERE:  # corners, and the sphere's centre, suffice
        return count
    mesh, place, reach, edges = table.rows[carried.mesh], position_of(carried), _thinnest(carried), table.edges
    meets_twice = other.kind == ShapeKind.MESH and table.rows[other.mesh].edges > 0
    share = 0.5 * CORNER_SHARE if meets_twice else CORNER_SHARE
    for i in range(mesh.first_edge, mesh.first_edge + mesh.edges):
        p = along(place, 1.0, to_world(carried, (edges[i, 0], edges[i, 1], edges[i, 2])))
        q = along(place, 1.0, to_world(carried, (edges[i, 3], edges[i, 4], edges[i, 5])))
        if may_pass(p, q, other):
            count = edge_in(p, q, target, share, reach, table, scratch, count)
    return count


@kernel
def _gather(a: SolidRecord, b: SolidRecord, n: Vec3, table: MeshTable, scratch: ScratchRecord) -> tuple[int, float]:
    """(number of points of either shape in the other, by faces that face the normal n from a to b; sum of depths)."""
    count, out = 0, times(-1.0, n)
    if a.kind == ShapeKind.MESH:
        count = _corners_in(a, Target(b, out, 1.0), table, scratch, 0)
        count = _edges_in(a, Target(b, out, 1.0), table, scratch, count)
    else:
        count, _ = points_in_mesh(a, b, out, table, scratch)
    if b.kind == ShapeKind.MESH and a.kind != ShapeKind.SPHERE:  # a sphere is exact by its centre
        count = _corners_in(b, Target(a, n, -1.0), table, scratch, count)
        count = _edges_in(b, Target(a, n, -1.0), table, scratch, count)
    total = 0.0
    for k in range(count):
        total += scratch.points[k, 3]
    return count, total


@kernel
def _least_overlap(a: SolidRecord, b: SolidRecord) -> Vec3:
    """World axis of least overlap of the bounds of two shapes, from a to b."""
    least, n = math.inf, (0.0, 0.0, 0.0)
    for k in range(3):
        upward, downward = a.high[k] - b.low[k], b.high[k] - a.low[k]
        if min(upward, downward) < least:
            least = min(upward, downward)
            sign = 1.0 if upward < downward else -1.0
            n = (sign if k == 0 else 0.0, sign if k == 1 else 0.0, sign if k == 2 else 0.0)
    return n


@kernel
def _share_out(count: int, scratch: ScratchRecord) -> None:
    """Distribute the stiffness over the points by their depth, within their own shares."""
    points, total = scratch.points, 0.0
    for k in range(count):
        total += points[k, 3]
    for k in range(count):
        points[k, 4] = min(points[k, 4], points[k, 3] / total) if total > 0.0 else 0.0


@kernel
def touch_carried_mesh(
    a: SolidRecord, b: SolidRecord, last: Vec3, table: MeshTable, scratch: ScratchRecord
) -> tuple[int, Vec3]:
    """Contact points of a pair of which one is a mesh carried by a body, the other any shape.

    The faces that face the normal of the contact count. A new contact takes the deeper of two alternatives: the nearest
    faces of all points, or those along the axis of least overlap. For equal blocks stacked corner on corner the nearest
    faces are ambiguous; in a hollow the bounds are misleading.

    Args:
        a: SOLID of any shape but a wall.
        b: SOLID of a wall or a mesh; one of the two is a carried mesh.
        last: Normal of the last tick from a to b while they touch, else zero.
        table: MeshTable.
        scratch: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    if b.kind != ShapeKind.WALL and last == ANY_DIRECTION:
        last = _least_overlap(a, b)
        _, along_axis = _gather(a, b, last, table, scratch)
        _, nearest = _gather(a, b, ANY_DIRECTION, table, scratch)
        if nearest >= along_axis:
            last = ANY_DIRECTION
    count, _ = _gather(a, b, last, table, scratch)
    if count == 0:
        return 0, last
    mean, normals = (0.0, 0.0, 0.0), scratch.normals
    for k in range(count):
        mean = along(mean, scratch.points[k, 3], (normals[k, 0], normals[k, 1], normals[k, 2]))
    up = unit(mean, times(-1.0, last))
    project_depths(up, count, scratch)
    _share_out(count, scratch)
    return count, times(-1.0, up)
