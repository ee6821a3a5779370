"""Reference of the joints at every tick: position, velocity, acceleration, and the share of guidance towards it.

    phase' = cadence                                             [cycles/s]
    q  = rest + w (c(phase, u) - rest)
    dq = w' (c - rest) + w (c_phase phase' + c_u u')
    ddq = w'' (c - rest) + 2 w' (c_phase phase' + c_u u')
          + w (c_phase_phase phase'^2 + c_phase phase'' + 2 c_phase_u phase' u' + c_u_u u'^2 + c_u u'')

w is the amplitude, 0 in standing and 1 in the whole movement, u the speed or the step. Cadence, speed, step and
amplitude are ramps (`ramp`), so that q is smooth up to its acceleration whatever their targets do: an amplitude that
rises from 0 is the start from standing into the walk, one that falls to 0 the stop; in standing the phase returns to 0.
The guidance of every joint is a ramp, too, and 0 at once where the person does not lead.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.contracts.loop.reference_rows import GrowsWith
from mimics_app.maths.gait_series import STEP_EXPONENT
from mimics_app.rendering.haptic.reference.cycle_curves import SLOPES, curve_at

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        CurveRecord,
        RampRecord,
        ReferenceRecord,
        SceneRecord,
        StateRecord,
        Table,
    )

__all__ = ["RAMP", "REFERENCE", "SMOOTHING", "follow_target", "step_reference"]


# A parameter that follows its target within a rate limit, smooth up to its acceleration.
#
# A point is led to the target at no more than the rate; two first-order filters of SMOOTHING in a row follow it. Their
# responses are positive and have unit area, so the value's rate never exceeds the limit, its acceleration never exceeds
# the limit over SMOOTHING and is continuous, and the value does not overshoot.

SMOOTHING = 0.1
"""Time constant of each filter [s]: a tenth of a slow step."""

RAMP = np.dtype(
    [
        ("led", "f8"),  # led to the target at the rate
        ("half", "f8"),  # after the first filter
        ("value", "f8"),  # after the second
        ("rate", "f8"),  # of the value [1/s]
        ("acceleration", "f8"),  # [1/s^2]
    ],
    align=True,
)
"""One parameter on its way; zeros are at rest at 0."""


@kernel
def set_ramp(ramp: RampRecord, value: float) -> None:
    """Be at rest at a value."""
    ramp.led = ramp.half = ramp.value = value
    ramp.rate = ramp.acceleration = 0.0


@kernel
def follow_target(ramp: RampRecord, target: float, limit: float, dt: float) -> None:
    """Advance by one tick.

    Args:
        ramp: RAMP record.
        target: Target of the value, in its unit.
        limit: Largest rate [unit/s].
        dt: Tick [s], shorter than SMOOTHING.
    """
    most = limit * dt
    ramp.led += min(most, max(-most, target - ramp.led))
    first = (ramp.led - ramp.half) / SMOOTHING
    ramp.rate = (ramp.half - ramp.value) / SMOOTHING
    ramp.acceleration = (first - ramp.rate) / SMOOTHING
    ramp.half += dt * first
    ramp.value += dt * ramp.rate


_STANDS = 1e-6
"""Amplitude below which the joints stand [-]: a millionth of a step is a micrometre."""

REFERENCE = np.dtype(
    [
        ("begun", "i8"),  # 1 once the ramps are at their targets
        ("cadence", RAMP),  # [1/s]
        ("speed", RAMP),  # [m/s]
        ("step", RAMP),  # [m]
        ("amplitude", RAMP),  # [-]
        ("led", "f8", (MAX_JOINTS,)),  # guidance of each joint, led to its target [-]
        ("half", "f8", (MAX_JOINTS,)),  # after the first filter of its ramp
        ("share", RAMP),  # scratch of one joint's guidance
        ("slopes", SLOPES),  # scratch of one joint's curve
    ],
    align=True,
)
"""State of the reference, but for its outputs, which are fields of STATE; zeros are the initial state."""


@kernel
def _cadence_wanted(scene: SceneRecord) -> float:
    """Target of the cadence [1/s]: the one that is set, else the natural one of the speed."""
    if scene.reference_cadence > 0.0 or scene.natural_step <= 0.0:
        return scene.reference_cadence
    speed = scene.reference_speed
    return 0.5 * speed / (scene.natural_step * speed**STEP_EXPONENT) if speed > 0.0 else 0.0


@kernel
def _step_wanted(scene: SceneRecord, cadence: float) -> float:
    """Target of the step [m] at a cadence: half the way of a cycle, at most the longest step of the walk."""
    return min(0.5 * scene.reference_speed / cadence, scene.longest_step) if cadence > 0.0 else 0.0


@kernel
def _begin(scene: SceneRecord, reference: ReferenceRecord) -> None:
    """Start in standing, with cadence, speed and step as they are set."""
    cadence = _cadence_wanted(scene)
    set_ramp(reference.cadence, cadence)
    set_ramp(reference.speed, scene.reference_speed)
    set_ramp(reference.step, _step_wanted(scene, cadence))
    set_ramp(reference.amplitude, 0.0)
    reference.begun = 1


@kernel
def _follow_parameters(scene: SceneRecord, reference: ReferenceRecord, leads: bool, dt: float) -> None:
    cadence = _cadence_wanted(scene)
    follow_target(reference.cadence, cadence, scene.cadence_rate, dt)
    follow_target(reference.speed, scene.reference_speed, scene.speed_rate, dt)
    step_rate = scene.amplitude_rate * scene.longest_step  # a step grows like the amplitude
    follow_target(reference.step, _step_wanted(scene, cadence), step_rate, dt)
    follow_target(reference.amplitude, scene.reference_amplitude if leads else 0.0, scene.amplitude_rate, dt)


@kernel
def _advance_phase(state: StateRecord, reference: ReferenceRecord, dt: float) -> None:
    """Advance the phase; in standing it is 0."""
    amplitude = reference.amplitude
    if amplitude.led == 0.0 and amplitude.half < _STANDS and amplitude.value < _STANDS:
        set_ramp(amplitude, 0.0)
        state.phase = 0.0
        return
    phase = state.phase + dt * reference.cadence.value
    state.phase = phase - math.floor(phase)


@kernel
def _grown(curve: CurveRecord, reference: ReferenceRecord) -> tuple[float, float, float]:
    """Quantity u on which a curve depends, with its first and second derivative in time."""
    if curve.grows_with == GrowsWith.NOTHING:
        return 0.0, 0.0, 0.0
    ramp = reference.speed if curve.grows_with == GrowsWith.SPEED else reference.step
    u = math.hypot(ramp.value, curve.least)
    if u == 0.0:
        return 0.0, 0.0, 0.0
    rate = ramp.value * ramp.rate / u
    return u, rate, (ramp.rate * ramp.rate + ramp.value * ramp.acceleration - rate * rate) / u


@kernel
def _set_joint(curve: CurveRecord, reference: ReferenceRecord, state: StateRecord, joint: int) -> None:
    """Set the reference of one joint."""
    phase, w = state.phase - curve.shift, reference.amplitude
    u, du, ddu = _grown(curve, reference)
    slopes = reference.slopes
    curve_at(curve, phase - math.floor(phase), u, slopes)
    turn, dturn = reference.cadence.value, reference.cadence.rate
    away = slopes.value - curve.rest
    first = slopes.by_phase * turn + slopes.by_u * du
    second = slopes.by_phase_twice * turn * turn + slopes.by_phase * dturn
    second += 2.0 * slopes.by_both * turn * du + slopes.by_u_twice * du * du + slopes.by_u * ddu
    state.q_reference[joint] = curve.rest + w.value * away
    state.dq_reference[joint] = w.rate * away + w.value * first
    state.ddq_reference[joint] = w.acceleration * away + 2.0 * w.rate * first + w.value * second


@kernel
def _guide(
    share: RampRecord, reference: ReferenceRecord, guidance: Vec, joint: int, target: float, limit: float, dt: float
) -> None:
    """Advance the guidance of one joint."""
    share.led, share.half, share.value = reference.led[joint], reference.half[joint], guidance[joint]
    follow_target(share, target, limit, dt)
    reference.led[joint], reference.half[joint], guidance[joint] = share.led, share.half, share.value


@kernel
def step_reference(scene: SceneRecord, curves: Table[CurveRecord], state: StateRecord, leads: bool, dt: float) -> None:
    """Advance the reference of all joints by one tick.

    Args:
        scene: SCENE record: cadence, speed, amplitude, guidance and their rates; `objects.curves` counts the rows.
        curves: CURVE records, one for each joint.
        state: STATE record of the first point of contact; receives phase, q_reference, dq_reference, ddq_reference
            and guidance.
        leads: Whether the person leads the device; otherwise nothing guides, and the joints go to standing.
        dt: Tick [s].
    """
    reference = state.reference_state
    if reference.begun == 0:
        _begin(scene, reference)
    _follow_parameters(scene, reference, leads, dt)
    _advance_phase(state, reference, dt)
    state.amplitude = reference.amplitude.value
    for j in range(scene.objects.curves):
        _set_joint(curves[j], reference, state, j)
        if leads:
            target = scene.guidance * curves[j].guidance
            _guide(reference.share, reference, state.guidance, j, target, scene.guidance_rate, dt)
        else:
            state.guidance[j] = reference.led[j] = reference.half[j] = 0.0
