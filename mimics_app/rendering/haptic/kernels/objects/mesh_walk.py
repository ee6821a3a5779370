"""A finger on a triangle mesh: where its stand-in rests while the point is behind the surface.

The stand-in is the point of the surface with the locally least distance to the point (a god-object: Zilles & Salisbury
1995). It starts at the triangle by which the point came in and walks from triangle to triangle over shared edges and
corners, every step closer; since it is on the surface by construction it cannot fall between two triangles, and what a
step costs does not depend on the size of the mesh. At a sharp edge it stays on the face it is on until the point has
left the solid round that edge: no push out of another side (Figure 27). It rides in the frame of the mesh.

A point with a radius is pushed away from the closest point of the surface while its centre is outside.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import (
    ANYWHERE,
    INSIDE,
    closest_on_triangle,
    closest_triangle,
    first_crossing,
    triangle_normal,
)
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import ContactRecord, ContactScratchRecord, MeshRecord, MeshTable

__all__ = ["probe_mesh"]


_CORNER = 3
"""Least region number of a corner."""

_MOST_STEPS = 64
"""Triangles one tick may walk over; at 1 mm triangles that is 60 m/s."""

_CLOSER = 1.0 - 1e-12
"""Factor on the square of the distance below which a step counts as closer: rounding must not walk in circles."""

_TOUCHING = 1e-10
"""Distance [m] below which the direction to the stand-in means nothing."""


@kernel
def _square(p: Vec, q: Vec) -> float:
    return (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2


@kernel
def _around_corner(meshes: MeshTable, corner: int, p: Vec, best: float, out: Vec) -> int:
    """A triangle round a vertex that is closer to p than `best` [m^2], the closest of them; -1: none."""
    found = -1
    for k in range(meshes.fan_starts[corner], meshes.fan_starts[corner + 1]):
        t = meshes.fans[k]
        closest_on_triangle(meshes.vertices, meshes.corners, t, p, out)
        square = _square(p, out)
        if square < best * _CLOSER:
            found, best = t, square
    return found


@kernel
def _walk(meshes: MeshTable, start: int, p: Vec, rest: Vec, trial: Vec) -> tuple[int, int]:
    """Walk from a triangle towards p; (triangle, region) where no neighbour is closer, rest its closest point."""
    t = start
    region = closest_on_triangle(meshes.vertices, meshes.corners, t, p, rest)
    for _ in range(_MOST_STEPS):
        if region == INSIDE:
            break
        best = _square(p, rest)
        if region >= _CORNER:
            following = _around_corner(meshes, meshes.corners[t, region - _CORNER], p, best, trial)
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
    """The stand-in is at the open edge of a sheet."""
    if region == INSIDE:
        return False
    if region < _CORNER:
        return meshes.neighbours[t, region] < 0
    k = region - _CORNER
    return meshes.neighbours[t, k] < 0 or meshes.neighbours[t, (k + 2) % 3] < 0


@kernel
def _entered(meshes: MeshTable, mesh: MeshRecord, scratch: ContactScratchRecord, contact: ContactRecord) -> int:
    """The triangle by which the point comes in, or which its ball touches; -1: it does not."""
    vertices, corners, boxes = meshes.vertices, meshes.corners, meshes.boxes
    if contact.known == 1:
        t = first_crossing(mesh, vertices, corners, boxes, contact.previous, scratch.p, scratch.a)
        if t >= 0:
            return t
    elif mesh.closed == 1:
        t = closest_triangle(mesh, vertices, corners, boxes, scratch.p, math.inf, ANYWHERE, scratch.a)
        if t >= 0 and _distance_behind(meshes, t, scratch) > 0.0:
            return t
    if scratch.radius > 0.0:
        t = closest_triangle(mesh, vertices, corners, boxes, scratch.p, scratch.radius, ANYWHERE, scratch.a)
        if t >= 0 and _distance_behind(meshes, t, scratch) <= 0.0:
            return t
    return -1


@kernel
def _distance_behind(meshes: MeshTable, t: int, scratch: ContactScratchRecord) -> float:
    """How far [m] the point is behind a triangle's plane; scratch.c becomes the plane's unit normal."""
    size = triangle_normal(meshes.vertices, meshes.corners, t, scratch.c)
    first = meshes.corners[t, 0]
    behind = 0.0
    for i in range(3):
        scratch.c[i] /= size
        behind -= scratch.c[i] * (scratch.p[i] - meshes.vertices[first, i])
    return behind


@kernel
def _rest(meshes: MeshTable, scratch: ContactScratchRecord, t: int, region: int, contact: ContactRecord) -> None:
    """Depth and normal from the point to its stand-in scratch.a on triangle t."""
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
    """Depth and normal of the present point at a mesh.

    Args:
        meshes: MeshTable.
        row: Of the mesh.
        scratch: CONTACT_SCRATCH record: p, radius; scratch is used.
        contact: Record of `CONTACT`, updated; its feature is 1 + the triangle the stand-in is on.
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
    copy(scratch.p, contact.previous)
    contact.known = 1
