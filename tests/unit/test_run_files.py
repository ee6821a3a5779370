"""The files of a run one by one: what is written reads back exactly, what is damaged is found and named."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import random
import signal
import subprocess
import threading
import time
import zlib
from multiprocessing.connection import Pipe
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import OutputError, PartialDataError, SceneError
from mimics_app.contracts.loop.haptic import EVENT, SAMPLE, SCENE, EventKind
from mimics_app.contracts.loop.loop_fields import FURTHER, LOOP_FIELDS, Replay
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording import append_file, columns, run_folder
from mimics_app.recording.append_file import AppendFile, is_claimed
from mimics_app.recording.arrow_format import decode_samples, encode_samples, parameters_dtype, parameters_schema
from mimics_app.recording.byte_channel import CLOSE, LINE, TRIAL, Inbox, Outbox
from mimics_app.recording.columns import column_names, column_units, present_columns, row_length, rows_of
from mimics_app.recording.event_log import encode_event, events_of, read_lines, to_json
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.recorder_process import _Session
from mimics_app.recording.recorder_status import RecorderStatus, StatusWord
from mimics_app.recording.recover import recover
from mimics_app.recording.replay import gather
from mimics_app.recording.report import write_report
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES, create_run_folder, private_files
from mimics_app.recording.signal_rows import SignalRow
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.statics import Statics, write_statics
from mimics_app.recording.streams import EventStream, ParameterStream, SampleStream, hash_of_files
from mimics_app.recording.trial_table import TrialTable, read_trials
from mimics_app.tasks.kinds.registry import report_sections
from tests.support.recorder_app import fake_samples, push_ticks, scene_block

COLUMNS = len(present_columns())
"""Numbers of a sample that are recorded of three joints and one hand."""


def _write_run(folder: Path, rows: int = 1000) -> Run:
    """A run folder as a recorder leaves it when it is killed, without a process."""
    state = StateHash()
    samples = SampleStream(folder, state)
    for first in range(0, rows, 50):
        samples.append(fake_samples(first, min(50, rows - first)), first)
    ParameterStream(folder).append(scene_block().tobytes())
    EventStream(folder, state).append_lines([b'{"source":"app","kind":"frame","frame":0}'])
    (folder / "session.json").write_text("{}")
    samples.sync()
    return Run.open(folder)


# columns


def test_every_column_has_a_name_and_a_unit() -> None:
    assert len(column_names()) == len(column_units()) == COLUMNS <= row_length(1) < row_length(4)
    assert row_length(4) == SAMPLE.itemsize // 8
    assert len(set(column_names())) == COLUMNS
    bare = {name for name, unit in zip(column_names(), column_units(), strict=True) if unit == "1"}
    assert bare == {
        "tick", "buttons", "status", "sequence", "stop_word", "held", "progress", "ramp", "state", "cause",
        "margin", "touching", "touched_shape", "held_body", "bodies", "stiffness_share", "tank_share", "calm",
    }  # fmt: skip
    inputs = {field.name for field in LOOP_FIELDS if field.replay is Replay.INPUT}
    fields = {"t", "tick", *inputs, *columns.OUTPUT_FIELDS, *columns.TIMING_FIELDS}
    assert fields == {*(SAMPLE.names or ())} - {FURTHER}
    samples = fake_samples(3, 2)
    assert rows_of(samples)[1][present_columns()[column_names().index("f_tunnel[2]")]] == samples["f_tunnel"][1][2]


# blocks


def test_block_reads_back_bit_for_bit_with_nan_and_infinity() -> None:
    samples = fake_samples(0, 50)
    samples["q"][7, :3] = [np.nan, np.inf, -0.0]
    block = decode_samples(encode_samples(samples, 3, 150))
    assert (block.seq, block.first) == (3, 150)
    assert block.records.tobytes() == samples.tobytes()


def test_full_blocks_have_one_length_whatever_their_number() -> None:
    lengths = {len(encode_samples(fake_samples(0, 50), seq, seq * 50)) for seq in (0, 9, 10**6, 10**12)}
    assert len(lengths) == 1


def header_length(block: bytes) -> int:
    """Bytes before the compressed rows: a mark, the length of the metadata, and these."""
    return 8 + int.from_bytes(block[4:8], "little")


def test_each_flipped_bit_of_the_rows_is_caught() -> None:
    """Of the compressed rows; one that means nothing, such as of the filling behind them, changes nothing."""
    good = encode_samples(fake_samples(0, 50), 0, 0)
    chance, caught = random.Random(1), 0
    for _ in range(300):
        data = bytearray(good)
        data[chance.randrange(header_length(good), len(good))] ^= 1 << chance.randrange(8)
        try:
            block = decode_samples(bytes(data))
        except ValueError:
            caught += 1
            continue
        assert block.records.tobytes() == fake_samples(0, 50).tobytes()
    assert caught > 250


def test_flipped_bits_of_a_header_never_pass_other_rows() -> None:
    """A damaged header is refused, or does not matter; it never changes what is read."""
    good = encode_samples(fake_samples(0, 50), 0, 0)
    for place in range(header_length(good)):
        for bit in range(8):
            data = bytearray(good)
            data[place] ^= 1 << bit
            try:
                block = decode_samples(bytes(data))
            except ValueError:
                continue
            assert block.records.tobytes() == fake_samples(0, 50).tobytes() and block.first == 0


def test_parameters_dtype_survives_json() -> None:
    assert parameters_dtype(parameters_schema()) == SCENE


# damaged streams


@pytest.mark.parametrize("seed", range(12))
def test_truncated_stream_keeps_every_whole_block(tmp_path: Path, seed: int) -> None:
    _write_run(tmp_path)
    path = tmp_path / "haptic.arrows"
    size = path.stat().st_size
    cut = random.Random(seed).randrange(2000, size)
    os.truncate(path, cut)
    run = Run.open(tmp_path)
    block = len(encode_samples(fake_samples(0, 50), 0, 0))
    whole = (cut - (size - 20 * block)) // block
    assert len(run.haptic) == 50 * max(0, whole)
    assert run.haptic.tobytes() == fake_samples(0, 50 * max(0, whole)).tobytes()
    assert not run.gaps


@pytest.mark.parametrize("with_index", [True, False], ids=["sidecar", "no sidecar"])
@pytest.mark.parametrize("seed", range(6))
def test_zeroed_page_costs_at_most_two_blocks(tmp_path: Path, seed: int, with_index: bool) -> None:
    """4 KB lie in one block or across two; headers that fall into the hole must not end the stream."""
    _write_run(tmp_path)
    path = tmp_path / "haptic.arrows"
    start = random.Random(seed).randrange(0, path.stat().st_size - 4096)
    with path.open("r+b") as file:
        file.seek(start)
        file.write(b"\0" * 4096)
    if not with_index:
        (tmp_path / "haptic.arrows.idx").unlink()
    run = Run.open(tmp_path)
    assert len(run.haptic) >= 900
    assert run.damages
    ticks = run.haptic["tick"].astype(int)
    assert run.haptic.tobytes() == fake_samples(0, 1000)[ticks].tobytes()
    recover(tmp_path)
    manifest = Run.open(tmp_path).manifest
    assert manifest is not None and manifest.rows == len(run.haptic)
    assert (tmp_path / "haptic.arrows.damaged").exists()
    assert pa.ipc.open_stream(path).read_all().num_rows == len(run.haptic)
    assert Run.open(tmp_path).disagreements() == []
    lost = 1000 - len(run.haptic)
    assert sum(gap.ticks for gap in Run.open(tmp_path).gaps) == (lost if ticks[-1] == 999 else lost - (999 - ticks[-1]))


def test_garbage_sidecar_does_no_harm(tmp_path: Path) -> None:
    _write_run(tmp_path)
    (tmp_path / "haptic.arrows.idx").write_bytes(np.random.default_rng(0).bytes(24 * 30 + 5))
    assert len(Run.open(tmp_path).haptic) == 1000


def test_stream_that_was_resumed_is_one_stream(tmp_path: Path) -> None:
    """A torn block at the end goes, the rest is hashed when the run is sealed, and the blocks number on."""
    _write_run(tmp_path, 120)
    with (tmp_path / "haptic.arrows").open("ab") as file:
        file.write(encode_samples(fake_samples(120, 50), 3, 120)[:1000])
    samples, whole = SampleStream(tmp_path, StateHash(), resume=True), StateHash()
    assert samples.next_row == 120
    samples.append(fake_samples(120, 30), 120)
    samples.close()
    whole.add_samples(fake_samples(0, 150))
    assert hash_of_files(tmp_path, []).hexdigest() == whole.hexdigest()
    table = pa.ipc.open_stream(tmp_path / "haptic.arrows").read_all()
    assert np.array_equal(table["t"].to_numpy(), fake_samples(0, 150)["t"])
    assert not Run.open(tmp_path).damages


def _stream_of(folder: Path, names: list[str], units: list[str], rows: np.ndarray) -> None:
    """A haptic.arrows of another version: these columns, rows [n, len(names)]."""
    metadata = {"columns": json.dumps(names), "units": json.dumps(units), "version": "0"}
    item = pa.field("item", pa.float64(), nullable=False)
    kind = pa.list_(item, len(names))
    fields = [pa.field("t", pa.float64(), nullable=False), pa.field("sample", kind, nullable=False)]
    schema = pa.schema(fields, metadata=metadata)
    t = np.arange(len(rows)) / 1000
    crc = zlib.crc32(rows.tobytes(), zlib.crc32(t.tobytes(), zlib.crc32(np.array([0, 0], "<i8").tobytes())))
    values = pa.FixedSizeListArray.from_arrays(pa.array(rows.ravel()), type=kind)
    batch = pa.RecordBatch.from_arrays([pa.array(t), values], schema=schema)
    with pa.ipc.new_stream(folder / "haptic.arrows", schema) as writer:
        writer.write_batch(batch, custom_metadata={"seq": "0", "first": "0", "crc": f"{crc:08x}"})
    (folder / "session.json").write_text("{}")


def test_other_columns_are_read_as_far_as_they_are_known(tmp_path: Path) -> None:
    """Unknown columns are ignored, missing ones absent, and one in another unit is not taken for ours."""
    rows = np.arange(12.0).reshape(3, 4)
    rows[:, 0] = np.arange(3)
    names = ["tick", "state", "of_another_version", "margin"]
    _stream_of(tmp_path, names, ["1", "1", "K", "%"], rows)
    run = Run.open(tmp_path)
    assert np.array_equal(run.haptic["tick"], [0, 1, 2]) and np.array_equal(run.haptic["state"], rows[:, 1])
    assert np.array_equal(run.haptic["t"], [0.0, 0.001, 0.002])
    assert np.isnan(run.haptic["margin"]).all() and np.isnan(run.haptic["f_user_world"]).all()
    absent = set(run.layout.absent)
    assert {"margin", "q[0]"} <= absent and not {"t", "tick", "state"} & absent
    assert any("recorded without" in problem for problem in run.problems())
    write_report(tmp_path, report_sections())
    with pytest.raises(PartialDataError, match="other columns"):
        gather(run)
    recover(tmp_path)
    again = Run.open(tmp_path)
    assert again.haptic.tobytes() == run.haptic.tobytes() and again.layout.absent == run.layout.absent


def test_stream_without_our_columns_is_named(tmp_path: Path) -> None:
    schema = pa.schema([pa.field("t", pa.float64())])
    with pa.ipc.new_stream(tmp_path / "haptic.arrows", schema) as writer:
        writer.write_batch(pa.record_batch([pa.array([1.0])], schema=schema))
    assert any("its description of the columns cannot be read" in problem for problem in Run.open(tmp_path).problems())
    with pytest.raises(SceneError, match="not a run folder"):
        Run.open(tmp_path.parent / "nothing")


# the state hash


def test_hash_does_not_depend_on_block_boundaries_nor_on_timing() -> None:
    samples = fake_samples(0, 500)
    hashes = set()
    for size in (1, 7, 50, 500):
        state = StateHash()
        for first in range(0, 500, size):
            state.add_samples(samples[first : first + size])
        hashes.add(state.hexdigest())
    late = samples.copy()
    late["lateness_ns"] += 5e5
    late["duration_ns"] = 1.0
    state = StateHash()
    state.add_samples(late)
    assert hashes == {state.hexdigest()}


def test_hash_changes_with_one_ulp_of_any_state_column() -> None:
    samples = fake_samples(0, 20)

    def digest(records: np.ndarray) -> str:
        state = StateHash()
        state.add_samples(records)
        return state.hexdigest()

    reference = digest(samples)
    for column, name in zip(present_columns(), column_names(), strict=True):
        changed = samples.copy()
        rows = rows_of(changed)
        rows[13, column] = np.nextafter(rows[13, column], np.inf)
        assert (digest(changed) == reference) == (name in ("lateness_ns", "duration_ns")), name


def test_hash_knows_events_trials_and_their_streams() -> None:
    event = np.zeros(2, EVENT)
    event["kind"] = EventKind.TRIP

    def digest(events: np.ndarray, rows: list[dict[str, object]]) -> str:
        state = StateHash()
        state.add_events(events)
        for row in rows:
            state.add_trial(row)
        return state.hexdigest()

    reference = digest(event, [{"a": 1, "b": 2}])
    assert digest(event, [{"b": 2, "a": 1}]) == reference
    for name in EVENT.names or ():
        other = event.copy()
        other[name].flat[-1] = (
            1e-40 if other[name].dtype.kind == "f" else 5
        )  # a float32 far below the smallest normal one
        assert (digest(other, [{"a": 1, "b": 2}]) == reference) == (name == "t_ns"), name
    assert digest(event, [{"a": 1, "b": 2.0000000000000004}]) != reference
    assert digest(event[:1], [{"a": 1, "b": 2}]) != reference


# events and trials


def test_event_line_reads_back_exactly_with_nan(tmp_path: Path) -> None:
    event = np.zeros(1, EVENT)
    event["t_ns"], event["tick"], event["kind"], event["force"] = 2**62 + 1, 9, EventKind.CONTACT_BEGIN, 0.1
    event["position_world"], event["value"] = [0.1, np.nan, -2.0], np.nan
    (tmp_path / "events.jsonl").write_bytes(encode_event(event[0], 0) + b'\n{"torn": ')
    lines, bad = read_lines(tmp_path / "events.jsonl")
    assert bad == 1
    assert events_of(lines).tobytes() == event.tobytes()


@pytest.mark.parametrize(("digits", "good", "read"), [(29, 1, 1e29), (60, 1, np.inf), (400, 0, None)])
def test_an_event_with_a_number_of_many_digits_is_read_or_refused(tmp_path, digits, good, read):
    event = np.zeros((), EVENT)
    event["kind"] = EventKind.TRIP
    line = encode_event(event, 0).replace(b'"cause":0.0', b'"cause":1' + digits * b"0")
    (tmp_path / "events.jsonl").write_bytes(line + b"\n")
    lines, bad = read_lines(tmp_path / "events.jsonl")
    assert (len(lines), bad) == (good, 1 - good)
    assert not good or events_of(lines)["force"][0] == np.float32(read)


def test_trial_rows_read_back_as_they_were(tmp_path: Path) -> None:
    table = TrialTable(tmp_path / "trials.csv")
    rows: list[dict[str, object]] = [
        {"trial": 0, "score": 0.1 + 0.2, "name": 'a "b", c', "done": True},
        {"trial": 1, "score": -0.0, "name": "12", "done": False, "list": [1, 2.5]},
        {"trial": 2, "score": 1e-300, "name": "true", "done": True, "note": "line\nbreak"},
    ]
    for row in rows:
        table.append(row)
    assert read_trials(tmp_path / "trials.csv") == rows
    assert TrialTable(tmp_path / "trials.csv", resume=True).rows == rows
    with (tmp_path / "trials.csv").open("ab") as file:
        file.write(b"3,0.5")
    assert read_trials(tmp_path / "trials.csv") == rows


# onto the medium, and for whose eyes


@pytest.fixture
def synced(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the files that were brought onto the medium, in order: the one place where it is requested."""
    names: list[str] = []
    monkeypatch.setattr(append_file, "_sync", lambda fd: names.append(Path(os.readlink(f"/proc/self/fd/{fd}")).name))
    return names


