"""Sequence of D2.1 4.3.6: the states in which a walking patient stops, explores an obstacle with one foot, walks on.

    walking -> obstacle_enabled -> stopping -> collision_enabled -> leg_released -> exploring
       ^                                                                              |
       +---- resuming <---- to_start <---------------- guidance_restored <------------+
    any -> standing (latched: both legs held by the device's own brakes) -> guidance_restored

Hard objects act only while both legs stand. The guidance of one leg at most is below 1 within the sequence, and then
the drives hold the other leg extended. A fault, a stop command and an expired time limit end in `standing`: motors
without current, joints braked. Only a person leaves it, once the fault is gone; the brakes open when both drives hold
their legs again.

The loop steps this machine once a tick; the test of the machine searches all states of it, not of a model.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.gait_state import GaitState

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        SequenceFactsRecord,
        SequenceRecord,
        SequenceSettingsRecord,
    )

__all__ = [
    "SEQUENCE",
    "SEQUENCE_FACTS",
    "SEQUENCE_SETTINGS",
    "SequenceCause",
    "SequenceCommand",
    "SequenceFault",
    "begin_sequence",
    "step_sequence",
]


class SequenceCommand(IntEnum):
    """What a person or the scene orders in a tick."""

    NONE = 0
    OBSTACLE = 1  # an obstacle for the leg SEQUENCE_FACTS.leg
    ABORT = 2  # back to walking, on the shortest safe path
    STOP = 3  # standing on the brakes
    CONFIRM = 4  # leave `standing`


class SequenceFault(IntEnum):
    """Fault of the device in a tick."""

    NONE = 0
    DEVICE = 1  # stopped, unplugged, silent, late or garbled
    LEFT_ENCODER = 2
    RIGHT_ENCODER = 3
    LIMIT = 4  # force, power or speed beyond a limit
    NOT_FINITE = 5


class SequenceCause(IntEnum):
    """Why the sequence is in `standing`."""

    NONE = 0
    DEVICE = 1
    LEFT_ENCODER = 2
    RIGHT_ENCODER = 3
    LIMIT = 4
    NOT_FINITE = 5
    COMMAND = 6
    TIME_LIMIT = 7
    UNKNOWN_STATE = 8


_STATES = len(GaitState)

SEQUENCE = np.dtype(
    [
        ("state", np.int64),  # GaitState
        ("cause", np.int64),  # SequenceCause
        ("free_leg", np.int64),  # 0 left, 1 right: the one that explores
        ("ticks", np.int64),  # since the state was entered, up to its time limit
        ("hard", np.int64),  # 1: hard objects act on the free leg
        ("braked", np.int64),  # 1: motors without current, the device's own brakes hold both legs
        ("held", np.int64, 2),  # 1: the drives hold this leg extended
        ("guidance", np.float64, 2),  # share of the guidance force of each leg, 0-1
        ("belt", np.float64),  # share of the walking speed, 0-1
    ],
    align=True,
)
"""State and outputs of the sequence; `begin_sequence` sets the initial ones."""

SEQUENCE_SETTINGS = np.dtype(
    [
        ("guidance", np.float64, 2),  # share prescribed for each leg while walking, 0-1
        ("guidance_step", np.float64),  # largest change of a share per tick
        ("belt_step", np.float64),  # likewise of the belt's share
        ("longest", np.int64, _STATES),  # time limit of each state [ticks], 0: none
        ("shown", np.int64),  # time for which an obstacle is announced before it acts [ticks]
    ],
    align=True,
)

SEQUENCE_FACTS = np.dtype(
    [
        ("command", np.int64),  # SequenceCommand
        ("leg", np.int64),  # leg of an OBSTACLE command: 0 left, 1 right
        ("fault", np.int64),  # SequenceFault
        ("standing", np.int64),  # 1: belt and reference do not move, and no leg moves but the free one
        ("extended", np.int64, 2),  # 1: this leg is extended
        ("at_obstacle", np.int64),  # 1: the step in which to stop has begun
        ("clear", np.int64),  # 1: no foot is inside a hard object
        ("overstepped", np.int64),  # 1: the free foot is beyond the obstacle, on the ground
        ("at_start", np.int64),  # 1: both legs are at the start pose
    ],
    align=True,
)
"""What the machine knows of the world in one tick."""


@kernel
def begin_sequence(sequence: SequenceRecord) -> None:
    """Set the state at the start of a session: standing on the brakes until a person confirms."""
    sequence.free_leg = 0
    _brake(sequence, SequenceCause.NONE)


@kernel
def _brake(sequence: SequenceRecord, cause: int) -> None:
    """Enter `standing`: hard objects off, motors without current, brakes closed, belt stopped, in this tick."""
    sequence.state = GaitState.STANDING
    sequence.cause = cause
    sequence.ticks = 0
    sequence.hard = 0
    sequence.braked = 1
    sequence.belt = 0.0
    for leg in range(2):
        sequence.held[leg] = 0
        sequence.guidance[leg] = 0.0


@kernel
def _approach(value: float, target: float, step: float) -> float:
    """Move a share towards its target by at most `step`."""
    return min(value + step, max(value - step, target))


@kernel
def _guide(sequence: SequenceRecord, settings: SequenceSettingsRecord, left: float, right: float) -> None:
    """Move the guidance of both legs towards shares."""
    sequence.guidance[0] = _approach(sequence.guidance[0], left, settings.guidance_step)
    sequence.guidance[1] = _approach(sequence.guidance[1], right, settings.guidance_step)


@kernel
def _guided(sequence: SequenceRecord) -> bool:
    """Whether both legs have full guidance."""
    return sequence.guidance[0] == 1.0 and sequence.guidance[1] == 1.0


@kernel
def _supported(sequence: SequenceRecord, facts: SequenceFactsRecord) -> bool:
    """Whether the patient stands on the extended, guided leg that does not explore."""
    other = 1 - sequence.free_leg
    return facts.standing == 1 and facts.extended[other] == 1 and sequence.guidance[other] == 1.0


@kernel
def _before_contact(sequence: SequenceRecord, settings: SequenceSettingsRecord, facts: SequenceFactsRecord) -> int:
    """State that follows one of the steps 1 to 4 by its guards: the present one or another."""
    state, abort = int(sequence.state), facts.command == SequenceCommand.ABORT
    if state == GaitState.WALKING:
        return GaitState.OBSTACLE_ENABLED if facts.command == SequenceCommand.OBSTACLE else state
    if state == GaitState.OBSTACLE_ENABLED:
        if abort:
            return GaitState.WALKING
        ready = facts.at_obstacle == 1 and sequence.ticks >= settings.shown
        return GaitState.STOPPING if ready else state
    if state == GaitState.STOPPING:
        if abort:
            return GaitState.GUIDANCE_RESTORED
        ready = sequence.belt == 0.0 and _guided(sequence) and _supported(sequence, facts) and facts.clear == 1
        return GaitState.COLLISION_ENABLED if ready else state
    if abort or not _supported(sequence, facts):
        return GaitState.GUIDANCE_RESTORED
    return GaitState.LEG_RELEASED if sequence.ticks >= settings.shown else state


@kernel
def _from_contact(sequence: SequenceRecord, settings: SequenceSettingsRecord, facts: SequenceFactsRecord) -> int:
    """State that follows one of the steps 5 to 9, or `standing`, by its guards: the present one or another."""
    state, abort = int(sequence.state), facts.command == SequenceCommand.ABORT
    if state == GaitState.LEG_RELEASED or state == GaitState.EXPLORING:
        if abort or facts.overstepped == 1 or not _supported(sequence, facts):
            return GaitState.GUIDANCE_RESTORED
        return GaitState.EXPLORING if sequence.guidance[sequence.free_leg] == 0.0 else state
    if state == GaitState.GUIDANCE_RESTORED:
        return GaitState.TO_START if _guided(sequence) and sequence.belt == 0.0 else state
    if state == GaitState.TO_START:
        return GaitState.RESUMING if facts.at_start == 1 else state
    if state == GaitState.RESUMING:
        if abort:
            return GaitState.GUIDANCE_RESTORED
        return GaitState.WALKING if sequence.belt == 1.0 and _prescribed(sequence, settings) else state
    return GaitState.GUIDANCE_RESTORED if facts.command == SequenceCommand.CONFIRM else state


@kernel
def _prescribed(sequence: SequenceRecord, settings: SequenceSettingsRecord) -> bool:
    """Whether both legs have their prescribed guidance."""
    return sequence.guidance[0] == settings.guidance[0] and sequence.guidance[1] == settings.guidance[1]


@kernel
def _act(sequence: SequenceRecord, settings: SequenceSettingsRecord, facts: SequenceFactsRecord) -> None:
    """Set the outputs of the present state: guidance, belt, held leg, hard objects, brakes."""
    state, free = sequence.state, sequence.free_leg
    walks = state == GaitState.WALKING or state == GaitState.OBSTACLE_ENABLED or state == GaitState.RESUMING
    explores = state == GaitState.LEG_RELEASED or state == GaitState.EXPLORING
    if walks:
        _guide(sequence, settings, settings.guidance[0], settings.guidance[1])
    elif explores:
        _guide(sequence, settings, 1.0 if free == 1 else 0.0, 0.0 if free == 1 else 1.0)
    else:
        _guide(sequence, settings, 1.0, 1.0)
    sequence.belt = _approach(sequence.belt, 1.0 if walks else 0.0, settings.belt_step)
    if sequence.braked == 1 and _guided(sequence):
        sequence.braked = 0
    sequence.hard = 1 if (state == GaitState.COLLISION_ENABLED or explores) and facts.standing == 1 else 0
    for leg in range(2):
        sequence.held[leg] = 1 if sequence.hard == 1 and leg != free else 0


@kernel
def _expired(state: int) -> int:
    """State that follows an expired time limit: an exploration ends, an obstacle is dropped, the rest is a fault."""
    if state == GaitState.OBSTACLE_ENABLED:
        return GaitState.WALKING
    if state == GaitState.COLLISION_ENABLED or state == GaitState.LEG_RELEASED or state == GaitState.EXPLORING:
        return GaitState.GUIDANCE_RESTORED
    return GaitState.STANDING


@kernel
def step_sequence(sequence: SequenceRecord, settings: SequenceSettingsRecord, facts: SequenceFactsRecord) -> bool:
    """Advance the sequence by one tick.

    Args:
        sequence: SEQUENCE record, advanced.
        settings: SEQUENCE_SETTINGS record.
        facts: SEQUENCE_FACTS record of this tick.

    Returns:
        Whether the state changed.
    """
    before = sequence.state
    if facts.fault != SequenceFault.NONE:
        _brake(sequence, facts.fault)
        return before != sequence.state
    if not 0 <= before < _STATES:
        _brake(sequence, SequenceCause.UNKNOWN_STATE)
        return True
    if facts.command == SequenceCommand.STOP:
        _brake(sequence, SequenceCause.COMMAND)
        return before != sequence.state
    if before <= GaitState.COLLISION_ENABLED:
        after = _before_contact(sequence, settings, facts)
    else:
        after = _from_contact(sequence, settings, facts)
    longest = settings.longest[before]
    if after == before and 0 < longest <= sequence.ticks:
        after = _expired(before)
        if after == GaitState.STANDING:
            _brake(sequence, SequenceCause.TIME_LIMIT)
            return True
    if after == before:
        sequence.ticks += 1 if sequence.ticks < max(longest, settings.shown) else 0
    else:
        if before == GaitState.WALKING:
            sequence.free_leg = 1 if facts.leg == 1 else 0
        sequence.cause = SequenceCause.NONE
        sequence.state = after
        sequence.ticks = 0
    if after != GaitState.STANDING:
        _act(sequence, settings, facts)
    return after != before
