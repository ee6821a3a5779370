"""A body against a wall, the half-space below local z = 0 (Figures 41, 43): its lowest points, exactly."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.manifold import add_point, write_feature
from mimics_app.rendering.haptic.kernels.objects.triples import (
    Three,
    along,
    axis,
    dot,
    middle,
    minus,
    times,
)

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import Floats, SolidRecord

__all__ = ["touch_wall"]


_OF_A_CORNER = 0.25
"""Share of a face's stiffness that each of its four corners has [-]."""

_CORNERS = 8
"""Of a box, numbered by bits: which side along each of its axes."""

_UP = 4
"""The bit of its third axis."""


@kernel
def _sink(p: Three, height: float, share: float, n: Three, points: F8, count: int) -> int:
    """Add point p at a height over the wall, if it is below; the contact is half way to the wall."""
    if height >= 0.0:
        return count
    return add_point(points, count, along(p, -0.5 * height, n), -height, share)


@kernel
def _box(solid: SolidRecord, height: float, n: Three, points: F8) -> int:
    """The corners below the wall: of a box that is not in it to the middle at most four."""
    size, centre = solid.size, middle(solid)
    x, y, z = axis(solid, 0), axis(solid, 1), axis(solid, 2)
    hx, hy, hz = 0.5 * size[0], 0.5 * size[1], 0.5 * size[2]
    ex, ey, ez = hx * dot(x, n), hy * dot(y, n), hz * dot(z, n)
    if height >= abs(ex) + abs(ey) + abs(ez):
        return 0
    count = 0
    for corner in range(_CORNERS):
        i = 1.0 if corner & 1 else -1.0
        j = 1.0 if corner & 2 else -1.0
        k = 1.0 if corner & _UP else -1.0
        h = height + i * ex + j * ey + k * ez
        if h < 0.0:
            p = along(along(along(centre, i * hx, x), j * hy, y), k * hz, z)
            count = _sink(p, h, _OF_A_CORNER, n, points, count)
    return count


@kernel
def touch_wall(a: SolidRecord, b: SolidRecord, corners: Floats, points: F8) -> tuple[int, Three]:
    """Contact points of shape a in wall b.

    Args:
        a: SOLID, a sphere, box, cylinder or capsule.
        b: SOLID, the wall.
        corners: Room for eight corners, shape [8, 3].
        points: Receives the points, see `manifold`.

    Returns:
        (points, unit normal from a to the wall).
    """
    n, centre, size = axis(b, 2), middle(a), a.size
    height = dot(minus(centre, middle(b)), n)
    kind, into = a.kind, times(-1.0, n)
    if kind == ShapeKind.SPHERE:
        return _sink(along(centre, -size[0], n), height - size[0], 1.0, n, points, 0), into
    if kind == ShapeKind.BOX:
        return _box(a, height, n, points), into
    up, count = axis(a, 1), 0
    if kind == ShapeKind.CAPSULE:
        for end in range(2):
            reach = (end - 0.5) * size[1]
            p = along(along(centre, reach, up), -size[0], n)
            count = _sink(p, height + reach * dot(up, n) - size[0], 0.5, n, points, count)
        return count, into
    corner_count, _, share = write_feature(a, into, corners)
    for k in range(corner_count):
        p = (corners[k, 0], corners[k, 1], corners[k, 2])
        count = _sink(p, dot(minus(p, middle(b)), n), share, n, points, count)
    return count, into
