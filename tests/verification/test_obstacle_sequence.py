"""The nine steps of D2.1 4.3.6: the machine of the loop searched whole, and seeded sessions with every fault."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.loop.gait_state import GAIT_STATES, GaitState
from mimics_app.lab.haptic.sequence_search import Rule, broken_rule, search_sequence, small_settings
from mimics_app.rendering.haptic.control.lokomat.obstacle_sequence import (
    SEQUENCE,
    SEQUENCE_FACTS,
    SequenceCommand,
    SequenceFault,
    begin_sequence,
    step_sequence,
)

STEPS = (
    "walking",
    "obstacle_enabled",
    "stopping",
    "collision_enabled",
    "leg_released",
    "exploring",
    "guidance_restored",
    "to_start",
    "resuming",
)
"""The nine steps, in the order and with the names of the recorded event."""


def _walking() -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Sequence of a walking patient, settings, and facts that hinder nothing."""
    sequence, facts, settings = np.zeros(1, SEQUENCE), np.zeros(1, SEQUENCE_FACTS), small_settings()
    begin_sequence(sequence[0])
    for name in ("standing", "extended", "at_obstacle", "clear", "at_start"):
        facts[name] = 1
    facts["command"] = SequenceCommand.CONFIRM
    for _ in range(30):
        step_sequence(sequence[0], settings[0], facts[0])
        facts["command"] = SequenceCommand.NONE
    assert sequence["state"][0] == GaitState.WALKING and sequence["belt"][0] == 1.0
    return sequence, settings, facts


def test_the_names_are_the_nine_steps_and_standing() -> None:
    assert GAIT_STATES == (*STEPS, "standing")


def test_an_obstacle_leads_through_the_nine_steps_in_their_order() -> None:
    sequence, settings, facts = _walking()
    visited = [STEPS[0]]
    facts["command"], facts["leg"] = SequenceCommand.OBSTACLE, 1
    for tick in range(60):
        step_sequence(sequence[0], settings[0], facts[0])
        facts["command"] = SequenceCommand.NONE
        facts["overstepped"] = sequence["state"][0] == GaitState.EXPLORING
        name = GAIT_STATES[sequence["state"][0]]
        if name == "exploring":
            assert sequence["free_leg"][0] == 1 and sequence["guidance"][0].tolist() == [1.0, 0.0]
            assert sequence["held"][0].tolist() == [1, 0] and sequence["hard"][0] == 1
        if name != visited[-1]:
            visited.append(name)
        if tick > 1 and name == "walking":
            break
    assert visited == [*STEPS, "walking"]


@pytest.mark.requirement("R25")
def test_the_exhaustive_search_finds_no_violation_and_reaches_every_state() -> None:
    found = search_sequence()
    assert found.violations == 0, found.broken
    assert found.reached == GAIT_STATES
    assert found.states > 100 and found.cases == found.states * 7680


PLANTED: dict[Rule, tuple[dict[str, Any], dict[str, Any], dict[str, Any]]] = {
    Rule.HARD_ONLY_STANDING: ({}, {"hard": 1}, {}),
    Rule.ONE_LEG_AT_A_TIME: ({}, {"guidance": (0.0, 0.75)}, {}),
    Rule.FAULT_ENDS_STANDING: ({}, {}, {"fault": SequenceFault.LEFT_ENCODER}),
    Rule.STOP_ENDS_STANDING: ({}, {}, {"command": SequenceCommand.STOP}),
    Rule.STANDING_UNTIL_CONFIRMED: ({"state": GaitState.STANDING, "braked": 1}, {}, {}),
    Rule.BRAKES_OPEN_UNDER_GUIDANCE: ({"braked": 1}, {"guidance": (1.0, 0.75)}, {}),
    Rule.ABORT_LEADS_BACK: ({}, {"state": GaitState.STOPPING}, {"command": SequenceCommand.ABORT}),
    Rule.NO_JUMP: ({"guidance": (0.25, 1.0)}, {}, {}),
    Rule.BELT_ONLY_WALKING: ({"belt": 0.5}, {"state": GaitState.TO_START}, {}),
}
"""Rule -> changes of before, after and facts of a walking tick that break it."""


