"""Signed distance from a point to a convex shape, and the outward normal there, in the shape's frame.

Distance < 0 inside. Inside a box or cylinder the normal is that of the nearest face, but a `hint` (the normal of the
last tick, or zero) holds its face until another is less than half as deep, so that the normal of a deep contact does
not flip. The distance is a convex function of the point.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths.triple_kernels import across, minus, unit
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.solid_frame import position_of, to_local, to_world

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, SolidRecord

__all__ = ["depth_under", "distance_to"]


_HELD = 0.5
"""Factor on the depth of a held face when faces are compared [-]."""

_FACING = 0.3
"""Cosine between the normal of a face and a direction from which the face counts as facing it [-]."""

_ALIKE = 0.9
"""Cosine between a hint and a normal above which the hint holds the face [-]."""

_NO_DIRECTION = 1e-12
"""Length below which its direction is undefined [m]."""


@kernel
def _from_centre(q: Vec3, radius: float, hint: Vec3) -> tuple[float, Vec3]:
    """Distance and normal of a ball; at its centre the normal is the hint, or up."""
    far = math.sqrt(dot(q, q))
    if far < _NO_DIRECTION:
        return far - radius, unit(hint, (0.0, 1.0, 0.0))
    return far - radius, (q[0] / far, q[1] / far, q[2] / far)


@kernel
def _box(q: Vec3, half: Vec3, hint: Vec3) -> tuple[float, Vec3]:
    """Distance and normal of a box of half edges `half`."""
    x, y, z = abs(q[0]) - half[0], abs(q[1]) - half[1], abs(q[2]) - half[2]
    sx, sy, sz = math.copysign(1.0, q[0]), math.copysign(1.0, q[1]), math.copysign(1.0, q[2])
    if x > 0.0 or y > 0.0 or z > 0.0:
        out = (sx * max(x, 0.0), sy * max(y, 0.0), sz * max(z, 0.0))
        far = math.sqrt(dot(out, out))
        return far, (out[0] / far, out[1] / far, out[2] / far)
    hx = x * _HELD if hint[0] * sx > _ALIKE else x
    hy = y * _HELD if hint[1] * sy > _ALIKE else y
    hz = z * _HELD if hint[2] * sz > _ALIKE else z
    if hx >= hy and hx >= hz:
        return x, (sx, 0.0, 0.0)
    if hy >= hz:
        return y, (0.0, sy, 0.0)
    return z, (0.0, 0.0, sz)


@kernel
def _cylinder(q: Vec3, radius: float, half: float, hint: Vec3) -> tuple[float, Vec3]:
    """Distance and normal of a cylinder about y of half length `half`."""
    rho = math.sqrt(q[0] * q[0] + q[2] * q[2])
    if rho > _NO_DIRECTION:
        side = (q[0] / rho, 0.0, q[2] / rho)
    else:
        side = unit((hint[0], 0.0, hint[2]), (1.0, 0.0, 0.0))
    up = math.copysign(1.0, q[1])
    across_side, across_cap = rho - radius, abs(q[1]) - half
    if across_side > 0.0 and across_cap > 0.0:
        far = math.sqrt(across_side * across_side + across_cap * across_cap)
        return far, (side[0] * across_side / far, up * across_cap / far, side[2] * across_side / far)
    outside = across_side > 0.0 or across_cap > 0.0
    by_cap = across_cap * _HELD if not outside and hint[1] * up > _ALIKE else across_cap
    by_side = (
        across_side * _HELD if not outside and abs(hint[1]) < 1.0 - _ALIKE and dot(hint, hint) > 0.5 else across_side
    )
    if by_cap >= by_side:
        return across_cap, (0.0, up, 0.0)
    return across_side, side


@kernel
def _shape_distance(kind: int, size: Floats, q: Vec3, hint: Vec3) -> tuple[float, Vec3]:
    """(distance [m], outward unit normal) of a point from a sphere, box, cylinder or capsule.

    Args:
        kind: ShapeKind.
        size: SHAPE.size.
        q: The point in the shape's frame [m].
        hint: Last normal in that frame, or zero; decides where the geometry is ambiguous.
    """
    if kind == ShapeKind.SPHERE:
        return _from_centre(q, size[0], hint)
    if kind == ShapeKind.BOX:
        return _box(q, (0.5 * size[0], 0.5 * size[1], 0.5 * size[2]), hint)
    if kind == ShapeKind.CYLINDER:
        return _cylinder(q, size[0], 0.5 * size[1], hint)
    half = 0.5 * size[1]
    foot = min(max(q[1], -half), half)
    sideways = hint
    if abs(q[1]) < half:  # on the axis only perpendicular directions lead out
        axis = (0.0, 1.0, 0.0)
        sideways = unit((hint[0], 0.0, hint[2]), across(axis))
    return _from_centre((q[0], q[1] - foot, q[2]), size[0], sideways)


@kernel
def distance_to(solid: SolidRecord, p: Vec3, hint: Vec3) -> tuple[float, Vec3]:
    """`_shape_distance` of a SOLID, with point, hint and normal in the world."""
    q = to_local(solid, minus(p, position_of(solid)))
    far, n = _shape_distance(solid.kind, solid.size, q, to_local(solid, hint))
    return far, to_world(solid, n)


@kernel
def _shallower(depth: float, cosine: float, best: float, out: Vec3, n: Vec3) -> tuple[float, Vec3]:
    """Depth and normal of the face (depth, out) if it is facing and shallower than (best, n), else of the latter."""
    if cosine > _FACING and depth < best:
        return depth, out
    return best, n


@kernel
def _under_cylinder(size: Floats, q: Vec3, toward: Vec3) -> tuple[float, Vec3, float]:
    """(depth under the face that faces `toward`, its normal, distance inside its border); local frame."""
    half, rho = 0.5 * size[1], math.sqrt(q[0] * q[0] + q[2] * q[2])
    side = (q[0] / rho, 0.0, q[2] / rho) if rho > _NO_DIRECTION else unit((toward[0], 0.0, toward[2]), (1.0, 0.0, 0.0))
    up = math.copysign(1.0, toward[1])
    by_side, by_cap = size[0] - rho, half - up * q[1]
    depth, n = _shallower(by_side, dot(side, toward), math.inf, side, toward)
    depth, n = _shallower(by_cap, abs(toward[1]), depth, (0.0, up, 0.0), n)
    if n[1] == 0.0:
        return depth, n, half - abs(q[1])
    return depth if depth <= size[1] else 0.0, n, by_side


@kernel
def _under_box(size: Floats, q: Vec3, toward: Vec3) -> tuple[float, Vec3, float]:
    """As `_under_cylinder`, for a box."""
    sx, sy, sz = math.copysign(1.0, toward[0]), math.copysign(1.0, toward[1]), math.copysign(1.0, toward[2])
    depth, n = _shallower(0.5 * size[0] - sx * q[0], abs(toward[0]), math.inf, (sx, 0.0, 0.0), toward)
    depth, n = _shallower(0.5 * size[1] - sy * q[1], abs(toward[1]), depth, (0.0, sy, 0.0), n)
    depth, n = _shallower(0.5 * size[2] - sz * q[2], abs(toward[2]), depth, (0.0, 0.0, sz), n)
    beside = math.inf
    for i in range(3):
        if n[i] == 0.0:
            beside = min(beside, 0.5 * size[i] - abs(q[i]))
        elif depth > size[i]:
            depth = 0.0
    return depth, n, beside


@kernel
def depth_under(solid: SolidRecord, p: Vec3, toward: Vec3) -> tuple[float, Vec3]:
    """Depth of a point in a box, cylinder or capsule by the faces that face a direction, <= 0 outside.

    A point counts up to as far beside the face as it is under it, so that a corner just at an edge is supported.

    Args:
        solid: SOLID of the shape.
        p: Point, world [m].
        toward: Outward direction, world, unit.

    Returns:
        (depth [m], outward normal of that face, world).
    """
    q, direction = to_local(solid, minus(p, position_of(solid))), to_local(solid, toward)
    if solid.kind == ShapeKind.BOX:
        depth, n, beside = _under_box(solid.size, q, direction)
    elif solid.kind == ShapeKind.CYLINDER:
        depth, n, beside = _under_cylinder(solid.size, q, direction)
    else:
        far, n = _shape_distance(solid.kind, solid.size, q, direction)
        depth, beside = -far, 0.0
    if depth < -beside or depth == math.inf:
        depth = 0.0
    return depth, to_world(solid, n)
