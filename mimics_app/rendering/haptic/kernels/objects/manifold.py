"""Contact manifold of two flat or straight features along one normal: faces, caps, lines.

Each solid contributes the feature that faces the other most: a box a face, a cylinder its cap (eight points of the rim,
the deepest first) or the line of its side. The two are projected along the normal; their intersection is a polygon, a
line or a point, and the depth at each of its corners is the difference of the two heights. So one rule serves a face on
a face, a tilted face (edge or corner on a face) and two crossing edges.

The stiffness of a contact belongs to a whole face and is distributed over the corners by their share of the outline: a
corner has half of both its sides. Shares are continuous when corners merge, and forces when a corner begins to touch,
as its depth is 0 there. A box on a face has its whole stiffness, on an edge half, on a corner a quarter: its effective
mass falls in the same proportion, so that one bound on the mass serves all (see `check_bodies`).

Points are rows x, y, z, depth, share of an array [MAX_CONTACT_POINTS, 5]; polygons rows u, v in the plane of contact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import across, along, cross, minus, times, unit
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, SolidRecord

__all__ = ["CORNER_SHARE", "RIM_POINTS", "ContactFeature", "add_point", "lay_over", "write_feature"]


CORNER_SHARE = 0.25
"""Share of a face's stiffness at each of its four corners [-]."""

RIM_POINTS = 8
"""Points that represent the rim of a cylinder."""

_LEANS = math.sqrt(0.5)
"""Cosine between the axis of a cylinder and the normal from which its feature is a cap instead of its side [-]."""

Plane = tuple[float, float, float]
"""Coefficients a, b, c of the height h = a + b u + c v above the plane of contact."""

_NO_LENGTH = 1e-12
"""Smallest length that is divided by [m]."""

_NO_SQUARE = 1e-24
"""Smallest square of a length that is divided by [m^2]."""

_PARALLEL = 1e-9
"""Sine of the angle between two lines, times the ratio of their lengths, below which they count as parallel [-]."""

_FACE = 4
"""Corners of a face of a box."""


class ContactFeature(NamedTuple):
    """Part of a solid that faces another one.

    Attributes:
        corners: Corners in order, world [m], shape [8, 3], of which the first `corner_count` are used.
        corner_count: Number of corners; 2: a line.
        normal: Outward normal.
        share: Share of the stiffness of a single corner.
    """

    corners: Floats
    corner_count: int
    normal: Vec3
    share: float


@kernel
def add_point(points: F8, count: int, p: Vec3, depth: float, share: float) -> int:
    """Append a contact point, unless the table is full; return the number of points."""
    if count >= points.shape[0]:
        return count
    points[count, 0], points[count, 1], points[count, 2] = p
    points[count, 3] = depth
    points[count, 4] = share
    return count + 1


@kernel
def _box_face(solid: SolidRecord, d: Vec3, corners: Floats) -> Vec3:
    """Write the four corners of the face of a box that faces d most, in order; return its outward normal."""
    size = solid.size
    axes = (axis(solid, 0), axis(solid, 1), axis(solid, 2))
    cosines = (dot(axes[0], d), dot(axes[1], d), dot(axes[2], d))
    face = 0
    if abs(cosines[1]) > abs(cosines[face]):
        face = 1
    if abs(cosines[2]) > abs(cosines[face]):
        face = 2
    if face == 0:
        n, t, s, depth, width, height = axes[0], axes[1], axes[2], size[0], size[1], size[2]
    elif face == 1:
        n, t, s, depth, width, height = axes[1], axes[2], axes[0], size[1], size[2], size[0]
    else:
        n, t, s, depth, width, height = axes[2], axes[0], axes[1], size[2], size[0], size[1]
    out = times(math.copysign(1.0, cosines[face]), n)
    centre = along(position_of(solid), 0.5 * depth, out)
    for corner in range(_FACE):
        u = 0.5 * width if corner == 0 or corner == 3 else -0.5 * width
        v = 0.5 * height if corner < 2 else -0.5 * height
        p = along(along(centre, u, t), v, s)
        corners[corner, 0], corners[corner, 1], corners[corner, 2] = p
    return out


