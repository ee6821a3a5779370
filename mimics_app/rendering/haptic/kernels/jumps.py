"""Jumps of the measured position: an encoder lost counts, or the device was restarted or reconnected."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.haptic import NANOSECOND, DeviceStatus
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SceneRecord, StateRecord

__all__ = ["note_jump"]


@kernel
def note_jump(scene: SceneRecord, state: StateRecord, status: int, last_age: float, dt: float) -> None:
    """Set state.jumped where the position moved farther than `velocity_limit` allows, whatever the reported velocity.

    |x_k - x_j| > velocity_limit (t_k - t_j + late_hold) + position_jump, where t_j is the time of the last position x_j
    by its stated age; a tick may be late by `late_hold` before another monitor trips.

    Args:
        scene: SCENE record.
        state: STATE record with the present hip.
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
