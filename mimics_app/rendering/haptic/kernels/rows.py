"""The vectors a tick leaves: the command to the device and the sample row of the recording."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SafetyState
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_STATE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_Q,
)
from mimics_app.rendering.haptic.kernels.objects.published import sum_motions

__all__ = ["write_command", "write_inputs", "write_objects", "write_outputs"]

Vec = NDArray[np.float64]

_HOMED = int(SafetyState.HOMED)
_SAFE_STOP = int(SafetyState.SAFE_STOP)


@kernel
def write_command(state: Any, command: Vec) -> None:
    """Command vector for the device."""
    for i in range(3):
        command[COMMAND_DQ + i] = state.command[i]
        command[COMMAND_FORCE + i] = state.f_command[i]
    command[COMMAND_ENABLED] = 1.0 if _HOMED <= state.safety < _SAFE_STOP else 0.0
    command[COMMAND_STATE] = float(state.safety)


@kernel
def write_inputs(
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
    row.delay = data[DATA_DELAY]
    row.status = float(status)
    row.sequence = float(state.sequence)
    row.stop_word = float(stop_word)
    row.held = float(held)
    row.period_s = period


@kernel
def write_outputs(state: Any, row: Any) -> None:
    """The part of the sample row that a replay compares."""
    for i in range(3):
        row.hip_world[i] = state.hip_world[i]
        row.v_world[i] = state.v_world[i]
        row.f_virt_world[i] = state.f_virt_world[i]
        row.f_user_world[i] = state.f_user_world[i]
        row.f_tunnel[i] = state.tunnel.force_tnb[i]
        row.v_virtual[i] = state.v_virtual[i]
        row.command[i] = state.command[i]
        row.f_command[i] = state.f_command[i]
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
    row.stiffness_share = state.stiffness_share
    row.credit = state.acting.credit
    row.passivity = state.acting.passivity
    row.tank = state.acting.tank
    row.tank_share = state.acting.tank_share


@kernel
def write_objects(work: Any, counts: Any, row: Any) -> None:
    """What the objects did in this tick, likewise."""
    totals = work.totals[0]
    for i in range(3):
        row.f_shapes[i] = totals.shape_force[i]
        row.f_effects[i] = totals.effect_force[i]
        row.f_grip[i] = totals.grip_force[i]
    row.touching = float(totals.touching)
    row.depth = totals.depth
    row.touched_shape = float(totals.shape)
    row.held_body = float(totals.held)
    row.bodies = sum_motions(work.motion_words, counts.bodies)
