"""Contact of a body with a triangle mesh of the static scene: sample points of the body, each at its closest triangle.

Samples are the centre of a sphere, the end centres of a capsule, the corners of a box, points of a cylinder's rims.
Parts of the mesh that enter a face between them are found where it has ridges (`collisions_ridges`): a mesh without
ridges must be coarse compared with the bodies that rest on it. All points of a contact push along one normal, the mean
of theirs weighted by depth.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import along, minus, times, unit
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.manifold import CORNER_SHARE, RIM_POINTS, add_point
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import (
    ANY_DIRECTION,
    closest_on_triangle,
    closest_triangle,
    triangle_normal,
)
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of, to_local, to_world

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import MeshTable, ScratchRecord, SolidRecord

__all__ = ["depth_in_mesh", "points_in_mesh", "project_depths", "touch_mesh"]


_UNDER = 0.5
"""Cosine between the direction to a face and its normal from which a point counts as under the face [-]."""

_DEEPEST = 0.5
"""Largest depth of a sample behind the surface, relative to the shape's thinnest side [-]."""

_CORNERS = 8
"""Corners of a box."""


@kernel
def _samples(solid: SolidRecord) -> tuple[int, float, float, float]:
    """(number of samples, their radius [m], share of the stiffness of each, largest depth behind the surface [m])."""
    size = solid.size
    if solid.kind == ShapeKind.SPHERE:
        return 1, size[0], 1.0, size[0]
    if solid.kind == ShapeKind.CAPSULE:
        return 2, size[0], 0.5, size[0]
    if solid.kind == ShapeKind.BOX:
        return _CORNERS, 0.0, CORNER_SHARE, _DEEPEST * min(size[0], min(size[1], size[2]))
    return 2 * RIM_POINTS, 0.0, 1.0 / RIM_POINTS, _DEEPEST * min(2.0 * size[0], size[1])


@kernel
def _sample(solid: SolidRecord, k: int) -> Vec3:
    """Sample k of a shape, world [m]."""
    size, p = solid.size, position_of(solid)
    if solid.kind == ShapeKind.SPHERE:
        return p
    if solid.kind == ShapeKind.BOX:
        for j in range(3):
            p = along(p, 0.5 * size[j] if k & (1 << j) else -0.5 * size[j], axis(solid, j))
        return p
    p = along(p, 0.5 * size[1] if k % 2 == 1 else -0.5 * size[1], axis(solid, 1))
    if solid.kind == ShapeKind.CAPSULE:
        return p
    angle = 2.0 * math.pi * (k // 2) / RIM_POINTS
    p = along(p, size[0] * math.cos(angle), axis(solid, 0))
    return along(p, size[0] * math.sin(angle), axis(solid, 2))


@kernel
def depth_in_mesh(
    b: SolidRecord,
    p: Vec3,
    radius: float,
    reach: float,
    toward: Vec3,
    table: MeshTable,
    scratch: ScratchRecord,
) -> tuple[float, Vec3]:
    """Depth of a ball in a mesh [m], 0 where it does not touch, and the outward normal there, world.

    Args:
        b: SOLID of the mesh.
        p: Centre of the ball, world [m].
        radius: Radius of the ball [m].
        reach: Largest distance of its centre from the surface [m].
        toward: Only faces of the mesh that face this direction count, or all with ANY_DIRECTION.
        table: MeshTable.
        scratch: SCRATCH.
    """
    mesh, vertices, corners = table.rows[b.mesh], table.vertices, table.corners
    q, closest, n = scratch.mesh_point, scratch.mesh_closest, scratch.mesh_normal
    local = to_local(b, minus(p, position_of(b)))
    q[0], q[1], q[2] = local
    t = closest_triangle(mesh, vertices, corners, table.boxes, q, reach, to_local(b, toward), closest)
    if t < 0:
        return 0.0, local
    closest_on_triangle(vertices, corners, t, q, closest)
    size = triangle_normal(vertices, corners, t, n)
    out = (n[0] / size, n[1] / size, n[2] / size)
    offset = minus(local, (closest[0], closest[1], closest[2]))
    far = math.sqrt(dot(offset, offset))
    if dot(offset, out) < 0.0:
        if toward != ANY_DIRECTION and -dot(offset, out) < _UNDER * far:
            return 0.0, local
        return radius + far, to_world(b, unit(times(-1.0, offset), out))
    if far >= radius:
        return 0.0, local
    return radius - far, to_world(b, unit(offset, out))


@kernel
def project_depths(up: Vec3, count: int, scratch: ScratchRecord) -> None:
    """Project the depths of all points from their own normals in `scratch.normals` to the common normal `up`."""
    normals = scratch.normals
    for k in range(count):
        scratch.points[k, 3] *= max(0.0, dot(up, (normals[k, 0], normals[k, 1], normals[k, 2])))


@kernel
def points_in_mesh(
    a: SolidRecord,
    b: SolidRecord,
    toward: Vec3,
    table: MeshTable,
    scratch: ScratchRecord,
) -> tuple[int, Vec3]:
    """Find the samples of shape a in a mesh; arguments as `touch_mesh` and `depth_in_mesh`, but balls meet all faces.

    Returns:
        (points, sum of the mesh's outward normals there weighted by depth); `scratch.normals` receives the normals.
    """
    count, mean = 0, (0.0, 0.0, 0.0)
    samples, radius, share, reach = _samples(a)
    normals, offset = scratch.normals, toward if radius == 0.0 else ANY_DIRECTION
    for k in range(samples):
        p = _sample(a, k)
        depth, n = depth_in_mesh(b, p, radius, reach, offset, table, scratch)
        if depth > 0.0:
            normals[count, 0], normals[count, 1], normals[count, 2] = n
            mean = along(mean, depth, n)
            count = add_point(scratch.points, count, along(p, 0.5 * depth - radius, n), depth, share)
    return count, mean


@kernel
def touch_mesh(
    a: SolidRecord,
    b: SolidRecord,
    last: Vec3,
    table: MeshTable,
    scratch: ScratchRecord,
) -> tuple[int, Vec3]:
    """Contact points of shape a at a mesh of the static scene.

    Args:
        a: SOLID of a sphere, box, cylinder or capsule.
        b: SOLID of the mesh.
        last: Normal of the last tick from a to b; returned where nothing touches.
        table: MeshTable.
        scratch: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    count, mean = points_in_mesh(a, b, ANY_DIRECTION, table, scratch)
    if count == 0:
        return 0, last
    up = unit(mean, (0.0, 1.0, 0.0))
    project_depths(up, count, scratch)
    return count, times(-1.0, up)
