"""From forces to commands: the controllers, and the commands while none of them may act.

Controllers of a polar device (SCENE.polar, as the HapticMaster) command the velocity of its one point and derive that
of the joints; those of any other device command the joints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.contracts.loop.haptic import AdmittanceForm, Controller, SafetyState, TripCause
from mimics_app.rendering.haptic.control.admittance import admit, limit_motion
from mimics_app.rendering.haptic.control.impedance import draw_along, draw_joints
from mimics_app.rendering.haptic.control.joint_admittance import admit_joints
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.control.world_pd import world_pd_straight, world_pd_through_joints
from mimics_app.rendering.haptic.kernels.acting import drop_force
from mimics_app.rendering.haptic.kernels.joints import (
    find_jacobian,
    points_of,
    rates_of,
    to_tool,
    torques_of,
    velocities_of,
)
from mimics_app.rendering.haptic.kernels.limiter import (
    brake_at_limits,
    decay,
    limit_force,
    limit_joints,
    limit_torques,
)
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch, lets_feel
from mimics_app.rendering.haptic.kernels.vectors import all_finite, copy, fill, norm, scale

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table

__all__ = ["control", "note_arrival"]


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


@kernel
def _find_velocities(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dq: Vec) -> None:
    """Set v_virtual of every point from the joint velocities dq."""
    work = states[0].joint_work
    velocities_of(kin, scene, states[0].q, dq, work, work.velocities)
    for c in range(scene.contacts):
        copy(work.velocities[3 * c : 3 * c + 3], states[c].v_virtual)


@kernel
def _share_below(scene: SceneRecord, velocities: Vec, limit: float) -> float:
    """Largest common factor 0-1 that brings the speed of every point within `limit` [m/s]."""
    share = 1.0
    for c in range(scene.contacts):
        speed = norm(velocities[3 * c : 3 * c + 3])
        if speed > limit:
            share = min(share, limit / speed)
    return share


@kernel
def _wish(kin: Kin, scene: SceneRecord, state: StateRecord) -> None:
    """Set joint_work.wish to the joint velocities requested by the PD controller."""
    work = state.joint_work
    if scene.controller == Controller.JOINT_PD:
        joint_pd(state.q, state.dq, scene.target, scene.kp, scene.kd, work.wish)
    elif scene.through_joints == 1:
        world_pd_through_joints(kin, scene, state.q, state.dq, work, work.wish)
    else:
        world_pd_straight(kin, scene, state.q, state.dq, work, work.wish)


@kernel
def _approach(kin: Kin, scene: SceneRecord, state: StateRecord, acceleration: float, speed: float, dt: float) -> None:
    """Move dq_virtual towards joint_work.wish within `speed` and `acceleration` of every point, scaled as a whole."""
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

    A person may hold the handle: the motion is slow, and its acceleration is limited to twice the deceleration.
    """
    state, work = states[0], states[0].joint_work
    _wish(kin, scene, state)
    speed = min(scene.max_velocity, scene.drive_speed)
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
    """Set state.arrived: every point is within 1 mm of a PD controller's target and slower than 5 mm/s."""
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
    """Admittance controller: measured and virtual force accelerate the virtual mass, or the masses at all points."""
    state = states[0]
    damping = scene.virtual_damping
    if state.safety != SafetyState.ACTIVE:
        damping += _EXTRA_DAMPING
    damping = min(damping, _MOST_DAMPING * scene.virtual_mass / dt)
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
def _hold_command(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Repeat the last command within the limits at the present pose, and the force on the user as limited before."""
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
def _stop_not_finite(scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Latch SAFE_STOP for a command that is not finite; no force, and the last command decays."""
    state = states[0]
    latch(state, SafetyState.SAFE_STOP, TripCause.NOT_FINITE)
    state.state_changed = 1
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
    share = _share_below(scene, work.velocities, scene.max_velocity * (1.0 + _ROUNDING))
    if share < 1.0:
        scale(state.dq_virtual, share)
        _find_velocities(kin, scene, states, state.dq_virtual)


@kernel
def _control_motion(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Set the joint velocities for a velocity-driven device."""
    state, work = states[0], states[0].joint_work
    if scene.controller == Controller.ADMITTANCE and state.safety >= SafetyState.READY:
        _follow_hand(kin, scene, states, dt)
    elif scene.controller == Controller.JOINT_PD or scene.controller == Controller.WORLD_PD:
        _drive_to_target(kin, scene, states, dt)
    else:
        decay(state.command, dt)
        copy(state.command, state.dq_virtual)
        _find_velocities(kin, scene, states, state.dq_virtual)
    each = scene.polar == 1 and scene.form == AdmittanceForm.SEED and scene.controller == Controller.ADMITTANCE
    limited = limit_joints(
        state.command, scene.joint_velocity, scene.joint_acceleration, each, dt, work.step, state.dq_virtual
    )
    if brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.dq_virtual) or limited:
        _find_velocities(kin, scene, states, state.dq_virtual)
    _keep_speed(kin, scene, states)
    if all_finite(state.dq_virtual) and _velocities_finite(scene, states):
        copy(state.dq_virtual, state.command)
    else:
        _stop_not_finite(scene, states, dt)


@kernel
def _limit_drive(scene: SceneRecord, point: StateRecord, dt: float, wanted: Vec) -> None:
    """Move f_command towards `wanted` [N] within the limits of the force on the user."""
    rise = scene.force_rate_limit * dt
    if not limit_force(wanted, 1.0, scene.force_limit, rise, point.v, scene.power_limit, point.f_command, point.work_b):
        copy(wanted, point.f_command)  # not finite: the caller stops


@kernel
def _control_force(kin: Kin, scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Set the forces for a force-driven device: the force on the user, or one that draws the device to a target.

    Both are within the same limits of force, of its change, and of power.
    """
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
                min(scene.drive_force, scene.force_limit),
                dt,
                point.reference,
                point.work_a,
            )
            _limit_drive(scene, point, dt, point.work_a)
        else:
            copy(point.hip, point.reference)
            fill(point.v_virtual, 0.0)
            copy(point.f_user, point.f_command)
        finite = finite and all_finite(point.f_command)
    if scene.polar == 1 or not drives:
        fill(state.dq_virtual, 0.0)
    fill(state.command, 0.0)
    if not finite:
        _stop_not_finite(scene, states, dt)


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
    """Set torque_command = J^T f of the commanded forces; torques that are not finite become 0."""
    state, work = states[0], states[0].joint_work
    for c in range(scene.contacts):
        copy(states[c].f_command, work.forces[3 * c : 3 * c + 3])
    torques_of(kin, scene, state.q, work.forces, work, state.torque_command)
    if not all_finite(state.torque_command):
        fill(state.torque_command, 0.0)


@kernel
def _command_torques(kin: Kin, scene: SceneRecord, states: Table[StateRecord], held: int, dt: float) -> None:
    """Set the torques of a torque-driven device: of the commanded forces, or of a PD controller, held when late."""
    state = states[0]
    drives = scene.controller == Controller.JOINT_PD or scene.controller == Controller.WORLD_PD
    if not drives or scene.force_driven == 0 or is_stopped(state) or state.safety < SafetyState.HOMED:
        _find_torques(kin, scene, states)
    elif held != HOLD:
        _draw_joints(kin, scene, state, dt)


@kernel
def control(kin: Kin, scene: SceneRecord, states: Table[StateRecord], held: int, dt: float) -> None:
    """Set this tick's command, velocities, forces or torques: of the controller, held in a late tick, or decaying."""
    state = states[0]
    if is_stopped(state) or state.safety < SafetyState.HOMED:
        copy(state.q, state.joint_reference)
        decay(state.command, dt)
        brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
        fill(state.dq_virtual, 0.0)
        for c in range(scene.contacts):
            fill(states[c].v_virtual, 0.0)
            fill(states[c].f_command, 0.0)
            copy(states[c].hip, states[c].reference)
    elif held == HOLD:
        _hold_command(kin, scene, states)
    elif scene.force_driven == 1:
        _control_force(kin, scene, states, dt)
    else:
        for c in range(scene.contacts):
            copy(states[c].f_user, states[c].f_command)
        _control_motion(kin, scene, states, dt)
    if scene.torques == 1:
        _command_torques(kin, scene, states, held, dt)
