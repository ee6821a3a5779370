"""Everything between the interaction points and the shapes of one tick: near, touched, pressed, rubbed."""

from __future__ import annotations

import math
from typing import Any

from mimics_app.contracts.haptic_objects import BodyFlag, ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.contact import forget, to_object
from mimics_app.rendering.haptic.kernels.directions import MOST_TOUCHED, note_contact
from mimics_app.rendering.haptic.kernels.objects.corner import part_walls, share_corner
from mimics_app.rendering.haptic.kernels.objects.cull import find_near
from mimics_app.rendering.haptic.kernels.objects.memory import follow_point, keep_poses, notice_changes, recall
from mimics_app.rendering.haptic.kernels.objects.mesh_walk import probe_mesh
from mimics_app.rendering.haptic.kernels.objects.records import MOST_WALLS
from mimics_app.rendering.haptic.kernels.objects.shapes import probe_shape
from mimics_app.rendering.haptic.kernels.objects.surface import anchor_stiffness, lower_by_ripple, normal_force, rub
from mimics_app.rendering.haptic.kernels.vectors import copy, rotate

__all__ = ["touch_points"]

_WALL = int(ShapeKind.WALL)
_MESH = int(ShapeKind.MESH)
_FORCE_ON_OBJECT = int(BodyFlag.FORCE_ON_OBJECT)
_TORQUE_ON_OBJECT = int(BodyFlag.TORQUE_ON_OBJECT)


@kernel
def _take_point(desk: Any, point: int, rows: Any, work: Any) -> None:
    """Put a point on the desk."""
    for i in range(3):
        desk.felt[i] = 0.0
        desk.point[i] = work.point_positions[point, i]
        desk.point_velocity[i] = work.point_velocities[point, i]
    desk.radius = rows.points[point].radius


@kernel
def _take_motion(desk: Any, motion: Any) -> None:
    """Let the shape on the desk move with its body: velocity of its origin, and spin."""
    copy(motion.omega, desk.spin)
    spin = desk.spin
    x = desk.position[0] - motion.centre[0]
    y = desk.position[1] - motion.centre[1]
    z = desk.position[2] - motion.centre[2]
    desk.drift[0] = motion.velocity[0] + spin[1] * z - spin[2] * y
    desk.drift[1] = motion.velocity[1] + spin[2] * x - spin[0] * z
    desk.drift[2] = motion.velocity[2] + spin[0] * y - spin[1] * x


@kernel
def _take_shape(desk: Any, row: int, body: int, work: Any) -> None:
    """Put the pose of a shape on the desk, and the motion of its body."""
    for i in range(3):
        desk.position[i] = work.shape_positions[row, i]
        desk.drift[i] = 0.0
        desk.spin[i] = 0.0
        for j in range(3):
            desk.rotation[i, j] = work.shape_rotations[row, i, j]
    if body >= 0:
        _take_motion(desk, work.motions[body])


@kernel
def _look(desk: Any) -> None:
    """Place and velocity of the point in the frame of the shape, (8)."""
    to_object(
        desk.rotation,
        desk.position,
        desk.drift,
        desk.spin,
        desk.point,
        desk.point_velocity,
        desk.p,
        desk.v,
    )


@kernel
def _feel(desk: Any, shape: Any, memory: Any, meshes: Any) -> bool:
    """Depth of the point in the shape, and its rate; False while they do not touch."""
    contact = memory.contact
    if shape.kind == _MESH:
        probe_mesh(meshes, shape.mesh, desk, contact)
    else:
        probe_shape(shape, desk, contact)
    if contact.depth > 0.0:
        lower_by_ripple(shape, desk.p, contact, desk.slope)
    if not contact.depth > 0.0:
        memory.touching = 0
        return False
    desk.rate = 0.0
    for i in range(3):
        desk.rate -= desk.v[i] * (contact.normal[i] - desk.slope[i])
    return True


@kernel
def _press(desk: Any, shape: Any, memory: Any, depth: float) -> bool:
    """Force of the contact at hand on the user, its normal, stiffness and damping; False when it is not finite."""
    n = memory.contact.normal
    push, desk.stiffness, desk.damping = normal_force(shape, depth, desk.rate)
    touched, force = desk.a, desk.b
    for i in range(3):
        touched[i] = desk.p[i] - desk.radius * n[i]
    rub(shape, touched, desk.v, n, push, desk.damping, memory, force)
    desk.hold = anchor_stiffness(shape) if memory.sticking == 1 else 0.0
    for i in range(3):
        force[i] += push * (n[i] - desk.slope[i])
    rotate(desk.rotation, force, desk.force)
    rotate(desk.rotation, n, desk.normal)
    # A clamp hides what is not a number, hence all that goes into it is asked too.
    total = desk.force[0] + desk.force[1] + desk.force[2] + desk.stiffness + desk.damping + desk.rate
    return math.isfinite(total)


