"""The tick: device data in, command out. Live, un-timed and replayed runs call this very function.

    data -> motion -> ball -> tunnel -> safety -> limiter -> stability -> controller -> command, sample row

Everything that a tick depends on is in its arguments: the device's data and status, the stop word, the late-tick class,
the measured period and the parameter block. All are recorded, so that a recording can be simulated again bit for bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import Controller, DeviceStatus, SafetyState, TripCause
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_STATE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
)
from mimics_app.rendering.haptic.control.admittance import admit, limit_motion
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.control.world_pd import world_pd_straight, world_pd_through_joints
from mimics_app.rendering.haptic.kernels.kinematics import (
    apply_inverse_jacobian,
    apply_jacobian,
    forward,
    robot_to_tool,
    tool_to_robot,
)
from mimics_app.rendering.haptic.kernels.limiter import brake_at_limits, limit_force, settle
from mimics_app.rendering.haptic.kernels.passivity import observe, reset_observer
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch, step_safety
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, margin_of, stiffness_limit
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_ENDED, CONTACT_UNCHANGED
from mimics_app.rendering.haptic.kernels.tunnel import restart_tracking, tunnel_force
from mimics_app.rendering.haptic.kernels.vectors import all_finite, copy, fill, norm, rotate, rotate_back

__all__ = ["tick"]

Vec = NDArray[np.float64]

_BALL_TIME = 0.05
"""Time constant with which the ball follows the grasp force [s]."""

_CLEAR_TIME = 0.02
"""A contact ends after this long without touching [s]: no chatter of one scrape into many."""

_EXTRA_DAMPING = 30.0
"""Added to the virtual damping while the virtual force is off or ramping down [N s/m]."""

_ABSURD = 1e6
"""Beyond this a number from a device counts as not finite."""

_DRIVE_SPEED = 0.3
"""Largest speed of a PD controller [m/s]."""

_ARRIVED_DISTANCE = 1e-3
_ARRIVED_SPEED = 5e-3

_CALM_MARGIN = 0.05
"""A margin that fell below 0 must rise above this before it is told again."""

_READY = int(SafetyState.READY)
_HOMED = int(SafetyState.HOMED)
_ACTIVE = int(SafetyState.ACTIVE)
_DEGRADED = int(SafetyState.DEGRADED)
_SAFE_STOP = int(SafetyState.SAFE_STOP)
_NOT_FINITE = int(TripCause.NOT_FINITE)
_FRESH = int(DeviceStatus.FRESH)
_JOINT_PD = int(Controller.JOINT_PD)
_WORLD_PD = int(Controller.WORLD_PD)
_ADMITTANCE = int(Controller.ADMITTANCE)


@kernel
def _is_plausible(data: Vec) -> bool:
    """False for NaN, infinities and absurd sizes; written so that NaN fails the comparison."""
    for i in range(data.shape[0]):
        if not abs(data[i]) < _ABSURD:
            return False
    return data[DATA_BUTTONS] >= 0.0


@kernel
def _take_data(scene: Any, state: Any, data: Vec, status: int, dt: float) -> None:
    """Device data into the state; data that is not finite, or not fresh, leaves the last good motion standing."""
    state.readable = 1
    if status != _FRESH:
        state.age += dt
    elif _is_plausible(data):
        copy(data[DATA_Q : DATA_Q + 3], state.q)
        copy(data[DATA_DQ : DATA_DQ + 3], state.dq)
        copy(data[DATA_FORCE : DATA_FORCE + 3], state.f_meas)
        state.grasp = data[DATA_GRASP]
        state.buttons = int(data[DATA_BUTTONS])
        state.age = max(0.0, data[DATA_AGE])
        state.answered = 1
    else:
        state.readable = 0
        fill(state.dq, 0.0)
        fill(state.f_meas, 0.0)
    state.stale = 1 if int(state.age * 1e9 + 0.5) > scene.stale_warn_ns else 0


@kernel
def _find_motion(scene: Any, state: Any) -> None:
    """Position, velocity and measured force in robot and world frame."""
    forward(state.q, scene.axis_offset, state.hip)
    apply_jacobian(state.q, scene.axis_offset, state.dq, state.v)
    rotate(scene.R_world_from_robot, state.hip, state.hip_world)
    for i in range(3):
        state.hip_world[i] += scene.origin_world[i]
    rotate(scene.R_world_from_robot, state.v, state.v_world)
    tool_to_robot(state.q, state.f_meas, state.work_a)
    rotate(scene.R_world_from_robot, state.work_a, state.f_meas_world)


@kernel
def _size_ball(scene: Any, state: Any, dt: float) -> None:
    """Ball radius from grasp force: largest open-handed, smallest at grasp_force_full, smoothed."""
    share = state.grasp / scene.grasp_force_full if scene.grasp_force_full > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    target = scene.ball_radius_max - share * (scene.ball_radius_max - scene.ball_radius_min)
    last = state.ball_radius
    if last == 0.0:
        last = target
    state.ball_radius = last + (target - last) * min(1.0, dt / _BALL_TIME)
    state.tunnel.ball_radius_rate = (state.ball_radius - last) / dt


@kernel
def _follow_contact(state: Any, dt: float) -> None:
    """Begin and end of a contact with the wall; only what the user can feel counts."""
    state.contact_change = CONTACT_UNCHANGED
    felt = state.safety == _ACTIVE or state.safety == _DEGRADED
    touching = felt and state.tunnel.wall_force > 0.0
    state.clear_ticks = 0 if touching else state.clear_ticks + 1
    if touching and state.in_contact == 0:
        state.in_contact = 1
        state.contacts += 1
        state.contact_tick = state.tick
        state.contact_change = CONTACT_BEGAN
    elif state.in_contact == 1 and (not felt or state.clear_ticks * dt >= _CLEAR_TIME):
        state.in_contact = 0
        state.contact_change = CONTACT_ENDED


@kernel
def _limit(scene: Any, state: Any, held: int, dt: float) -> None:
    """Force the user feels: held in a late tick, zero in a stop state, else the limited and ramped virtual force."""
    if is_stopped(state):
        fill(state.f_user_world, 0.0)
    elif held != HOLD and not limit_force(
        state.f_virt_world, state.ramp, scene.force_limit, scene.force_rate_limit * dt, state.f_user_world
    ):
        latch(state, _SAFE_STOP, _NOT_FINITE)
    rotate_back(scene.R_world_from_robot, state.f_user_world, state.f_user)


@kernel
def _share_of_wall(state: Any, held: int) -> None:
    """The wall's part of the force the user feels: the limiter scales the whole, a held tick holds it too."""
    if held == HOLD and not is_stopped(state):
        return
    wanted = norm(state.f_virt_world)
    scale = state.tunnel.wall_force * norm(state.f_user_world) / wanted if wanted > 0.0 else 0.0
    for i in range(3):
        state.f_wall_world[i] = scale * state.tunnel.normal_world[i]


