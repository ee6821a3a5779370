"""Spheres and capsules against solids (Figures 40, 44): closest points, by the signed distance of the other shape.

A capsule rests on another solid along a part of its axis: the ends of that part carry half of the contact's stiffness
each, and a third point, nearest between them (as on an edge), its depth beyond the line between the ends. All three
move continuously when the capsule rolls, tips over an edge, or crosses another.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import along, minus, times
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.distances import distance_to
from mimics_app.rendering.haptic.kernels.objects.manifold import add_point
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of, to_local

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, SolidRecord

__all__ = ["touch_by_capsule", "touch_by_sphere"]

Span = tuple[float, float]


_HALVINGS = 40
"""Steps of the bisection along the axis: to 1e-12 of its length."""

_FLAT = 1e-9
"""Slope of the distance along the axis up to which the axis counts as parallel to a face [-]."""

_FACE = 1.0 - 1e-9
"""Cosine between a normal and an axis of the solid from which it counts as that of a face [-]."""

_NO_DIRECTION = 1e-12
"""Length below which its direction is undefined [m]; squared, that of a square."""


@kernel
def touch_by_sphere(a: SolidRecord, b: SolidRecord, last: Vec3, points: F8) -> tuple[int, Vec3]:
    """Contact point of sphere a with shape b (not a wall).

    Args:
        a: SOLID of a sphere.
        b: SOLID of the other shape.
        last: Normal of the last tick from a to b, or zero; decides at coinciding centres and deep inside.
        points: Receives the contact point, see `manifold`.

    Returns:
        (points, unit normal from a to b).
    """
    centre, radius = position_of(a), a.size[0]
    far, n = distance_to(b, centre, times(-1.0, last))
    if far >= radius:
        return 0, last
    half_way = along(centre, -0.5 * (far + radius), n)
    return add_point(points, 0, half_way, radius - far, 1.0), times(-1.0, n)


@kernel
def _nearest(b: SolidRecord, start: Vec3, run: Vec3, hint: Vec3) -> tuple[float, float, Vec3]:
    """Point of the axis nearest to shape b: (share of the axis, distance, normal).

    The distance is convex along the axis and its slope is the normal's component along it: bisection finds its minimum.
    """
    low, high, t = 0.0, 1.0, 0.5
    far, n = distance_to(b, along(start, t, run), hint)
    for _ in range(_HALVINGS):
        slope = dot(n, run)
        if abs(slope) <= _FLAT * math.sqrt(dot(run, run)):
            break
        if slope > 0.0:
            high = t
        else:
            low = t
        t = 0.5 * (low + high)
        far, n = distance_to(b, along(start, t, run), hint)
    return t, far, n


@kernel
def _slab(p: float, run: float, half: float, span: Span) -> Span:
    """Part of a span of the axis within |p + t run| <= half."""
    if abs(run) < _NO_DIRECTION:
        return span if abs(p) <= half else (1.0, 0.0)
    s, t = (-half - p) / run, (half - p) / run
    return max(span[0], min(s, t)), min(span[1], max(s, t))


@kernel
def _disc(p: Vec3, run: Vec3, radius: float, span: Span) -> Span:
    """Part of a span of the axis above a cap, x^2 + z^2 <= r^2."""
    square = run[0] * run[0] + run[2] * run[2]
    if square < _NO_DIRECTION * _NO_DIRECTION:
        return span
    b = (p[0] * run[0] + p[2] * run[2]) / square
    c = (p[0] * p[0] + p[2] * p[2] - radius * radius) / square
    root = b * b - c
    if root < 0.0:
        return 1.0, 0.0
    return max(span[0], -b - math.sqrt(root)), min(span[1], -b + math.sqrt(root))


@kernel
def _common_part(kind: int, size: Floats, p: Vec3, run: Vec3, n: Vec3) -> Span:
    """Part of the axis above the face with normal n, in the frame of b; reversed where there is none."""
    span = (0.0, 1.0)
    if kind == ShapeKind.BOX:
        if max(abs(n[0]), max(abs(n[1]), abs(n[2]))) < _FACE:
            return 1.0, 0.0
        for i in range(3):
            if abs(n[i]) < 0.5:
                span = _slab(p[i], run[i], 0.5 * size[i], span)
        return span
    if kind == ShapeKind.CYLINDER and abs(n[1]) > _FACE:
        return _disc(p, run, size[0], span)
    if abs(n[1]) > 1.0 - _FACE and kind == ShapeKind.CYLINDER:
        return 1.0, 0.0
    return _slab(p[1], run[1], 0.5 * size[1], span)


@kernel
def touch_by_capsule(a: SolidRecord, b: SolidRecord, last: Vec3, points: F8) -> tuple[int, Vec3]:
    """Contact points of capsule a with shape b (capsule, cylinder or box); arguments as `touch_by_sphere`."""
    radius = a.size[0]
    run = times(a.size[1], axis(a, 1))
    start = along(position_of(a), -0.5, run)
    hint = times(-1.0, last)
    at, far, n = _nearest(b, start, run, hint)
    if far >= radius:
        return 0, last
    local = to_local(b, minus(start, position_of(b)))
    low, high = _common_part(b.kind, b.size, local, to_local(b, run), to_local(b, n))
    count, between = 0, 0.0
    if low < high:
        at = min(max(at, low), high)
        for end in range(2):
            t = high if end == 1 else low
            p = along(start, t, run)
            away, _ = distance_to(b, p, hint)
            depth = radius - away
            if depth > 0.0:
                weight = (at - low) if end == 1 else (high - at)
                between += depth * weight / (high - low)
                count = add_point(points, count, along(p, -0.5 * (away + radius), n), depth, 0.5)
    depth = radius - far
    if depth > between:
        half_way = along(along(start, at, run), -0.5 * (far + radius), n)
        count = add_point(points, count, half_way, depth, (depth - between) / depth)
    return count, times(-1.0, n)
