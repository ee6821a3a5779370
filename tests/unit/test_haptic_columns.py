"""Columns of a recording: what mimics.load reads from haptic_columns.arrows is what haptic.arrows has."""

from __future__ import annotations

import errno
import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

import mimics_app as mimics
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.loop.loop_fields import Extent, point_rows
from mimics_app.recording import append_file, haptic_columns
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.arrow_format import INDEX_ROW
from mimics_app.recording.column_file import BATCH_ROWS, ColumnFile
from mimics_app.recording.columns import HAPTICMASTER, column_names, recorded_fields
from mimics_app.recording.recover import recover
from mimics_app.recording.run import Run
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import SampleStream

ROWS = 2 * BATCH_ROWS + 1234
TWO_HANDS = Extent(("m", "rad", "m", "m"), 2, torques=True)
COLUMNS = "haptic_columns.arrows"


def _block(first: int, count: int) -> np.ndarray:
    """Samples of four points of contact, every number of them random."""
    samples = np.zeros(count, SAMPLE)
    samples.view(np.float64)[:] = np.random.default_rng(first).normal(size=samples.nbytes // 8)
    samples["tick"] = np.arange(first, first + count)
    return samples


def _record(folder: Path, extent: Extent = HAPTICMASTER, rows: int = ROWS, *, closed: bool = True) -> None:
    """A run folder as a recorder leaves it, whole or killed."""
    samples, columns = SampleStream(folder, StateHash(extent), extent), ColumnFile(folder, extent)
    for first in range(0, rows, 50):
        block = _block(first, min(50, rows - first))
        samples.append(block, first)
        columns.add(block)
    for stream in (samples, columns) if closed else ():
        stream.close()
    (folder / "session.json").write_text("{}")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole run."""
    folder = tmp_path_factory.mktemp("recorded")
    _record(folder)
    return folder


@pytest.fixture
def run(recorded: Path, tmp_path: Path) -> Path:
    """A copy of it, to be damaged."""
    for path in recorded.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path


def _assert_equal(folder: Path, names: tuple[str, ...] = ("t", "f_user_world", "q", "margin")) -> None:
    """Fields by mimics.load are, to the bit, those of the blocks of haptic.arrows."""
    table, samples = mimics.load(folder).haptic, Run.open(folder).haptic
    for name in names:
        recorded = samples[name] if table[name].ndim == 1 else samples[name][:, : table[name].shape[1]]
        assert table[name].tobytes() == recorded.tobytes(), name


def _without_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make reading of all blocks fail."""
    monkeypatch.setattr(Run, "haptic", property(lambda _: pytest.fail("haptic.arrows was read as a whole")))


def test_fields_of_a_whole_run_are_read_without_its_blocks(recorded: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _assert_equal(recorded, tuple(field.name for field in recorded_fields(HAPTICMASTER)))
    _without_blocks(monkeypatch)
    monkeypatch.setattr(haptic_columns, "decode_samples", lambda *_: pytest.fail("a block was decoded"))
    table = mimics.load(recorded).haptic
    assert table["f_user_world"].shape == (ROWS, 3) and table["f_user_world"].units == "N"
    assert table.units["hip_world"] == "m" and "margin" in table and table.rows == ROWS


def test_every_point_of_contact_has_its_columns(tmp_path: Path) -> None:
    _record(tmp_path, TWO_HANDS, 200)
    table, samples = mimics.load(tmp_path).haptic, Run.open(tmp_path).haptic
    assert np.array_equal(table["point_1_f_user_world"], point_rows(samples, 1)["f_user_world"])
    assert table["torque_meas"].shape == (200, 4)


def test_any_arrow_reader_opens_them(recorded: Path) -> None:
    table = pa.ipc.open_stream(recorded / COLUMNS).read_all()
    assert table.column_names == column_names() and table.num_rows == ROWS
    assert table.schema.field("hip_world[1]").metadata[b"unit"] == b"m"


def test_a_killed_run_is_continued_from_its_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The last rows, of less than a batch, are in haptic.arrows alone."""
    _record(tmp_path, closed=False)
    _assert_equal(tmp_path)
    _without_blocks(monkeypatch)
    assert mimics.load(tmp_path).haptic["t"].shape == (ROWS,)


@pytest.mark.parametrize("kept", [0, 7, 5000, 7_000_000])
def test_columns_that_are_cut_off_are_continued_from_the_blocks(run: Path, kept: int) -> None:
    content = (run / COLUMNS).read_bytes()
    assert len(content) > kept
    (run / COLUMNS).write_bytes(content[:kept])
    _assert_equal(run)


def test_a_flipped_bit_of_a_column_is_read_from_the_blocks(run: Path) -> None:
    content = bytearray((run / COLUMNS).read_bytes())
    for place in range(20_000, len(content), 5000):
        content[place] ^= 1
    (run / COLUMNS).write_bytes(content)
    _assert_equal(run)


@pytest.mark.seconds
def test_without_columns_or_with_damaged_blocks_the_blocks_are_read(run: Path) -> None:
    content = bytearray((run / "haptic.arrows").read_bytes())
    _seq, offset, _length = np.fromfile(run / "haptic.arrows.idx", np.int64).reshape(-1, 3)[7].tolist()
    content[offset : offset + 8] = bytes(8)
    (run / "haptic.arrows").write_bytes(content)
    recover(run)
    _assert_equal(run)
    assert mimics.load(run).haptic.rows == ROWS - 50
    (run / COLUMNS).unlink()
    _assert_equal(run)


@pytest.mark.parametrize("block", [7, 170])
def test_a_row_that_is_damaged_in_both_files_is_nan_where_it_is_lost_and_no_other_row_moves(
    run: Path, recorded: Path, block: int
) -> None:
    """Of two batches, in a column of the first one and in a column of the second."""
    whole, blocks = mimics.load(recorded).haptic, bytearray((run / "haptic.arrows").read_bytes())
    _seq, offset, length = np.fromfile(run / "haptic.arrows.idx", np.int64).reshape(-1, 3)[block].tolist()
    blocks[offset + length // 2] ^= 1
    (run / "haptic.arrows").write_bytes(blocks)
    columns = bytearray((run / COLUMNS).read_bytes())
    columns[len(columns) * (1 if block < 160 else 3) // 5] ^= 1
    (run / COLUMNS).write_bytes(columns)
    table, lost = mimics.load(run).haptic, 0
    assert table.rows == ROWS
    for name, column in whole.items():
        found = table[name]
        same = np.asarray(found == column)
        assert np.isnan(found[~same]).all(), name
        changed = np.flatnonzero(~same.reshape(ROWS, -1).all(axis=1))
        assert changed.tolist() in ([], list(range(50 * block, 50 * block + 50))), name
        lost += len(changed) > 0
    assert lost == 1


def test_columns_of_another_device_are_not_read(run: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    other = tmp_path_factory.mktemp("other")
    _record(other, TWO_HANDS, 100)
    (run / COLUMNS).write_bytes((other / COLUMNS).read_bytes())
    _assert_equal(run)


def test_rows_recorded_later_do_not_lengthen_the_next_column(tmp_path: Path) -> None:
    samples = SampleStream(tmp_path, StateHash())
    samples.append(_block(0, 50), 0)
    table = mimics.load(tmp_path).haptic
    assert table["t"].shape == (50,)
    samples.append(_block(50, 50), 50)
    assert table["hip_world"].shape == (50, 3) and mimics.load(tmp_path).haptic["t"].shape == (100,)


def test_a_full_disk_ends_the_columns_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    append = AppendFile.append

    def full(self: AppendFile, data: bytes) -> None:
        if len(data) > 1_000_000:  # a batch
            raise OSError(errno.ENOSPC, "No space left on device")
        append(self, data)

    monkeypatch.setattr(AppendFile, "append", full)
    _record(tmp_path)
    _assert_equal(tmp_path)


def test_columns_that_cannot_be_flushed_end_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The recorder would take it for trouble with haptic.arrows, and lose its rows."""
    columns = ColumnFile(tmp_path)
    columns.add(_block(0, 50))
    used: list[int] = []

    def fail(descriptor: int) -> None:
        used.append(descriptor)
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(append_file, "_sync", fail)
    columns.sync()
    with pytest.raises(OSError, match="descriptor"):
        os.fstat(used[0])
    columns.add(_block(50, 50))
    columns.close()


@pytest.mark.seconds
def test_a_block_whose_row_of_the_sidecar_finds_no_room_is_in_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    append, failing = AppendFile.append, iter([False] * 20 + [True] + [False] * 1000)

    def full(self: AppendFile, data: bytes) -> None:
        if len(data) == INDEX_ROW.itemsize and next(failing):
            raise OSError(errno.ENOSPC, "No space left on device")
        append(self, data)

    monkeypatch.setattr(AppendFile, "append", full)
    samples, columns = SampleStream(tmp_path, StateHash()), ColumnFile(tmp_path)
    for first in range(0, BATCH_ROWS + 1000, 50):
        with suppress(OSError):
            samples.append(_block(first, 50), first)
            columns.add(_block(first, 50))
    samples.close()
    columns.close()
    (tmp_path / "session.json").write_text("{}")
    assert len(Run.open(tmp_path).haptic) == BATCH_ROWS + 950
    _assert_equal(tmp_path)
    recover(tmp_path)
    _assert_equal(tmp_path)


def test_a_second_recorder_leaves_the_columns_as_they_are(tmp_path: Path) -> None:
    _record(tmp_path, rows=BATCH_ROWS + 100, closed=False)
    samples = SampleStream(tmp_path, StateHash(), resume=True)
    columns = ColumnFile(tmp_path, resume=True)
    before = (tmp_path / COLUMNS).read_bytes()
    for first in range(samples.next_row, samples.next_row + 200, 50):
        samples.append(_block(first, 50), first)
        columns.add(_block(first, 50))
    samples.close()
    columns.close()
    assert (tmp_path / COLUMNS).read_bytes() == before
    _assert_equal(tmp_path)


@pytest.mark.seconds
@pytest.mark.parametrize("lost", [3, 8, 2000])
def test_recover_makes_the_columns_readable_to_their_last_batch(run: Path, lost: int) -> None:
    content = (run / COLUMNS).read_bytes()
    (run / COLUMNS).write_bytes(content[:-lost])
    assert COLUMNS in recover(run).repaired
    table = pa.ipc.open_stream(run / COLUMNS).read_all()
    assert table.num_rows == (ROWS if lost <= 8 else 2 * BATCH_ROWS)
    assert recover(run).repaired == () and Run.open(run).disagreements() == []
    _assert_equal(run)
