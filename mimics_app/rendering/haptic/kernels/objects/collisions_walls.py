"""Contact of a body with a wall, the half-space below local z = 0 (Figures 41, 43), by its lowest points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import along, minus, times
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.manifold import CORNER_SHARE, add_point, write_feature
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, SolidRecord

__all__ = ["touch_wall"]


_CORNERS = 8
"""Corners of a box, numbered by bits: the side along each of its axes."""

_THIRD_AXIS = 4
"""Bit of the third axis in the number of a corner."""


@kernel
def _sink(p: Vec3, height: float, share: float, n: Vec3, points: F8, count: int) -> int:
    """Add point p at a height above the wall [m] if it is below; the contact lies half way to the wall."""
    if height >= 0.0:
        return count
    return add_point(points, count, along(p, -0.5 * height, n), -height, share)


@kernel
def _box(solid: SolidRecord, height: float, n: Vec3, points: F8) -> int:
    """Add the corners below the wall: at most four while the centre of the box is outside."""
    size, centre = solid.size, position_of(solid)
    x, y, z = axis(solid, 0), axis(solid, 1), axis(solid, 2)
    hx, hy, hz = 0.5 * size[0], 0.5 * size[1], 0.5 * size[2]
    ex, ey, ez = hx * dot(x, n), hy * dot(y, n), hz * dot(z, n)
    if height >= abs(ex) + abs(ey) + abs(ez):
        return 0
    count = 0
    for corner in range(_CORNERS):
        i = 1.0 if corner & 1 else -1.0
        j = 1.0 if corner & 2 else -1.0
        k = 1.0 if corner & _THIRD_AXIS else -1.0
        h = height + i * ex + j * ey + k * ez
        if h < 0.0:
            p = along(along(along(centre, i * hx, x), j * hy, y), k * hz, z)
            count = _sink(p, h, CORNER_SHARE, n, points, count)
    return count


@kernel
def touch_wall(a: SolidRecord, b: SolidRecord, corners: Floats, points: F8) -> tuple[int, Vec3]:
    """Contact points of shape a in wall b.

    Args:
        a: SOLID, a sphere, box, cylinder or capsule.
        b: SOLID, the wall.
        corners: Scratch, shape [8, 3].
        points: Receives the contact points, see `manifold`.

    Returns:
        (points, unit normal from a to the wall).
    """
    n, centre, size = axis(b, 2), position_of(a), a.size
    height = dot(minus(centre, position_of(b)), n)
    kind, inward = a.kind, times(-1.0, n)
    if kind == ShapeKind.SPHERE:
        return _sink(along(centre, -size[0], n), height - size[0], 1.0, n, points, 0), inward
    if kind == ShapeKind.BOX:
        return _box(a, height, n, points), inward
    up, count = axis(a, 1), 0
    if kind == ShapeKind.CAPSULE:
        for end in range(2):
            reach = (end - 0.5) * size[1]
            p = along(along(centre, reach, up), -size[0], n)
            count = _sink(p, height + reach * dot(up, n) - size[0], 0.5, n, points, count)
        return count, inward
    feature = write_feature(a, inward, corners)
    for k in range(feature.corner_count):
        p = (corners[k, 0], corners[k, 1], corners[k, 2])
        count = _sink(p, dot(minus(p, position_of(b)), n), feature.share, n, points, count)
    return count, inward
