"""Safety state machine of the haptic loop; its thresholds are in the SCENE record.

    OFF -> INIT -> HOMED -> READY -> ACTIVE <-> DEGRADED          any -> SAFE_STOP, E_STOP (latched)

    OFF       no parameters yet; no motion
    INIT      waiting for the device's first finite data; no motion
    HOMED     the device responds; a controller may drive to its target
    READY     target reached, or the person leads (admittance, impedance): the virtual force is still off
    ACTIVE    entered once the virtual force was below `ramp_force` for 100 ms; its factor ramps from 0 to 1
    DEGRADED  a tick was too late: the virtual force ramps down, motion is damped; back by the same soft start.
              For a simulated device (`late_latches` 0) late ticks latch no stop
    SAFE_STOP, E_STOP   no force, motion decays, until SCENE.resets changes; then INIT, never ACTIVE directly

Stop key and device button latch E_STOP, every other cause latches SAFE_STOP; E_STOP may follow SAFE_STOP, never the
reverse.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic import (
    SECOND_NS,
    Button,
    DeviceStatus,
    SafetyState,
    TripCause,
)
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.controller_slot import person_leads
from mimics_app.rendering.haptic.kernels.jumps import lags_too_far
from mimics_app.rendering.haptic.kernels.tunnel_state import TunnelStatus

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table

__all__ = [
    "HOLD",
    "IN_TIME",
    "LATE_DAMP",
    "LATE_STOP",
    "MISSED_STOP",
    "is_rendered",
    "is_stopped",
    "latch",
    "step_safety",
]

IN_TIME, HOLD, LATE_DAMP, LATE_STOP, MISSED_STOP = 0, 1, 2, 3, 4
"""Late-tick classes, SAMPLE.held."""

_QUIET_TIME = 0.1
"""Time of virtual force below ramp_force before the soft start [s]."""

_RAMP_DOWN_TIME = 0.05
"""Time in which the virtual force ramps from full to 0 in DEGRADED [s]."""


_STOP_BUTTON = int(Button.STOP)


@kernel
def is_stopped(state: StateRecord) -> bool:
    """True in the two latched states."""
    return state.safety >= SafetyState.SAFE_STOP


@kernel
def is_rendered(state: StateRecord) -> bool:
    """Whether the virtual force acts on the user."""
    return state.safety == SafetyState.ACTIVE or state.safety == SafetyState.DEGRADED


@kernel
def latch(state: StateRecord, stop: int, cause: int) -> None:
    """Enter a stop state (SAFE_STOP or E_STOP) for a cause, unless one at least as strong is latched already."""
    if state.safety >= stop:
        return
    state.safety = stop
    state.cause = cause
    state.ramp = 0.0
    state.quiet_ticks = 0
    state.tripped = 1


@kernel
def _reset_stop(scene: SceneRecord, state: StateRecord, stop_word: int) -> bool:
    """Leave a latched stop on a new SCENE.resets, once stop key and button are released; return whether it was left."""
    if scene.resets == state.resets:
        return False
    if state.safety < SafetyState.SAFE_STOP:
        state.resets = scene.resets
    elif stop_word == 0 and state.buttons & _STOP_BUTTON == 0 and state.readable == 1:
        state.resets = scene.resets
        state.safety = SafetyState.INIT
        state.cause = TripCause.NONE
        state.quiet_ticks = 0
        state.answered = 0
        return True
    return False


@kernel
def _outside_workspace(scene: SceneRecord, state: StateRecord) -> bool:
    """Whether a joint is beyond its limits by more than the margin; NaN counts as outside."""
    for i in range(scene.joints):
        if not (
            scene.joint_min[i] - scene.workspace_margin <= state.q[i] <= scene.joint_max[i] + scene.workspace_margin
        ):
            return True
    return False


@kernel
def _gave_too_much(scene: SceneRecord, state: StateRecord) -> bool:
    """Whether the contacts gave more than `energy_limit` to the handle or, under passivity control, by their credit."""
    lowest = state.observer.energy
    if scene.passivity == 1:
        lowest = min(lowest, state.acting.credit)
    return not lowest >= -scene.energy_limit


@kernel
def _point_trips(scene: SceneRecord, states: Table[StateRecord], cause: int) -> bool:
    """Whether `cause` (VELOCITY, JUMP, NOT_FOLLOWING, ENERGY or OSCILLATION) holds at any point of contact."""
    for c in range(scene.contacts):
        state = states[c]
        if cause == TripCause.VELOCITY and not norm(state.v) <= scene.velocity_limit:
            return True
        if cause == TripCause.JUMP and state.jumped == 1:
            return True
        if cause == TripCause.NOT_FOLLOWING and lags_too_far(scene, state):
            return True
        if cause == TripCause.ENERGY and _gave_too_much(scene, state):
            return True
        if cause == TripCause.OSCILLATION and state.swing.lost == 1:
            return True
    return False


@kernel
def _motion_cause(scene: SceneRecord, states: Table[StateRecord]) -> TripCause:
    """Cause in the measured motion that latches SAFE_STOP in this tick, or NONE."""
    cause = TripCause.NONE
    if _point_trips(scene, states, TripCause.VELOCITY):
        cause = TripCause.VELOCITY
    elif _point_trips(scene, states, TripCause.JUMP):
        cause = TripCause.JUMP
    elif _point_trips(scene, states, TripCause.NOT_FOLLOWING):
        cause = TripCause.NOT_FOLLOWING
    return cause


@kernel
def _largest_force(scene: SceneRecord, states: Table[StateRecord]) -> float:
    """Largest virtual force on a point of contact [N]."""
    largest = norm(states[0].f_virt_world)
    for c in range(1, scene.contacts):
        largest = max(largest, norm(states[c].f_virt_world))
    return largest


@kernel
def _is_strained(scene: SceneRecord, states: Table[StateRecord]) -> bool:
    """Whether the measured force at any point of contact is beyond its limit; NaN counts as beyond."""
    for c in range(scene.contacts):
        if not norm(states[c].f_meas) <= scene.measured_force_limit:
            return True
    return False


@kernel
def _late_cause(held: int) -> TripCause:
    """Cause of a late-tick class beyond HOLD."""
    return TripCause.MISSED_IN_ROW if held == MISSED_STOP else TripCause.LATE_TICK


@kernel
def _find_trip(scene: SceneRecord, states: Table[StateRecord], status: int, held: int, dt: float) -> TripCause:
    """Cause that latches SAFE_STOP in this tick, or NONE."""
    cause, state = TripCause.NONE, states[0]
    if state.readable == 0 or state.tunnel.status == TunnelStatus.NOT_FINITE or state.objects_failed == 1:
        cause = TripCause.NOT_FINITE
    elif status == DeviceStatus.FAULT:
        cause = TripCause.DEVICE_FAULT
    elif state.safety >= SafetyState.HOMED and held >= LATE_STOP and scene.late_latches == 1:
        cause = _late_cause(held)
    elif state.safety >= SafetyState.HOMED and int(state.age * SECOND_NS + 0.5) > scene.stale_stop_ns:
        cause = TripCause.STALE_DEVICE
    elif state.safety >= SafetyState.HOMED and _outside_workspace(scene, state):
        cause = TripCause.WORKSPACE
    elif state.safety >= SafetyState.HOMED and _motion_cause(scene, states) != TripCause.NONE:
        cause = _motion_cause(scene, states)
    elif _point_trips(scene, states, TripCause.ENERGY):
        cause = TripCause.ENERGY
    elif _point_trips(scene, states, TripCause.OSCILLATION):
        cause = TripCause.OSCILLATION
    elif state.safety >= SafetyState.HOMED and state.strained_ticks * dt * SECOND_NS > scene.stale_stop_ns:
        cause = TripCause.SENSOR
    return cause


@kernel
def _come_up(scene: SceneRecord, state: StateRecord, quiet: bool) -> None:
    """Advance from OFF to ACTIVE, at most one state per tick; READY returns to HOMED when a PD target moves away."""
    safety = state.safety
    haptic = person_leads(scene)
    if safety == SafetyState.OFF:
        state.safety = SafetyState.INIT if scene.sequence > 0 else SafetyState.OFF
    elif safety == SafetyState.INIT:
        state.safety = SafetyState.HOMED if state.answered == 1 else SafetyState.INIT
    elif safety == SafetyState.HOMED:
        state.safety = SafetyState.READY if haptic or state.arrived == 1 else SafetyState.HOMED
    elif haptic:
        state.safety = SafetyState.ACTIVE if quiet else SafetyState.READY
    else:
        state.safety = SafetyState.READY if state.arrived == 1 else SafetyState.HOMED


@kernel
def _stay_active(scene: SceneRecord, state: StateRecord, quiet: bool, held: int) -> None:
    """Step ACTIVE and DEGRADED: HOMED under another controller, DEGRADED when late, ACTIVE again when quiet."""
    if not person_leads(scene):
        state.safety = SafetyState.HOMED
    elif state.safety == SafetyState.ACTIVE and held >= LATE_DAMP:
        state.safety = SafetyState.DEGRADED
        state.cause = _late_cause(held)
        state.tripped = 1
    elif state.safety == SafetyState.DEGRADED and state.ramp == 0.0 and quiet:
        state.safety = SafetyState.ACTIVE
        state.cause = TripCause.NONE


@kernel
def _move_ramp(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Move the soft-start factor: up in ACTIVE over ramp_time, down in DEGRADED, zero elsewhere."""
    if state.safety == SafetyState.ACTIVE:
        state.ramp = min(1.0, state.ramp + dt / scene.ramp_time) if scene.ramp_time > dt else 1.0
    elif state.safety == SafetyState.DEGRADED:
        state.ramp = max(0.0, state.ramp - dt / _RAMP_DOWN_TIME)
    else:
        state.ramp = 0.0


