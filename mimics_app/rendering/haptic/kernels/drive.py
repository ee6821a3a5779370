"""From forces to commands: the controller of a tick, and what it sends while it may not act.

Of a polar device (SCENE.polar, the HapticMaster's kind) the velocity of its one point is led and joints follow; of any
other the joints are led and their points follow.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.device_descriptor import Kin
from mimics_app.contracts.haptic import AdmittanceForm, Controller, SafetyState, TripCause
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.control.admittance import admit, limit_motion
from mimics_app.rendering.haptic.control.impedance import draw_along, draw_joints
from mimics_app.rendering.haptic.control.joint_admittance import admit_joints
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.control.world_pd import world_pd_straight, world_pd_through_joints
from mimics_app.rendering.haptic.kernels.joints import (
    find_jacobian,
    points_of,
    rates_of,
    to_tool,
    torques_of,
    velocities_of,
)
from mimics_app.rendering.haptic.kernels.limiter import brake_at_limits, limit_joints, settle
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch, lets_feel
from mimics_app.rendering.haptic.kernels.vectors import all_finite, copy, fill, norm, scale

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SceneRecord, StateRecord, Table

__all__ = ["control", "note_arrival"]


_EXTRA_DAMPING = 30.0
"""Added to the virtual damping while the virtual force is off or ramping down [N s/m]."""

_DRIVE_SPEED = 0.3
"""Largest speed of a PD controller [m/s]."""

_ARRIVED_DISTANCE = 1e-3
_ARRIVED_SPEED = 5e-3
_READY = int(SafetyState.READY)
_HOMED = int(SafetyState.HOMED)
_ACTIVE = int(SafetyState.ACTIVE)
_SAFE_STOP = int(SafetyState.SAFE_STOP)
_NOT_FINITE = int(TripCause.NOT_FINITE)


@kernel
def _find_velocities(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dq: Vec) -> None:
    """v_virtual of every point while the joints move with dq."""
    work = states[0].joint_work
    velocities_of(kin, scene, states[0].q, dq, work, work.velocities)
    for c in range(scene.contacts):
        copy(work.velocities[3 * c : 3 * c + 3], states[c].v_virtual)


@kernel
def _share_below(scene: SceneRecord, velocities: Vec, most: float) -> float:
    """Largest share of velocities of the points that leaves each within `most` [m/s], 0-1."""
    share = 1.0
    for c in range(scene.contacts):
        speed = norm(velocities[3 * c : 3 * c + 3])
        if speed > most:
            share = min(share, most / speed)
    return share


@kernel
def _wish(kin: Kin, scene: SceneRecord, state: StateRecord) -> None:
    """joint_work.wish: joint velocities that the PD controller requests."""
    work = state.joint_work
    if scene.controller == Controller.JOINT_PD:
        joint_pd(state.q, state.dq, scene.target, scene.kp, scene.kd, work.wish)
    elif scene.through_joints == 1:
        world_pd_through_joints(kin, scene, state.q, state.dq, work, work.wish)
    else:
        world_pd_straight(kin, scene, state.q, state.dq, work, work.wish)


@kernel
def _approach(kin: Kin, scene: SceneRecord, state: StateRecord, acceleration: float, speed: float, dt: float) -> None:
    """dq_virtual towards the wish, no point faster than `speed` nor harder than `acceleration`; all scaled alike."""
    work = state.joint_work
    velocities_of(kin, scene, state.q, work.wish, work, work.velocities)
    share = _share_below(scene, work.velocities, speed)
    for j in range(scene.joints):
        work.wish[j] = share * work.wish[j] - state.dq_virtual[j]
    velocities_of(kin, scene, state.q, work.wish, work, work.velocities)
    share = _share_below(scene, work.velocities, acceleration * dt)
    for j in range(scene.joints):
        state.dq_virtual[j] += share * work.wish[j]


@kernel
def _drive_to_target(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """PD controller towards SCENE.target, limited in acceleration and speed as a whole vector.

    A person's hand is on the handle: the drive is slow, and starts no harder than twice what it brakes with.
    """
    state, work = states[0], states[0].joint_work
    _wish(kin, scene, state)
    speed = min(scene.max_velocity, _DRIVE_SPEED)
    gentle = 2.0 * speed * max(scene.kp[0], scene.kp[1], scene.kp[2])
    acceleration = min(scene.max_acceleration, gentle)
    if scene.polar == 1:
        velocities_of(kin, scene, state.q, work.wish, work, state.work_a)
        limit_motion(state.v_virtual, acceleration, speed, dt, state.work_a)
        copy(state.work_a, state.v_virtual)
        rates_of(kin, scene, state.q, state.v_virtual, work, state.dq_virtual)
    else:
        _approach(kin, scene, state, acceleration, speed, dt)
        _find_velocities(kin, scene, states, state.dq_virtual)


@kernel
def note_arrival(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """state.arrived: a PD controller's target is within 1 mm and the robot at rest within 5 mm/s, at every point."""
    state, work = states[0], states[0].joint_work
    state.arrived = 0
    if scene.controller == Controller.JOINT_PD:
        points_of(kin, scene, scene.target, work.place)
    elif scene.controller == Controller.WORLD_PD:
        copy(scene.target, work.place)
    else:
        return
    arrived = 1
    for c in range(scene.contacts):
        for i in range(3):
            state.work_a[i] = work.place[3 * c + i] - states[c].hip[i]
        if not (norm(state.work_a) < _ARRIVED_DISTANCE and norm(states[c].v) < _ARRIVED_SPEED):
            arrived = 0
    state.arrived = arrived