@pytest.mark.parametrize("rule", PLANTED, ids=lambda rule: rule.name.lower())
def test_a_planted_violation_breaks_its_rule(rule: Rule) -> None:
    before, after, facts = np.zeros(1, SEQUENCE), np.zeros(1, SEQUENCE), np.zeros(1, SEQUENCE_FACTS)
    for record in (before, after):
        record["guidance"], record["belt"] = 1.0, 1.0
    assert broken_rule(before[0], after[0], facts[0], small_settings()[0]) == Rule.NONE
    for record, changes in zip((before, after, facts), PLANTED[rule], strict=True):
        for name, value in changes.items():
            record[name] = value
    assert broken_rule(before[0], after[0], facts[0], small_settings()[0]) == rule


def _bring_to(state: GaitState) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """A session in a state of the sequence."""
    sequence, settings, facts = _walking()
    facts["command"] = SequenceCommand.OBSTACLE
    for _ in range(60):
        if sequence["state"][0] == state:
            return sequence, settings, facts
        step_sequence(sequence[0], settings[0], facts[0])
        facts["command"] = SequenceCommand.NONE
        facts["overstepped"] = sequence["state"][0] == GaitState.EXPLORING
    raise AssertionError(f"{state.name} is not reached")


@pytest.mark.parametrize("seeds", [6 * (len(SequenceFault) - 1), pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("state", list(GaitState)[:9], ids=lambda state: state.name.lower())
def test_every_fault_at_every_step_ends_standing_in_seeded_sessions(state: GaitState, seeds: int) -> None:
    """Daily each fault comes six times to each step; the search above tries every state with every fault."""
    faults = list(SequenceFault)[1:]
    for seed in range(seeds):
        rng = np.random.default_rng([seed, int(state)])
        sequence, settings, facts = _bring_to(state)
        for _ in range(int(rng.integers(0, 3))):
            facts["overstepped"] = 0
            step_sequence(sequence[0], settings[0], facts[0])
        fault = faults[seed % len(faults)]
        facts["fault"] = fault
        step_sequence(sequence[0], settings[0], facts[0])
        facts["fault"] = SequenceFault.NONE
        for _ in range(20):
            assert sequence["state"][0] == GaitState.STANDING and sequence["braked"][0] == 1
            assert not sequence["guidance"].any() and sequence["cause"][0] == fault
            facts["command"] = rng.choice([SequenceCommand.NONE, SequenceCommand.ABORT, SequenceCommand.OBSTACLE])
            for name in ("standing", "extended", "at_obstacle", "clear", "overstepped", "at_start"):
                facts[name] = rng.integers(0, 2, facts[name].shape)
            step_sequence(sequence[0], settings[0], facts[0])


def test_a_confirmed_session_keeps_its_brakes_until_both_drives_hold() -> None:
    sequence, settings, facts = _bring_to(GaitState.EXPLORING)
    facts["fault"], facts["overstepped"] = SequenceFault.RIGHT_ENCODER, 0
    facts["command"] = SequenceCommand.CONFIRM
    step_sequence(sequence[0], settings[0], facts[0])
    assert sequence["state"][0] == GaitState.STANDING, "a present fault cannot be confirmed away"
    facts["fault"] = SequenceFault.NONE
    shares = []
    for _ in range(12):
        step_sequence(sequence[0], settings[0], facts[0])
        facts["command"] = SequenceCommand.NONE
        if sequence["braked"][0]:
            shares.append(float(sequence["guidance"][0, 0]))
    assert shares == [0.25, 0.5, 0.75]
    assert sequence["state"][0] in (GaitState.RESUMING, GaitState.WALKING)
