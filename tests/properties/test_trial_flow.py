"""The flow of trials under any robot and any clock: it never sticks, never runs backwards, always ends."""

from __future__ import annotations

import dataclasses
import math

import msgspec
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.haptic import EventKind, SafetyState
from mimics_app.contracts.trial_state import TrialState
from mimics_app.tasks.state_machine import Conditions, next_state
from mimics_app.tasks.task import TaskSpec
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

conditions = st.builds(
    Conditions,
    elapsed_s=st.floats(0.0, 100.0),
    latched=st.booleans(),
    arrived=st.booleans(),
    go=st.booleans(),
    goal=st.booleans(),
    trial_over=st.booleans(),
    attempts_left=st.booleans(),
    trials_left=st.booleans(),
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


@settings(deadline=None)
@given(state=st.sampled_from(TrialState), seen=conditions)
def test_only_the_drawn_transitions_exist(state, seen):
    following = next_state(state, seen)
    if seen.latched and state is not TrialState.DONE:
        assert following is TrialState.STOPPED
    else:
        assert following is state or following in NEXT[state]


@settings(deadline=None)
@given(state=st.sampled_from(TrialState), seen=conditions)
def test_every_state_ends_when_its_time_is_over(state, seen):
    late = dataclasses.replace(seen, elapsed_s=1e6, latched=False)
    if state is not TrialState.DONE:
        assert next_state(state, late) is not state


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
    frames, st.integers(0, 400_000_000), st.sampled_from([None, EventKind.CONTACT_BEGIN, EventKind.CONTACT_END])
)


def feed(player, step):
    changes, frame_ns, kind = step
    rows = [] if kind is None else [(player.now_ns - 1_000_000, kind, 1.0)]
    player.step(*rows, frame_ns=frame_ns, **(changes | {"q": np.array(changes["q"])}))


@settings(deadline=None, max_examples=60)
@given(history=st.lists(steps, max_size=80), seed=st.integers(0, 2**31))
def test_any_robot_any_clock_no_negative_time_and_rows_in_order(history, seed):
    player = Player(make_manager(SPEC, seed))
    for step in history:
        feed(player, step)
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
    assert 0 <= practice["completed"] <= practice["trials"] and 0 <= result["completed"] <= result["trials"]
    assert all(math.isfinite(value) for value in result.values())


@settings(deadline=None, max_examples=40)
@given(history=st.lists(steps, max_size=30), arrives=st.booleans(), ramps=st.booleans(), travels=st.booleans())
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
    assert player.manager.done
    counted = {row["trial"] for row in player.manager.rows}
    assert counted == {0, 1, 2, 3}


@settings(deadline=None, max_examples=20)
@given(history=st.lists(steps, max_size=60), seed=st.integers(0, 2**31))
def test_the_same_frames_give_the_same_session(history, seed):
    def play():
        player = Player(make_manager(SPEC, seed))
        for step in history:
            feed(player, step)
        return player.manager.rows, player.states, [orders.haptic for orders in player.orders]

    assert play() == play()
