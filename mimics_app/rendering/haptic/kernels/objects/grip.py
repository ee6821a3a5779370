"""Two-finger grip: friction holds a body between the fingers, and its weight and inertia are felt.

The fingers lie on both sides of the hand on one axis u and press inwards with the grasp force N. Each sticks to a point
of the body by a spring and damper of the body's own surface; perpendicular to u its force stays within the cone mu f of
its normal force f and slips beyond it (Hayward and Armstrong 2000), so both together carry 2 mu N. Along u the body is
held between two springs: the finger it moves into presses with N + k d + b d', the other with N - k d - b d', never
below 0. Torsion about u is held by the contact patches, up to 2/3 mu f times their radius (Coulomb friction of a disc
of uniform pressure). The user gets the opposite of the forces on the body. Each point of contact of the device grips
with its own grasp force; two of them can hold one body.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic_objects import BodyFlag, ShapeKind
from mimics_app.maths import vec
from mimics_app.rendering.haptic.kernels.friction import forget_friction, hayward_armstrong

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        BodyRecord,
        Floats,
        FrictionRecord,
        GripRecord,
        MeshRecord,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        Rows,
        ShapeRecord,
        TotalsRecord,
    )

__all__ = ["grip_bodies"]


@kernel
def half_extent(shape: ShapeRecord, R: Floats, u: Vec) -> float:
    """Half of the extent of a centrally symmetric shape along u [m].

    Args:
        shape: SHAPE record of a sphere, box, cylinder or capsule.
        R: World from shape, shape [3, 3].
        u: Unit direction, world.
    """
    along = abs(R[0, 1] * u[0] + R[1, 1] * u[1] + R[2, 1] * u[2])
    if shape.kind == ShapeKind.SPHERE:
        return shape.size[0]
    if shape.kind == ShapeKind.CAPSULE:
        return shape.size[0] + 0.5 * shape.size[1] * along
    if shape.kind == ShapeKind.CYLINDER:
        return 0.5 * shape.size[1] * along + shape.size[0] * math.sqrt(max(0.0, 1.0 - along * along))
    extent = 0.0
    for axis in range(3):
        extent += 0.5 * shape.size[axis] * abs(R[0, axis] * u[0] + R[1, axis] * u[1] + R[2, axis] * u[2])
    return extent


@kernel
def mesh_extent(mesh: MeshRecord, hulls: Floats, R: Floats, u: Vec) -> tuple[float, float]:
    """(lowest, highest) coordinate of a mesh along u from its origin [m], by the vertices of its hull.

    Args:
        mesh: MESH record of a mesh that a body carries.
        hulls: MeshTable.hulls.
        R: World from shape, shape [3, 3].
        u: Unit direction, world.
    """
    x = R[0, 0] * u[0] + R[1, 0] * u[1] + R[2, 0] * u[2]
    y = R[0, 1] * u[0] + R[1, 1] * u[1] + R[2, 1] * u[2]
    z = R[0, 2] * u[0] + R[1, 2] * u[1] + R[2, 2] * u[2]
    low, high = 0.0, 0.0
    for i in range(mesh.first_hull, mesh.first_hull + mesh.hull_corners):
        along = x * hulls[i, 0] + y * hulls[i, 1] + z * hulls[i, 2]
        low = min(low, along) if i > mesh.first_hull else along
        high = max(high, along) if i > mesh.first_hull else along
    return low, high


_TAKE_FORCE = 0.3
"""Grasp force from which the fingers count as closed [N]."""

_RELEASE_FORCE = 0.15
"""Grasp force below which closed fingers count as open [N]: a hysteresis against chatter."""

_TAKE_REACH = 0.7
"""Largest distance of a body's centre from the fingers' axis at which it can be gripped [half widths]."""

_LOSE_REACH = 1.0
"""Distance of a body's centre from the fingers' axis beyond which the fingers have slipped off [half widths]."""

_CENTRING_TIME = 0.1
"""Time constant with which closing fingers centre the body between them [s]."""

_PATCH_RADIUS = 0.3
"""Radius of the contact patch of a finger [half widths]."""

_PATCH_TIME = 0.02
"""Torsional damping over stiffness of a contact patch [s]: that of a well damped fingertip."""

_LONGEST_LEAD = 0.02
"""Largest damping over stiffness of a finger [s]: a slipping finger with more would leave the body."""

_PATCH_ARM = 2.0 / 3.0
"""Mean lever arm of Coulomb friction on a disc of uniform pressure [radii]."""

_FORCE_ON = int(BodyFlag.FORCE_ON_OBJECT)
_TORQUE_ON = int(BodyFlag.TORQUE_ON_OBJECT)

_UPRIGHT = 0.1
"""Horizontal part of a unit vector below which it counts as vertical: 6 degrees [-]."""


@kernel
def _next_point(rows: Rows, counts: ObjectCountsRecord, contact: int, begin: int) -> int:
    """First interaction point from row `begin` on that a point of contact carries; counts.points: none."""
    row = begin
    while row < counts.points and rows.points[row].contact != contact:
        row += 1
    return row


@kernel
def _find_fingers(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, contact: int, grip: GripRecord) -> float:
    """Set the frame of the grip: fingers at its first two interaction points, or along x on both sides of a single one.

    Returns:
        Half the distance between the fingers [m]; 0 for a single point; -1: it has none.
    """
    first = _next_point(rows, counts, contact, 0)
    if first >= counts.points:
        return -1.0
    last = _next_point(rows, counts, contact, first + 1)
    if last >= counts.points or rows.points[first].enabled == 0 or rows.points[last].enabled == 0:
        last = first
    length = 0.0
    for i in range(3):
        place = work.point_positions[first, i]
        grip.centre[i] = 0.5 * (place + work.point_positions[last, i])
        grip.velocity[i] = 0.5 * (work.point_velocities[first, i] + work.point_velocities[last, i])
        grip.axis[i] = work.point_positions[last, i] - place
        length += grip.axis[i] * grip.axis[i]
    length = math.sqrt(length)
    for i in range(3):
        grip.axis[i] = grip.axis[i] / length if length > 0.0 else (1.0 if i == 0 else 0.0)
    _complete_frame(grip.axis, grip.across)
    return 0.5 * length


@kernel
def _complete_frame(u: Vec, across: Floats) -> None:
    """Set two unit vectors perpendicular to u, the first horizontal unless u is vertical."""
    level = math.sqrt(u[0] * u[0] + u[2] * u[2])
    if level > _UPRIGHT:
        across[0, 0], across[0, 1], across[0, 2] = -u[2] / level, 0.0, u[0] / level
    else:
        size = math.sqrt(u[0] * u[0] + u[1] * u[1])
        across[0, 0], across[0, 1], across[0, 2] = u[1] / size, -u[0] / size, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        across[1, i] = u[j] * across[0, k] - u[k] * across[0, j]


@kernel
def _measure(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, body: int, grip: GripRecord) -> int:
    """Set grip.low and grip.high to the extent of a body along the axis.

    Returns:
        Row of its first shape, whose surface the fingers touch; -1: it has none.
    """
    surface = -1
    for k in range(counts.shapes):
        shape = rows.shapes[k]
        if shape.body != body or shape.enabled == 0 or shape.kind == ShapeKind.WALL:
            continue
        middle = 0.0
        for i in range(3):
            middle += (work.shape_positions[k, i] - grip.centre[i]) * grip.axis[i]
        if shape.kind == ShapeKind.MESH:
            mesh = work.meshes.rows[shape.mesh]
            low, high = mesh_extent(mesh, work.meshes.hulls, work.shape_rotations[k], grip.axis)
        else:
            high = half_extent(shape, work.shape_rotations[k], grip.axis)
            low = -high
        if surface < 0:
            surface = k
            grip.low = middle + low
            grip.high = middle + high
        grip.low = min(grip.low, middle + low)
        grip.high = max(grip.high, middle + high)
    return surface


@kernel
def _distance_across(motion: MotionRecord, grip: GripRecord) -> float:
    """Distance of the body's centre of mass from the fingers' axis [m]."""
    square = 0.0
    for axis in range(2):
        part = 0.0
        for i in range(3):
            part += (motion.centre[i] - grip.centre[i]) * grip.across[axis, i]
        square += part * part
    return math.sqrt(square)


@kernel
def _take(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, grip: GripRecord, span: float) -> None:
    """Grip the first body between the closing fingers, which are at +-span [m] on their axis."""
    for body in range(counts.bodies):
        if rows.bodies[body].grip == 0 or _measure(rows, work, counts, body, grip) < 0:
            continue
        half = 0.5 * (grip.high - grip.low)
        offset = 0.5 * (grip.high + grip.low)
        if _distance_across(work.motions[body], grip) > _TAKE_REACH * half or abs(offset) > max(
            0.5 * half, span - half
        ):
            continue
        grip.body = body
        grip.spawn = rows.bodies[body].spawn
        grip.crushed = -1
        grip.half_width = half
        grip.offset = offset
        grip.twist = 0.0
        _stick(work.motions[body], grip, grip.low, grip.contact_a)
        _stick(work.motions[body], grip, grip.high, grip.contact_b)
        forget_friction(grip.friction_a)
        forget_friction(grip.friction_b)
        grip.friction_a.sticking = 1
        grip.friction_b.sticking = 1
        return


@kernel
def _stick(motion: MotionRecord, grip: GripRecord, along: float, contact: Vec) -> None:
    """Set the contact point of a finger in the body's frame: on the axis, at `along` from the grip's centre [m]."""
    for i in range(3):
        grip.place[i] = grip.centre[i] + along * grip.axis[i] - motion.position[i]
    for i in range(3):
        contact[i] = 0.0
        for j in range(3):
            contact[i] += motion.rotation[j, i] * grip.place[j]


@kernel
def _locate(motion: MotionRecord, grip: GripRecord, contact: Vec) -> None:
    """Set grip.place to a contact point, from the centre of mass, and grip.moving to its velocity against the hand."""
    for i in range(3):
        grip.place[i] = motion.position[i] - motion.centre[i]
        for j in range(3):
            grip.place[i] += motion.rotation[i, j] * contact[j]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        spin = motion.omega[j] * grip.place[k] - motion.omega[k] * grip.place[j]
        grip.moving[i] = motion.velocity[i] + spin - grip.velocity[i]


@kernel
def _press(motion: MotionRecord, grip: GripRecord, k: float, b: float) -> float:
    """Force k d + b d' [N] of the displacement of the body's contact points along the axis."""
    d = 0.0
    rate = 0.0
    _locate(motion, grip, grip.contact_a)
    for i in range(3):
        d += 0.5 * (motion.centre[i] + grip.place[i] - grip.centre[i]) * grip.axis[i]
        rate += 0.5 * grip.moving[i] * grip.axis[i]
    _locate(motion, grip, grip.contact_b)
    for i in range(3):
        d += 0.5 * (motion.centre[i] + grip.place[i] - grip.centre[i]) * grip.axis[i]
        rate += 0.5 * grip.moving[i] * grip.axis[i]
    return k * (d - grip.offset) + b * rate


@kernel
def _hold_with(
    surface: ShapeRecord,
    motion: MotionRecord,
    grip: GripRecord,
    contact: Vec,
    friction: FrictionRecord,
    normal_force: float,
    side: float,
    k: float,
) -> None:
    """Set grip.force to one finger's force on the body: its push along the axis, and its friction perpendicular to it.

    Args:
        surface: SHAPE record of the touched surface.
        motion: MOTION record of the body.
        grip: GRIP record.
        contact: Contact point, body frame [m]; dragged along where it slips.
        friction: FRICTION record of this finger.
        normal_force: f [N] >= 0.
        side: +1 for the finger at +u, which pushes towards -u, -1 for the other.
        k: Stiffness perpendicular to the axis [N/m] > 0.
    """
    _locate(motion, grip, contact)
    lead = min(surface.damping / k, _LONGEST_LEAD)
    for axis in range(2):
        grip.shift[axis] = 0.0
        for i in range(3):
            away = motion.centre[i] + grip.place[i] - grip.centre[i] + lead * grip.moving[i]
            grip.shift[axis] += away * grip.across[axis, i]
    mu = surface.friction_static if friction.sticking != 0 else surface.friction_dynamic
    friction.touching = 1
    for axis in range(2):
        friction.anchor[axis] = 0.0
    hayward_armstrong(grip.shift, normal_force, mu, k, friction, grip.hold)
    if friction.touching == 0:  # a finger in the air takes its contact point with it
        friction.anchor[0], friction.anchor[1] = grip.shift[0], grip.shift[1]
    for i in range(3):
        grip.force[i] = -side * normal_force * grip.axis[i]
        slip = 0.0
        for axis in range(2):
            grip.force[i] += grip.hold[axis] * grip.across[axis, i]
            slip += friction.anchor[axis] * grip.across[axis, i]
        grip.moving[i] = slip
    for i in range(3):  # the contact point moves on the body by the slip
        for j in range(3):
            contact[i] -= motion.rotation[j, i] * grip.moving[j]


@kernel
def _add(body: BodyRecord, motion: MotionRecord, grip: GripRecord, totals: TotalsRecord) -> None:
    """Add one finger's force to the body, and its opposite to the user."""
    for i in range(3):
        j, m = (i + 1) % 3, (i + 2) % 3
        if body.flags & _FORCE_ON:
            motion.force[i] += grip.force[i]
        if body.flags & _TORQUE_ON:
            motion.torque[i] += grip.place[j] * grip.force[m] - grip.place[m] * grip.force[j]
        motion.force_user[i] -= grip.force[i]
        totals.grip_force[i] -= grip.force[i]


