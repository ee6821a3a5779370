"""The flow of trials under any robot and any clock: it never sticks, never runs backwards, always ends."""

from __future__ import annotations

import itertools
import math
from collections import Counter

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.tasks.state_machine import Conditions, next_state
from mimics_app.tasks.task import TaskSpec
from tests.support.examples import same_examples
from tests.support.task_play import START, Player, make_manager

SPEC = msgspec.convert(
    {
        "time_limit_s": 1.0,
        "rest_s": 0.2,
        "result_s": 0.1,
        "start": {"hold_s": 0.05, "ready_s": 0.1, "limit_s": 0.5, "attempts": 2},
        "trials": [{"trials": [{}, {"time_limit_s": 0.3}], "order": "shuffled", "repetitions": 2}],
    },
    TaskSpec,
)

NEXT = {
    TrialState.APPROACH: {TrialState.READY, TrialState.ABORTED},
    TrialState.READY: {TrialState.TRAVEL, TrialState.ABORTED},
    TrialState.TRAVEL: {TrialState.FINISHED, TrialState.TIMEOUT},
    TrialState.FINISHED: {TrialState.REST, TrialState.DONE},
    TrialState.TIMEOUT: {TrialState.REST, TrialState.DONE},
    TrialState.ABORTED: {TrialState.APPROACH, TrialState.REST, TrialState.DONE},
    TrialState.STOPPED: {TrialState.APPROACH, TrialState.REST, TrialState.DONE},
    TrialState.REST: {TrialState.APPROACH},
    TrialState.DONE: set(),
}


CAUSES = ("latched", "arrived", "go", "goal", "trial_over", "attempts_left", "trials_left")
ALL_SEEN = [
    Conditions(elapsed_s, **dict(zip(CAUSES, flags, strict=True)))
    for elapsed_s in (0.0, 2.5, 1e6)
    for flags in itertools.product((False, True), repeat=len(CAUSES))
]
"""Everything a state can see: at once, after result and rest but before any limit, and when all time is over."""


@pytest.mark.parametrize("state", TrialState)
def test_the_drawn_transitions_exist_and_no_others(state):
    for latched in (False, True):
        found = {next_state(state, seen) for seen in ALL_SEEN if seen.latched is latched} - {state}
        if latched and state is not TrialState.DONE:
            assert found == {TrialState.STOPPED} - {state}
        else:
            assert found == NEXT[state]


@pytest.mark.parametrize("state", [state for state in TrialState if state is not TrialState.DONE])
def test_every_state_ends_when_its_time_is_over(state):
    late = [seen for seen in ALL_SEEN if seen.elapsed_s == 1e6 and not seen.latched]
    assert len(late) == 2 ** (len(CAUSES) - 1)
    assert all(next_state(state, seen) is not state for seen in late)


frames = st.fixed_dictionaries(
    {
        "state": st.sampled_from([int(SafetyState.ACTIVE)] * 6 + [int(state) for state in SafetyState]),
        "ramp": st.sampled_from([0.0, 0.5, 1.0, 1.0]),
        "q": st.sampled_from([START, START, (0.1, 0.1, 0.1)]),
        "progress": st.sampled_from([0.0, 0.3, 0.97, 0.98, 1.0]),
        "distance": st.floats(0.0, 0.1),
        "penetration": st.sampled_from([0.0, 0.001]),
    }
)
steps = st.tuples(
    st.one_of(st.just({}), st.just({}), frames),  # mostly the robot of paper as it is: it obeys, and travels
    st.integers(0, 400_000_000),
    st.sampled_from([None, EventKind.CONTACT_BEGIN, EventKind.CONTACT_END]),
    st.integers(1, 20),
)
"""Changes of a frame, its length [ns], an event in it, and how often it comes."""