@kernel
def _watch_margin(scene: Any, state: Any, period: float) -> None:
    """Stability limit and margin of the wall for the measured period; tells when it is lost, and does not act."""
    tunnel = scene.tunnel
    damping = scene.virtual_damping + scene.arm_damping + tunnel.damping
    state.period = period
    state.stiffness_limit = stiffness_limit(damping, period, scene.device_delay)
    stiffness = tunnel.stiffness + tunnel.centring if tunnel.pieces > 0 else 0.0
    state.margin = margin_of(state.stiffness_limit, stiffness)
    felt = state.safety == _ACTIVE or state.safety == _DEGRADED
    state.margin_lost = 1 if felt and state.margin < 0.0 and state.warned == 0 else 0
    if state.margin_lost == 1:
        state.warned = 1
    elif state.margin > _CALM_MARGIN:
        state.warned = 0


@kernel
def _watch_contact(state: Any) -> None:
    """Energy of the contact by the passivity observer, and the worst of all contacts."""
    observer = state.observer
    if state.contact_change == CONTACT_BEGAN:
        reset_observer(observer)
    observe(observer, state.hip_world, state.f_wall_world)
    state.least_energy = min(state.least_energy, observer.lowest)
    if state.in_contact == 0:
        return
    if state.touched == 0:
        state.touched = 1
        state.least_margin = LARGEST_MARGIN
        state.least_limit = state.stiffness_limit
    state.least_margin = min(state.least_margin, state.margin)
    state.least_limit = min(state.least_limit, state.stiffness_limit)