@kernel
def step_safety(
    scene: SceneRecord, states: Table[StateRecord], status: int, stop_word: int, held: int, dt: float
) -> None:
    """Step the state machine and the soft-start factor, after motion and virtual forces of the tick are known.

    Args:
        scene: SCENE record.
        states: STATE records of the points of contact; the first one is stepped.
        status: DeviceStatus of this tick's read.
        stop_word: Not 0 while the stop key requests E_STOP.
        held: Late-tick class.
        dt: Tick [s].
    """
    state = states[0]
    before = state.safety
    was_reset = _reset_stop(scene, state, stop_word)
    if stop_word != 0:
        latch(state, SafetyState.E_STOP, TripCause.STOP_KEY)
    elif state.buttons & _STOP_BUTTON != 0:
        latch(state, SafetyState.E_STOP, TripCause.DEVICE_BUTTON)
    state.strained_ticks = state.strained_ticks + 1 if _is_strained(scene, states) else 0
    cause = _find_trip(scene, states, status, held, dt)
    if cause != TripCause.NONE:
        latch(state, SafetyState.SAFE_STOP, cause)
    calm = held < LATE_DAMP and _largest_force(scene, states) < scene.ramp_force
    state.quiet_ticks = state.quiet_ticks + 1 if calm else 0
    if state.safety < SafetyState.SAFE_STOP:
        quiet = state.quiet_ticks * dt >= _QUIET_TIME
        if was_reset:
            state.safety = SafetyState.INIT
        elif state.safety < SafetyState.ACTIVE:
            _come_up(scene, state, quiet)
        else:
            _stay_active(scene, state, quiet, held)
    _move_ramp(scene, state, dt)
    state.state_changed = 1 if state.safety != before else 0
