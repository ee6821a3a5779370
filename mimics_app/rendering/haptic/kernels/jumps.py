"""Wrong positions: they jump (an encoder lost counts, the device was restarted), or do not follow what is driven."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic import NANOSECOND, DeviceStatus, SafetyState
from mimics_app.maths.vec import copy, norm
from mimics_app.rendering.haptic.kernels.controller_slot import drives_to_target

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord

__all__ = ["lags_too_far", "note_jump", "note_lag"]

_FARTHEST = 0.05
"""Way by which a driven device may stay behind [m]."""

_BEHIND = 0.5
"""Time at the speed of a drive by which it may stay behind [s]: half of what is not yet forgotten, else a slow drive of
a position that sticks would never get there."""

_FORGOTTEN = 1.0
"""Time constant with which the way is forgotten [s], so that a servo with a small error never adds up to the limit."""


@kernel
def note_lag(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Set state.lag, the way by which a point stayed behind the velocity commanded since the loop drives it alone.

    A hand that leads the device notices what is wrong; towards a target nobody does, and a position that sticks never
    arrives. Of a simulated device nothing can stick. Call it before `note_jump`, which takes the position.

    Args:
        scene: SCENE record.
        state: STATE record with the present hip, and the commanded velocity of the last tick.
        dt: Tick [s].
    """
    real = scene.force_driven == 0 and scene.late_latches == 1
    moves = SafetyState.HOMED <= state.safety < SafetyState.SAFE_STOP
    counts = drives_to_target(scene) and real and moves and state.placed == 1
    for i in range(3):
        behind = state.v_virtual[i] * dt - (state.hip[i] - state.last_hip[i])
        state.lag[i] = (1.0 - dt / _FORGOTTEN) * state.lag[i] + behind if counts else 0.0


@kernel
def lags_too_far(scene: SceneRecord, state: StateRecord) -> bool:
    """Whether the device stayed behind farther than one that follows; NaN counts as farther."""
    return not norm(state.lag) <= min(_FARTHEST, _BEHIND * min(scene.drive_speed, scene.max_velocity))


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