@kernel
def _cylinder_feature(solid: SolidRecord, d: Vec3, corners: Floats) -> tuple[int, Vec3]:
    """Write the cap or the side line of a cylinder that faces d; return the number of points and the normal."""
    size, up, centre = solid.size, axis(solid, 1), position_of(solid)
    cosine = dot(up, d)
    leaning = along(d, -cosine, up)
    # An upright cylinder has no deepest rim point: any will do, as four or more points resist alike in all directions.
    down = unit(leaning, across(up))
    if abs(cosine) < _LEANS:
        for end in range(2):
            p = along(along(centre, size[0], down), (end - 0.5) * size[1], up)
            corners[end, 0], corners[end, 1], corners[end, 2] = p
        return 2, down
    out = times(math.copysign(1.0, cosine), up)
    cap, aside = along(centre, 0.5 * size[1], out), cross(out, down)
    for k in range(RIM_POINTS):
        angle = 2.0 * math.pi * k / RIM_POINTS
        p = along(along(cap, size[0] * math.cos(angle), down), size[0] * math.sin(angle), aside)
        corners[k, 0], corners[k, 1], corners[k, 2] = p
    return RIM_POINTS, out


@kernel
def write_feature(solid: SolidRecord, d: Vec3, corners: Floats) -> ContactFeature:
    """Return the feature of a box or cylinder that faces d.

    Args:
        solid: SOLID of a box or cylinder.
        d: Unit outward direction, world.
        corners: Receives the corners, shape [8, 3].
    """
    if solid.kind == ShapeKind.BOX:
        return ContactFeature(corners, _FACE, _box_face(solid, d, corners), CORNER_SHARE)
    count, n = _cylinder_feature(solid, d, corners)
    if count == 2:
        # Continuous from half for each end of a lying cylinder to the eighth of a point of the rim.
        lean = abs(dot(axis(solid, 1), d)) / _LEANS
        return ContactFeature(corners, 2, n, 0.5 - (0.5 - 1.0 / RIM_POINTS) * lean)
    return ContactFeature(corners, count, n, 1.0 / RIM_POINTS)


@kernel
def _project(feature: ContactFeature, origin: Vec3, u: Vec3, v: Vec3, polygon: F8) -> None:
    """Write the coordinates u, v of a feature's corners in the plane of contact."""
    corners = feature.corners
    for k in range(feature.corner_count):
        q = minus((corners[k, 0], corners[k, 1], corners[k, 2]), origin)
        polygon[k, 0], polygon[k, 1] = dot(q, u), dot(q, v)


@kernel
def _plane_of(feature: ContactFeature, origin: Vec3, u: Vec3, v: Vec3, n: Vec3) -> Plane:
    """Height of a feature along n as a linear function: of its face, or along a line and constant across it."""
    corners, m = feature.corners, feature.normal
    first = (corners[0, 0], corners[0, 1], corners[0, 2])
    q = minus(first, origin)
    if feature.corner_count > 2:
        steep = dot(m, n)
        b, c = -dot(m, u) / steep, -dot(m, v) / steep
    else:
        run = minus((corners[1, 0], corners[1, 1], corners[1, 2]), first)
        eu, ev = dot(run, u), dot(run, v)
        slope = dot(run, n) / max(eu * eu + ev * ev, _NO_SQUARE)
        b, c = slope * eu, slope * ev
    return dot(q, n) - b * dot(q, u) - c * dot(q, v), b, c