def histories(most):
    return st.lists(steps, min_size=most // 2, max_size=most)


def feed(player, step):
    changes, frame_ns, kind, times = step
    changes = changes | ({"q": np.array(changes["q"])} if changes else {})
    for _ in range(times):
        rows = [] if kind is None else [(player.now_ns - 1_000_000, kind, 1.0)]
        player.step(*rows, frame_ns=frame_ns, **changes)


def check_reached(players, share):
    """The histories lead through whole sessions: every state, every outcome, and contacts, in a share of the plays."""
    states = Counter(state for player in players for state in set(player.states))
    rows = [row for player in players for row in player.manager.rows]
    outcomes = Counter(row["outcome"] for row in rows)
    assert all(states[state.value] >= share * len(players) for state in TrialState), states
    assert all(outcomes[kind] >= share * len(players) for kind in ("finished", "timeout", "aborted")), outcomes
    assert sum(row["contacts"] > 0 for row in rows) >= share * len(players)


@pytest.mark.seconds
def test_any_robot_any_clock_no_negative_time_and_rows_in_order():
    players = []

    @same_examples
    @settings(max_examples=60)
    @given(history=histories(60), seed=st.integers(0, 2**31))
    def check(history, seed):
        player = Player(make_manager(SPEC, seed), speed=1.5)
        players.append(player)
        for step in history:
            feed(player, step)
        check_session(player)

    check()
    check_reached(players, 0.1)


def check_session(player):
    """What holds for the rows and orders of every session."""
    rows = player.manager.rows
    assert [(row["trial"], row["attempt"]) for row in rows] == sorted({(row["trial"], row["attempt"]) for row in rows})
    for row in rows:
        assert 0.0 <= row["time_s"] == round(row["time_s"], 9)
        assert 0.0 <= row["contact_time_s"] <= row["time_s"] + 1e-12
        assert row["begin_ns"] <= row["end_ns"]
        assert row["score"] is None if row["outcome"] == "aborted" else 0.0 <= row["score"] <= 100.0
        if row["path_error_rms_m"] is not None:  # None where nobody was let go
            assert 0.0 <= row["path_error_rms_m"] <= row["path_error_max_m"] * (1 + 1e-12)
    for orders in player.orders:
        assert orders.view.elapsed_s >= 0.0
    result = player.manager.result()
    practice = result.pop("practice", {"completed": 0, "trials": 0})
    assert result.pop("counted", "trials") in ("trials", "practice", "under way")
    assert 0 <= practice["completed"] <= practice["trials"] and 0 <= result["completed"] <= result["trials"]
    assert all(math.isfinite(value) for value in result.values())


@pytest.mark.seconds
@settings(max_examples=40)
@given(history=histories(20), arrives=st.booleans(), ramps=st.booleans(), travels=st.booleans())
def test_whatever_happened_it_ends_once_the_stops_are_over(history, arrives, ramps, travels):
    player = Player(make_manager(SPEC), speed=2.0 if travels else 0.0)
    for step in history:
        feed(player, step)
    if not arrives:
        player.change = lambda frame, p: {"q": np.array([0.1, 0.1, 0.1])}
    elif not ramps:
        player.change = lambda frame, p: {"ramp": 0.0}
    # 4 trials, at most 2 attempts of 0.5 + 0.5 + 1.0 s, each with 0.3 s of result and rest
    longest_s = 4 * 2 * (2.0 + 0.1 + 0.2)
    for _ in range(math.ceil(longest_s * 60) + 200):
        player.step()
        if player.manager.done:  # which leads nowhere else, see NEXT
            break
    assert player.manager.done
    counted = {row["trial"] for row in player.manager.rows}
    assert counted == {0, 1, 2, 3}


@pytest.mark.seconds
def test_the_same_frames_give_the_same_session():
    players = []

    def play(history, seed):
        player = Player(make_manager(SPEC, seed), speed=1.5)
        players.append(player)
        for step in history:
            feed(player, step)
        return player.manager.rows, player.states, [orders.haptic for orders in player.orders]

    @same_examples
    @settings(max_examples=20)
    @given(history=histories(40), seed=st.integers(0, 2**31))
    def check(history, seed):
        assert play(history, seed) == play(history, seed)

    check()
    check_reached(players, 1e-9)
