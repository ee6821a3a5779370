"""Contact of the interaction points with the shapes in one tick: culling, contact tests, forces, reaction on bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import BodyFlag, ShapeKind
from mimics_app.maths.vec import copy, rotate
from mimics_app.rendering.haptic.kernels.contact import forget, sphere, to_object, wall
from mimics_app.rendering.haptic.kernels.directions import MAX_TOUCHED, note_contact
from mimics_app.rendering.haptic.kernels.objects.corner import orthogonalise, share_corner
from mimics_app.rendering.haptic.kernels.objects.cull import find_near
from mimics_app.rendering.haptic.kernels.objects.memory import follow_point, keep_poses, notice_changes, recall
from mimics_app.rendering.haptic.kernels.objects.mesh_walk import probe_mesh
from mimics_app.rendering.haptic.kernels.objects.records import MAX_WALLS
from mimics_app.rendering.haptic.kernels.objects.shapes_box import box
from mimics_app.rendering.haptic.kernels.objects.shapes_round import capsule, cylinder
from mimics_app.rendering.haptic.kernels.objects.surface_force import (
    anchor_stiffness,
    lower_by_ripple,
    normal_force,
    set_friction,
)

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        ContactRecord,
        ContactScratchRecord,
        Floats,
        MemoryRecord,
        MeshTable,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        Rows,
        ShapeRecord,
        Table,
        TotalsRecord,
        TouchedRecord,
        WallTouchRecord,
    )

__all__ = ["touch_points"]

_FORCE_ON_OBJECT = int(BodyFlag.FORCE_ON_OBJECT)
_TORQUE_ON_OBJECT = int(BodyFlag.TORQUE_ON_OBJECT)


@kernel
def _take_point(scratch: ContactScratchRecord, point: int, rows: Rows, work: ObjectWork) -> None:
    """Copy a point to the scratch."""
    for i in range(3):
        scratch.on_point[i] = 0.0
        scratch.point[i] = work.point_positions[point, i]
        scratch.point_velocity[i] = work.point_velocities[point, i]
    scratch.radius = rows.points[point].radius
    scratch.contact = rows.points[point].contact


@kernel
def _take_motion(scratch: ContactScratchRecord, motion: MotionRecord) -> None:
    """Set velocity of origin and angular velocity of the shape in the scratch from its body."""
    copy(motion.omega, scratch.spin)
    spin = scratch.spin
    x = scratch.position[0] - motion.centre[0]
    y = scratch.position[1] - motion.centre[1]
    z = scratch.position[2] - motion.centre[2]
    scratch.drift[0] = motion.velocity[0] + spin[1] * z - spin[2] * y
    scratch.drift[1] = motion.velocity[1] + spin[2] * x - spin[0] * z
    scratch.drift[2] = motion.velocity[2] + spin[0] * y - spin[1] * x


@kernel
def _take_shape(scratch: ContactScratchRecord, row: int, body: int, work: ObjectWork) -> None:
    """Copy the pose of a shape to the scratch, and the motion of its body."""
    for i in range(3):
        scratch.position[i] = work.shape_positions[row, i]
        scratch.drift[i] = 0.0
        scratch.spin[i] = 0.0
        for j in range(3):
            scratch.rotation[i, j] = work.shape_rotations[row, i, j]
    if body >= 0:
        _take_motion(scratch, work.motions[body])


@kernel
def _to_shape(scratch: ContactScratchRecord) -> None:
    """Set position and velocity of the point in the frame of the shape, (8)."""
    to_object(
        scratch.rotation,
        scratch.position,
        scratch.drift,
        scratch.spin,
        scratch.point,
        scratch.point_velocity,
        scratch.p,
        scratch.v,
    )


@kernel
def _probe_shape(shape: ShapeRecord, scratch: ContactScratchRecord, contact: ContactRecord) -> None:
    """Find depth and normal of the present point in any analytic shape.

    Args:
        shape: SHAPE row of the present shape.
        scratch: CONTACT_SCRATCH record with p, v and radius; its vectors a and b are overwritten.
        contact: Record of `CONTACT`, updated; depth 0 outside.
    """
    p, v, radius = scratch.p, scratch.v, scratch.radius
    if shape.kind == ShapeKind.SPHERE:
        sphere(p, v, shape.size[0] + radius, contact)
    elif shape.kind == ShapeKind.BOX:
        core = scratch.a
        for i in range(3):
            core[i] = shape.size[i] - 2.0 * shape.rounding
        box(p, v, core, shape.rounding + radius, contact)
    elif shape.kind == ShapeKind.CYLINDER:
        core_length = shape.size[1] - 2.0 * shape.rounding
        cylinder(p, v, shape.size[0] - shape.rounding, core_length, shape.rounding + radius, contact)
    elif shape.kind == ShapeKind.CAPSULE:
        capsule(p, v, shape.size[0] + radius, shape.size[1], scratch.a, scratch.b, contact)
    elif shape.kind == ShapeKind.WALL:
        p[2] -= radius
        wall(p, contact)
        p[2] += radius


@kernel
def _probe(scratch: ContactScratchRecord, shape: ShapeRecord, memory: MemoryRecord, meshes: MeshTable) -> bool:
    """Find depth of the point in the shape, and its rate; False while they do not touch."""
    contact = memory.contact
    if shape.kind == ShapeKind.MESH:
        probe_mesh(meshes, shape.mesh, scratch, contact)
    else:
        _probe_shape(shape, scratch, contact)
    scratch.lowered = contact.depth
    if contact.depth > 0.0:
        lower_by_ripple(shape, scratch.p, contact, scratch.slope)
    scratch.lowered -= contact.depth
    if not contact.depth > 0.0:
        memory.touching = 0
        return False
    scratch.rate = 0.0
    for i in range(3):
        scratch.rate -= scratch.v[i] * (contact.normal[i] - scratch.slope[i])
    return True


@kernel
def _press(scratch: ContactScratchRecord, shape: ShapeRecord, memory: MemoryRecord, depth: float) -> bool:
    """Set force on the user, normal, stiffness and damping of the present contact; False when one is not finite."""
    n = memory.contact.normal
    push, scratch.stiffness, scratch.damping = normal_force(shape, depth, scratch.rate)
    touched, force = scratch.a, scratch.b
    for i in range(3):
        touched[i] = scratch.p[i] - scratch.radius * n[i]
    set_friction(shape, touched, scratch.v, n, push, scratch.damping, memory, force)
    for i in range(3):
        scratch.c[i] = -scratch.stiffness * scratch.lowered * n[i] - push * scratch.slope[i]
    rotate(scratch.rotation, scratch.c, scratch.ripple)
    scratch.hold = anchor_stiffness(shape) if memory.sticking == 1 else 0.0
    for i in range(3):
        force[i] += push * (n[i] - scratch.slope[i])
    rotate(scratch.rotation, force, scratch.force)
    rotate(scratch.rotation, n, scratch.normal)
    # A clamp hides NaN, hence its inputs are tested too.
    total = scratch.force[0] + scratch.force[1] + scratch.force[2] + scratch.stiffness + scratch.damping + scratch.rate
    return math.isfinite(total)


@kernel
def _count(
    scratch: ContactScratchRecord,
    totals: TotalsRecord,
    touched: Table[TouchedRecord],
    row: int,
    direction: Floats,
    depth: float,
    is_static: bool,
) -> None:
    """Add the present contact to the totals of the point and of the tick, and to the list of contacts."""
    totals.touching += 1
    totals.static_touching += 1 if is_static else 0
    totals.stiffness += scratch.stiffness
    if totals.listed < MAX_TOUCHED:
        note_contact(touched[totals.listed], row, direction, scratch.stiffness, scratch.damping, scratch.hold)
        totals.listed += 1
    else:
        totals.even_stiffness += max(scratch.stiffness, scratch.hold)
    for i in range(3):
        totals.shape_force[i] += scratch.force[i]
        totals.ordered_force[i] += scratch.ripple[i]
        scratch.on_point[i] += scratch.force[i]
    if depth > totals.depth:
        totals.depth = depth
        totals.shape = row
        totals.approach_speed = scratch.rate
        copy(scratch.normal, totals.normal)


@kernel
def _react(scratch: ContactScratchRecord, motion: MotionRecord, flags: int) -> None:
    """Apply the opposite of the present force to the shape's body, at the touched point, as its flags allow."""
    force = scratch.force
    motion.touched |= 1 << scratch.contact
    for i in range(3):
        motion.force_user[i] += force[i]
        if flags & _FORCE_ON_OBJECT:
            motion.force[i] -= force[i]
    if not flags & _TORQUE_ON_OBJECT:
        return
    x = scratch.point[0] - scratch.radius * scratch.normal[0] - motion.centre[0]
    y = scratch.point[1] - scratch.radius * scratch.normal[1] - motion.centre[1]
    z = scratch.point[2] - scratch.radius * scratch.normal[2] - motion.centre[2]
    motion.torque[0] -= y * force[2] - z * force[1]
    motion.torque[1] -= z * force[0] - x * force[2]
    motion.torque[2] -= x * force[1] - y * force[0]


