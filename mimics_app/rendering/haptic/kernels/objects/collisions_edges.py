"""Sharp edges of a mesh that a body carries, where they pass through another shape between their corners.

An edge goes into the other shape at t0 through a face n0 and leaves it at t1 through a face n1. The way out that is
perpendicular to the edge e lies between the two faces, n ~ (n1.e) n0 - (n0.e) n1: along e x (n0 x n1), the axis of two
crossed edges (Gottschalk, Lin & Manocha 1996), with the depth (n1.e) (-n0.e) L / |n| for the chord of length L, less
where the shape ends before its two faces would meet. Where the two faces look apart there is no such normal; then,
as wherever an edge sticks out on one side only, the ends of the chord are points like corners: planks that cross lie on
four of them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.distances import distance_to
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANYWHERE, LOOKS, first_crossing, triangle_normal
from mimics_app.rendering.haptic.kernels.objects.triples import (
    Three,
    along,
    dot,
    into,
    middle,
    minus,
    out_of,
    times,
    unit,
)

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import MeshTable, ScratchRecord, SolidRecord

__all__ = ["chord_in", "deepest_between", "may_pass"]


_NONE = (0.0, 0.0, 0.0)
"""Normal of an end of a chord that lies inside: there the edge ends."""

_OPPOSITE = 0.05
"""Length of (n1.e) n0 - (n0.e) n1 below which two faces look opposite ways."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
_NARROWED = 24
"""Steps of the search for the deepest place of an edge: a hundred-thousandth of its length."""

_HALVED = 32
"""Steps of the search for the ends of a chord."""

_BEYOND = 1.001
"""The way out is looked for so much farther than where the faces would meet."""

Chord = tuple[bool, float, float, Three, Three]


@kernel
def may_pass(p: Three, q: Three, solid: SolidRecord) -> bool:
    """The bounds of the segment p -> q overlap those of a shape that has some."""
    for k in range(3):
        if max(p[k], q[k]) < solid.low[k] or min(p[k], q[k]) > solid.high[k]:
            return False
    return True


@kernel
def _face(j: int, sign: float) -> Three:
    return sign if j == 0 else 0.0, sign if j == 1 else 0.0, sign if j == 2 else 0.0


@kernel
def _chord_in_box(solid: SolidRecord, p: Three, q: Three) -> Chord:
    """Clip by the six faces, in the frame of the box."""
    a, b = into(solid, minus(p, middle(solid))), into(solid, minus(q, middle(solid)))
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
    return t0 < t1, t0, t1, out_of(solid, n0), out_of(solid, n1)


@kernel
def _deepest(solid: SolidRecord, p: Three, direction: Three) -> float:
    """Share of the segment where a round shape is deepest, by golden section: its distance is convex along a line."""
    low, high = 0.0, 1.0
    left, right = high - _GOLDEN, low + _GOLDEN
    at_left, _ = distance_to(solid, along(p, left, direction), ANYWHERE)
    at_right, _ = distance_to(solid, along(p, right, direction), ANYWHERE)
    for _k in range(_NARROWED):
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left, _ = distance_to(solid, along(p, left, direction), ANYWHERE)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right, _ = distance_to(solid, along(p, right, direction), ANYWHERE)
    return 0.5 * (low + high)


@kernel
def _surface(solid: SolidRecord, p: Three, direction: Three, inside: float, end: float) -> tuple[float, Three]:
    """(share, normal) where the segment comes out of a shape between a place inside and its end; _NONE: it does not."""
    far, _ = distance_to(solid, along(p, end, direction), ANYWHERE)
    if far <= 0.0:
        return end, _NONE
    outside = end
    for _k in range(_HALVED):
        between = 0.5 * (inside + outside)
        far, _ = distance_to(solid, along(p, between, direction), ANYWHERE)
        if far <= 0.0:
            inside = between
        else:
            outside = between
    _, n = distance_to(solid, along(p, outside, direction), ANYWHERE)
    return outside, n


@kernel
def _chord_in_round(solid: SolidRecord, p: Three, q: Three) -> Chord:
    """Of a cylinder or capsule, by its distance alone."""
    direction = minus(q, p)
    t = _deepest(solid, p, direction)
    far, _ = distance_to(solid, along(p, t, direction), ANYWHERE)
    if far >= 0.0:
        return False, 0.0, 0.0, _NONE, _NONE
    t0, n0 = _surface(solid, p, direction, t, 0.0)
    t1, n1 = _surface(solid, p, direction, t, 1.0)
    return True, t0, t1, n0, n1


@kernel
def _entry(solid: SolidRecord, a: Three, b: Three, table: MeshTable, room: ScratchRecord) -> tuple[bool, float, Three]:
    """(whether, at which share, normal of the face) the segment a -> b goes into a mesh, in its frame."""
    mesh, first, last, n = table.rows[solid.mesh], room.mesh_point, room.mesh_closest, room.mesh_normal
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
def _chord_in_mesh(solid: SolidRecord, p: Three, q: Three, table: MeshTable, room: ScratchRecord) -> Chord:
    """From where the segment first goes in to where it last comes out; what is between in a hollow is not reported."""
    a, b = into(solid, minus(p, middle(solid))), into(solid, minus(q, middle(solid)))
    enters, t0, n0 = _entry(solid, a, b, table, room)
    leaves, back, n1 = _entry(solid, b, a, table, room)
    if not enters:
        t0, n0 = 0.0, _NONE
    t1 = 1.0 - back if leaves else 1.0
    return (enters or leaves) and t0 < t1, t0, t1, out_of(solid, n0), out_of(solid, n1 if leaves else _NONE)


@kernel
def chord_in(solid: SolidRecord, p: Three, q: Three, table: MeshTable, room: ScratchRecord) -> Chord:
    """The part of a straight line that lies in a shape.

    Args:
        solid: SOLID of a box, cylinder, capsule or mesh.
        p: Beginning of the segment, world [m].
        q: Its end [m].
        table: MeshTable.
        room: SCRATCH.

    Returns:
        (whether there is one, share of the segment at which it begins, at which it ends, outward normals of the faces
        there; zero where the segment itself begins or ends inside).
    """
    if solid.kind == ShapeKind.BOX:
        return _chord_in_box(solid, p, q)
    if solid.kind == ShapeKind.MESH:
        return _chord_in_mesh(solid, p, q, table, room)
    return _chord_in_round(solid, p, q)


@kernel
def deepest_between(
    solid: SolidRecord, p: Three, q: Three, chord: Chord, toward: Three, table: MeshTable, room: ScratchRecord
) -> tuple[float, Three, Three]:
    """The way out of a shape for an edge that passes through it.

    Args:
        solid: SOLID of the shape.
        p: Beginning of the edge, world [m].
        q: Its end [m].
        chord: What `chord_in` gave for it; both of its normals are there.
        toward: Direction that the normal out of it must look along, or ANYWHERE.
        table: MeshTable.
        room: SCRATCH.

    Returns:
        (depth [m], 0: there is none; unit normal out of the shape; place on the edge [m]).
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
    if toward != ANYWHERE and dot(n, toward) <= LOOKS:
        return 0.0, n, p
    depth = rise * fall * (t1 - t0) * length / size
    foot = min(t0 + depth * dot(n0, n) / (fall * length), t1)
    at = along(p, foot, direction)
    _, _, out, _, leaves = chord_in(solid, at, along(at, _BEYOND * depth, n), table, room)
    if unit(leaves, _NONE) != _NONE:
        depth = min(depth, _BEYOND * depth * out)
    return depth, n, at
