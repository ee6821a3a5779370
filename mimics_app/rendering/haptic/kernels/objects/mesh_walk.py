"""Contact of a point with a triangle mesh by a proxy (god-object: Zilles & Salisbury 1995) on the surface.

The proxy is the point of the surface with the locally smallest distance to the HIP. It starts at the triangle of entry
and walks from triangle to triangle over shared edges and vertices, each step closer; as it is on the surface by
construction it cannot fall between two triangles, and the cost of a step does not depend on the size of the mesh. At a
sharp edge it stays on its face until the point has left the solid around that edge: it is never pushed out of another
side (Figure 27). It moves with the frame of the mesh.

A point with a radius is pushed away from the closest point of the surface while its centre is outside.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.contact import remember
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import (
    ANY_DIRECTION,
    FIRST_VERTEX,
    INSIDE,
    closest_on_triangle,
    closest_triangle,
    first_crossing,
    triangle_normal,
)

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, ContactScratchRecord, MeshRecord, MeshTable

__all__ = ["probe_mesh"]


_MAX_STEPS = 64
"""Largest number of triangles crossed in one tick; with 1 mm triangles that is 60 m/s."""

_CLOSER = 1.0 - 1e-12
"""Factor on the square distance below which a step counts as closer: rounding must not cause cycles [-]."""

_TOUCHING = 1e-10
"""Distance below which the direction to the proxy is undefined [m]."""


@kernel
def _square(p: Vec, q: Vec) -> float:
    """Square of the distance of two points [m^2]."""
    return (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2


@kernel
def _around_vertex(meshes: MeshTable, vertex: int, p: Vec, best: float, out: Vec) -> int:
    """Closest triangle around a vertex, if it is closer to p than `best` [m^2]; -1: none is."""
    found = -1
    for k in range(meshes.fan_starts[vertex], meshes.fan_starts[vertex + 1]):
        t = meshes.fans[k]
        closest_on_triangle(meshes.vertices, meshes.corners, t, p, out)
        square = _square(p, out)
        if square < best * _CLOSER:
            found, best = t, square
    return found


@kernel
def _walk(meshes: MeshTable, start: int, p: Vec, rest: Vec, trial: Vec) -> tuple[int, int]:
    """Walk from a triangle towards p until no neighbour is closer; return (triangle, region), set rest to the proxy."""
    t = start
    region = closest_on_triangle(meshes.vertices, meshes.corners, t, p, rest)
    for _ in range(_MAX_STEPS):
        if region == INSIDE:
            break
        best = _square(p, rest)
        if region >= FIRST_VERTEX:
            following = _around_vertex(meshes, meshes.corners[t, region - FIRST_VERTEX], p, best, trial)
        else:
            following = meshes.neighbours[t, region]
            if following >= 0:
                closest_on_triangle(meshes.vertices, meshes.corners, following, p, trial)
                if not _square(p, trial) < best * _CLOSER:
                    following = -1
        if following < 0:
            break
        t = following
        region = closest_on_triangle(meshes.vertices, meshes.corners, t, p, rest)
    return t, region


@kernel
def _is_rim(meshes: MeshTable, t: int, region: int) -> bool:
    """Whether the proxy is at a boundary edge of an open mesh."""
    if region == INSIDE:
        return False
    if region < FIRST_VERTEX:
        return meshes.neighbours[t, region] < 0
    k = region - FIRST_VERTEX
    return meshes.neighbours[t, k] < 0 or meshes.neighbours[t, (k + 2) % 3] < 0


@kernel
def _entered(meshes: MeshTable, mesh: MeshRecord, scratch: ContactScratchRecord, contact: ContactRecord) -> int:
    """Triangle through which the point enters, or that its ball touches; -1: none."""
    vertices, corners, boxes = meshes.vertices, meshes.corners, meshes.boxes
    if contact.known == 1:
        t = first_crossing(mesh, vertices, corners, boxes, contact.previous, scratch.p, scratch.a)
        if t >= 0:
            return t
    elif mesh.closed == 1:
        t = closest_triangle(mesh, vertices, corners, boxes, scratch.p, math.inf, ANY_DIRECTION, scratch.a)
        if t >= 0 and _distance_behind(meshes, t, scratch) > 0.0:
            return t
    if scratch.radius > 0.0:
        t = closest_triangle(mesh, vertices, corners, boxes, scratch.p, scratch.radius, ANY_DIRECTION, scratch.a)
        if t >= 0 and _distance_behind(meshes, t, scratch) <= 0.0:
            return t
    return -1


@kernel
def _distance_behind(meshes: MeshTable, t: int, scratch: ContactScratchRecord) -> float:
    """Distance of the point behind a triangle's plane [m]; scratch.c receives the plane's unit normal."""
    size = triangle_normal(meshes.vertices, meshes.corners, t, scratch.c)
    first = meshes.corners[t, 0]
    behind = 0.0
    for i in range(3):
        scratch.c[i] /= size
        behind -= scratch.c[i] * (scratch.p[i] - meshes.vertices[first, i])
    return behind


@kernel
def _rest(meshes: MeshTable, scratch: ContactScratchRecord, t: int, region: int, contact: ContactRecord) -> None:
    """Set depth and normal from the point and its proxy scratch.a on triangle t."""
    behind = _distance_behind(meshes, t, scratch)
    distance = math.sqrt(_square(scratch.p, scratch.a))
    if behind > 0.0:
        contact.depth = 0.0 if _is_rim(meshes, t, region) else distance + scratch.radius
    else:
        contact.depth = scratch.radius - distance
    if not contact.depth > 0.0:
        contact.depth = 0.0
        return
    for i in range(3):
        n = scratch.c[i]
        if region != INSIDE and distance > _TOUCHING:
            n = (scratch.a[i] - scratch.p[i]) / distance if behind > 0.0 else (scratch.p[i] - scratch.a[i]) / distance
        contact.normal[i] = n
    contact.feature = t + 1


@kernel
def probe_mesh(meshes: MeshTable, row: int, scratch: ContactScratchRecord, contact: ContactRecord) -> None:
    """Find depth and normal of the present point at a mesh.

    Args:
        meshes: MeshTable.
        row: Row of the mesh.
        scratch: CONTACT_SCRATCH record with p and radius; its vectors a, b, c are overwritten.
        contact: Record of `CONTACT`, updated; its feature is 1 + the triangle of the proxy.
    """
    mesh = meshes.rows[row]
    start = contact.feature - 1 if contact.inside == 1 else -1
    if start >= 0 and scratch.radius > 0.0 and _distance_behind(meshes, start, scratch) <= 0.0:
        start = -1
    if start < 0:
        start = _entered(meshes, mesh, scratch, contact)
    contact.depth = 0.0
    contact.feature = 0
    if start >= 0:
        t, region = _walk(meshes, start, scratch.p, scratch.a, scratch.b)
        _rest(meshes, scratch, t, region, contact)
    contact.inside = contact.depth > 0.0
    remember(scratch.p, contact)