@kernel
def _note_wall(scratch: ContactScratchRecord, wall: WallTouchRecord, row: int, contact: ContactRecord) -> None:
    """Store a touched wall until all walls of the point are known."""
    wall.row = row
    wall.depth = contact.depth
    wall.rate = scratch.rate
    wall.lowered = scratch.lowered
    rotate(scratch.rotation, contact.normal, wall.normal)
    copy(wall.normal, wall.direction)
    copy(scratch.slope, wall.slope)


@kernel
def _apply(
    scratch: ContactScratchRecord,
    shape: ShapeRecord,
    row: int,
    memory: MemoryRecord,
    depth: float,
    direction: Floats,
    rows: Rows,
    work: ObjectWork,
) -> None:
    """Find the force of the present contact and add it to the totals and the body; it is stiff along `direction`."""
    totals = work.totals[scratch.contact]
    if not _press(scratch, shape, memory, depth):
        forget(memory.contact)
        memory.touching = 0
        totals.status = 1
        return
    _count(scratch, totals, work.touched[scratch.contact], row, direction, depth, shape.body < 0)
    if shape.body >= 0:
        _react(scratch, work.motions[shape.body], rows.bodies[shape.body].flags)


@kernel
def _apply_walls(scratch: ContactScratchRecord, point: int, met: int, rows: Rows, work: ObjectWork) -> None:
    """Apply the contacts of the present point with walls, which form a corner."""
    walls = work.walls
    if share_corner(walls, met, scratch.a, scratch.b, scratch.c):
        orthogonalise(walls, met)
    for k in range(met):
        row = walls[k].row
        shape, memory = rows.shapes[row], work.memories[point, row]
        if walls[k].depth <= 0.0:
            memory.touching = 0
            continue
        _take_shape(scratch, row, shape.body, work)
        _to_shape(scratch)
        copy(walls[k].slope, scratch.slope)
        scratch.rate = walls[k].rate
        scratch.lowered = walls[k].lowered
        _apply(scratch, shape, row, memory, walls[k].depth, walls[k].direction, rows, work)


