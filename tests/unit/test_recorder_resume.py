"""A recorder that takes over reads the end of its files, however long the run is, and loses nothing by it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import EVENT, EventKind, TripCause
from mimics_app.contracts.shared_memory.session_memory import Capacities
from mimics_app.recording import streams
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import EventStream, ParameterStream, SampleStream, hash_of_files
from tests.support.recorder_app import fake_samples, scene_block

BLOCKS, ROWS = 400, 50


def write(folder: Path, blocks: int) -> StateHash:
    """A run as a recorder leaves it that was killed."""
    state = StateHash()
    samples, parameters, events = SampleStream(folder, state), ParameterStream(folder), EventStream(folder, state)
    for i in range(blocks):
        samples.append(fake_samples(i * ROWS, ROWS), i * ROWS)
        parameters.append(scene_block(i + 1).tobytes())
        event = np.zeros(1, EVENT)
        event["tick"], event["kind"] = i, EventKind.TRIP if i % 100 == 7 else EventKind.CONTACT_BEGIN
        event["force"] = TripCause.JUMP
        events.append_events(event)
    events.append_lines([b'{"source":"recorder","kind":"gap","reason":"x","rows":3,"after_row":50}'])
    events.append_lines([b'{"source":"app","kind":"note","text":"\\"source\\":\\"loop\\""}'])
    return state


@pytest.fixture
def decoded(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is decoded while it goes on."""
    seen: list[str] = []
    for name in ("decode_samples", "decode_parameters"):
        real = getattr(streams, name)
        monkeypatch.setattr(streams, name, lambda data, name=name, real=real: (seen.append(name), real(data))[1])
    return seen


@pytest.mark.parametrize("torn", [0, 1, 1000], ids=["whole", "a byte torn", "a block torn"])
def test_going_on_reads_a_block_or_two_of_hundreds(tmp_path: Path, decoded: list[str], torn: int):
    write(tmp_path, BLOCKS)
    haptic = tmp_path / FILES["haptic"]
    with haptic.open("r+b") as file:
        file.truncate(haptic.stat().st_size - torn)
    samples = SampleStream(tmp_path, StateHash(), resume=True)
    parameters = ParameterStream(tmp_path, resume=True)
    assert decoded.count("decode_samples") <= 2 and decoded.count("decode_parameters") == 1
    assert samples.next_row == (BLOCKS - (torn > 0)) * ROWS and parameters.count == BLOCKS


def test_a_sidecar_that_lags_or_is_lost_costs_no_row(tmp_path: Path):
    write(tmp_path, 20)
    index = tmp_path / FILES["index"]
    index.write_bytes(index.read_bytes()[: 24 * 18 + 5])
    assert SampleStream(tmp_path, StateHash(), resume=True).next_row == 20 * ROWS
    index.unlink()
    assert SampleStream(tmp_path, StateHash(), resume=True).next_row == 20 * ROWS
    assert hash_of_files(tmp_path, []).rows == 20 * ROWS


def test_events_are_counted_without_being_read(tmp_path: Path):
    write(tmp_path, BLOCKS)
    with (tmp_path / FILES["events"]).open("ab") as file:
        file.write(b'{"source":"loop","kind":"trip","n":400,"t_ns"')
    events = EventStream(tmp_path, StateHash(), resume=True)
    assert (events.next_event, events.earlier_trips) == (BLOCKS, 4)
    assert [gap["rows"] for gap in events.earlier_gaps] == [3]


def test_the_hash_of_the_files_is_that_of_one_recorder_that_lived(tmp_path: Path):
    state = write(tmp_path, 30)
    resumed = SampleStream(tmp_path, StateHash(), resume=True)
    more = fake_samples(30 * ROWS, 7)
    resumed.append(more, 30 * ROWS)
    state.add_samples(more)
    row = {"trial": 1, "score": 2.5}
    state.add_trial(row)
    assert hash_of_files(tmp_path, [row]).hexdigest() == state.hexdigest()


def test_the_ring_holds_more_than_twice_the_longest_start_that_was_measured():
    """7.4 s from a kill to the next recorder on a machine with eight times the work it has cores for."""
    assert Capacities().samples > 2 * 7400
