"""Contact tests of one point (HIP) with one shape, in its frame (D2.1 equations 8, 13, 14, 16).

Each test fills a `CONTACT` record: depth d > 0 inside, unit outward normal, the feature of entry. The record is the
memory of one (HIP, object) pair; `forget` it on teleport, disabling, or a changed shape. Where a normal is undefined
the last valid one is kept, never NaN.

The printed equations and their corrections:

- (8) gives the position only; the rate of depth needs the velocity too, including the object's rotation.
- (13) `|HIP'| - r` and (16) `HIP'(z)` are negative inside: their springs would pull in.
- (14) `min(HIP' - dim/2)` has no absolute value, the wrong sign and the wrong extremum: inside all differences are
  negative and the smallest belongs to the FARTHEST face. Nor does it hold the face of entry as Figure 27 requires.
- The rule of Figure 27, "force cannot change direction", holds for flat faces; on a sphere the feature is held and its
  normal follows the HIP.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.maths.vec import copy, dot, fill, norm

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord

__all__ = [
    "cube",
    "forget",
    "hold_face",
    "in_box",
    "leave",
    "nearest_face",
    "remember",
    "sphere",
    "to_object",
    "wall",
]


_CENTRE = 1e-12
"""Distance from a sphere's centre below which its normal is undefined [m]."""


@kernel
def forget(contact: ContactRecord) -> None:
    """Clear the memory of a contact: the next test takes the point as a new one."""
    contact.depth = 0.0
    contact.feature = 0
    contact.inside = 0
    contact.known = 0


@kernel
def leave(p: Vec, contact: ContactRecord) -> None:
    """Note that the point p is outside."""
    forget(contact)
    remember(p, contact)


@kernel
def remember(p: Vec, contact: ContactRecord) -> None:
    """Keep p as the previous point of the next tick."""
    copy(p, contact.previous)
    contact.known = 1


@kernel
def to_object(R: Mat, centre: Vec, v_object: Vec, omega: Vec, hip: Vec, v_hip: Vec, p: Vec, v: Vec) -> None:
    """Set p and v to position and velocity of the HIP in the object's frame, (8): HIP' = R^T (HIP - centre).

    Args:
        R: World from object, shape [3, 3], orthogonal.
        centre: Origin of the object [m], world.
        v_object: Object's velocity [m/s], world.
        omega: Object's angular velocity [rad/s], world.
        hip: HIP [m], world.
        v_hip: Velocity of the HIP [m/s], world.
        p: Receives HIP' [m].
        v: Receives R^T (v_hip - v_object - omega x (HIP - centre)) [m/s]: 0 when the HIP moves with the object.
    """
    x, y, z = hip[0] - centre[0], hip[1] - centre[1], hip[2] - centre[2]
    vx = v_hip[0] - v_object[0] - (omega[1] * z - omega[2] * y)
    vy = v_hip[1] - v_object[1] - (omega[2] * x - omega[0] * z)
    vz = v_hip[2] - v_object[2] - (omega[0] * y - omega[1] * x)
    for i in range(3):
        p[i] = R[0, i] * x + R[1, i] * y + R[2, i] * z
        v[i] = R[0, i] * vx + R[1, i] * vy + R[2, i] * vz


@kernel
def wall(p: Vec, contact: ContactRecord) -> None:
    """Test a half-space z < 0 with its free side at +z, (16): d = -HIP'(z), n = +e_z. Any depth is inside."""
    if p[2] >= 0.0:
        leave(p, contact)
        return
    contact.depth = -p[2]
    _flat(2, 1.0, contact)
    contact.feature = 1
    remember(p, contact)


@kernel
def _flat(axis: int, sign: float, contact: ContactRecord) -> None:
    """Set the normal of a face, sign e_axis."""
    fill(contact.normal, 0.0)
    contact.normal[axis] = sign
    contact.inside = 1


