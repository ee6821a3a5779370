"""The vectors and records a tick leaves: command to the device, sample row of the recording, snapshot for all."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SafetyState
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_fields import LOOP_FIELDS, moves_of
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
from mimics_app.contracts.record_copy import field_copier

__all__ = ["write_command", "write_inputs", "write_outputs", "write_snapshot"]

Vec = NDArray[np.float64]

_copy_outputs = field_copier(moves_of(LOOP_FIELDS, recorded=True))
_copy_published = field_copier(moves_of(LOOP_FIELDS, recorded=False))

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
def write_outputs(state: Any, totals: Any, row: Any) -> None:
    """The part of the sample row that a replay compares."""
    _copy_outputs(state, totals, row)


@kernel
def write_snapshot(state: Any, totals: Any, t_ns: int, out: Any) -> None:
    """The newest state of a tick that was released at `t_ns`, for all who read it while the loop goes on."""
    out.tick = state.tick - 1
    out.t_ns = t_ns
    _copy_published(state, totals, out)
