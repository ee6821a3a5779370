"""The second before a trip: written when its row is there, by a recorder that may die, or cut from the run later."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mimics_app.contracts.loop.haptic import EVENT, EventKind, TripCause
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.manifest import hash_files
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.report import write_report
from mimics_app.recording.run import Run
from mimics_app.recording.trip_log import MOST_TRIPS, TripLog, complete_trips, read_trip, trip_file
from mimics_app.tasks.kinds.registry import report_sections
from tests.support.recorder_app import fake_samples, push_ticks
from tests.support.synthetic_run import write_synthetic_run


def trip(*ticks: int) -> np.ndarray:
    events = np.zeros(len(ticks), EVENT)
    events["tick"], events["kind"], events["force"] = ticks, EventKind.TRIP, TripCause.JUMP
    return events


def test_rows_of_the_second_before_and_its_own(tmp_path: Path):
    log = TripLog(tmp_path)
    for first in range(0, 3000, 50):
        if first == 2000:
            log.note_events(trip(2017))
        log.note_samples(fake_samples(first, 50))
    samples = read_trip(trip_file(tmp_path, 0))
    assert samples["tick"].tolist() == list(range(1017, 2018))
    assert samples.tobytes() == fake_samples(1017, 1001).tobytes()


def test_written_as_soon_as_the_row_is_there_whichever_comes_first(tmp_path: Path):
    log = TripLog(tmp_path)
    log.note_events(trip(120))
    log.note_samples(fake_samples(0, 100))
    assert not trip_file(tmp_path, 0).exists()
    log.note_samples(fake_samples(100, 50))
    assert read_trip(trip_file(tmp_path, 0))["tick"][-1] == 120
    log.note_events(trip(149))
    log.note_samples(fake_samples(150, 50))
    assert read_trip(trip_file(tmp_path, 1))["tick"][[0, -1]].tolist() == [0, 149]


def test_the_end_writes_what_there_is(tmp_path: Path):
    log = TripLog(tmp_path, earlier=3)
    log.note_samples(fake_samples(0, 50))
    log.note_events(trip(60))
    log.finish()
    assert read_trip(trip_file(tmp_path, 3))["tick"][-1] == 49 and not trip_file(tmp_path, 0).exists()


def test_a_loop_that_trips_without_end_fills_no_disk(tmp_path: Path):
    log = TripLog(tmp_path)
    log.note_events(trip(*range(MOST_TRIPS + 20)))
    log.note_samples(fake_samples(0, 200))
    assert len(list((tmp_path / "trips").iterdir())) == MOST_TRIPS


def test_recorder_writes_seals_and_reports(tmp_path: Path):
    memory = SessionMemory()
    recorder = Recorder(memory, tmp_path, {"seed": 1})
    recorder.start()
    samples = fake_samples(0, 1500)
    push_ticks(memory, 0, 1500, events=False)
    ring.push(memory.recorder_event_words, memory.recorder_events, trip(1200))
    recorder.close({})
    assert read_trip(trip_file(tmp_path, 0)).tobytes() == samples[200:1201].tobytes()
    run = Run.open(tmp_path)
    assert run.manifest is not None and "trips/trip_000.arrows" in run.manifest.files
    assert run.disagreements() == []
    trip_file(tmp_path, 0).write_bytes(b"")
    assert run.disagreements() == ["trips/trip_000.arrows was changed after the run was closed"]


def test_report_names_and_draws_the_trips_of_a_run_that_has_no_logs(tmp_path: Path):
    folder = write_synthetic_run(tmp_path)
    run = Run.open(folder)
    reported = [int(t) for t in run.events["tick"][run.events["kind"] == EventKind.TRIP]]
    assert reported, "the run this test is about has a trip"
    page = write_report(folder, report_sections()).read_text()
    assert "trips/trip_000.arrows" in page and "Speed before the trip" in page
    found = complete_trips(run)
    assert [tick for tick, _ in found] == reported
    assert read_trip(found[0][1])["tick"][-1] == reported[0]
    assert "trips/trip_000.arrows" in hash_files(folder)