@kernel
def _drive_to_target(scene: Any, state: Any, dt: float) -> None:
    """PD controller towards SCENE.target, limited in acceleration and speed as a whole vector.

    A person's hand is on the handle: the drive is slow, and starts no harder than twice what it brakes with.
    """
    d1 = scene.axis_offset
    wish = state.work_b
    if scene.controller == _JOINT_PD:
        joint_pd(state.q, state.dq, scene.target, scene.kp, scene.kd, wish)
    elif scene.form == 0:
        world_pd_through_joints(state.q, state.dq, scene.target, scene.kp, scene.kd, d1, state.work_a, wish)
    else:
        world_pd_straight(state.q, state.dq, scene.target, scene.kp, scene.kd, d1, state.work_a, wish)
    apply_jacobian(state.q, d1, wish, state.work_a)
    speed = min(scene.max_velocity, _DRIVE_SPEED)
    gentle = 2.0 * speed * max(scene.kp[0], scene.kp[1], scene.kp[2])
    limit_motion(state.v_virtual, min(scene.max_acceleration, gentle), speed, dt, state.work_a)
    copy(state.work_a, state.v_virtual)
    apply_inverse_jacobian(state.q, d1, state.v_virtual, state.dq_virtual)


@kernel
def _note_arrival(scene: Any, state: Any) -> None:
    """state.arrived: a PD controller's target is within 1 mm and the robot at rest within 5 mm/s."""
    state.arrived = 0
    if scene.controller == _JOINT_PD:
        forward(scene.target, scene.axis_offset, state.work_a)
    elif scene.controller == _WORLD_PD:
        copy(scene.target, state.work_a)
    else:
        return
    for i in range(3):
        state.work_a[i] -= state.hip[i]
    if norm(state.work_a) < _ARRIVED_DISTANCE and norm(state.v) < _ARRIVED_SPEED:
        state.arrived = 1


@kernel
def _follow_hand(scene: Any, state: Any, dt: float) -> None:
    """Admittance: measured and virtual force move the virtual mass."""
    robot_to_tool(state.q, state.f_user, state.work_b)
    for i in range(3):
        state.work_b[i] += state.f_meas[i]
    damping = scene.virtual_damping
    if state.safety != _ACTIVE:
        damping += _EXTRA_DAMPING
    admit(
        scene.form,
        state.q,
        state.work_b,
        scene.virtual_mass,
        damping,
        scene.max_acceleration,
        scene.max_velocity,
        scene.axis_offset,
        dt,
        state.work_a,
        state.v_virtual,
        state.dq_virtual,
    )


@kernel
def _control(scene: Any, state: Any, held: int, dt: float) -> None:
    """Joint velocities to send: from the controller, held, or dying away."""
    if is_stopped(state) or state.safety < _HOMED:
        settle(state.command, dt)
        fill(state.v_virtual, 0.0)
        fill(state.dq_virtual, 0.0)
        return
    if held == HOLD:
        return
    if scene.controller == _ADMITTANCE and state.safety >= _READY:
        _follow_hand(scene, state, dt)
    elif scene.controller == _JOINT_PD or scene.controller == _WORLD_PD:
        _drive_to_target(scene, state, dt)
    else:
        settle(state.command, dt)
        copy(state.command, state.dq_virtual)
        apply_jacobian(state.q, scene.axis_offset, state.dq_virtual, state.v_virtual)
    if brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.dq_virtual):
        apply_jacobian(state.q, scene.axis_offset, state.dq_virtual, state.v_virtual)
    if all_finite(state.dq_virtual) and all_finite(state.v_virtual):
        copy(state.dq_virtual, state.command)
    else:
        latch(state, _SAFE_STOP, _NOT_FINITE)
        state.state_changed = 1
        fill(state.f_user_world, 0.0)
        fill(state.f_user, 0.0)
        fill(state.v_virtual, 0.0)
        fill(state.dq_virtual, 0.0)
        settle(state.command, dt)