@kernel
def _hold_twist(
    surface: ShapeRecord, body: BodyRecord, motion: MotionRecord, grip: GripRecord, pressed: float, k: float, dt: float
) -> None:
    """Add the torque of the contact patches about the axis: a spring and damper that slips at the Coulomb torque."""
    radius = _PATCH_RADIUS * grip.half_width
    stiffness = 2.0 * k * radius * radius
    lag = _PATCH_TIME * vec.dot(motion.omega, grip.axis)
    most = surface.friction_dynamic * pressed * _PATCH_ARM * radius
    grip.twist += lag / _PATCH_TIME * dt
    torque = -stiffness * (grip.twist + lag)
    if abs(torque) > most:
        torque = math.copysign(most, torque)
        grip.twist = -torque / stiffness - lag
    if body.flags & _TORQUE_ON:
        for i in range(3):
            motion.torque[i] += torque * grip.axis[i]


@kernel
def grip_bodies(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, contact: int, grasp: float, dt: float
) -> None:
    """Grip, hold and release bodies with one point of contact for one tick.

    Adds to grip_force, stiffness, even_stiffness and even_damping of its totals, and to force, torque and force_user of
    the held body; sets totals.held, and totals.crushed once the grasp was beyond crush_force. A body without friction
    slips out; a respawned one is released.

    Args:
        rows: Tables of the main thread; bodies with `grip` set can be held.
        work: Working arrays.
        counts: OBJECT_COUNTS record.
        contact: Number of the point of contact.
        grasp: Force between its fingers [N].
        dt: Tick [s].
    """
    grip = work.grip[contact]
    if counts.points == 0 or counts.bodies == 0 or (grip.body < 0 and not grasp >= _TAKE_FORCE):
        grip.body = -1
        return
    span = _find_fingers(rows, work, counts, contact, grip)
    if span < 0.0:
        grip.body = -1
        return
    if grip.body < 0:
        _take(rows, work, counts, grip, span)
    if grip.body < 0:
        return
    if not grasp >= _RELEASE_FORCE or grip.body >= counts.bodies:
        grip.body = -1
        return
    body = rows.bodies[grip.body]
    motion = work.motions[grip.body]
    surface_row = _measure(rows, work, counts, grip.body, grip)
    lost = _distance_across(motion, grip) > _LOSE_REACH * grip.half_width
    if lost or surface_row < 0 or body.spawn != grip.spawn or body.grip == 0:
        grip.body = -1
        return
    surface = rows.shapes[surface_row]
    k = surface.friction_stiffness if surface.friction_stiffness > 0.0 else surface.stiffness
    if not k > 0.0:
        grip.body = -1
        return
    _hold_body(surface, body, motion, grip, work.totals[contact], grasp, k, dt)


