"""Stops and short holds as a run reports them: apart, with cause, time and advice; and a recorder that was replaced."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mimics_app.app.session.safety_watch import SafetyWatch, hold_message
from mimics_app.app.session.watches import RecorderWatch
from mimics_app.contracts.loop.haptic import EVENT, EventKind, SafetyState, TripCause
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.recorder_status import StatusWord
from mimics_app.recording.trips import Trip, TripReader


def reported(*trips: tuple[int, SafetyState, TripCause]) -> np.ndarray:
    """Events of trips (tick, state they lead to, cause), as the loop publishes them."""
    events = np.zeros(2 * len(trips), EVENT)
    for i, (tick, state, cause) in enumerate(trips):
        events["tick"][2 * i : 2 * i + 2] = tick
        events["kind"][2 * i], events["force"][2 * i] = EventKind.STATE, state
        events["kind"][2 * i + 1], events["force"][2 * i + 1] = EventKind.TRIP, cause
    return events


HOLD = (700, SafetyState.DEGRADED, TripCause.LATE_TICK)
STOP = (12_345, SafetyState.SAFE_STOP, TripCause.STALE_DEVICE)


def late(stops: int, holds: int) -> Any:
    return SimpleNamespace(stops=stops, holds=holds)


def test_trips_are_reported_apart_also_when_a_frame_comes_between_state_and_trip():
    events = reported(HOLD, STOP)
    reader = TripReader()
    found = [trip for event in events for trip in reader.take(event.reshape(1))]
    assert found == TripReader().take(events)
    assert found == [Trip(700, TripCause.LATE_TICK, False), Trip(12_345, TripCause.STALE_DEVICE, True)]


def test_a_cause_that_is_no_number_is_still_a_trip():
    events = reported(STOP)
    events["force"] = np.nan
    assert TripReader().take(events) == [Trip(12_345, TripCause.NONE, True)]


@pytest.mark.parametrize("cause", list(TripCause))
def test_every_cause_has_words_and_an_advice(cause: TripCause):
    trip = Trip(1, cause, True)
    assert trip.what and trip.advice


def test_a_stop_is_reported_with_time_cause_and_advice(capsys):
    SafetyWatch().see(reported(STOP))
    line = capsys.readouterr().err
    assert line == (
        "mimics: 12.345 s: safety stop: the device sent nothing new for too long; check its cable and its power\n"
    )


def test_a_force_cut_at_its_limit_is_reported_once(capsys):
    events = np.zeros(2, EVENT)
    events["kind"], events["tick"], events["force"] = EventKind.FORCE_LIMIT, (1500, 1900), (94.7, 120.0)
    watch = SafetyWatch()
    watch.see(events)
    watch.see(events)
    line = "mimics: 1.500 s: a virtual force of 95 N was cut at force_limit, which a hand may feel\n"
    assert capsys.readouterr().err == line


def test_holds_one_after_the_other_are_reported_once_and_counted(capsys):
    watch = SafetyWatch()
    for tick in range(1000, 9000, 400):
        watch.see(reported((tick, SafetyState.DEGRADED, TripCause.LATE_TICK)))
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1 and "1.000 s: force paused (1), it comes back: this computer was too busy" in lines[0]
    watch.see(reported((20_000, SafetyState.DEGRADED, TripCause.MISSED_IN_ROW)))
    assert "force paused (21)" in capsys.readouterr().err


def test_the_answer_counts_stops_and_holds_apart_and_names_the_last_stop(capsys):
    watch = SafetyWatch()
    assert watch.summary(SafetyState.ACTIVE, late(0, 0)) == {"state": "ACTIVE", "stops": 0, "holds": 0}
    watch.see(reported(HOLD))
    answer = watch.summary(SafetyState.ACTIVE, late(0, 1))
    assert (answer["stops"], answer["holds"], answer["cause"], answer["t_s"]) == (0, 1, "LATE_TICK", 0.7)
    watch.see(reported(STOP))
    answer = watch.summary(SafetyState.SAFE_STOP, late(1, 1))
    assert (answer["state"], answer["cause"], answer["t_s"]) == ("SAFE_STOP", "STALE_DEVICE", 12.345)
    assert answer["what"] and answer["advice"]


def test_the_picture_says_that_a_busy_machine_pauses():
    assert "Paused" in hold_message(SafetyState.DEGRADED)
    assert {hold_message(state) for state in SafetyState if state is not SafetyState.DEGRADED} == {""}


def test_a_recorder_that_died_and_is_back_is_reported_on_the_terminal(capsys):
    recorder: Any = SimpleNamespace(restarts=0, ready=True, problem="", holds_s=16.4)
    watch = RecorderWatch(recorder)
    watch.check()
    assert capsys.readouterr().err == ""
    recorder.restarts, recorder.ready = 1, False
    watch.check()
    watch.check()
    assert capsys.readouterr().err == (
        "mimics: the recorder died and is replaced (number 1); meanwhile data are buffered for 16 s\n"
    )
    recorder.ready = True
    watch.check()
    watch.check()
    assert capsys.readouterr().err == "mimics: the recorder is back\n"
    recorder.problem = "the disk is full"
    watch.check()
    recorder.problem = ""
    watch.check()
    assert (
        capsys.readouterr().err
        == "mimics: the disk is full\nmimics: the disk can be written again: the recording resumes, with a gap\n"
    )


def test_a_recorder_that_dies_each_time_is_given_up_in_one_line(tmp_path, monkeypatch, capsys):
    recorder = Recorder(SessionMemory(), tmp_path, {})
    dead: Any = SimpleNamespace(is_alive=lambda: False, pid=0)
    recorder._process, recorder._status[StatusWord.READY] = dead, 1

    def spawn(number: int) -> Any:
        recorder._status[StatusWord.READY] = number + 1
        return dead

    monkeypatch.setattr(recorder, "_spawn", spawn)
    watch = RecorderWatch(recorder)
    for _ in range(10):
        recorder.supervise()
        watch.check()
    lines = capsys.readouterr().err.splitlines()
    assert recorder.restarts == sum("is replaced" in line for line in lines) == 5
    assert lines[-1] == "mimics: the recorder process does not stay alive: nothing is recorded"
    assert lines[-2] == "mimics: the recorder is back", "of the fifth"
