"""Positions that no hand can have moved to: a device that lost count, was restarted, or was pulled out and put back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.haptic import (
    NANOSECOND,
    DeviceStatus,
)
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SceneRecord, StateRecord

__all__ = ["note_jump"]


@kernel
def note_jump(scene: SceneRecord, state: StateRecord, status: int, last_age: float, dt: float) -> None:
    """state.jumped: the position moved further than `velocity_limit` allows, whatever the reported velocity says.

    |x_k - x_j| > velocity_limit (t_k - t_j + late_hold) + position_jump, where x_j is the position before, as old as
    its age said; a tick may come late by `late_hold` before anything else notices.

    Args:
        scene: SCENE record.
        state: STATE record; hip as just found.
        status: DeviceStatus of this tick's read.
        last_age: Age of the data before this tick's [s].
        dt: Tick [s].
    """
    state.jumped = 0
    if status != DeviceStatus.FRESH or state.readable == 0:
        return
    if state.placed == 1:
        square = 0.0
        for i in range(3):
            square += (state.hip[i] - state.last_hip[i]) ** 2
        reach = scene.velocity_limit * (last_age + dt + NANOSECOND * scene.late_hold_ns) + scene.position_jump
        state.jumped = 0 if square <= reach * reach else 1
    state.placed = 1
    copy(state.hip, state.last_hip)