@kernel
def _clip_edge(polygon: Floats, count: int, ax: float, ay: float, nx: float, ny: float, out: Floats) -> int:
    """Clip a polygon or line to (p - a) . n <= 0 (Sutherland & Hodgman 1974); return the number of its corners."""
    kept = 0
    before = (polygon[count - 1, 0] - ax) * nx + (polygon[count - 1, 1] - ay) * ny
    for k in range(count):
        last = k - 1 if k > 0 else count - 1
        here = (polygon[k, 0] - ax) * nx + (polygon[k, 1] - ay) * ny
        crosses = (here < 0.0 and before > 0.0) or (here > 0.0 and before < 0.0)
        if crosses and not (count == 2 and k == 0) and kept < out.shape[0]:
            t = before / (before - here)
            out[kept, 0] = polygon[last, 0] + t * (polygon[k, 0] - polygon[last, 0])
            out[kept, 1] = polygon[last, 1] + t * (polygon[k, 1] - polygon[last, 1])
            kept += 1
        if here <= 0.0 and kept < out.shape[0]:
            out[kept, 0], out[kept, 1] = polygon[k, 0], polygon[k, 1]
            kept += 1
        before = here
    return kept


@kernel
def _clip(subject: Floats, count: int, window: Floats, sides: int, scratch: Floats) -> int:
    """Clip `subject` in place by every side of the convex `window`; return the number of its corners."""
    turn = 0.0
    for k in range(sides):
        after = k + 1 if k + 1 < sides else 0
        turn += window[k, 0] * window[after, 1] - window[after, 0] * window[k, 1]
    sense = 1.0 if turn > 0.0 else -1.0
    for k in range(sides):
        after = k + 1 if k + 1 < sides else 0
        ex, ey = window[after, 0] - window[k, 0], window[after, 1] - window[k, 1]
        count = _clip_edge(subject, count, window[k, 0], window[k, 1], sense * ey, -sense * ex, scratch)
        for j in range(count):
            subject[j, 0], subject[j, 1] = scratch[j, 0], scratch[j, 1]
        if count == 0:
            return 0
    return count


@kernel
def _spread(polygon: Floats, count: int, lone: float, k: int, outline: float) -> float:
    """Share of corner k: half of its two sides, relative to the outline; `lone` where there is no outline."""
    if count < 3 or outline < _NO_LENGTH:
        return lone
    last = k - 1 if k > 0 else count - 1
    after = k + 1 if k + 1 < count else 0
    sides = math.hypot(polygon[k, 0] - polygon[last, 0], polygon[k, 1] - polygon[last, 1])
    sides += math.hypot(polygon[k, 0] - polygon[after, 0], polygon[k, 1] - polygon[after, 1])
    return 0.5 * sides / outline


@kernel
def _outline(polygon: Floats, count: int) -> float:
    """Perimeter of a polygon [m]."""
    total = 0.0
    for k in range(count):
        after = k + 1 if k + 1 < count else 0
        total += math.hypot(polygon[k, 0] - polygon[after, 0], polygon[k, 1] - polygon[after, 1])
    return total


@kernel
def _cross_lines(a: Floats, b: Floats, out: Floats) -> int:
    """Write the points common to two projected lines: the ends of their common part, then their crossing.

    Returns the number of points: 0, 2 (parallel), or 3.
    """
    ax, ay, bx, by = a[1, 0] - a[0, 0], a[1, 1] - a[0, 1], b[1, 0] - b[0, 0], b[1, 1] - b[0, 1]
    square = max(ax * ax + ay * ay, _NO_SQUARE)
    s = ((b[0, 0] - a[0, 0]) * ax + (b[0, 1] - a[0, 1]) * ay) / square
    t = ((b[1, 0] - a[0, 0]) * ax + (b[1, 1] - a[0, 1]) * ay) / square
    low, high = max(0.0, min(s, t)), min(1.0, max(s, t))
    if low > high:
        return 0
    out[0, 0], out[0, 1] = a[0, 0] + low * ax, a[0, 1] + low * ay
    out[1, 0], out[1, 1] = a[0, 0] + high * ax, a[0, 1] + high * ay
    area = ax * by - ay * bx
    if abs(area) < _PARALLEL * square:
        return 2
    at = min(max(((b[0, 0] - a[0, 0]) * by - (b[0, 1] - a[0, 1]) * bx) / area, low), high)
    out[2, 0], out[2, 1] = a[0, 0] + at * ax, a[0, 1] + at * ay
    return 3