@kernel
def _touch_near(scratch: ContactScratchRecord, point: int, found: int, rows: Rows, work: ObjectWork) -> None:
    """Apply the contacts of the present point with the shapes found near it."""
    met = 0
    for k in range(found):
        row = work.near[k]
        shape, memory = rows.shapes[row], work.memories[point, row]
        _take_shape(scratch, row, shape.body, work)
        recall(scratch, point, shape, work.births[row].tick, work.befores, memory)
        _to_shape(scratch)
        if not _probe(scratch, shape, memory, work.meshes):
            continue
        if shape.kind == ShapeKind.WALL and met < MAX_WALLS:
            _note_wall(scratch, work.walls[met], row, memory.contact)
            met += 1
        else:
            _apply(scratch, shape, row, memory, memory.contact.depth, scratch.normal, rows, work)
    if met > 0:
        _apply_walls(scratch, point, met, rows, work)


@kernel
def touch_points(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, dt: float) -> None:
    """Add the forces between the points in use and all shapes, on the user and the opposite on the bodies.

    Args:
        rows: Tables of objects.
        work: ObjectWork with points and shapes placed for this tick; `point_forces`, `totals` (shape_force,
            ordered_force, stiffness, touching, static_touching, listed, even_stiffness, depth, shape, normal,
            approach_speed, status), `touched` and the bodies' force, torque, force_user, touched are updated. A force
            that is not finite is dropped and sets status.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    if counts.shapes == 0:
        return
    scratch = work.contact_scratch[0]
    notice_changes(rows.shapes, work.motions, counts, scratch, work.births, work.befores)
    for point in range(counts.points):
        is_enabled = rows.points[point].enabled != 0
        _take_point(scratch, point, rows, work)
        follow_point(scratch, point, is_enabled, dt)
        if not is_enabled:
            continue
        found = find_near(work.bounds, counts.shapes, scratch.point, scratch.radius, work.near)
        if found > 0:
            _touch_near(scratch, point, found, rows, work)
        for i in range(3):
            work.point_forces[point, i] += scratch.on_point[i]
    keep_poses(work.motions, counts.bodies, work.befores)
