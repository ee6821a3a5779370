"""Files of body signals that claim more than they hold, or are none, are refused; long ones are played in parts."""

from __future__ import annotations

import bz2
import gzip
import os
import threading
import tracemalloc
from pathlib import Path

import edfio
import numpy as np
import pytest

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.read_budget import READ_BUDGET
from mimics_app.inputs.physio import csv_file, edf_file, stored_samples, time_grid
from mimics_app.inputs.physio.recording import FileSource, check_wfdb_header, read_signal_file

CHEAP = 24 << 20
"""Memory within which a file is refused [bytes]."""


def refusal(path: Path, at_most: int = CHEAP) -> str:
    tracemalloc.start()
    try:
        with pytest.raises(SceneError) as caught:
            read_signal_file(path)
        assert tracemalloc.get_traced_memory()[1] < at_most
    finally:
        tracemalloc.stop()
    return caught.value.issues[0].what


@pytest.mark.parametrize("name", ["x.csv", "x.csv.gz", "x.edf", "x.bdf"])
def test_a_pipe_is_no_recording(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    assert "not a regular file" in refusal(tmp_path / name)


COUNTS = 256 + 2 * (16 + 80 + 5 * 8 + 80)
"""Place of the numbers of samples in a record, of a file of two signals."""
WAVE = np.round(1000.0 * np.sin(np.arange(6000) / 30.0))


def write_edf(path: Path, rate: int = 200, unit: str = "uV") -> np.ndarray:
    """Two signals of 30 s as edfio writes them; returns the second, the ECG."""
    kind, file = (edfio.BdfSignal, edfio.Bdf) if path.suffix == ".bdf" else (edfio.EdfSignal, edfio.Edf)
    options = {"physical_dimension": unit, "physical_range": (-2000, 2000)}
    other = kind(np.zeros(300), 10, label="Temp", **options)
    file([other, kind(WAVE, rate, label="ECG", **options)]).write(path)
    return np.asarray(WAVE, float)


@pytest.mark.parametrize("suffix", [".edf", ".bdf"])
def test_samples_are_those_that_an_independent_library_wrote(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    wave = write_edf(tmp_path / f"x{suffix}")
    step = 4000.0 / (2**16 if suffix == ".edf" else 2**24) * 1e-3
    (whole,) = read_signal_file(tmp_path / f"x{suffix}")
    np.testing.assert_allclose(whole.values[:], 1e-3 * wave, atol=step)
    assert (whole.rate, whole.start_s) == (200.0, 0.0)
    monkeypatch.setattr(stored_samples, "KEPT_BYTES", 0)
    (parts,) = read_signal_file(tmp_path / f"x{suffix}")
    assert not isinstance(parts.values, np.ndarray) and len(parts.values) == len(wave)
    for first, last in ((0, 1), (199, 201), (0, 6000), (5999, 6000), (37, 4711), (6000, 9000), (50, 50)):
        np.testing.assert_array_equal(parts.values[first:last], whole.values[first:last])


def test_a_long_edf_is_opened_without_being_read(tmp_path: Path) -> None:
    """A day at 1 kHz, all zeros: a file with a hole."""
    path = tmp_path / "long.edf"
    write_edf(path, 200)
    head = bytearray(path.read_bytes()[:768])
    head[236:244] = b"86400   "
    head[244:252] = b"1       "
    head[COUNTS + 8 : COUNTS + 16] = b"1000    "
    with path.open("wb") as file:
        file.write(head)
        file.truncate(768 + 86_400 * 2 * (int(head[COUNTS : COUNTS + 8]) + 1000))
    tracemalloc.start()
    try:
        (signal,) = read_signal_file(path)
        source = FileSource([signal])
        blocks = [block for t in range(0, 100, 10) for block in source.read(t * SECOND_NS)]
        assert len(signal.values) == 86_400_000 and signal.rate == 1000.0
        assert [len(block.values) for block in blocks] == [10_000] * 9
        assert len(signal.values[50_000_000:50_001_000]) == 1000
        assert tracemalloc.get_traced_memory()[1] < CHEAP
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("at", "text", "told"),
    [
        (236, b"99999999", "are stated"),
        (236, b"-1      ", "are stated"),
        (236, b"nan     ", "not a number"),
        (236, b"1e30    ", "are stated"),
        (244, b"99999999", "samples at"),
        (244, b"1e-30   ", "samples at"),
        (252, b"9999", "9999 signals"),
        (252, b"0   ", "0 signals"),
        (COUNTS, b"99999999", "stated to have"),
        (COUNTS, b"1.5     ", "stated to have"),
        (COUNTS, b"-5      ", "stated to have"),
    ],
)
def test_a_header_of_edf_that_lies_is_refused(tmp_path: Path, at: int, text: bytes, told: str) -> None:
    write_edf(tmp_path / "x.edf")
    data = bytearray((tmp_path / "x.edf").read_bytes())
    data[at : at + len(text)] = text
    (tmp_path / "x.edf").write_bytes(data)
    assert told in refusal(tmp_path / "x.edf")


def test_an_edf_that_becomes_shorter_while_it_plays_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stored_samples, "KEPT_BYTES", 0)
    write_edf(tmp_path / "x.edf")
    (signal,) = read_signal_file(tmp_path / "x.edf")
    os.truncate(tmp_path / "x.edf", 2000)
    with pytest.raises(OSError, match="became shorter"):
        signal.values[4000:4010]


def rows(count: int, rate: float = 250.0) -> str:
    return "t_s,ecg,gsr\n" + "".join(f"{k / rate:.4f},{k % 97},{0.5 * (k % 13)}\n" for k in range(count))