def test_append_file_syncs_what_was_appended_once(tmp_path: Path, synced: list[str]) -> None:
    file = AppendFile(tmp_path / "a")
    file.sync()
    assert synced == []
    file.append(b"1")
    file.sync()
    file.sync()
    assert synced == ["a"]
    file.append(b"2")
    file.close()
    assert synced == ["a", "a"]


def test_trial_is_on_the_medium_before_the_next_begins(tmp_path: Path, synced: list[str]) -> None:
    table = TrialTable(tmp_path / "trials.csv")
    table.append({"trial": 0})  # a new column: written anew and synced by write_atomically
    synced.clear()
    table.append({"trial": 1})
    assert synced == ["trials.csv"]


def test_recorder_syncs_its_streams_every_second(tmp_path: Path, synced: list[str]) -> None:
    memory, outbox = SessionMemory(), Outbox()
    session = _Session(memory, Inbox(outbox.reader), RecorderStatus(), tmp_path, 0)
    second = 1_000_000_000
    session.step(second)
    for pushed, now in enumerate((second + second // 2, 2 * second + 1, 2 * second + second // 2, 3 * second + 2)):
        synced.clear()
        push_ticks(memory, 100 * pushed, 100)
        outbox.send(LINE, b'{"source":"app","kind":"note"}')
        session.step(now)
        assert set(synced) == ({"haptic.arrows", "haptic.arrows.idx", "events.jsonl"} if pushed % 2 else set())
    synced.clear()
    push_ticks(memory, 400, 50)
    session.step(3 * second + 3)
    assert synced == []
    session.finish()
    assert {"haptic.arrows", "haptic.arrows.idx", "parameters.arrows"} <= set(synced)


def test_a_slow_disk_is_no_jump_of_the_wall_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    memory, outbox, clock = SessionMemory(), Outbox(), MonotonicClock()
    session = _Session(memory, Inbox(outbox.reader), RecorderStatus(), tmp_path, 0)
    session.step(clock.now_ns())
    monkeypatch.setattr(SampleStream, "sync", lambda stream: time.sleep(0.2))
    session._next_sync = 0
    session.step(clock.now_ns())
    session.finish()
    lines = [line for line in read_lines(tmp_path / "events.jsonl")[0] if line["kind"] == "clock"]
    assert lines and not [line for line in lines if "jump_s" in line]


def test_every_file_of_a_run_is_its_users_alone(tmp_path: Path) -> None:
    """Whatever the umask: what the recorder, the report and a recovery write."""
    before = os.umask(0)
    try:
        folder = create_run_folder(tmp_path / "runs")
        memory = SessionMemory()
        recorder = Recorder(memory, folder, {"seed": 1})
        recorder.start()
        push_ticks(memory, 0, 1200)
        trip = np.zeros(1, EVENT)
        trip["kind"], trip["tick"] = EventKind.TRIP, 1100
        ring.push(memory.recorder_event_words, memory.recorder_events, trip)
        recorder.trial({"trial": 0})
        recorder.signals([SignalRow(0, SignalBlock("ecg", 1000.0, 0, np.zeros(20)))])
        there = [path for path in folder.iterdir() if path.suffix != ".part"]  # one that is renamed meanwhile
        while_it_runs = {path.name: path.stat().st_mode & 0o777 for path in there}
        recorder.close({})
        write_statics(folder, Statics({"paths": np.arange(3.0)}, ()))
        write_report(folder, report_sections())
        (folder / "manifest.json").unlink()
        with (folder / "events.jsonl").open("ab") as file:
            file.write(b"torn")
        recover(folder)
        with private_files():
            (folder / "a picture.png").touch()
            (folder / "pictures").mkdir()
    finally:
        os.umask(before)
    assert ".reserve" in while_it_runs and set(while_it_runs.values()) == {0o600}
    assert folder.stat().st_mode & 0o777 == 0o700
    modes = {path: path.stat().st_mode & 0o777 for path in folder.rglob("*")}
    assert {path.name for path in modes} >= {*FILES.values(), "trips", "trip_000.arrows", "events.jsonl.damaged"}
    assert all(mode == (0o700 if path.is_dir() else 0o600) for path, mode in modes.items()), modes


# the channel


def test_channel_keeps_order_through_a_full_pipe_and_counts_what_it_gives_up() -> None:
    outbox = Outbox(limit_bytes=1 << 20)
    inbox = Inbox(outbox.reader)
    payloads = [b"%06d" % i + b"x" * (i % 3000) for i in range(4000)]
    sent = [payload for payload in payloads if outbox.send(LINE, payload)]
    assert outbox.dropped == len(payloads) - len(sent) > 0
    received: list[bytes] = []
    while len(received) < len(sent):
        received += [payload for _, payload in inbox.messages()]
        outbox.flush()
    assert received == sent
    assert inbox.skipped_bytes == 0 and not inbox.ended


def test_full_channel_still_takes_trials_and_the_end() -> None:
    outbox = Outbox(limit_bytes=1 << 16)
    inbox = Inbox(outbox.reader)
    while outbox.send(LINE, bytes(5000)):
        pass
    assert outbox.send(TRIAL, b"score") and outbox.send(CLOSE, b"end")
    received: list[tuple[bytes, bytes]] = []
    while not received or received[-1][0] != CLOSE:
        received += inbox.messages()
        outbox.flush()
    assert received[-2:] == [(TRIAL, b"score"), (CLOSE, b"end")]


def test_reader_that_starts_inside_a_message_finds_the_next() -> None:
    outbox = Outbox()
    outbox.send(LINE, b"lost")
    outbox.send(TRIAL, b"kept")
    os.read(outbox.reader.fileno(), 7)
    inbox = Inbox(outbox.reader)
    assert list(inbox.messages()) == [(TRIAL, b"kept")]
    assert inbox.skipped_bytes == 10


def test_a_damaged_length_costs_its_message_and_not_all_that_follow() -> None:
    reader, writer = Pipe(duplex=False)
    outbox, inbox = Outbox(), Inbox(reader)
    outbox.send(LINE, b"lost")
    outbox.send(TRIAL, b"kept")
    sent = bytearray(os.read(outbox.reader.fileno(), 1000))
    sent[4:8] = (1 << 30).to_bytes(4, "little")
    os.write(writer.fileno(), sent)
    assert list(inbox.messages()) == [(TRIAL, b"kept")]


# the run folder


def test_run_folder_is_never_an_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tokens = iter([bytes(4), bytes(4), b"\x11" * 4])
    monkeypatch.setattr(run_folder.os, "urandom", lambda _: next(tokens))
    first = create_run_folder(tmp_path / "runs")
    (first / "trials.csv").write_text("precious")
    second = create_run_folder(tmp_path / "runs")
    assert second != first or (second / "trials.csv").read_text() == "precious"
    assert len(list((tmp_path / "runs").iterdir())) == 2
    with pytest.raises(FileExistsError):
        _write_run(first / "..")
        _write_run(first / "..")


def test_run_folder_refuses_a_file_and_a_full_disk(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="a run folder cannot be created"):
        create_run_folder(tmp_path / "file")
    with pytest.raises(OutputError, match="MB free"):
        create_run_folder(tmp_path, expected_s=1e12)


# a full disk


def test_a_file_is_claimed_although_somebody_asks_whether_it_is(tmp_path: Path) -> None:
    file = AppendFile(tmp_path / "f")
    with (tmp_path / "f").open("rb") as asking:
        fcntl.flock(asking, fcntl.LOCK_SH)
        done = threading.Timer(0.01, fcntl.flock, (asking, fcntl.LOCK_UN))
        done.start()
        file.claim()
        done.join()
    assert is_claimed(tmp_path / "f")
    file.close()
    assert not is_claimed(tmp_path / "f")


def test_append_file_never_keeps_half_a_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = AppendFile(tmp_path / "f")
    file.append(b"whole")
    real = os.write

    def short(descriptor: int, data: bytes) -> int:
        if len(data) <= 3:
            raise OSError(errno.ENOSPC, "full")
        return real(descriptor, data[:3])

    monkeypatch.setattr(append_file.os, "write", short)
    with pytest.raises(OSError, match="full"):
        file.append(b"abcdef")
    monkeypatch.undo()
    assert (tmp_path / "f").read_bytes() == b"whole", "also before anything else is appended"
    file.append(b"next")
    assert (tmp_path / "f").read_bytes() == b"wholenext"


def test_full_disk_stops_the_recording_and_nothing_else(tmp_path: Path) -> None:
    """On a tmpfs of 3 MB: readable to the last block, trials kept, the app informed, the ring drained on."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(disk)], capture_output=True)
    if mount.returncode:
        pytest.skip("no right to mount a small disk here")
    try:
        folder = disk / "run"
        folder.mkdir()
        memory = SessionMemory()
        recorder = Recorder(memory, folder, {})
        recorder.start()
        recorder.parameters(scene_block())
        for tick in range(0, 16_000, 1000):
            recorder.wait_for_room(1000)
            push_ticks(memory, tick, 1000)
        recorder.trial({"trial": 0, "score": 1.0})
        recorder.wait_for_room(8192)
        assert "disk is full" in recorder.problem
        manifest = recorder.close({"seed": 3})
        run = Run.open(folder)
        assert 3000 < len(run.haptic) < 16_000
        assert manifest.dropped["samples"] == 16_000 - len(run.haptic)
        assert "disk is full" in manifest.problem
        assert run.trials == [{"trial": 0, "score": 1.0}]
        assert run.haptic.tobytes() == fake_samples(0, len(run.haptic)).tobytes()
        assert run.disagreements() == [] and not run.damages
        assert pa.ipc.open_stream(folder / "haptic.arrows").read_all().num_rows == len(run.haptic)
    finally:
        subprocess.run(["umount", str(disk)], check=True)


# the whole recorder on the virtual clock


@pytest.mark.seconds
def test_two_recordings_of_the_same_have_the_same_hash(tmp_path: Path) -> None:
    hashes = []
    for name, step in (("a", 1000), ("b", 17)):
        folder = tmp_path / name
        folder.mkdir()
        memory = SessionMemory()
        recorder = Recorder(memory, folder, {"seed": 7, "array": np.arange(3), "bad": float("nan")})
        recorder.journal("frame", {"frame": -1, "tick": np.int64(3)})
        recorder.start()
        for tick in range(0, 20_000, step):
            count = min(step, 20_000 - tick)
            recorder.wait_for_room(count)
            push_ticks(memory, tick, count)
            recorder.journal("frame", {"frame": tick // step, "tick": tick})
        recorder.trial({"trial": 0, "score": np.float64(0.25), "none": None})
        manifest = recorder.close({"task": {"completed": True}})
        hashes.append(manifest.state_hash)
        run = Run.open(folder)
        assert manifest.status == "clean" and manifest.rows == 20_000 == len(run.haptic)
        assert [line["frame"] for line in run.lines_of("app", "frame")] == list(range(-1, -(-20_000 // step)))
        assert run.problems() == [] and run.disagreements() == []
        assert manifest.summary == {"task": {"completed": True}}
        session = json.loads((folder / "session.json").read_text())
        assert session["array"] == [0, 1, 2] and session["bad"] is None and "numpy" in session["versions"]
        assert not (folder / ".reserve").exists()
    assert hashes[0] == hashes[1]
    recovery = recover(tmp_path / "a")
    assert recovery.repaired == () and recovery.verdict.whole and recovery.verdict.status == "clean"
    with (tmp_path / "a" / "trials.csv").open("a") as file:
        file.write("1,2,\n")
    assert len(Run.open(tmp_path / "a").disagreements()) == 2


def test_abandoned_run_is_interrupted_and_whole(tmp_path: Path) -> None:
    """An error in the app: nothing that was handed over is lost, and the process is gone."""
    memory = SessionMemory()
    recorder = Recorder(memory, tmp_path, {})
    recorder.start(wait=False)
    push_ticks(memory, 0, 333)
    for frame in range(100):
        recorder.journal("frame", {"frame": frame})
    recorder.trial({"trial": 0})
    recorder.abandon()
    assert not recorder.alive
    run = Run.open(tmp_path)
    assert run.status == "interrupted" and len(run.haptic) == 333 and len(run.trials) == 1
    assert len(run.lines_of("app", "frame")) == 100 and run.disagreements() == []


@pytest.mark.seconds
def test_abandoned_run_of_a_recorder_that_was_just_killed_is_whole(tmp_path: Path) -> None:
    """The standby has taken over before anybody looked: it is not killed over its work."""
    memory = SessionMemory()
    recorder = Recorder(memory, tmp_path, {})
    recorder.start()
    recorder.keep_standby()
    recorder.trial({"trial": 0})
    while recorder._status[StatusWord.TRIALS] == 0:
        time.sleep(0.01)
    os.kill(recorder.pid or 0, signal.SIGKILL)
    push_ticks(memory, 0, 2 * len(memory.samples) // 3)
    recorder.abandon(60.0)
    run = Run.open(tmp_path)
    assert run.status == "interrupted" and len(run.haptic) == 2 * len(memory.samples) // 3
    assert len(run.trials) == 1 and run.disagreements() == []


def test_names_of_files_that_are_no_text_are_recorded() -> None:
    """A folder whose name is not UTF-8 reaches Python with half characters, which JSON encoders refuse."""
    line = to_json({"file": "/tmp/\udcff", "rows": [float("nan"), ("\udc80", 1)], "at": Path("/a/\udcfe")})
    assert json.loads(line) == {"file": "/tmp/\\udcff", "rows": [None, ["\\udc80", 1]], "at": "/a/\\udcfe"}
