"""From forces to commands: the controller that acts, the limits behind it, and the commands while none may act.

A controller is a plug-in (contracts/loop/controller_port.py). What it wishes is limited here in the same way for each:
speed and acceleration of joints and points, the brake at the joint limits, forces with their rise and power; and it
must be finite. The points of a polar device (SCENE.polar, as the HapticMaster) are limited as one vector, from which
the joints follow; those of any other device by one factor on its joints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.function_pointers import functions_at
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.controller_port import CONTROLLER_FUNCTION
from mimics_app.contracts.loop.controller_slots import CommandKind, Slot, TargetKind
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.maths.vec import all_finite, clamp_norm, copy, fill, norm, scale
from mimics_app.rendering.haptic.kernels.acting import drop_force, payable_share, tank_level
from mimics_app.rendering.haptic.kernels.admittance import limit_motion
from mimics_app.rendering.haptic.kernels.controller_slot import drives_to_target, moves_mass, person_leads
from mimics_app.rendering.haptic.kernels.joints import (
    find_jacobian,
    points_of,
    rates_of,
    share_below,
    torques_of,
    velocities_of,
)
from mimics_app.rendering.haptic.kernels.limiter import (
    brake_at_limits,
    decay,
    lever_of,
    limit_force,
    limit_joints,
    limit_torques,
)
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table

__all__ = ["control", "draw_along", "note_arrival"]


# Impedance control: motion in, force out, for devices that take forces and have a small inertia.
#
#     F = F_virtual - b v
#
# Gravity and inertia of the device are not compensated. The viscosity b is rendered to give a light device a known
# damping. To a trial's start a spring and damper draw the device behind a reference that moves as the PD controllers of
# D2.1 4.2.5 and 4.2.6 command.


@kernel
def draw_along(
    x: Vec, v: Vec, v_reference: Vec, stiffness: float, damping: float, most: float, dt: float, reference: Vec, f: Vec
) -> None:
    """Compute the force f [N] that draws the device behind a reference moving at v_reference.

    The reference waits for the device: its distance is at most the one at which the spring alone reaches `most`.

    Args:
        x: Position of the device [m], shape [3], any frame.
        v: Its velocity [m/s].
        v_reference: Velocity of the reference [m/s].
        stiffness: Stiffness of the spring [N/m], > 0.
        damping: Damping beside it [N s/m].
        most: Largest force [N].
        dt: Tick [s].
        reference: Position of the reference [m]; advanced.
        f: Out: force [N].
    """
    for i in range(3):
        f[i] = reference[i] + v_reference[i] * dt - x[i]
    clamp_norm(f, most / stiffness)
    for i in range(3):
        reference[i] = x[i] + f[i]
        f[i] = stiffness * f[i] + damping * (v_reference[i] - v[i])
    clamp_norm(f, most)


@kernel
def draw_joints(
    q: Vec, dq: Vec, dq_reference: Vec, jacobian: Vec, rows: int, gains: Vec, dt: float, reference: Vec, tau: Vec
) -> None:
    """Compute torques tau [N, N m] that draw the joints behind a reference moving at dq_reference; it waits for them.

    Stiffness and damping at the points are scaled by the square of each joint's lever arm to them, the force limit by
    its length, so that a singular pose blocks no joint.

    Args:
        q: Joints, shape [joints] or longer, like all vectors below.
        dq: Joint velocities.
        dq_reference: Joint velocities of the reference.
        jacobian: Jacobian of all points, row by row.
        rows: Number of its rows.
        gains: Stiffness [N/m] > 0, damping [N s/m], and largest force [N] at a point, shape [3].
        dt: Tick [s].
        reference: Joints of the reference; advanced.
        tau: Out: torques, shape [joints].
    """
    joints = tau.shape[0]
    for j in range(joints):
        lever = lever_of(jacobian, rows, joints, j)
        stiffness, damping, most = gains[0] * lever * lever, gains[1] * lever * lever, gains[2] * lever
        reach = most / stiffness if stiffness > 0.0 else 0.0
        gap = min(reach, max(-reach, reference[j] + dq_reference[j] * dt - q[j]))
        reference[j] = q[j] + gap
        tau[j] = min(most, max(-most, stiffness * gap + damping * (dq_reference[j] - dq[j])))


_EXTRA_DAMPING = 30.0
"""Addition to the virtual damping while the virtual force is off or ramping down [N s/m]."""

_MOST_DAMPING = 0.5
"""Largest virtual damping [virtual masses per tick]; from 2 on the virtual mass would oscillate alone."""

_ARRIVED_DISTANCE = 1e-3
"""Largest distance from the target of a point that has arrived [m]."""

_ROUNDING = 1e-13
"""Relative excess of a speed that is none [-]."""

_ARRIVED_SPEED = 5e-3
"""Largest speed of a point that has arrived [m/s]."""

_LEFT_DISTANCE, _LEFT_SPEED = 2e-3, 25e-3
"""Beyond these [m, m/s] a point that had arrived has left: one step of a coarse encoder at a foot is 20 mm/s."""


@kernel
def _find_velocities(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dq: Vec) -> None:
    """Set v_virtual of every point from the joint velocities dq."""
    work = states[0].joint_work
    velocities_of(kin, scene, states[0].q, dq, work, work.velocities)
    for c in range(scene.contacts):
        copy(work.velocities[3 * c : 3 * c + 3], states[c].v_virtual)


@kernel
def _describe(scene: SceneRecord, state: StateRecord) -> None:
    """Write to control.now what the parameter block says to a controller; call it when the block changed."""
    now = state.control.now
    now.joints, now.contacts = scene.joints, scene.contacts
    copy(scene.geometry, now.geometry)
    for j in range(MAX_JOINTS):
        now.joint_inertia[j] = scene.joint_inertia[j]
    copy(scene.joint_min, now.joint_min)
    copy(scene.joint_max, now.joint_max)
    copy(scene.target, now.target)
    now.virtual_mass = scene.virtual_mass
    now.max_acceleration, now.max_velocity = scene.max_acceleration, scene.max_velocity


@kernel
def _begin_output(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Write to control.out the motion commanded in the last tick or, of a controller of forces, no force."""
    state, out = states[0], states[0].control.out
    out.braked = out.stop = out.gait = out.free_leg = 0
    out.belt = 1.0
    out.strikes[0] = out.strikes[1] = -1
    if scene.commands[scene.controller] != CommandKind.VELOCITY:
        fill(out.force, 0.0)
        fill(out.torque, 0.0)
        return
    out.points_given = 0
    copy(state.dq_virtual, out.dq)
    for c in range(scene.contacts):
        for i in range(3):
            out.v[3 * c + i] = states[c].v_virtual[i]


