"""Exhaustive search of the obstacle sequence: every state that the machine of the loop reaches, under every input.

The machine is `obstacle_sequence.step_sequence` itself, with shares in quarters and time limits of a few ticks, so that
its states are finite. Every combination of commands, faults and facts is applied in every state reached, also those
that no device would report together; each step is checked against the rules below.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.rendering.haptic.control.lokomat.obstacle_sequence import (
    SEQUENCE,
    SEQUENCE_FACTS,
    SEQUENCE_SETTINGS,
    SequenceCause,
    SequenceCommand,
    SequenceFault,
    begin_sequence,
    step_sequence,
)

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        Ints,
        SequenceFactsRecord,
        SequenceRecord,
        SequenceSettingsRecord,
        Table,
    )

__all__ = ["Rule", "SequenceSearch", "broken_rule", "search_sequence", "small_settings"]


class Rule(IntEnum):
    """Rules of the sequence; a step breaks the first one that does not hold."""

    NONE = 0
    HARD_ONLY_STANDING = 1  # hard objects: only in steps 4 to 6, belt at rest, other leg extended, guided and held
    ONE_LEG_AT_A_TIME = 2  # brakes open: a leg without guidance stands beside one with full guidance
    FAULT_ENDS_STANDING = 3  # in the same tick: on the brakes, no current, no hard object
    STOP_ENDS_STANDING = 4  # likewise of a stop command
    STANDING_UNTIL_CONFIRMED = 5  # nothing but a person's command leaves it
    BRAKES_OPEN_UNDER_GUIDANCE = 6  # brakes open only when both drives hold their legs
    ABORT_LEADS_BACK = 7  # no step towards the obstacle follows an abort
    NO_JUMP = 8  # guidance and belt change by their steps; only the brakes take them away at once
    BELT_ONLY_WALKING = 9  # the belt gains speed only in walking states


_QUARTERS = 4
_SHARES = _QUARTERS + 1
_STATES, _CAUSES = len(GaitState), len(SequenceCause)
_MOST_TICKS = 4
_TICKS = _MOST_TICKS + 1
_KEYS = _STATES * _CAUSES * _TICKS * _SHARES**3 * 2**5
_COMMANDS, _FAULTS = len(SequenceCommand), len(SequenceFault)
_INPUTS = _COMMANDS * _FAULTS * 2**8
_ROUNDING = 1e-12
_LONGEST_RETURN = 200
"""Ticks after which a session that nothing hinders walks again."""


@dataclass(frozen=True, slots=True)
class SequenceSearch:
    """Result of a search.

    Attributes:
        states: Reached states of machine and outputs.
        cases: Steps checked: states times inputs.
        violations: Steps that broke a rule, and states from which the walk does not return.
        reached: Names of the gait states reached.
        broken: Number of violations by rule.
    """

    states: int
    cases: int
    violations: int
    reached: tuple[str, ...]
    broken: dict[str, int]


def small_settings() -> NDArray[Any]:
    """Return a SEQUENCE_SETTINGS record, shape [1], with steps and limits of a few ticks."""
    settings = np.zeros(1, SEQUENCE_SETTINGS)
    settings["guidance"] = 0.75, 0.5
    settings["guidance_step"], settings["belt_step"] = 0.25, 0.5
    settings["longest"] = _MOST_TICKS
    settings["longest"][0, [GaitState.WALKING, GaitState.STANDING]] = 0
    settings["shown"] = 1
    return settings


@kernel
def _digit(key: int, base: int) -> tuple[int, int]:
    """Last digit of a key in a base, and the rest."""
    return key % base, key // base


@kernel
def _read_key(key: int, sequence: SequenceRecord) -> None:
    sequence.state, key = _digit(key, _STATES)
    sequence.cause, key = _digit(key, _CAUSES)
    sequence.ticks, key = _digit(key, _TICKS)
    sequence.free_leg, key = _digit(key, 2)
    sequence.hard, key = _digit(key, 2)
    sequence.braked, key = _digit(key, 2)
    for leg in range(2):
        sequence.held[leg], key = _digit(key, 2)
        share, key = _digit(key, _SHARES)
        sequence.guidance[leg] = share / _QUARTERS
    sequence.belt = key / _QUARTERS


@kernel
def _key_of(sequence: SequenceRecord) -> int:
    key = round(_QUARTERS * sequence.belt)
    for place in range(2):
        leg = 1 - place
        key = key * _SHARES + round(_QUARTERS * sequence.guidance[leg])
        key = key * 2 + sequence.held[leg]
    key = key * 2 + sequence.braked
    key = key * 2 + sequence.hard
    key = key * 2 + sequence.free_leg
    key = key * _TICKS + sequence.ticks
    key = key * _CAUSES + sequence.cause
    return key * _STATES + sequence.state


@kernel
def _read_input(number: int, facts: SequenceFactsRecord) -> None:
    facts.command, number = _digit(number, _COMMANDS)
    facts.fault, number = _digit(number, _FAULTS)
    facts.leg, number = _digit(number, 2)
    facts.standing, number = _digit(number, 2)
    facts.extended[0], number = _digit(number, 2)
    facts.extended[1], number = _digit(number, 2)
    facts.at_obstacle, number = _digit(number, 2)
    facts.clear, number = _digit(number, 2)
    facts.overstepped, number = _digit(number, 2)
    facts.at_start = number


@kernel
def _is_safe(sequence: SequenceRecord) -> bool:
    """Whether both legs stand on the brakes without current."""
    idle = sequence.guidance[0] == 0.0 and sequence.guidance[1] == 0.0 and sequence.belt == 0.0
    return sequence.state == GaitState.STANDING and sequence.braked == 1 and sequence.hard == 0 and idle


@kernel
def _may_touch(after: SequenceRecord, facts: SequenceFactsRecord) -> bool:
    """Whether hard objects may act."""
    other = 1 - after.free_leg
    explores = GaitState.COLLISION_ENABLED <= after.state <= GaitState.EXPLORING
    still = facts.standing == 1 and after.belt == 0.0 and after.braked == 0
    return explores and still and after.held[other] == 1 and after.guidance[other] == 1.0 and facts.extended[other] == 1


@kernel
def _leads_on(before: int, after: int) -> bool:
    """Whether a step between two states leads towards the obstacle."""
    return before < after <= GaitState.EXPLORING


@kernel
def broken_rule(
    before: SequenceRecord, after: SequenceRecord, facts: SequenceFactsRecord, settings: SequenceSettingsRecord
) -> int:
    """Return the first Rule that the step from `before` to `after` breaks, Rule.NONE where all hold."""
    if after.hard == 1 and not _may_touch(after, facts):
        return Rule.HARD_ONLY_STANDING
    for leg in range(2):
        if after.braked == 0 and after.guidance[leg] == 0.0 and after.guidance[1 - leg] != 1.0:
            return Rule.ONE_LEG_AT_A_TIME
    if facts.fault != SequenceFault.NONE and not (_is_safe(after) and after.cause == facts.fault):
        return Rule.FAULT_ENDS_STANDING
    if facts.command == SequenceCommand.STOP and not _is_safe(after):
        return Rule.STOP_ENDS_STANDING
    confirmed = facts.command == SequenceCommand.CONFIRM and facts.fault == SequenceFault.NONE
    if before.state == GaitState.STANDING and not confirmed and not _is_safe(after):
        return Rule.STANDING_UNTIL_CONFIRMED
    if before.braked == 1 and after.braked == 0 and not (after.guidance[0] == 1.0 and after.guidance[1] == 1.0):
        return Rule.BRAKES_OPEN_UNDER_GUIDANCE
    if facts.command == SequenceCommand.ABORT and _leads_on(before.state, after.state):
        return Rule.ABORT_LEADS_BACK
    return _broken_motion(before, after, settings)


@kernel
def _broken_motion(before: SequenceRecord, after: SequenceRecord, settings: SequenceSettingsRecord) -> int:
    """Return the rule of guidance and belt that a step breaks, Rule.NONE where both hold."""
    if after.state == GaitState.STANDING:
        return Rule.NONE
    for leg in range(2):
        if abs(after.guidance[leg] - before.guidance[leg]) > settings.guidance_step + _ROUNDING:
            return Rule.NO_JUMP
    if abs(after.belt - before.belt) > settings.belt_step + _ROUNDING:
        return Rule.NO_JUMP
    walks = after.state <= GaitState.OBSTACLE_ENABLED or after.state == GaitState.RESUMING
    if after.belt > before.belt and not (walks and after.braked == 0):
        return Rule.BELT_ONLY_WALKING
    return Rule.NONE


@kernel
def _returns(work: Table[SequenceRecord], settings: SequenceSettingsRecord, facts: SequenceFactsRecord) -> bool:
    """Whether a session walks again from work[1] when nothing hinders it and a person confirms."""
    sequence = work[1]
    for _ in range(_LONGEST_RETURN):
        if sequence.state == GaitState.WALKING and sequence.belt == 1.0:
            return True
        stands = sequence.state == GaitState.STANDING
        facts.command = SequenceCommand.CONFIRM if stands else SequenceCommand.NONE
        step_sequence(sequence, settings, facts)
    return False


@kernel
def _search(
    settings: SequenceSettingsRecord,
    work: Table[SequenceRecord],
    facts: Table[SequenceFactsRecord],
    known: NDArray[np.bool_],
    queue: Ints,
    broken: Ints,
    reached: Ints,
) -> int:
    """Search from work[0]; return the number of states.

    Args:
        settings: Settings of the sequence.
        work: Two records; the first holds the initial state.
        facts: Two records; the second holds facts that hinder nothing.
        known: Flags of the keys, all False.
        queue: Scratch, as long as `known`.
        broken: Receives the number of violations by Rule, and last of states without return.
        reached: Receives 1 for each gait state.
    """
    queue[0] = _key_of(work[0])
    known[queue[0]] = True
    first, count = 0, 1
    while first < count:
        key = queue[first]
        first += 1
        _read_key(key, work[0])
        reached[work[0].state] = 1
        for number in range(_INPUTS):
            _read_key(key, work[1])
            _read_input(number, facts[0])
            step_sequence(work[1], settings, facts[0])
            rule = broken_rule(work[0], work[1], facts[0], settings)
            broken[rule] += 1 if rule != Rule.NONE else 0
            after = _key_of(work[1])
            if not known[after]:
                known[after] = True
                queue[count] = after
                count += 1
        _read_key(key, work[1])
        if not _returns(work, settings, facts[1]):
            broken[broken.shape[0] - 1] += 1
    return count


def search_sequence() -> SequenceSearch:
    """Search all states of the obstacle sequence under all inputs."""
    work, facts = np.zeros(2, SEQUENCE), np.zeros(2, SEQUENCE_FACTS)
    begin_sequence(work[0])
    for name in ("standing", "extended", "at_obstacle", "clear", "overstepped", "at_start"):
        facts[1][name] = 1
    known, queue = np.zeros(_KEYS, np.bool_), np.zeros(_KEYS, np.int64)
    broken, reached = np.zeros(len(Rule) + 1, np.int64), np.zeros(_STATES, np.int64)
    states = int(_search(small_settings()[0], work, facts, known, queue, broken, reached))
    names = [*(rule.name.lower() for rule in Rule), "no_return"]
    found = {name: int(count) for name, count in zip(names, broken, strict=True) if count}
    gait_states = tuple(state.name.lower() for state in GaitState if reached[state])
    return SequenceSearch(states, states * _INPUTS, int(broken.sum()), gait_states, found)
