"""Contacts of sharp mesh edges that pass through another shape between their corners.

An edge enters the other shape at t0 through a face n0 and leaves it at t1 through a face n1. The separating direction
perpendicular to the edge e lies between the two faces, n ~ (n1.e) n0 - (n0.e) n1: along e x (n0 x n1), the axis of two
crossed edges (Gottschalk, Lin & Manocha 1996), with the depth (n1.e) (-n0.e) L / |n| for the chord of length L, less
where the shape ends before its two faces would meet. For opposite faces such a normal does not exist; then, as wherever
an edge leaves on one side only, the ends of the chord are contact points like corners: crossed planks rest on four.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import along, minus, times, unit
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.distances import distance_to
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANY_DIRECTION, FACING, first_crossing, triangle_normal
from mimics_app.rendering.haptic.kernels.objects.solid_frame import position_of, to_local, to_world

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import MeshTable, ScratchRecord, SolidRecord

__all__ = ["chord_in", "deepest_between", "may_pass"]


_NONE = (0.0, 0.0, 0.0)
"""Normal at an end of a chord inside the shape, where the edge itself ends."""

_OPPOSITE = 0.05
"""Length of (n1.e) n0 - (n0.e) n1 below which two faces count as opposite [-]."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Inverse of the golden ratio [-]."""

_NARROWED = 24
"""Steps of the search for the deepest point of an edge: to a hundred-thousandth of its length."""

_HALVED = 32
"""Steps of the search for the ends of a chord."""

_BEYOND = 1.001
"""Length of the probe along the normal, relative to the depth at which the faces would meet [-]."""

Chord = tuple[bool, float, float, Vec3, Vec3]
"""Part of a segment inside a shape, see `chord_in`."""


@kernel
def may_pass(p: Vec3, q: Vec3, solid: SolidRecord) -> bool:
    """Whether the bounds of the segment p -> q overlap those of a bounded shape."""
    for k in range(3):
        if max(p[k], q[k]) < solid.low[k] or min(p[k], q[k]) > solid.high[k]:
            return False
    return True


@kernel
def _face(j: int, sign: float) -> Vec3:
    """Unit vector sign e_j."""
    return sign if j == 0 else 0.0, sign if j == 1 else 0.0, sign if j == 2 else 0.0


@kernel
def _chord_in_box(solid: SolidRecord, p: Vec3, q: Vec3) -> Chord:
    """Chord in a box, by clipping against its six faces."""
    a, b = to_local(solid, minus(p, position_of(solid))), to_local(solid, minus(q, position_of(solid)))
    t0, t1, n0, n1 = 0.0, 1.0, _NONE, _NONE
    for j in range(3):
        for sign in (-1.0, 1.0):
            before, after = sign * a[j] - 0.5 * solid.size[j], sign * b[j] - 0.5 * solid.size[j]
            if before > 0.0 and after > 0.0:
                return False, 0.0, 0.0, _NONE, _NONE
            if before > 0.0:
                t = before / (before - after)
                if t > t0:
                    t0, n0 = t, _face(j, sign)
            elif after > 0.0:
                t = before / (before - after)
                if t < t1:
                    t1, n1 = t, _face(j, sign)
    return t0 < t1, t0, t1, to_world(solid, n0), to_world(solid, n1)


@kernel
def _deepest(solid: SolidRecord, p: Vec3, direction: Vec3) -> float:
    """Share of the segment where it is deepest in a round shape, by golden section: the distance is convex."""
    low, high = 0.0, 1.0
    left, right = high - _GOLDEN, low + _GOLDEN
    at_left, _ = distance_to(solid, along(p, left, direction), ANY_DIRECTION)
    at_right, _ = distance_to(solid, along(p, right, direction), ANY_DIRECTION)
    for _k in range(_NARROWED):
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left, _ = distance_to(solid, along(p, left, direction), ANY_DIRECTION)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right, _ = distance_to(solid, along(p, right, direction), ANY_DIRECTION)
    return 0.5 * (low + high)


@kernel
def _surface(solid: SolidRecord, p: Vec3, direction: Vec3, inside: float, end: float) -> tuple[float, Vec3]:
    """(share, normal) at which the segment leaves a shape between an inner point and its end; _NONE: it does not."""
    far, _ = distance_to(solid, along(p, end, direction), ANY_DIRECTION)
    if far <= 0.0:
        return end, _NONE
    outside = end
    for _k in range(_HALVED):
        between = 0.5 * (inside + outside)
        far, _ = distance_to(solid, along(p, between, direction), ANY_DIRECTION)
        if far <= 0.0:
            inside = between
        else:
            outside = between
    _, n = distance_to(solid, along(p, outside, direction), ANY_DIRECTION)
    return outside, n


