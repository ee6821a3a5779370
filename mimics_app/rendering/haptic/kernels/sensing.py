"""Device data into motion, forces and ball size: the first part of a tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.contracts.loop.haptic import SECOND_NS, DeviceStatus
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.contracts.loop.loop_ports import (
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
    DATA_TORQUE,
)
from mimics_app.maths.vec import copy, fill, rotate
from mimics_app.rendering.haptic.kernels.joints import points_of, to_robot, velocities_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table

__all__ = ["find_motion", "read_sample", "size_ball"]


_BALL_TIME = 0.05
"""Time constant with which the ball follows the grasp force [s]."""

_LARGEST_PLAUSIBLE = 1e6
"""Magnitude from which a number of the device counts as not finite [its own unit]."""


@kernel
def _is_plausible(data: Vec) -> bool:
    """Whether all numbers are finite and below `_LARGEST_PLAUSIBLE`; the comparison is false for NaN."""
    plausible = data[DATA_BUTTONS] >= 0.0
    for i in range(data.shape[0]):  # without a branch, so that several are compared at once
        plausible &= abs(data[i]) < _LARGEST_PLAUSIBLE
    return plausible


@kernel
def _take_forces(states: Table[StateRecord], contacts: int, data: Vec) -> None:
    """Set measured force and grasp force of every point of contact."""
    for c in range(contacts):
        states[c].grasp = data[DATA_GRASP + c]
        copy(data[DATA_FORCE + 3 * c : DATA_FORCE + 3 * c + 3], states[c].f_meas)


@kernel
def read_sample(scene: SceneRecord, states: Table[StateRecord], data: Vec, status: int, dt: float) -> None:
    """Take fresh, finite device data into the states; other data leaves the last valid positions unchanged."""
    state = states[0]
    state.readable = 1
    if status != DeviceStatus.FRESH:
        state.age += dt
    elif _is_plausible(data):
        copy(data[DATA_Q : DATA_Q + MAX_JOINTS], state.q)
        copy(data[DATA_DQ : DATA_DQ + MAX_JOINTS], state.dq)
        copy(data[DATA_TORQUE : DATA_TORQUE + MAX_JOINTS], state.torque_meas)
        _take_forces(states, scene.contacts, data)
        state.buttons = int(data[DATA_BUTTONS])
        state.age = max(0.0, data[DATA_AGE])
        state.delay = data[DATA_DELAY]
        state.answered = 1
    else:
        state.readable = 0
        fill(state.dq, 0.0)
        fill(state.torque_meas, 0.0)
        for c in range(scene.contacts):
            fill(states[c].f_meas, 0.0)
    was_stale = state.stale
    state.stale = 1 if int(state.age * SECOND_NS + 0.5) > scene.stale_warn_ns else 0
    state.stale_began = 1 if state.stale == 1 and was_stale == 0 and state.answered == 1 else 0


@kernel
def _place(scene: SceneRecord, state: StateRecord, x: Vec, v: Vec, f: Vec) -> None:
    """Set position and velocity of one point in robot and world frame, and its measured force in the world."""
    copy(x, state.hip)
    copy(v, state.v)
    rotate(scene.R_world_from_robot, state.hip, state.hip_world)
    for i in range(3):
        state.hip_world[i] += scene.origin_world[i]
    rotate(scene.R_world_from_robot, state.v, state.v_world)
    rotate(scene.R_world_from_robot, f, state.f_meas_world)


@kernel
def find_motion(kin: Kin, scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Set position, velocity and measured force of every point of contact."""
    state, work = states[0], states[0].joint_work
    points_of(kin, scene, state.q, work.points)
    velocities_of(kin, scene, state.q, state.dq, work, work.velocities)
    for c in range(scene.contacts):
        copy(states[c].f_meas, work.place[3 * c : 3 * c + 3])
    to_robot(kin, scene, state.q, work.place, work.forces)
    for c in range(scene.contacts):
        first, end = 3 * c, 3 * c + 3
        _place(scene, states[c], work.points[first:end], work.velocities[first:end], work.forces[first:end])


@kernel
def size_ball(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Set the ball radius from the grasp force: largest without grasp, smallest at grasp_force_full, smoothed."""
    share = state.grasp / scene.grasp_force_full if scene.grasp_force_full > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    target = scene.ball_radius_max - share * (scene.ball_radius_max - scene.ball_radius_min)
    last = state.ball_radius
    if last == 0.0:
        last = target
    state.ball_radius = last + (target - last) * min(1.0, dt / _BALL_TIME)
    state.ball_radius_rate = (state.ball_radius - last) / dt