@kernel
def _follow_hand(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Admittance: measured and virtual force move the virtual mass, or the masses at all points."""
    state = states[0]
    damping = scene.virtual_damping
    if state.safety != _ACTIVE:
        damping += _EXTRA_DAMPING
    if scene.polar == 0:
        admit_joints(kin, scene, states, scene.virtual_mass, damping, dt, state.dq_virtual)
        _find_velocities(kin, scene, states, state.dq_virtual)
        share = _share_below(scene, state.joint_work.velocities, scene.max_velocity)
        if share < 1.0:
            scale(state.dq_virtual, share)
            _find_velocities(kin, scene, states, state.dq_virtual)
        return
    to_tool(kin, scene, state.q, state.f_user, state.work_b)
    for i in range(3):
        state.work_b[i] += state.f_meas[i]
    admit(
        scene.form,
        state.q,
        state.work_b,
        scene.virtual_mass,
        damping,
        scene.max_acceleration,
        scene.max_velocity,
        scene.geometry[0],
        dt,
        state.work_a,
        state.v_virtual,
        state.dq_virtual,
    )


@kernel
def _hold(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """The last command again, within the limits of where the robot is by now; so the force, as the user feels it."""
    state, work = states[0], states[0].joint_work
    if lets_feel(scene.controller):
        for c in range(scene.contacts):
            copy(states[c].f_user, states[c].f_command)
    brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
    velocities_of(kin, scene, state.q, state.command, work, work.velocities)
    share = _share_below(scene, work.velocities, scene.max_velocity)
    if share < 1.0:
        scale(state.command, share)


@kernel
def _give_up(scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """What would be sent is not finite: a latched stop, and nothing."""
    state = states[0]
    latch(state, _SAFE_STOP, _NOT_FINITE)
    state.state_changed = 1
    for c in range(scene.contacts):
        fill(states[c].f_user_world, 0.0)
        fill(states[c].f_user, 0.0)
        fill(states[c].f_command, 0.0)
        fill(states[c].v_virtual, 0.0)
    fill(state.dq_virtual, 0.0)
    settle(state.command, dt)


@kernel
def _velocities_finite(scene: SceneRecord, states: Table[StateRecord]) -> bool:
    for c in range(scene.contacts):
        if not all_finite(states[c].v_virtual):
            return False
    return True


@kernel
def _control_motion(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Joint velocities for a device that follows them."""
    state, work = states[0], states[0].joint_work
    if scene.controller == Controller.ADMITTANCE and state.safety >= _READY:
        _follow_hand(kin, scene, states, dt)
    elif scene.controller == Controller.JOINT_PD or scene.controller == Controller.WORLD_PD:
        _drive_to_target(kin, scene, states, dt)
    else:
        settle(state.command, dt)
        copy(state.command, state.dq_virtual)
        _find_velocities(kin, scene, states, state.dq_virtual)
    each = scene.polar == 1 and scene.form == AdmittanceForm.SEED and scene.controller == Controller.ADMITTANCE
    limited = limit_joints(
        state.command, scene.joint_velocity, scene.joint_acceleration, each, dt, work.step, state.dq_virtual
    )
    if brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.dq_virtual) or limited:
        _find_velocities(kin, scene, states, state.dq_virtual)
    if all_finite(state.dq_virtual) and _velocities_finite(scene, states):
        copy(state.dq_virtual, state.command)
    else:
        _give_up(scene, states, dt)


