"""What a replay reads of a run, and how the comparison decides, with a small tick of the test's own."""

from __future__ import annotations

import os
import sys
import zlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numba import typeof

from mimics_app.app.cli import main
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.loop.haptic import EVENT, SAMPLE, EventKind
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, Replay
from mimics_app.recording.arrow_format import decode_samples, encode_samples
from mimics_app.recording.columns import OUTPUT_FIELDS, present_columns
from mimics_app.recording.event_log import encode_event
from mimics_app.recording.recover import recover
from mimics_app.recording.replay import ReplayData, compare, compare_events, gather
from mimics_app.recording.run import Run
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.statics import Statics, read_statics, write_statics
from mimics_app.recording.streams import ParameterStream, SampleStream
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from tests.support.recorder_app import scene_block

TICKS = 1000
INPUTS = [field.name for field in LOOP_FIELDS if field.replay is Replay.INPUT]


def _fake_tick(data: ReplayData) -> np.ndarray:
    """A tick with a memory: every output depends on every input so far."""
    samples = data.samples.copy()
    inputs = samples.view(np.float64).reshape(len(samples), -1)
    first, last = (SAMPLE.fields[name][1] // 8 for name in (INPUTS[0], OUTPUT_FIELDS[0]))
    gain = np.array([0.0 if s == 0 else data.blocks[int(s)]["virtual_mass"][0] for s in samples["sequence"]])
    total = np.cumsum(inputs[:, first:last].sum(axis=1) * gain * 1e-3)
    for i, name in enumerate(OUTPUT_FIELDS):
        column = np.sin(total + i)
        samples[name] = (
            column if samples[name].ndim == 1 else column[:, None] * (1.0 + np.arange(samples[name].shape[1]))
        )
    return _of_the_device(samples)


def _of_the_device(samples: np.ndarray) -> np.ndarray:
    """Zeros where the device has no joint or point of contact."""
    rows = samples.view(np.float64).reshape(len(samples), -1)
    rows[:, np.setdiff1d(np.arange(rows.shape[1]), present_columns())] = 0.0
    return samples


def _write_run(folder: Path, drop_block: bool = False) -> Path:
    chance = np.random.default_rng(1)
    samples = np.zeros(TICKS, SAMPLE)
    samples["tick"], samples["t"] = np.arange(TICKS), np.arange(TICKS) / 1000
    for name in ("q", "dq", "f_meas", "grasp"):
        samples[name] = chance.normal(size=samples[name].shape)
    samples = _of_the_device(samples)
    samples["sequence"] = np.where(np.arange(TICKS) < 10, 0, np.where(np.arange(TICKS) < 400, 1, 2))
    blocks = {sequence: scene_block(sequence) for sequence in (1, 2)}
    for sequence, block in blocks.items():
        block["virtual_mass"] = 3.0 + sequence
    recorded = _fake_tick(ReplayData(samples, blocks))
    stream, parameters = SampleStream(folder, StateHash()), ParameterStream(folder)
    for first in range(0, TICKS, 50):
        stream.append(recorded[first : first + 50], first)
    for sequence, block in blocks.items():
        if not (drop_block and sequence == 2):
            parameters.append(block.tobytes())
    (folder / "session.json").write_text("{}")
    return folder


def test_recorded_inputs_give_the_recorded_outputs(tmp_path: Path) -> None:
    data = gather(Run.open(_write_run(tmp_path)))
    assert set(data.blocks) == {1, 2}
    assert compare(data.samples, _fake_tick(data)) is None


@pytest.mark.seconds
def test_a_flipped_bit_is_caught_by_the_checksum_or_changes_nothing(tmp_path: Path) -> None:
    """Some bits of a block fill it up or say what its reader knows; every other one costs the block."""
    whole = gather(Run.open(_write_run(tmp_path))).samples.tobytes()
    path = tmp_path / "haptic.arrows"
    content = path.read_bytes()
    places = np.linspace(0.1 * len(content), 0.9 * len(content), 60).astype(int)
    caught = 0
    for place in places:
        damaged = bytearray(content)
        damaged[place] ^= 1
        path.write_bytes(damaged)
        try:
            assert gather(Run.open(tmp_path)).samples.tobytes() == whole
        except PartialDataError as error:
            assert "50 ticks are missing after tick" in str(error)
            caught += 1
    assert caught > 0.8 * len(places)


@pytest.mark.parametrize("field", ["q", "dq", "f_meas", "grasp"])
def test_one_flipped_bit_with_a_repaired_checksum_changes_the_outputs(tmp_path: Path, field: str) -> None:
    """Somebody who writes the file anew passes the checksum, and fails the replay at that very tick."""
    data = gather(Run.open(_write_run(tmp_path)))
    samples = data.samples.copy()
    cell = samples[field].reshape(TICKS, -1)
    cell.view(np.uint64)[437, 0] ^= np.uint64(1) << np.uint64(44)
    samples[field] = cell.reshape(samples[field].shape)
    forged = np.concatenate([decode_samples(encode_samples(samples[i : i + 50], i // 50, i)).records
                             for i in range(0, TICKS, 50)])  # fmt: skip
    difference = compare(forged, _fake_tick(ReplayData(forged, data.blocks)))
    assert difference is not None and difference.tick == 437 and difference.column == "hip_world[0]"
    assert difference.recorded != difference.replayed and "tick 437, hip_world[0]" in str(difference)


def test_comparison_is_of_bits_and_of_outputs_only() -> None:
    one = np.zeros(5, SAMPLE)
    other = one.copy()
    other["lateness_ns"], other["q"][3] = 7.0, 1.0
    assert compare(one, other) is None
    other["ramp"][4] = -0.0
    difference = compare(one, other)
    assert difference is not None and (difference.tick, difference.column, difference.count) == (0, "ramp", 1)
    one["s"], other["s"], other["ramp"] = np.nan, np.nan, 0.0
    assert compare(one, other) is None, "the same not-a-number is the same"
    with pytest.raises(ValueError, match="5 recorded and 4"):
        compare(one, other[:4])


@pytest.mark.seconds
@pytest.mark.parametrize("row", [0, 999, 1000, 1001, 49_999])
def test_a_difference_is_found_in_every_row(row: int) -> None:
    """Also far behind the first second, and in the last row."""
    one = np.zeros(50_000, SAMPLE)
    one["tick"] = np.arange(50_000)
    other = one.copy()
    other["f_user_world"][row, 1] = np.nextafter(0.0, 1.0)
    difference = compare(one, other)
    assert difference is not None
    assert (difference.tick, difference.column, difference.count) == (row, "f_user_world[1]", 1)


def _events(count: int) -> np.ndarray:
    events = np.zeros(count, EVENT)
    events["tick"], events["kind"] = np.arange(count) * 3, 1 + np.arange(count) % 4
    events["force"], events["normal_world"] = np.linspace(0, 1, count), [0.0, 1.0, 0.0]
    return events


@pytest.mark.parametrize("field", [name for name in EVENT.names or () if name != "t_ns"])
@pytest.mark.parametrize("row", [0, 1999])
def test_an_event_that_differs_is_found(field: str, row: int) -> None:
    one, other = _events(2000), _events(2000)
    other["t_ns"] = 5
    one["value"], other["value"] = np.nan, np.inf
    assert compare_events(one, other, 10_000) is None
    cell = other[field].reshape(2000, -1)
    cell[row, 0] = 1 if field == "value" else cell[row, 0] + 1
    one["value"][row] = 0
    other["value"][row] = 1 if field == "value" else 0
    difference = compare_events(one, other, 10_000)
    assert difference is not None and difference.column == f"event {row}, {field}"
    assert (difference.tick, difference.count) == (one["tick"][row], 1)


@pytest.mark.parametrize("field", ["force", "value"])
@pytest.mark.parametrize(("recorded", "replayed"), [(np.nan, 0.5), (0.5, np.nan), (np.inf, 0.5), (0.5, -np.inf)])
def test_a_number_in_place_of_none_is_a_difference(field: str, recorded: float, replayed: float) -> None:
    """And both are named, wherever other rows have none on both sides."""
    one, other = _events(50), _events(50)
    for events in (one, other):
        events[field][::3] = np.nan
    one[field][31], other[field][31] = recorded, replayed
    difference = compare_events(one, other, 10_000)
    assert difference is not None and (difference.tick, difference.count) == (93, 1)
    assert difference.column == f"event 31, {field}"
    one[field][31] = other[field][31] = np.nan
    assert compare_events(one, other, 10_000) is None


def test_an_event_more_or_less_is_found_up_to_the_end(tmp_path: Path) -> None:
    events = _events(20)
    for one, other in ((events, events[:-1]), (events[:-1], events)):
        difference = compare_events(one, other, 100)
        assert difference is not None and difference.tick == 57
        assert (difference.recorded, difference.replayed) == (len(one), len(other))
        assert compare_events(one, other, 57) is None, "the end of a run that was cut off"
    assert compare_events(events[:0], events[:0], 100) is None


def test_missing_parameter_block_and_empty_run_cannot_be_replayed(tmp_path: Path) -> None:
    with pytest.raises(PartialDataError, match="parameter block 2 is missing"):
        gather(Run.open(_write_run(tmp_path, drop_block=True)))
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "session.json").write_text("{}")
    with pytest.raises(PartialDataError, match="holds no tick"):
        gather(Run.open(tmp_path / "empty"))


def test_checksum_is_crc32_of_the_rows() -> None:
    """Written down for readers that are not ours: CRC32 over seq and first (int64, little endian), t, then sample."""
    import pyarrow as pa

    from mimics_app.recording.arrow_format import schema_bytes
    from mimics_app.recording.column_layout import samples_schema

    samples = np.zeros(3, SAMPLE)
    samples["t"], samples["ramp"] = [1, 2, 3], [4, 5, 6]
    stream = schema_bytes(samples_schema()) + encode_samples(samples, 7, 350)
    message = pa.ipc.open_stream(stream).read_next_batch_with_custom_metadata()
    rows = samples.view("<f8").reshape(3, -1)[:, present_columns()]
    data = np.array([7, 350], "<i8").tobytes() + rows[:, 0].tobytes() + rows[:, 1:].tobytes()
    assert int(message.custom_metadata[b"crc"], 16) == zlib.crc32(data)


@pytest.mark.parametrize(("until", "said"), [(400, "not compared: 1 event from tick 400 on"), (TICKS, "")])
def test_events_are_compared_up_to_the_last_row(
    tmp_path: Path, until: int, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A run whose rows were cut off and recovered still has the events after them: no difference, and said so."""
    folder = _write_run(tmp_path)
    events = np.zeros(3, EVENT)
    events["tick"], events["kind"] = [5, 300, 700], EventKind.CONTACT_BEGIN
    lines = b"".join(encode_event(event, number) + b"\n" for number, event in enumerate(events))
    (folder / "events.jsonl").write_bytes(lines)
    if until < TICKS:
        _seq, offset, _length = np.fromfile(folder / "haptic.arrows.idx", np.int64).reshape(-1, 3)[until // 50].tolist()
        os.truncate(folder / "haptic.arrows", offset + 100)
    recover(folder)
    samples, printed = gather(Run.open(folder)).samples, events[events["tick"] < until]
    again = SimpleNamespace(samples=samples, events=printed, snapshots={})
    tick = SimpleNamespace(
        play_loop=lambda *_: again, play_task=lambda *_: (None, None)
    )  # the compiled one is not what is tested
    monkeypatch.setitem(sys.modules, "mimics_app.app.session.replay", tick)
    monkeypatch.setattr("mimics_app.app.terminal.first_start.say_if_cold", lambda: None)
    assert main(["replay", str(folder)]) == 0
    printed = capsys.readouterr().out
    assert f"{until} ticks replayed, every output and 2 events equal" in printed and said in printed


def test_meshes_come_back_from_disk_as_the_compiled_loop_takes_them(tmp_path: Path) -> None:
    """A file keeps no alignment of records, and a kernel of a fixed signature refuses those of another."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    given = ObjectStatics(build_mesh_table([(corners, faces)]), np.zeros(0, TUNNEL), ())
    write_statics(tmp_path, Statics(given.arrays, given.fields))
    kept = read_statics(tmp_path)
    assert kept is not None
    back = ObjectStatics.from_arrays(kept.arrays, kept.fields)
    for before, after in zip(given.meshes, back.meshes, strict=True):
        assert typeof(after) == typeof(before) and np.array_equal(after, before)
    with pytest.raises(ValueError, match="another dtype"):
        ObjectStatics.from_arrays({**kept.arrays, "rows": np.zeros(1)}, kept.fields)