@kernel
def _observe(scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Write to control.now what a controller sees in this tick."""
    state, now = states[0], states[0].control.now
    damping = scene.virtual_damping
    if state.safety != SafetyState.ACTIVE:
        damping += _EXTRA_DAMPING
    now.virtual_damping = min(damping, _MOST_DAMPING * scene.virtual_mass / dt)
    now.dt, now.tick, now.safety, now.ramp = dt, state.tick, state.safety, state.ramp
    copy(state.q, now.q)
    copy(state.dq, now.dq)
    if scene.torques == 1:
        copy(state.torque_meas, now.torque_meas)
    if scene.objects.curves > 0:
        now.phase = state.phase
        copy(state.q_reference, now.q_reference)
        copy(state.dq_reference, now.dq_reference)
        copy(state.ddq_reference, now.ddq_reference)
        copy(state.guidance, now.guidance)
    for c in range(scene.contacts):
        point = states[c]
        for i in range(3):
            now.x[3 * c + i] = point.hip[i]
            now.v[3 * c + i] = point.v[i]
            now.f_meas[3 * c + i] = point.f_meas[i]
            now.f_user[3 * c + i] = point.f_user[i]


@kernel
def _take_over(scene: SceneRecord, state: StateRecord) -> None:
    """Note in control.now.started whether another controller acted in the last tick; its memory is cleared then."""
    control = state.control
    control.now.started = 1 if control.slot != scene.controller else 0
    if control.now.started == 1:
        control.slot = scene.controller
        fill(control.memory, 0.0)
        fill(control.out.numbers, 0.0)


@kernel
def _take_call(scene: SceneRecord, state: StateRecord) -> None:
    """Write to control.now.obstacle what a person called since the last tick; not what was called in a stop."""
    now, called = state.control.now, scene.obstacle_calls != state.obstacle_calls
    state.obstacle_calls = scene.obstacle_calls
    now.obstacle = 1 + scene.obstacle if called and now.started == 0 else 0


@kernel
def _compute(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Let the selected controller write control.out."""
    control, slot = states[0].control, scene.controller
    _take_over(scene, states[0])
    _take_call(scene, states[0])
    _observe(scene, states, dt)
    _begin_output(scene, states)
    controller = functions_at(control.functions[slot], CONTROLLER_FUNCTION)
    controller(
        kin,
        control.now,
        scene.controller_parameters[slot],
        control.memory[:],
        states[0].joint_work,
        control.out,
    )


@kernel
def _approach(kin: Kin, scene: SceneRecord, state: StateRecord, acceleration: float, speed: float, dt: float) -> None:
    """Move dq_virtual towards control.out.dq within `speed` and `acceleration` of every point, scaled as a whole."""
    work, wish = state.joint_work, state.control.out.dq
    velocities_of(kin, scene, state.q, wish, work, work.velocities)
    share = share_below(scene.contacts, work.velocities, speed)
    for j in range(scene.joints):
        wish[j] = share * wish[j] - state.dq_virtual[j]
    velocities_of(kin, scene, state.q, wish, work, work.velocities)
    share = share_below(scene.contacts, work.velocities, acceleration * dt)
    for j in range(scene.joints):
        state.dq_virtual[j] += share * wish[j]


@kernel
def _drive_to_target(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Follow the wish of a controller that drives to SCENE.target, limited in acceleration and speed as a whole vector.

    A person may hold the handle: the motion is slow, and its acceleration is limited to twice the deceleration.
    """
    state, work, wish = states[0], states[0].joint_work, states[0].control.out.dq
    speed = min(scene.max_velocity, scene.drive_speed)
    acceleration = min(scene.max_acceleration, 2.0 * speed * scene.drive_rate)
    if scene.polar == 1:
        velocities_of(kin, scene, state.q, wish, work, state.work_a)
        limit_motion(state.v_virtual, acceleration, speed, dt, state.work_a)
        copy(state.work_a, state.v_virtual)
        rates_of(kin, scene, state.q, state.v_virtual, work, state.dq_virtual)
    else:
        _approach(kin, scene, state, acceleration, speed, dt)
        _find_velocities(kin, scene, states, state.dq_virtual)


@kernel
def note_arrival(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Set state.arrived: a controller drives, and every point is at its target and slow, or still near it and slow."""
    state, work = states[0], states[0].joint_work
    distance, speed = (_LEFT_DISTANCE, _LEFT_SPEED) if state.arrived == 1 else (_ARRIVED_DISTANCE, _ARRIVED_SPEED)
    state.arrived = 0
    if not drives_to_target(scene):
        return
    if scene.targets[scene.controller] == TargetKind.JOINTS:
        points_of(kin, scene, scene.target, work.place)
    else:
        copy(scene.target, work.place)
    arrived = 1
    for c in range(scene.contacts):
        for i in range(3):
            state.work_a[i] = work.place[3 * c + i] - states[c].hip[i]
        if not (norm(state.work_a) < distance and norm(states[c].v) < speed):
            arrived = 0
    state.arrived = arrived


@kernel
def _follow_mass(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Take the motion of what the controller simulates: its joint velocities, and those of the points."""
    state, out = states[0], states[0].control.out
    for j in range(scene.joints):
        state.dq_virtual[j] = out.dq[j]
    if out.points_given == 1:
        for c in range(scene.contacts):
            copy(out.v[3 * c : 3 * c + 3], states[c].v_virtual)
    else:
        _find_velocities(kin, scene, states, state.dq_virtual)


@kernel
def _render_forces(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Set f_command of every point: the virtual force on the user, and what a controller adds to it."""
    added = states[0].control.added_force
    for c in range(scene.contacts):
        point = states[c]
        copy(point.f_user, point.f_command)
        for i in range(3):
            if added[3 * c + i] != 0.0:
                point.f_command[i] += added[3 * c + i]


@kernel
def _drop_added(state: StateRecord) -> None:
    """Take away at once what a controller added to the force on the user."""
    fill(state.control.added_force, 0.0)
    fill(state.control.added_torque, 0.0)


@kernel
def _hold_command(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Repeat the last command within the limits at the present pose, and the force on the user as limited before."""
    state, work = states[0], states[0].joint_work
    if person_leads(scene):
        _render_forces(scene, states)
    brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
    velocities_of(kin, scene, state.q, state.command, work, work.velocities)
    share = share_below(scene.contacts, work.velocities, scene.max_velocity)
    if share < 1.0:
        scale(state.command, share)


@kernel
def _stop(scene: SceneRecord, states: Table[StateRecord], cause: int, dt: float) -> None:
    """Latch SAFE_STOP for a TripCause of the controller; no force, and the last command decays."""
    state = states[0]
    latch(state, SafetyState.SAFE_STOP, cause)
    state.state_changed = 1
    _drop_added(state)
    for c in range(scene.contacts):
        drop_force(states[c])
        fill(states[c].f_command, 0.0)
        fill(states[c].v_virtual, 0.0)
    fill(state.dq_virtual, 0.0)
    decay(state.command, dt)


@kernel
def _velocities_finite(scene: SceneRecord, states: Table[StateRecord]) -> bool:
    for c in range(scene.contacts):
        if not all_finite(states[c].v_virtual):
            return False
    return True


@kernel
def _keep_speed(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Scale dq_virtual to `max_velocity` at every point, after all that changes it: joint limits turn the motion."""
    state, work = states[0], states[0].joint_work
    velocities_of(kin, scene, state.q, state.dq_virtual, work, work.velocities)
    share = share_below(scene.contacts, work.velocities, scene.max_velocity * (1.0 + _ROUNDING))
    if share < 1.0:
        scale(state.dq_virtual, share)
        _find_velocities(kin, scene, states, state.dq_virtual)


@kernel
def _control_motion(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Set the joint velocities for a velocity-driven device, after the controller, if one acts."""
    state, work = states[0], states[0].joint_work
    if state.control.slot == Slot.OFF:
        decay(state.command, dt)
        copy(state.command, state.dq_virtual)
        _find_velocities(kin, scene, states, state.dq_virtual)
    elif moves_mass(scene):
        _follow_mass(kin, scene, states)
    else:
        _drive_to_target(kin, scene, states, dt)
    each = scene.each_joint[scene.controller] == 1
    dq, step = state.dq_virtual[: scene.joints], work.step[: scene.joints]
    limited = limit_joints(state.command, scene.joint_velocity, scene.joint_acceleration, each, dt, step, dq)
    if brake_at_limits(state.q, scene.joint_min, scene.joint_max, dq) or limited:
        _find_velocities(kin, scene, states, state.dq_virtual)
    _keep_speed(kin, scene, states)
    if all_finite(dq) and _velocities_finite(scene, states):
        copy(state.dq_virtual, state.command)
    else:
        _stop(scene, states, TripCause.NOT_FINITE, dt)


@kernel
def _limit_drive(scene: SceneRecord, point: StateRecord, dt: float, wanted: Vec) -> None:
    """Move f_command towards `wanted` [N] within the limits of the force on the user."""
    rise = scene.force_rate_limit * dt
    if not limit_force(wanted, 1.0, scene.force_limit, rise, point.v, scene.power_limit, point.f_command, point.work_b):
        copy(wanted, point.f_command)  # not finite: the caller stops


@kernel
def _is_drawn(scene: SceneRecord) -> bool:
    """Whether a spring draws a force-driven device to the target of a controller of velocities."""
    return drives_to_target(scene) and scene.commands[scene.controller] == CommandKind.VELOCITY


@kernel
def _draw_points(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Set the forces that draw a force-driven device to a target, within the limits of the force on the user."""
    _drive_to_target(kin, scene, states, dt)
    for c in range(scene.contacts):
        point = states[c]
        draw_along(
            point.hip,
            point.v,
            point.v_virtual,
            scene.drive_stiffness,
            scene.drive_damping,
            min(scene.drive_force, scene.force_limit),
            dt,
            point.reference,
            point.work_a,
        )
        _limit_drive(scene, point, dt, point.work_a)


@kernel
def _added_limit(scene: SceneRecord, states: Table[StateRecord]) -> float:
    """Largest force [N] that a controller may add: what the virtual force leaves of the limit, or that of a drive."""
    if not person_leads(scene):
        return min(scene.drive_force, scene.force_limit)
    virtual = 0.0
    for c in range(scene.contacts):
        virtual = max(virtual, norm(states[c].f_user))
    return max(0.0, scene.force_limit - virtual)


@kernel
def _pay_added(scene: SceneRecord, state: StateRecord, added: Vec, rates: Vec, dt: float) -> None:
    """Scale what a controller adds to `power_limit` and, where the person leads, to what the energy tank can pay.

    Args:
        scene: SCENE record.
        state: STATE record of the device, whose tank pays.
        added: Forces at the points [N], or torques at the joints [N, N m]; scaled.
        rates: Velocities that belong to them.
        dt: Tick [s].
    """
    power = 0.0
    for i in range(added.shape[0]):
        power += added[i] * rates[i]
    if abs(power) > scene.power_limit:
        scale(added, scene.power_limit / abs(power))
        power *= scene.power_limit / abs(power)
    if power != 0.0 and person_leads(scene):
        acting = state.acting
        share = payable_share(acting.tank, power, acting.inflow)
        scale(added, share)
        acting.tank = tank_level(acting.tank, share * power * dt, 0.0, scene.tank_size, dt)
        acting.least_tank = min(acting.least_tank, acting.tank)


@kernel
def _limit_added_forces(scene: SceneRecord, states: Table[StateRecord], dt: float) -> bool:
    """Set control.added_force from the controller's wish; return False where that is not finite."""
    state, control, points = states[0], states[0].control, 3 * scene.contacts
    ramp = state.ramp if person_leads(scene) else 1.0
    most, rise = _added_limit(scene, states), scene.force_rate_limit * dt
    for c in range(scene.contacts):
        point, first, end = states[c], 3 * c, 3 * c + 3
        wish, added = control.out.force[first:end], control.added_force[first:end]
        if not limit_force(wish, ramp, most, rise, point.v, scene.power_limit, added, point.work_b):
            return False
    _pay_added(scene, state, control.added_force[:points], control.now.v[:points], dt)
    return True


@kernel
def _limit_added_torques(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> bool:
    """Set control.added_torque from the controller's wish; return False where that is not finite."""
    state, control, joints = states[0], states[0].control, scene.joints
    work, wish, added = state.joint_work, control.out.torque[:joints], control.added_torque[:joints]
    if not all_finite(wish):
        return False
    if person_leads(scene):
        scale(wish, state.ramp)
    find_jacobian(kin, scene, state.q, work)
    most, rise = _added_limit(scene, states), scene.force_rate_limit * dt
    limit_torques(wish, work.jacobian, 3 * scene.contacts, most, rise, added)
    _pay_added(scene, state, added, state.dq[:joints], dt)
    return True


@kernel
def _limit_added(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> bool:
    """Set what the controller adds to the virtual force, at points or joints; return False where it is not finite."""
    kind = scene.commands[scene.controller]
    if states[0].control.slot != Slot.OFF and kind == CommandKind.FORCE:
        fill(states[0].control.added_torque, 0.0)
        return _limit_added_forces(scene, states, dt)
    if states[0].control.slot != Slot.OFF and kind == CommandKind.TORQUE:
        fill(states[0].control.added_force, 0.0)
        return _limit_added_torques(kin, scene, states, dt)
    _drop_added(states[0])
    return True


@kernel
def _control_force(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Set the forces for a force-driven device: the force on the user, or one that draws the device to a target.

    Both are within the same limits of force, of its change, and of power.
    """
    state, drawn, finite = states[0], _is_drawn(scene), True
    if drawn:
        _drop_added(state)
        _draw_points(kin, scene, states, dt)
    else:
        copy(state.q, state.joint_reference)
        for c in range(scene.contacts):
            copy(states[c].hip, states[c].reference)
            fill(states[c].v_virtual, 0.0)
        finite = _limit_added(kin, scene, states, dt)
        _render_forces(scene, states)
    for c in range(scene.contacts):
        finite = finite and all_finite(states[c].f_command)
    if scene.polar == 1 or not drawn:
        fill(state.dq_virtual, 0.0)
    fill(state.command, 0.0)
    if not finite:
        _stop(scene, states, TripCause.NOT_FINITE, dt)


@kernel
def _draw_joints(kin: Kin, scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Set the torque_command that draws the joints along with dq_virtual, within the limits of the force on the user.

    The force of a joint's torque is that at the points of contact: the torque over its lever arm to them.
    """
    work = state.joint_work
    find_jacobian(kin, scene, state.q, work)
    gains, joints = work.side, scene.joints
    gains[0], gains[1] = scene.drive_stiffness, scene.drive_damping
    gains[2] = min(scene.drive_force, scene.force_limit)
    tau = work.step[:joints]
    rows = 3 * scene.contacts
    draw_joints(state.q, state.dq, state.dq_virtual, work.jacobian, rows, gains, dt, state.joint_reference, tau)
    rise = scene.force_rate_limit * dt
    if not all_finite(tau):
        fill(tau, 0.0)
    limit_torques(tau, work.jacobian, rows, scene.force_limit, rise, state.torque_command[:joints])


@kernel
def _find_torques(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Set torque_command: J^T f of the commanded forces, and what a controller adds; not finite, they become 0."""
    state, work = states[0], states[0].joint_work
    for c in range(scene.contacts):
        copy(states[c].f_command, work.forces[3 * c : 3 * c + 3])
    torques_of(kin, scene, state.q, work.forces, work, state.torque_command)
    for j in range(scene.joints):
        if state.control.added_torque[j] != 0.0:
            state.torque_command[j] += state.control.added_torque[j]
    if not all_finite(state.torque_command):
        fill(state.torque_command, 0.0)


@kernel
def _command_torques(kin: Kin, scene: SceneRecord, states: Table[StateRecord], held: int, dt: float) -> None:
    """Set the torques of a torque-driven device: of forces and controller, or of a drive, which is held when late."""
    state = states[0]
    if not _is_drawn(scene) or scene.force_driven == 0 or is_stopped(state) or state.safety < SafetyState.HOMED:
        _find_torques(kin, scene, states)
    elif held != HOLD:
        _draw_joints(kin, scene, state, dt)


@kernel
def _rest(scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Let the command decay, without force: no controller acts."""
    state = states[0]
    state.control.slot = Slot.OFF
    _drop_added(state)
    copy(state.q, state.joint_reference)
    decay(state.command, dt)
    brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
    fill(state.dq_virtual, 0.0)
    for c in range(scene.contacts):
        fill(states[c].v_virtual, 0.0)
        fill(states[c].f_command, 0.0)
        copy(states[c].hip, states[c].reference)


@kernel
def _note_gait(state: StateRecord) -> None:
    """Note the gait state of the controller, and whether it changed: where it does not act, the brakes hold both legs.

    A controller without gait states has none; nor has one that never acted.
    """
    out, before = state.control.out, state.gait_state
    if state.control.slot == Slot.OFF and out.gait != 0:
        out.gait, out.free_leg = 1 + GaitState.STANDING, 0
    state.gait_state, state.free_leg = out.gait - 1, out.free_leg - 1
    state.left_strikes, state.right_strikes = out.strikes[0], out.strikes[1]
    state.gait_changed = 1 if state.gait_state != before and out.gait != 0 else 0


@kernel
def control(kin: Kin, scene: SceneRecord, states: Table[StateRecord], held: int, dt: float) -> None:
    """Set this tick's command, velocities, forces or torques: of the controller, held in a late tick, or decaying."""
    state = states[0]
    if state.parameters_taken == 1:
        _describe(scene, state)
    if is_stopped(state) or state.safety < SafetyState.HOMED:
        _rest(scene, states, dt)
    elif held == HOLD:
        _hold_command(kin, scene, states)
    else:
        if drives_to_target(scene) or (person_leads(scene) and state.safety >= SafetyState.READY):
            _compute(kin, scene, states, dt)
        else:
            state.control.slot = Slot.OFF
        if scene.force_driven == 1:
            _control_force(kin, scene, states, dt)
        else:
            for c in range(scene.contacts):
                copy(states[c].f_user, states[c].f_command)
            _control_motion(kin, scene, states, dt)
        stop = state.control.out.stop
        if state.control.slot != Slot.OFF and stop != 0:
            sensed = stop == TripCause.NOT_FOLLOWING or stop == TripCause.SENSOR
            _stop(scene, states, stop if sensed else TripCause.CONTROLLER, dt)
    _note_gait(state)
    if scene.torques == 1:
        _command_torques(kin, scene, states, held, dt)