@kernel
def _write_command(state: Any, command: Vec) -> None:
    """Command vector for the device."""
    for i in range(3):
        command[COMMAND_DQ + i] = state.command[i]
        command[COMMAND_FORCE + i] = state.f_user[i]
    command[COMMAND_ENABLED] = 1.0 if _HOMED <= state.safety < _SAFE_STOP else 0.0
    command[COMMAND_STATE] = float(state.safety)


@kernel
def _write_inputs(
    data: Vec, status: int, stop_word: int, held: int, period: float, state: Any, dt: float, row: Any
) -> None:
    """The part of the sample row that a replay needs, exactly as the device gave it."""
    row.t = state.tick * dt
    row.tick = float(state.tick)
    for i in range(3):
        row.q[i] = data[DATA_Q + i]
        row.dq[i] = data[DATA_DQ + i]
        row.f_meas[i] = data[DATA_FORCE + i]
    row.grasp = data[DATA_GRASP]
    row.buttons = data[DATA_BUTTONS]
    row.age = data[DATA_AGE]
    row.status = float(status)
    row.sequence = float(state.sequence)
    row.stop_word = float(stop_word)
    row.held = float(held)
    row.period_s = period


@kernel
def _write_outputs(state: Any, row: Any) -> None:
    """The part of the sample row that a replay compares."""
    for i in range(3):
        row.hip_world[i] = state.hip_world[i]
        row.v_world[i] = state.v_world[i]
        row.f_virt_world[i] = state.f_virt_world[i]
        row.f_user_world[i] = state.f_user_world[i]
        row.f_tunnel[i] = state.tunnel.force_tnb[i]
        row.v_virtual[i] = state.v_virtual[i]
        row.command[i] = state.command[i]
    row.s = state.tunnel.s
    row.progress = state.tunnel.progress
    row.distance = state.tunnel.distance
    row.offset_n = state.tunnel.offset_n
    row.offset_b = state.tunnel.offset_b
    row.penetration = state.tunnel.penetration
    row.ball_radius = state.ball_radius
    row.tunnel_radius = state.tunnel.radius
    row.ramp = state.ramp
    row.state = float(state.safety)
    row.cause = float(state.cause)
    row.stiffness_limit = state.stiffness_limit
    row.margin = state.margin
    row.energy = state.observer.energy


@kernel
def tick(
    scene: Any,
    state: Any,
    data: Vec,
    status: int,
    stop_word: int,
    held: int,
    period: float,
    dt: float,
    command: Vec,
    row: Any,
) -> None:
    """One tick.

    Args:
        scene: SCENE record, the parameters of this tick.
        state: STATE record, advanced by one tick.
        data: What the device's read gave, shape [DATA_LENGTH].
        status: DeviceStatus of that read.
        stop_word: Not 0 while the stop key asks for E_STOP.
        held: Late-tick class of this tick (safety.IN_TIME .. MISSED_STOP).
        period: Measured period [s]; dt where nothing can be late.
        dt: Tick [s].
        command: What the device's write takes, shape [COMMAND_LENGTH], filled here.
        row: SAMPLE record, filled here except for the timing fields.
    """
    state.tripped = 0
    state.parameters_taken = 1 if scene.sequence != state.sequence else 0
    state.sequence = scene.sequence
    if scene.trial != state.trial:
        state.trial = scene.trial
        restart_tracking(state.tunnel)
    _write_inputs(data, status, stop_word, held, period, state, dt, row)

    _take_data(scene, state, data, status, dt)
    _find_motion(scene, state)
    _size_ball(scene, state, dt)
    tunnel_force(scene.tunnel, state.hip_world, state.v_world, state.ball_radius, state.tunnel)
    copy(state.tunnel.force_world, state.f_virt_world)

    _note_arrival(scene, state)
    step_safety(scene, state, status, stop_word, held, dt)
    before = state.safety
    _limit(scene, state, held, dt)
    _share_of_wall(state, held)
    _follow_contact(state, dt)
    _watch_margin(scene, state, period)
    _watch_contact(state)
    _control(scene, state, held, dt)
    if state.safety != before:
        state.state_changed = 1
    _write_command(state, command)
    _write_outputs(state, row)
    state.tick += 1
