"""What the device says, as motion, force and ball: the first part of a tick."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import DeviceStatus
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_ports import DATA_AGE, DATA_BUTTONS, DATA_DELAY, DATA_DQ, DATA_FORCE, DATA_GRASP, DATA_Q
from mimics_app.rendering.haptic.kernels.kinematics import apply_jacobian, forward, tool_to_robot
from mimics_app.rendering.haptic.kernels.vectors import copy, fill, rotate

__all__ = ["find_motion", "size_ball", "take_data"]

Vec = NDArray[np.float64]

_BALL_TIME = 0.05
"""Time constant with which the ball follows the grasp force [s]."""

_ABSURD = 1e6
"""Beyond this a number from a device counts as not finite."""

_FRESH = int(DeviceStatus.FRESH)


@kernel
def _is_plausible(data: Vec) -> bool:
    """False for NaN, infinities and absurd sizes; written so that NaN fails the comparison."""
    for i in range(data.shape[0]):
        if not abs(data[i]) < _ABSURD:
            return False
    return data[DATA_BUTTONS] >= 0.0


@kernel
def take_data(scene: Any, state: Any, data: Vec, status: int, dt: float) -> None:
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
        state.delay = data[DATA_DELAY]
        state.answered = 1
    else:
        state.readable = 0
        fill(state.dq, 0.0)
        fill(state.f_meas, 0.0)
    was_stale = state.stale
    state.stale = 1 if int(state.age * 1e9 + 0.5) > scene.stale_warn_ns else 0
    state.stale_began = 1 if state.stale == 1 and was_stale == 0 and state.answered == 1 else 0


@kernel
def find_motion(scene: Any, state: Any) -> None:
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
def size_ball(scene: Any, state: Any, dt: float) -> None:
    """Ball radius from grasp force: largest open-handed, smallest at grasp_force_full, smoothed."""
    share = state.grasp / scene.grasp_force_full if scene.grasp_force_full > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    target = scene.ball_radius_max - share * (scene.ball_radius_max - scene.ball_radius_min)
    last = state.ball_radius
    if last == 0.0:
        last = target
    state.ball_radius = last + (target - last) * min(1.0, dt / _BALL_TIME)
    state.ball_radius_rate = (state.ball_radius - last) / dt