@kernel
def _count(desk: Any, totals: Any, touched: Any, row: int, direction: Any, depth: float, is_static: bool) -> None:
    """Add the contact at hand to the results of the point and of the tick, and to the list of contacts."""
    totals.touching += 1
    totals.static_touching += 1 if is_static else 0
    totals.stiffness += desk.stiffness
    if totals.listed < MOST_TOUCHED:
        note_contact(touched[totals.listed], row, direction, desk.stiffness, desk.damping, desk.hold)
        totals.listed += 1
    else:
        totals.even_stiffness += max(desk.stiffness, desk.hold)
    for i in range(3):
        totals.shape_force[i] += desk.force[i]
        desk.felt[i] += desk.force[i]
    if depth > totals.depth:
        totals.depth = depth
        totals.shape = row
        totals.approach_speed = desk.rate
        copy(desk.normal, totals.normal)


@kernel
def _react(desk: Any, motion: Any, flags: int) -> None:
    """The opposite of the force at hand on the shape's body, at the touched point, as its flags allow."""
    force = desk.force
    motion.touched = 1
    for i in range(3):
        motion.force_user[i] += force[i]
        if flags & _FORCE_ON_OBJECT:
            motion.force[i] -= force[i]
    if not flags & _TORQUE_ON_OBJECT:
        return
    x = desk.point[0] - desk.radius * desk.normal[0] - motion.centre[0]
    y = desk.point[1] - desk.radius * desk.normal[1] - motion.centre[1]
    z = desk.point[2] - desk.radius * desk.normal[2] - motion.centre[2]
    motion.torque[0] -= y * force[2] - z * force[1]
    motion.torque[1] -= z * force[0] - x * force[2]
    motion.torque[2] -= x * force[1] - y * force[0]


@kernel
def _note_wall(desk: Any, wall: Any, row: int, contact: Any) -> None:
    """Keep what pressing a wall needs until all walls of the point are known."""
    wall.row = row
    wall.depth = contact.depth
    wall.rate = desk.rate
    rotate(desk.rotation, contact.normal, wall.normal)
    copy(wall.normal, wall.direction)
    copy(desk.slope, wall.slope)


@kernel
def _settle(desk: Any, shape: Any, row: int, memory: Any, depth: float, direction: Any, rows: Any, work: Any) -> None:
    """Press the shape at hand and hand the force to all whom it concerns; stiff it is along `direction`."""
    totals = work.totals[0]
    if not _press(desk, shape, memory, depth):
        forget(memory.contact)
        memory.touching = 0
        totals.status = 1
        return
    _count(desk, totals, work.touched, row, direction, depth, shape.body < 0)
    if shape.body >= 0:
        _react(desk, work.motions[shape.body], rows.bodies[shape.body].flags)


@kernel
def _settle_walls(desk: Any, point: int, met: int, rows: Any, work: Any) -> None:
    """Press the walls that the point at hand met, their corner shared out."""
    walls = work.walls
    if share_corner(walls, met, desk.a, desk.b, desk.c):
        part_walls(walls, met)
    for k in range(met):
        row = walls[k].row
        shape, memory = rows.shapes[row], work.memories[point, row]
        if walls[k].depth <= 0.0:
            memory.touching = 0
            continue
        _take_shape(desk, row, shape.body, work)
        _look(desk)
        copy(walls[k].slope, desk.slope)
        desk.rate = walls[k].rate
        _settle(desk, shape, row, memory, walls[k].depth, walls[k].direction, rows, work)


@kernel
def _touch_near(desk: Any, point: int, found: int, rows: Any, work: Any) -> None:
    """Press every shape that the point at hand is in, of those found near it."""
    met = 0
    for k in range(found):
        row = work.near[k]
        shape, memory = rows.shapes[row], work.memories[point, row]
        _take_shape(desk, row, shape.body, work)
        recall(desk, point, shape, work.births[row].tick, work.befores, memory)
        _look(desk)
        if not _feel(desk, shape, memory, work.meshes):
            continue
        if shape.kind == _WALL and met < MOST_WALLS:
            _note_wall(desk, work.walls[met], row, memory.contact)
            met += 1
        else:
            _settle(desk, shape, row, memory, memory.contact.depth, desk.normal, rows, work)
    if met > 0:
        _settle_walls(desk, point, met, rows, work)


@kernel
def touch_points(rows: Any, work: Any, counts: Any, dt: float) -> None:
    """Forces between the points in use and all shapes: on the user, and the opposite on the bodies.

    Args:
        rows: Tables of objects.
        work: ObjectWork with points and shapes placed for this tick; `point_forces`, `totals` (shape_force, stiffness,
            touching, static_touching, listed, even_stiffness, depth, shape, normal, approach_speed, status), `touched`
            and the bodies' force, torque, force_user, touched are added to. A force that is not finite is left out,
            status becomes 1.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    if counts.shapes == 0:
        return
    desk = work.desk[0]
    notice_changes(rows.shapes, work.motions, counts, desk, work.births, work.befores)
    for point in range(counts.points):
        is_enabled = rows.points[point].enabled != 0
        _take_point(desk, point, rows, work)
        follow_point(desk, point, is_enabled, dt)
        if not is_enabled:
            continue
        found = find_near(work.bounds, counts.shapes, desk.point, desk.radius, work.near)
        if found > 0:
            _touch_near(desk, point, found, rows, work)
        for i in range(3):
            work.point_forces[point, i] += desk.felt[i]
    keep_poses(work.motions, counts.bodies, work.befores)