@kernel
def _hold_body(
    surface: ShapeRecord,
    body: BodyRecord,
    motion: MotionRecord,
    grip: GripRecord,
    totals: TotalsRecord,
    grasp: float,
    k: float,
    dt: float,
) -> None:
    """Apply the forces of both fingers, of stiffness k [N/m], for one tick."""
    grip.offset *= math.exp(-dt / _CENTRING_TIME)
    share = _press(motion, grip, k, surface.damping)
    press_a = max(0.0, grasp - share)
    press_b = max(0.0, grasp + share)
    _hold_with(surface, motion, grip, grip.contact_a, grip.friction_a, press_a, -1.0, k)
    _add(body, motion, grip, totals)
    _hold_with(surface, motion, grip, grip.contact_b, grip.friction_b, press_b, 1.0, k)
    _add(body, motion, grip, totals)
    _hold_twist(surface, body, motion, grip, press_a + press_b, k, dt)
    motion.asleep = 0
    motion.quiet_ticks = 0
    if body.crush_force > 0.0 and grasp > body.crush_force:
        grip.crushed = grip.body
    totals.stiffness += 2.0 * k
    totals.even_stiffness += 2.0 * k
    totals.even_damping += 2.0 * surface.damping
    totals.held = grip.body
    totals.crushed = grip.crushed