@kernel
def _control_force(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Forces for a device that renders them: what the user is to feel, or what draws the device to a target."""
    state = states[0]
    drives = scene.controller == Controller.JOINT_PD or scene.controller == Controller.WORLD_PD
    if drives:
        _drive_to_target(kin, scene, states, dt)
    else:
        copy(state.q, state.joint_reference)
    finite = True
    for c in range(scene.contacts):
        point = states[c]
        if drives:
            draw_along(
                point.hip,
                point.v,
                point.v_virtual,
                scene.drive_stiffness,
                scene.drive_damping,
                scene.drive_force,
                dt,
                point.reference,
                point.f_command,
            )
        else:
            copy(point.hip, point.reference)
            fill(point.v_virtual, 0.0)
            copy(point.f_user, point.f_command)
        finite = finite and all_finite(point.f_command)
    if scene.polar == 1 or not drives:
        fill(state.dq_virtual, 0.0)
    fill(state.command, 0.0)
    if not finite:
        _give_up(scene, states, dt)


@kernel
def _draw_joints(kin: Kin, scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """torque_command that draws the joints along with dq_virtual."""
    work = state.joint_work
    find_jacobian(kin, scene, state.q, work)
    gains, joints = work.side, scene.joints
    gains[0], gains[1], gains[2] = scene.drive_stiffness, scene.drive_damping, scene.drive_force
    tau = state.torque_command[:joints]
    rows = 3 * scene.contacts
    draw_joints(state.q, state.dq, state.dq_virtual, work.jacobian, rows, gains, dt, state.joint_reference, tau)


@kernel
def _find_torques(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """torque_command = J^T of the forces sent, for a device that takes torques; what is not finite is nothing."""
    state, work = states[0], states[0].joint_work
    for c in range(scene.contacts):
        copy(states[c].f_command, work.forces[3 * c : 3 * c + 3])
    torques_of(kin, scene, state.q, work.forces, work, state.torque_command)
    if not all_finite(state.torque_command):
        fill(state.torque_command, 0.0)


@kernel
def _command_torques(kin: Kin, scene: SceneRecord, states: Table[StateRecord], held: int, dt: float) -> None:
    """Torques of a device that takes them: of the forces felt, or what draws its joints; when late the last ones."""
    state = states[0]
    drives = scene.controller == Controller.JOINT_PD or scene.controller == Controller.WORLD_PD
    if not drives or scene.force_driven == 0 or is_stopped(state) or state.safety < _HOMED:
        _find_torques(kin, scene, states)
    elif held != HOLD:
        _draw_joints(kin, scene, state, dt)


@kernel
def control(kin: Kin, scene: SceneRecord, states: Table[StateRecord], held: int, dt: float) -> None:
    """What to send, velocities or forces: from the controller, held, or dying away."""
    state = states[0]
    if is_stopped(state) or state.safety < _HOMED:
        copy(state.q, state.joint_reference)
        settle(state.command, dt)
        brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
        fill(state.dq_virtual, 0.0)
        for c in range(scene.contacts):
            fill(states[c].v_virtual, 0.0)
            fill(states[c].f_command, 0.0)
            copy(states[c].hip, states[c].reference)
    elif held == HOLD:
        _hold(kin, scene, states)
    elif scene.force_driven == 1:
        _control_force(kin, scene, states, dt)
    else:
        for c in range(scene.contacts):
            copy(states[c].f_user, states[c].f_command)
        _control_motion(kin, scene, states, dt)
    if scene.torques == 1:
        _command_torques(kin, scene, states, held, dt)