@kernel
def _chord_in_round(solid: SolidRecord, p: Vec3, q: Vec3) -> Chord:
    """Chord in a cylinder or capsule, by its distance alone."""
    direction = minus(q, p)
    t = _deepest(solid, p, direction)
    far, _ = distance_to(solid, along(p, t, direction), ANY_DIRECTION)
    if far >= 0.0:
        return False, 0.0, 0.0, _NONE, _NONE
    t0, n0 = _surface(solid, p, direction, t, 0.0)
    t1, n1 = _surface(solid, p, direction, t, 1.0)
    return True, t0, t1, n0, n1


@kernel
def _entry(solid: SolidRecord, a: Vec3, b: Vec3, table: MeshTable, scratch: ScratchRecord) -> tuple[bool, float, Vec3]:
    """(whether the segment a -> b enters a mesh, share at which, normal of the face), in the frame of the mesh."""
    mesh, first, last, n = table.rows[solid.mesh], scratch.mesh_point, scratch.mesh_closest, scratch.mesh_normal
    first[0], first[1], first[2] = a
    last[0], last[1], last[2] = b
    t = first_crossing(mesh, table.vertices, table.corners, table.boxes, first, last, n)
    if t < 0:
        return False, 0.0, _NONE
    size = triangle_normal(table.vertices, table.corners, t, n)
    out = (n[0] / size, n[1] / size, n[2] / size)
    corner = table.corners[t, 0]
    on_face = (table.vertices[corner, 0], table.vertices[corner, 1], table.vertices[corner, 2])
    before, after = dot(minus(a, on_face), out), dot(minus(b, on_face), out)
    return True, min(max(before / (before - after), 0.0), 1.0), out


@kernel
def _chord_in_mesh(solid: SolidRecord, p: Vec3, q: Vec3, table: MeshTable, scratch: ScratchRecord) -> Chord:
    """Chord in a mesh, from the first entry to the last exit; gaps between them, in a hollow, are ignored."""
    a, b = to_local(solid, minus(p, position_of(solid))), to_local(solid, minus(q, position_of(solid)))
    enters, t0, n0 = _entry(solid, a, b, table, scratch)
    leaves, back, n1 = _entry(solid, b, a, table, scratch)
    if not enters:
        t0, n0 = 0.0, _NONE
    t1 = 1.0 - back if leaves else 1.0
    return (enters or leaves) and t0 < t1, t0, t1, to_world(solid, n0), to_world(solid, n1 if leaves else _NONE)


@kernel
def chord_in(solid: SolidRecord, p: Vec3, q: Vec3, table: MeshTable, scratch: ScratchRecord) -> Chord:
    """Part of a segment inside a shape.

    Args:
        solid: SOLID of a box, cylinder, capsule or mesh.
        p: Start of the segment, world [m].
        q: End of the edge [m].
        table: MeshTable.
        scratch: SCRATCH.

    Returns:
        (whether there is one, shares of the segment at which it begins and ends, outward normals of the faces there;
        zero where the segment itself begins or ends inside).
    """
    if solid.kind == ShapeKind.BOX:
        return _chord_in_box(solid, p, q)
    if solid.kind == ShapeKind.MESH:
        return _chord_in_mesh(solid, p, q, table, scratch)
    return _chord_in_round(solid, p, q)


@kernel
def deepest_between(
    solid: SolidRecord, p: Vec3, q: Vec3, chord: Chord, toward: Vec3, table: MeshTable, scratch: ScratchRecord
) -> tuple[float, Vec3, Vec3]:
    """Penetration depth of an edge that passes through a shape, between its two faces.

    Args:
        solid: SOLID of the shape.
        p: Start of the edge, world [m].
        q: End of the edge [m].
        chord: Result of `chord_in`, with two normals.
        toward: Direction that the outward normal must face, or ANY_DIRECTION.
        table: MeshTable.
        scratch: SCRATCH.

    Returns:
        (depth [m], 0: none; unit outward normal of the shape; point on the edge [m]).
    """
    _, t0, t1, n0, n1 = chord
    direction = minus(q, p)
    length = math.sqrt(dot(direction, direction))
    e = times(1.0 / length, direction)
    fall, rise = -dot(n0, e), dot(n1, e)
    sum_of_both = along(times(rise, n0), fall, n1)
    size = math.sqrt(dot(sum_of_both, sum_of_both))
    if size < _OPPOSITE:
        return 0.0, toward, p
    n = times(1.0 / size, sum_of_both)
    if toward != ANY_DIRECTION and dot(n, toward) <= FACING:
        return 0.0, n, p
    depth = rise * fall * (t1 - t0) * length / size
    foot = min(t0 + depth * dot(n0, n) / (fall * length), t1)
    at = along(p, foot, direction)
    _, _, out, _, leaves = chord_in(solid, at, along(at, _BEYOND * depth, n), table, scratch)
    if unit(leaves, _NONE) != _NONE:
        depth = min(depth, _BEYOND * depth * out)
    return depth, n, at
