"""Contact tests of cylinder and capsule about the local y axis, (15) corrected, with the feature of entry held.

The printed (15) gives `sqrt(x^2 + y^2) - r` and `z - h/2`, both negative inside, no lower cap, and no rule to choose
between them. As for the box, a cylinder here is all points within a reach of its core.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import copy
from mimics_app.rendering.haptic.kernels.contact import remember, sphere
from mimics_app.rendering.haptic.kernels.objects.shapes_box import SHELL

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord

__all__ = ["CAP", "SIDE", "capsule", "cylinder"]


SIDE = 1
"""Feature: the curved side of a cylinder."""

CAP = 2
"""Feature: the cap at +y; -CAP: the cap at -y."""

_AXIS = 1e-12
"""Distance from the axis below which the radial direction is undefined [m]."""


@kernel
def _side_crossing(previous: Vec, p: Vec, radius: float) -> float:
    """Share of the segment previous -> p at which the infinite cylinder is entered; -1: it starts inside."""
    dx, dz = p[0] - previous[0], p[2] - previous[2]
    c = previous[0] * previous[0] + previous[2] * previous[2] - radius * radius
    if c < 0.0:
        return -1.0
    a = dx * dx + dz * dz
    b = previous[0] * dx + previous[2] * dz
    root = math.sqrt(max(0.0, b * b - a * c))
    return c / (root - b) if root > b else 0.0


@kernel
def _entered_feature(p: Vec, v: Vec, radius: float, half: float, previous: Vec) -> int:
    """Feature crossed last by the segment previous -> p; on the rim that of larger inward speed; 0: starts inside."""
    side = _side_crossing(previous, p, radius)
    cap = -1.0
    sign = 1.0 if previous[1] > 0.0 else -1.0
    if abs(previous[1]) >= half:
        cap = (sign * half - previous[1]) / (p[1] - previous[1])
    if side < 0.0 and cap < 0.0:
        return 0
    if side == cap:
        rho = math.hypot(previous[0], previous[2])
        inward = -(v[0] * previous[0] + v[2] * previous[2]) / rho
        return SIDE if inward >= -sign * v[1] else int(sign) * CAP
    return SIDE if side > cap else int(sign) * CAP


@kernel
def _nearest_feature(p: Vec, rho: float, radius: float, half: float) -> int:
    """Feature nearest to a point inside the core."""
    if radius - rho <= half - abs(p[1]):
        return SIDE
    return CAP if p[1] >= 0.0 else -CAP


@kernel
def _hold_side(p: Vec, v: Vec, rho: float, radius: float, fresh: bool, contact: ContactRecord) -> None:
    """Set depth and normal under the side; a point that crosses the axis within a tick keeps its last normal."""
    n = contact.normal
    along = p[0] * n[0] + p[2] * n[2]
    if not fresh and along < 0.0:
        contact.depth = radius - along
        return
    if rho > _AXIS:
        n[0], n[1], n[2] = p[0] / rho, 0.0, p[2] / rho
    elif fresh:
        speed = math.hypot(v[0], v[2])
        n[0] = -v[0] / speed if speed > 0.0 else 0.0
        n[1] = 0.0
        n[2] = -v[2] / speed if speed > 0.0 else 1.0
    contact.depth = radius - rho


@kernel
def _hold_feature(p: Vec, v: Vec, rho: float, radius: float, half: float, fresh: bool, contact: ContactRecord) -> None:
    """Set depth and normal of the held feature of the core."""
    if contact.feature == SIDE:
        _hold_side(p, v, rho, radius, fresh, contact)
        return
    sign = 1.0 if contact.feature > 0 else -1.0
    contact.depth = half - sign * p[1]
    contact.normal[0], contact.normal[1], contact.normal[2] = 0.0, sign, 0.0


@kernel
def _still_held(p: Vec, rho: float, radius: float, half: float, contact: ContactRecord) -> bool:
    """True while the point is behind the feature by which it entered the core."""
    if contact.inside == 0 or contact.feature == SHELL:
        return False
    if contact.feature == SIDE:
        return rho <= radius
    return (p[1] if contact.feature > 0 else -p[1]) <= half


@kernel
def cylinder(p: Vec, v: Vec, radius: float, length: float, reach: float, contact: ContactRecord) -> None:
    """Find depth and normal in the offset surface of a cylinder about y, (15) corrected.

    In the shell around the core the surface is smooth, rim included. In the core the feature of entry is held: a cap
    with its fixed normal, the side with one that follows the point.

    Args:
        p: HIP' [m].
        v: Velocity of the HIP [m/s] in the object's frame; decides ties, and the first normal on the axis.
        radius: Radius of the core [m] >= 0.
        length: Length of the core along y [m] >= 0.
        reach: Radius around the core [m] >= 0: rounding of the rim and radius of the point.
        contact: Record of `CONTACT`, updated; features `SIDE`, `CAP`, -`CAP`, `SHELL`.
    """
    half = 0.5 * length
    rho = math.hypot(p[0], p[2])
    side, cap = rho - radius, abs(p[1]) - half
    distance = math.hypot(max(side, 0.0), max(cap, 0.0))
    contact.depth = 0.0
    if side < 0.0 and cap < 0.0:
        fresh = contact.inside == 0 or contact.feature == SHELL
        if fresh:
            contact.feature = _entered_feature(p, v, radius, half, contact.previous) if contact.known else 0
            if contact.feature == 0:
                contact.feature = _nearest_feature(p, rho, radius, half)
        _hold_feature(p, v, rho, radius, half, fresh, contact)
        contact.depth += reach
    elif distance < reach and _still_held(p, rho, radius, half, contact):
        _hold_feature(p, v, rho, radius, half, False, contact)
        contact.depth += reach
    elif 0.0 < distance < reach:
        share = max(side, 0.0) / distance
        contact.normal[0] = share * p[0] / rho if share > 0.0 else 0.0
        contact.normal[1] = math.copysign(max(cap, 0.0), p[1]) / distance
        contact.normal[2] = share * p[2] / rho if share > 0.0 else 0.0
        contact.depth = reach - distance
        contact.feature = SHELL
    contact.inside = contact.depth > 0.0
    if contact.inside == 0:
        contact.feature = 0
    remember(p, contact)


@kernel
def capsule(p: Vec, v: Vec, radius: float, length: float, around: Vec, sideways: Vec, contact: ContactRecord) -> None:
    """Find depth and normal in a capsule: a sphere about the closest point of the axis, with a sphere's memory.

    Args:
        p: HIP' [m].
        v: Velocity of the HIP [m/s] in the object's frame.
        radius: Sum of the radii of capsule and point [m].
        length: Length of the axis between the centres of its ends, along y [m].
        around: Scratch, shape [3]: the point relative to the closest point of the axis.
        sideways: Scratch, shape [3]: its velocity perpendicular to the axis.
        contact: Record of `CONTACT`, updated.
    """
    half = 0.5 * length
    copy(p, around)
    copy(v, sideways)
    around[1] = p[1] - min(max(p[1], -half), half)
    if around[1] == 0.0:
        sideways[1] = 0.0
    sphere(around, sideways, radius, contact)
    copy(p, contact.previous)
