"""A body against a triangle mesh of the static scene: its ends and corners, each at its closest triangle.

A sphere is tested by its middle, a capsule by those of its ends, a box by its corners, a cylinder by points of its
rims. What of the mesh pokes into a face between them is seen where it has ridges (`collisions_ridges`): a mesh without
any must be coarse beside the bodies that rest on it. All points of a contact push along one normal, the mean of theirs
by depth.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.manifold import add_point
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import (
    ANYWHERE,
    closest_on_triangle,
    closest_triangle,
    triangle_normal,
)
from mimics_app.rendering.haptic.kernels.objects.triples import (
    Three,
    along,
    axis,
    dot,
    into,
    middle,
    minus,
    out_of,
    times,
    unit,
)

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import MeshRecord, ScratchRecord, SolidRecord, Table

__all__ = ["depth_in_mesh", "points_in_mesh", "project_depths", "touch_mesh"]


_RIM = 8

_UNDER = 0.5
"""Cosine between the direction to a face and its normal from which a point is under it and not beside it."""

_DEEPEST = 0.5
"""How deep a corner is looked for behind the surface, as a share of the shape's thinnest side: beyond it is through."""


_OF_A_CORNER = 0.25
"""Share of a face's stiffness that each of its four corners has [-]."""

_CORNERS = 8
"""Of a box."""


@kernel
def _samples(solid: SolidRecord) -> tuple[int, float, float, float]:
    """(points, their radius [m], share of the stiffness of each, how far behind the surface they are seen [m])."""
    size = solid.size
    if solid.kind == ShapeKind.SPHERE:
        return 1, size[0], 1.0, size[0]
    if solid.kind == ShapeKind.CAPSULE:
        return 2, size[0], 0.5, size[0]
    if solid.kind == ShapeKind.BOX:
        return _CORNERS, 0.0, _OF_A_CORNER, _DEEPEST * min(size[0], min(size[1], size[2]))
    return 2 * _RIM, 0.0, 1.0 / _RIM, _DEEPEST * min(2.0 * size[0], size[1])


@kernel
def _sample(solid: SolidRecord, k: int) -> Three:
    """Point k of a shape, world [m]."""
    size, p = solid.size, middle(solid)
    if solid.kind == ShapeKind.SPHERE:
        return p
    if solid.kind == ShapeKind.BOX:
        for j in range(3):
            p = along(p, 0.5 * size[j] if k & (1 << j) else -0.5 * size[j], axis(solid, j))
        return p
    p = along(p, 0.5 * size[1] if k % 2 == 1 else -0.5 * size[1], axis(solid, 1))
    if solid.kind == ShapeKind.CAPSULE:
        return p
    angle = 2.0 * math.pi * (k // 2) / _RIM
    p = along(p, size[0] * math.cos(angle), axis(solid, 0))
    return along(p, size[0] * math.sin(angle), axis(solid, 2))


@kernel
def depth_in_mesh(
    b: SolidRecord,
    p: Three,
    radius: float,
    reach: float,
    toward: Three,
    meshes: Table[MeshRecord],
    vertices: F8,
    corners: I4,
    boxes: F8,
    room: ScratchRecord,
) -> tuple[float, Three]:
    """Depth of a ball in a mesh [m], 0 where it does not touch, and the outward normal there, world.

    Args:
        b: SOLID of the mesh.
        p: Middle of the ball, world [m].
        radius: Of the ball [m].
        reach: How far from the surface its middle is seen [m].
        toward: Only faces of the mesh that look along this direction count, or all with ANYWHERE.
        meshes: MeshTable.rows.
        vertices: MeshTable.vertices.
        corners: MeshTable.corners.
        boxes: MeshTable.boxes.
        room: SCRATCH.
    """
    q, closest, n = room.mesh_point, room.mesh_closest, room.mesh_normal
    local = into(b, minus(p, middle(b)))
    q[0], q[1], q[2] = local
    t = closest_triangle(meshes[b.mesh], vertices, corners, boxes, q, reach, into(b, toward), closest)
    if t < 0:
        return 0.0, local
    closest_on_triangle(vertices, corners, t, q, closest)
    size = triangle_normal(vertices, corners, t, n)
    out = (n[0] / size, n[1] / size, n[2] / size)
    offset = minus(local, (closest[0], closest[1], closest[2]))
    far = math.sqrt(dot(offset, offset))
    if dot(offset, out) < 0.0:
        if toward != ANYWHERE and -dot(offset, out) < _UNDER * far:
            return 0.0, local
        return radius + far, out_of(b, unit(times(-1.0, offset), out))
    if far >= radius:
        return 0.0, local
    return radius - far, out_of(b, unit(offset, out))


@kernel
def project_depths(up: Three, count: int, room: ScratchRecord) -> None:
    """Depths of points along one normal for all of them, from those along their own in `room.normals`."""
    normals = room.normals
    for k in range(count):
        room.points[k, 3] *= max(0.0, dot(up, (normals[k, 0], normals[k, 1], normals[k, 2])))


@kernel
def points_in_mesh(
    a: SolidRecord,
    b: SolidRecord,
    toward: Three,
    meshes: Table[MeshRecord],
    vertices: F8,
    corners: I4,
    boxes: F8,
    room: ScratchRecord,
) -> tuple[int, Three]:
    """What of shape a is inside a mesh; arguments as `touch_mesh` and `depth_in_mesh`, but balls look anywhere.

    Returns:
        (points, sum of the mesh's outward normals there by depth); `room.normals` receives the normals.
    """
    count, mean = 0, (0.0, 0.0, 0.0)
    samples, radius, share, reach = _samples(a)
    normals, offset = room.normals, toward if radius == 0.0 else ANYWHERE
    for k in range(samples):
        p = _sample(a, k)
        depth, n = depth_in_mesh(b, p, radius, reach, offset, meshes, vertices, corners, boxes, room)
        if depth > 0.0:
            normals[count, 0], normals[count, 1], normals[count, 2] = n
            mean = along(mean, depth, n)
            count = add_point(room.points, count, along(p, 0.5 * depth - radius, n), depth, share)
    return count, mean


@kernel
def touch_mesh(
    a: SolidRecord,
    b: SolidRecord,
    last: Three,
    meshes: Table[MeshRecord],
    vertices: F8,
    corners: I4,
    boxes: F8,
    room: ScratchRecord,
) -> tuple[int, Three]:
    """Contact points of shape a at a mesh of the static scene.

    Args:
        a: SOLID of a sphere, box, cylinder or capsule.
        b: SOLID of the mesh.
        last: Normal of the last tick from a to b; kept where nothing touches.
        meshes: MeshTable.rows.
        vertices: MeshTable.vertices.
        corners: MeshTable.corners.
        boxes: MeshTable.boxes.
        room: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    count, mean = points_in_mesh(a, b, ANYWHERE, meshes, vertices, corners, boxes, room)
    if count == 0:
        return 0, last
    up = unit(mean, (0.0, 1.0, 0.0))
    project_depths(up, count, room)
    return count, times(-1.0, up)