@kernel
def _height(plane: Plane, x: float, y: float) -> float:
    """Height of a plane at a point of the plane of contact [m]."""
    return plane[0] + plane[1] * x + plane[2] * y


@kernel
def _aside(line: Floats, x: float, y: float) -> float:
    """Distance of a point of the plane from the line of a cylinder's side [m]."""
    ex, ey = line[1, 0] - line[0, 0], line[1, 1] - line[0, 1]
    return abs((x - line[0, 0]) * ey - (y - line[0, 1]) * ex) / max(math.hypot(ex, ey), _NO_LENGTH)


@kernel
def _sag(radius: float, aside: float) -> float:
    """Drop of a cylinder's side at a distance `aside` from its line [m]."""
    return radius - math.sqrt(max(radius * radius - aside * aside, 0.0))


@kernel
def _intersect(polygons: F8, count_a: int, count_b: int) -> tuple[int, int]:
    """(row of `polygons` that receives the intersection of rows 0 and 1, number of its corners)."""
    if count_a == 2 and count_b == 2:
        return 2, _cross_lines(polygons[0], polygons[1], polygons[2])
    if count_a == 2:
        return 0, _clip(polygons[0], count_a, polygons[1], count_b, polygons[2])
    return 1, _clip(polygons[1], count_b, polygons[0], count_a, polygons[2])


@kernel
def lay_over(
    a: ContactFeature,
    b: ContactFeature,
    n: Vec3,
    lone: float,
    round_b: float,
    correction: float,
    polygons: Floats,
    points: F8,
) -> int:
    """Contact points of the intersection of two features projected along n.

    Args:
        a: Feature of the first solid.
        b: Feature of the second solid.
        n: Unit normal from the first to the second.
        lone: Share of a corner without an outline.
        round_b: Radius of the second solid if it is a cylinder [m]; used where both features are lines.
        correction: Depth subtracted from every point [m]: the missing depth of rounded edges.
        polygons: SCRATCH.polygon.
        points: Receives the points with a depth > 0, shape [MAX_CONTACT_POINTS, 5].

    Returns:
        Number of points.
    """
    u = across(n)
    v = cross(n, u)
    origin = (a.corners[0, 0], a.corners[0, 1], a.corners[0, 2])
    _project(a, origin, u, v, polygons[0])
    _project(b, origin, u, v, polygons[1])
    plane_a = _plane_of(a, origin, u, v, n)
    plane_b = _plane_of(b, origin, u, v, n)
    lines = a.corner_count == 2 and b.corner_count == 2
    row, found = _intersect(polygons, a.corner_count, b.corner_count)
    polygon = polygons[row]
    outline = _outline(polygon, found)
    count, side_by_side = 0, 0.0
    for k in range(found):
        x, y = polygon[k, 0], polygon[k, 1]
        height_a, height_b = _height(plane_a, x, y), _height(plane_b, x, y)
        depth = height_a - height_b - correction
        share = _spread(polygon, found, lone, k, outline)
        if lines and k < 2:
            depth -= _sag(round_b, _aside(polygons[1], x, y))
            side_by_side += 0.5 * max(depth, 0.0)
            share = 0.5
        elif lines:
            # Depth of the crossing beyond that of the two ends of the common part; parallel lines have no crossing.
            share = max(depth - side_by_side, 0.0) / max(depth, _NO_LENGTH)
        if depth > 0.0:
            p = along(along(along(origin, x, u), y, v), 0.5 * (height_a + height_b), n)
            count = add_point(points, count, p, depth, share)
    return count
