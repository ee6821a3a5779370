"""Detector of oscillation: softens the virtual force while it feeds a motion faster than a person's, then stops.

It bounds what no model of the loop knows. Force and motion are taken above 20 Hz, and averaged over 100 ms:

    power       mean of f.v, above 0 while the force feeds the motion
    force       root mean square of f, compared with FLOOR and with what the effects order

A contact that only rings, chatters or is knocked on takes energy; one that is unstable gives it. Once both averages and
that of the last 25 ms say so for 100 ms, the virtual force fades by 1/e in 100 ms until it is quiet; where it has faded
to a tenth and is not quiet, the state machine stops the loop in the next tick. It comes back in free motion only,
slowly. A contact that begins is given 150 ms to settle.

Forces that are ordered (vibration, stick-slip, ripples of a surface) are subtracted. They shake the hand, too, and the
contacts then answer: as many times the ordered force as ANSWER are expected.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.safety import is_rendered

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import Vec
    from mimics_app.rendering.haptic.record_types import StateRecord, SwingRecord, TotalsRecord

__all__ = ["FLOOR", "LEAST_CALM", "SWING", "begin_swing", "watch_swing"]

FLOOR = 0.5
"""Root mean square of a force that nobody minds [N]."""

ANSWER = 3.0
"""Force of the contacts that an ordered force may cause, as a multiple of it [-]."""

LEAST_CALM = 0.1
"""Share of the virtual force at which a sustained oscillation stops the loop [-]."""

_CORNER = 2.0 * math.pi * 20.0
"""Corner of each of the high-pass filters in a row [rad/s]."""

_STAGES = 4
"""High-pass filters in a row: a contact of 35 N that rings at 5 Hz keeps 0.1 N."""

_WINDOW = 0.1
"""Time of the averages, of the patience, and of the fading to 1/e [s]."""

_LATELY = 0.025
"""Time of the quick average [s]."""

_FEEDING = 0.03
"""Power as a share of the product of force and speed from which the force feeds the motion [-]."""

_SETTLING = 0.15
"""Time that a contact has to settle after it began [s], where none was before for _WINDOW."""

_REST = 0.5
"""Free motion after which the force begins to come back [s]."""

_RECOVERY = 10.0
"""Time in which it comes back from nothing [s]."""

_LINE = 32
"""Length of the delay line of forces [ticks]."""

SWING = np.dtype(
    [
        ("line", "f8", (_LINE, 3)),  # force on the user less the ordered one, by tick [N]
        ("stages", "f8", (3, _STAGES + 1, 3)),  # of force, velocity, ordered force: input, output of each filter
        ("moved", "f8", (3,)),  # mean velocity of the last tick [m/s]: a filtered one would lag and turn the sign
        ("power", "f8"),  # mean of f.v [W]
        ("force", "f8"),  # mean of |f|^2 [N^2]
        ("lately", "f8"),  # the same over the last 25 ms [N^2]
        ("speed", "f8"),  # mean of |v|^2 [m^2/s^2]
        ("ordered", "f8"),  # mean of the square of the ordered force [N^2]
        ("time", "f8"),  # for which the force has fed an oscillation [s]
        ("free", "f8"),  # without any virtual force [s]
        ("settling", "f8"),  # time that is left to a contact that began [s]
        ("begun", "i8"),  # 1 since `calm` was 1
        ("reported", "i8"),  # 1 in the tick in which the force begins to fade
        ("lost", "i8"),  # 1 in the tick in which fading has not helped: the next one stops
        ("calm", "f8"),  # share of the virtual force that is rendered
        ("least_calm", "f8"),  # smallest so far
        ("count", "i8"),  # oscillations so far
        ("worst", "f8"),  # largest root mean square of an oscillation [N]
    ],
    align=True,
)
"""State of the detector at one point of contact; zeros are the initial state."""


@kernel
def begin_swing(swing: SwingRecord) -> None:
    """Set the share of the virtual force in the first tick."""
    if swing.begun == 0:
        swing.begun = 1
        swing.calm = 1.0
        swing.least_calm = 1.0


@kernel
def _filter(swing: SwingRecord, row: int, value: Vec, dt: float) -> None:
    """Pass a vector through the high-pass filters of a row."""
    keep = 1.0 / (1.0 + _CORNER * dt)
    for i in range(3):
        change, passed = value[i] - swing.stages[row, 0, i], value[i]
        swing.stages[row, 0, i] = passed
        for n in range(1, _STAGES + 1):
            last = swing.stages[row, n, i]
            passed = keep * (last + change)
            change = passed - last
            swing.stages[row, n, i] = passed


@kernel
def _average(swing: SwingRecord, dt: float) -> None:
    """Follow the averages."""
    power, force, speed, ordered = 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        f, v, o = swing.stages[0, _STAGES, i], swing.stages[1, _STAGES, i], swing.stages[2, _STAGES, i]
        power += f * v
        force += f * f
        speed += v * v
        ordered += o * o
    share = min(1.0, dt / _WINDOW)
    swing.power += share * (power - swing.power)
    swing.force += share * (force - swing.force)
    swing.speed += share * (speed - swing.speed)
    swing.ordered += share * (ordered - swing.ordered)
    swing.lately += min(1.0, dt / _LATELY) * (force - swing.lately)


@kernel
def _is_fed(swing: SwingRecord) -> bool:
    """Whether the force feeds an oscillation that is more than ordered."""
    most = FLOOR + ANSWER * math.sqrt(swing.ordered)
    loud = swing.force > most * most and swing.lately > most * most
    return loud and swing.power > _FEEDING * math.sqrt(swing.force * swing.speed)


@kernel
def _fade(swing: SwingRecord, fed: bool, dt: float) -> None:
    """Lower the share of the force while an oscillation is fed; let it rise in free motion."""
    swing.reported = 0
    swing.time = swing.time + dt if fed else max(0.0, swing.time - dt)
    if fed and swing.time >= _WINDOW:
        if swing.calm == 1.0:
            swing.reported = 1
            swing.count += 1
        swing.worst = max(swing.worst, math.sqrt(swing.force))
        swing.calm *= 1.0 - min(1.0, dt / _WINDOW)
        swing.least_calm = min(swing.least_calm, swing.calm)
        swing.time = _WINDOW
    elif swing.free > _REST:
        swing.calm = min(1.0, swing.calm + dt / _RECOVERY)


@kernel
def watch_swing(state: StateRecord, totals: TotalsRecord, late: int, dt: float) -> None:
    """Follow the detector by one tick, after the force on the user is known; the state machine stops where it is lost.

    Args:
        state: STATE record of one point of contact; its `swing` is updated.
        totals: Its TOTALS record.
        late: Ticks until a force acts.
        dt: Tick [s].
    """
    swing, ordered, acting = state.swing, state.work_a, state.work_b
    share = state.acting.rendered_share * state.acting.tank_share * state.acting.effect_share
    slot = state.tick % _LINE
    quiet = True
    for i in range(3):
        ordered[i] = share * totals.ordered_force[i]
        swing.line[slot, i] = state.f_user_world[i] - ordered[i]
        quiet = quiet and state.f_user_world[i] == 0.0
    if not quiet and swing.free > _WINDOW:
        swing.settling = _SETTLING
    swing.settling = max(0.0, swing.settling - dt)
    swing.free = swing.free + dt if quiet else 0.0
    acted = (state.tick + _LINE - 1 - min(late, _LINE - 2)) % _LINE
    for i in range(3):
        acting[i] = swing.line[acted, i]
        swing.moved[i] = state.acting.displacement[i] / dt
    _filter(swing, 0, acting, dt)
    _filter(swing, 1, swing.moved, dt)
    _filter(swing, 2, ordered, dt)
    _average(swing, dt)
    _fade(swing, is_rendered(state) and swing.settling == 0.0 and _is_fed(swing), dt)
    swing.lost = 1 if swing.calm < LEAST_CALM and swing.time >= _WINDOW else 0
    if swing.lost == 1:
        swing.calm = 1.0
        swing.time = 0.0