@pytest.mark.parametrize("compress", [None, gzip.compress, bz2.compress])
def test_a_table_in_batches_is_the_table_in_one(tmp_path: Path, compress, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a gap, rows of one place on both sides of a joint, and cells without a value."""
    text = rows(3000).splitlines(keepends=True)
    text[700:900] = []
    for k in range(10, len(text), 57):
        time = text[k].split(",")[0]
        text[k] = f"{time},,1.5\n{time},{k},2.5\n"
    name = {None: "x.csv", gzip.compress: "x.csv.gz", bz2.compress: "x.csv.bz2"}[compress]
    (tmp_path / name).write_bytes((compress or bytes)("".join(text).encode()))
    whole = {one.name: one for one in read_signal_file(tmp_path / name)}
    monkeypatch.setattr(csv_file, "_BATCH", 64)
    monkeypatch.setattr(time_grid, "_FIRST_ROWS", 1000)
    monkeypatch.setattr(time_grid, "KEPT_BYTES", 100)
    monkeypatch.setattr(stored_samples, "KEPT_BYTES", 0)
    parts = {one.name: one for one in read_signal_file(tmp_path / name)}
    assert {*whole} == {*parts} == {"ecg", "gsr"} and len(whole["ecg"].values) == 3000
    for key, signal in whole.items():
        assert isinstance(signal.values, np.ndarray) and not isinstance(parts[key].values, np.ndarray)
        np.testing.assert_array_equal(parts[key].values[:], signal.values)
        np.testing.assert_array_equal(parts[key].values[1234:1300], signal.values[1234:1300])
    assert np.isnan(whole["ecg"].values[700:890]).all() and np.isnan(whole["ecg"].values[9])
    assert whole["gsr"].values[9] == 1.5, "of several rows of one place the first counts"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("t_s,ecg\n0,1\n0.0001,1\n0.0002,1\n26000,1\n", "spread over"),
        ("t_s,ecg\n0,1\n0.00001,1\n", "apart over"),
        ("t_s,ecg\n0,1\n1,1\n0.5,1\n", "backwards in row 2"),
        ("t_s," + "x" * 70_000 + "\n0,1\n", "its first row"),
        (",".join(["t_s", *"a" * 5000]) + "\n0,1\n", "more than 4096 columns"),
        ("t_s,ecg\n0," + "1" * (2 << 20) + "\n", "cannot be read"),
        ("t_s,ecg\n" + "0" * (3 << 20), "cannot be read"),
        ("", "it is empty"),
        ("\n\n\n", "it is empty"),
    ],
)
def test_a_table_that_claims_more_than_it_holds_is_refused(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "x.csv").write_text(text)
    assert told in refusal(tmp_path / "x.csv")


def test_no_thread_of_arrow_reads_through_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that still read while `tracemalloc` stopped crashed the interpreter."""
    threads, read = set(), csv_file._Text.readinto
    monkeypatch.setattr(csv_file._Text, "readinto", lambda *of: (threads.add(threading.get_ident()), read(*of))[1])
    monkeypatch.setattr(csv_file, "_BATCH", 4096)
    (tmp_path / "x.csv").write_text(rows(3000))
    assert len(read_signal_file(tmp_path / "x.csv")) == 2
    assert threads == {threading.get_ident()}


def test_text_that_unpacks_a_thousandfold_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_file, "_ROOM", 1 << 20)
    path = tmp_path / "x.csv.gz"
    path.write_bytes(gzip.compress(b"t_s,ecg\n" + b"0.1,0\n" * 4_000_000))
    assert "unpacks to more than 64 times" in refusal(path)


def test_a_long_table_takes_no_more_memory_than_a_short_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time_grid, "KEPT_BYTES", 1 << 16)
    monkeypatch.setattr(stored_samples, "KEPT_BYTES", 1 << 16)
    monkeypatch.setattr(time_grid, "_FIRST_ROWS", 1 << 12)
    monkeypatch.setattr(csv_file, "_BATCH", 1 << 15)
    peaks = []
    for count in (100_000, 400_000):
        (tmp_path / "x.csv").write_text(rows(count))
        tracemalloc.start()
        try:
            signals = read_signal_file(tmp_path / "x.csv")
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
        assert [len(one.values) for one in signals] == [count, count]
    assert peaks[1] < 1.2 * peaks[0]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x 1 250 1000\n../y.dat 16 200 11 0 0 0 0 ECG\n", "not in its folder"),
        ("x 1 250 1000\n/etc/hostname 16 200 11 0 0 0 0 ECG\n", "not in its folder"),
        ("x 1 250 1000\npipe 16 200 11 0 0 0 0 ECG\n", "cannot be read"),
        ("x 1 250 1000\ngone.dat 16 200 11 0 0 0 0 ECG\n", "cannot be read"),
        ("x 9 250 99999999999\nx.dat 16 200 11 0 0 0 0 ECG\n", "of memory"),
        ("x/2 1 250 1000\n../z 500\n", "not in its folder"),
        ("x/2 1 250 1000\nx 500\n", "segments that contain segments"),
        ("x many 250 1000\n", "lacks the numbers"),
        ("", "not a WFDB header"),
    ],
)
def test_a_header_of_wfdb_names_files_of_its_folder_alone(tmp_path: Path, text: str, told: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "x.dat").write_bytes(bytes(2000))
    (tmp_path / "x.hea").write_text(text)
    with pytest.raises(SceneError, match=told):
        check_wfdb_header(tmp_path / "x.hea")


def test_the_budget_is_that_of_all_readers() -> None:
    assert READ_BUDGET <= 1 << 28 and stored_samples.KEPT_BYTES <= READ_BUDGET // 4
    assert edf_file.kept is stored_samples.kept
