"""From forces to commands: the controller of a tick, and what it sends while it may not act."""

from __future__ import annotations

from typing import Any

from mimics_app.contracts.haptic import Controller, SafetyState, TripCause
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.control.admittance import admit, limit_motion
from mimics_app.rendering.haptic.control.impedance import draw_along
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.control.world_pd import world_pd_straight, world_pd_through_joints
from mimics_app.rendering.haptic.kernels.kinematics import (
    apply_inverse_jacobian,
    apply_jacobian,
    forward,
    robot_to_tool,
)
from mimics_app.rendering.haptic.kernels.limiter import brake_at_limits, settle
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch, lets_feel
from mimics_app.rendering.haptic.kernels.vectors import all_finite, clamp_norm, copy, fill, norm, scale

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
_JOINT_PD = int(Controller.JOINT_PD)
_WORLD_PD = int(Controller.WORLD_PD)
_ADMITTANCE = int(Controller.ADMITTANCE)


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
def note_arrival(scene: Any, state: Any) -> None:
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
def _hold(scene: Any, state: Any) -> None:
    """The last command again, within the limits of where the robot is by now; so the force, as the user feels it."""
    if lets_feel(scene.controller):
        copy(state.f_user, state.f_command)
    brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
    apply_jacobian(state.q, scene.axis_offset, state.command, state.work_a)
    if norm(state.work_a) > scene.max_velocity:
        scale(state.command, clamp_norm(state.work_a, scene.max_velocity))


@kernel
def _give_up(state: Any, dt: float) -> None:
    """What would be sent is not finite: a latched stop, and nothing."""
    latch(state, _SAFE_STOP, _NOT_FINITE)
    state.state_changed = 1
    fill(state.f_user_world, 0.0)
    fill(state.f_user, 0.0)
    fill(state.f_command, 0.0)
    fill(state.v_virtual, 0.0)
    fill(state.dq_virtual, 0.0)
    settle(state.command, dt)


@kernel
def _control_motion(scene: Any, state: Any, dt: float) -> None:
    """Joint velocities for a device that follows them."""
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
        _give_up(state, dt)


@kernel
def _control_force(scene: Any, state: Any, dt: float) -> None:
    """Force for a device that renders it: what the user is to feel, or what draws the device to a target."""
    if scene.controller == _JOINT_PD or scene.controller == _WORLD_PD:
        _drive_to_target(scene, state, dt)
        draw_along(
            state.hip,
            state.v,
            state.v_virtual,
            scene.drive_stiffness,
            scene.drive_damping,
            scene.drive_force,
            dt,
            state.reference,
            state.f_command,
        )
    else:
        copy(state.hip, state.reference)
        fill(state.v_virtual, 0.0)
        copy(state.f_user, state.f_command)
    fill(state.dq_virtual, 0.0)
    fill(state.command, 0.0)
    if not all_finite(state.f_command):
        _give_up(state, dt)


@kernel
def control(scene: Any, state: Any, held: int, dt: float) -> None:
    """What to send, velocities or a force: from the controller, held, or dying away."""
    if is_stopped(state) or state.safety < _HOMED:
        settle(state.command, dt)
        brake_at_limits(state.q, scene.joint_min, scene.joint_max, state.command)
        fill(state.v_virtual, 0.0)
        fill(state.dq_virtual, 0.0)
        fill(state.f_command, 0.0)
        copy(state.hip, state.reference)
    elif held == HOLD:
        _hold(scene, state)
    elif scene.force_driven == 1:
        _control_force(scene, state, dt)
    else:
        copy(state.f_user, state.f_command)
        _control_motion(scene, state, dt)