@kernel
def sphere(p: Vec, v: Vec, radius: float, contact: ContactRecord) -> None:
    """Test a sphere, (13): d = r - |HIP'|, n = HIP' / |HIP'|, with a memory at the centre.

    A point that crosses the centre within one tick keeps its last normal, and d = r - HIP'.n continues to grow: without
    that a mass faster than r sqrt(k/m) would be pushed out behind (1.29 m/s at 50 mm, 2 kN/m, 3 kg); with it twice that
    speed is needed. On a path around the centre the normal follows the point.

    Args:
        p: HIP' [m].
        v: Velocity of the HIP [m/s] in the object's frame, which gives a first normal at the centre.
        radius: r [m], plus the radius of the HIP's ball.
        contact: Record of `CONTACT`, updated.
    """
    distance = norm(p)
    if distance >= radius:
        leave(p, contact)
        return
    n = contact.normal
    along = dot(p, n)
    if contact.inside and along < 0.0:
        contact.depth = radius - along
    else:
        if distance > _CENTRE:
            for i in range(3):
                n[i] = p[i] / distance
        elif not contact.inside:
            _against(v, n)
        contact.depth = radius - distance
    contact.inside = 1
    contact.feature = 1
    remember(p, contact)


@kernel
def _against(v: Vec, n: Vec) -> None:
    """Set n = -v / |v|, or +z for v = 0."""
    speed = norm(v)
    for i in range(3):
        n[i] = -v[i] / speed if speed > 0.0 else 0.0
    if speed == 0.0:
        n[2] = 1.0


@kernel
def cube(p: Vec, v: Vec, dimensions: Vec, contact: ContactRecord) -> None:
    """Test a box, (14) with the face of entry held while the HIP is inside (Figure 27).

    d = dim_i/2 - s HIP'_i and n = s e_i for the face on side s of axis i.
    The face is the last of the slab planes crossed by the segment from the last HIP' to this one; on an edge or corner
    the one with the larger inward speed; for a new point that is inside, the nearest face.

    Args:
        p: HIP' [m].
        v: Velocity of the HIP [m/s] in the object's frame; decides ties.
        dimensions: Edge lengths [m], shape [3], > 0.
        contact: Record of `CONTACT`, updated. Depth may exceed half the edge.
    """
    if not in_box(p, dimensions):
        leave(p, contact)
        return
    if not contact.inside:
        contact.feature = _entered_face(p, v, dimensions, contact.previous) if contact.known else 0
        if contact.feature == 0:
            contact.feature = nearest_face(p, dimensions)
    hold_face(p, dimensions, contact)


@kernel
def in_box(p: Vec, dimensions: Vec) -> bool:
    """Return whether a point is inside a box of these edge lengths [m] around the origin."""
    for i in range(3):
        if not abs(p[i]) < 0.5 * dimensions[i]:
            return False
    return True


@kernel
def hold_face(p: Vec, dimensions: Vec, contact: ContactRecord) -> None:
    """Set depth and normal of the held face."""
    face = contact.feature
    axis = abs(face) - 1
    sign = 1.0 if face > 0 else -1.0
    contact.depth = 0.5 * dimensions[axis] - sign * p[axis]
    _flat(axis, sign, contact)
    remember(p, contact)


@kernel
def nearest_face(p: Vec, dimensions: Vec) -> int:
    """Return the face of a box nearest to a point in it: the number of its axis from 1, negative at its low end."""
    nearest = 0
    for i in range(1, 3):
        if 0.5 * dimensions[i] - abs(p[i]) < 0.5 * dimensions[nearest] - abs(p[nearest]):
            nearest = i
    return nearest + 1 if p[nearest] >= 0.0 else -nearest - 1


@kernel
def _entered_face(p: Vec, v: Vec, dimensions: Vec, previous: Vec) -> int:
    """Face whose plane is crossed last by the segment previous -> p; 0 when it starts inside all slabs."""
    face = 0
    latest = -1.0
    speed = 0.0
    for i in range(3):
        half = 0.5 * dimensions[i]
        if abs(previous[i]) < half:
            continue
        sign = 1.0 if previous[i] > 0.0 else -1.0
        crossing = (sign * half - previous[i]) / (p[i] - previous[i])
        inward = -sign * v[i]
        if crossing > latest or (crossing == latest and inward > speed):
            face = i + 1 if sign > 0.0 else -i - 1
            latest = crossing
            speed = inward
    return face
