"""Whole runs on body signals from outside: a stream, an amplifier that is unplugged, files of three formats."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import edfio
import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.session.body_replay import replay_body
from mimics_app.recording.run import Run
from tests.support.amplifier import AmplifierEmulator
from tests.support.body_signals import body

RATE = 1000


def play(folder: Path, source: str, seconds: float, after_frame: Callable[[int], None]) -> tuple[Run, list[str]]:
    """The recording of a session and what it said; `after_frame` is called with the number of frames done."""
    with mimics.open("wavy_tunnel", runs=folder, physio=source) as session:
        for frame in range(1, round(60 * seconds) + 1):
            session.step()
            after_frame(frame)
    return mimics.load(session.run_dir).run, session.notices


def ecg_of(run: Run) -> Any:
    return np.concatenate([row.block.values for row in run.signals if row.block.name == "ecg"])


def test_an_amplifier_that_is_unplugged_ends_its_signals_and_not_the_run(tmp_path: Path) -> None:
    """Two of four seconds it sends, a frame's worth a frame; then the cable is pulled."""
    ecg = body(2)[0]["ecg"]
    amplifier, opened = AmplifierEmulator(["ecg"], RATE, binary=True), threading.Event()

    def announce() -> None:
        while not opened.wait(0.05):
            amplifier.announce()

    def send(frame: int) -> None:
        opened.set()
        begin, end = (round(RATE * (frame - k) / 60) for k in (1, 0))
        if frame < 120:
            amplifier.send(ecg[begin:end, None])
        elif frame == 120:
            amplifier.unplug()

    talk = threading.Thread(target=announce)
    talk.start()
    try:
        run, reported = play(tmp_path, f"serial:{amplifier.port}", 4.0, send)
    finally:
        opened.set()
        talk.join()
    found = ecg_of(run)
    assert len(run.lines_of("app", "frame")) >= 239
    assert 1000 < len(found) <= len(ecg)
    assert np.isfinite(found).all()
    assert [line for line in reported if "the amplifier is gone" in line]
    (line,) = run.lines_of("app", "signal_source")
    assert "the amplifier is gone" in line["lost"]
    assert not run.losses()
    replayed = replay_body(run)
    assert replayed is not None
    assert replayed.difference == ""


def test_a_run_on_a_stream_of_lsl(tmp_path: Path) -> None:
    """A sender in another thread, as fast as the frames of the virtual clock go."""
    import pylsl

    name = f"mimics run {time.monotonic_ns()}"
    outlet = pylsl.StreamOutlet(pylsl.StreamInfo(name, "ECG", 1, RATE, "float32", name))
    ecg = body(4)[0]["ecg"]

    def send(frame: int) -> None:
        if frame == 1:
            assert outlet.wait_for_consumers(20.0)
        begin, end = (round(RATE * (frame - k) / 60) % len(ecg) for k in (1, 0))
        if begin < end:
            outlet.push_chunk(ecg[begin:end].astype(np.float32).reshape(-1, 1).tolist())
        time.sleep(0.004)

    run, _ = play(tmp_path, f"lsl:{name}", 8.0, send)
    found = ecg_of(run)
    good = found[np.isfinite(found)]
    assert len(good) > RATE
    assert np.isin(np.round(good, 4), np.round(ecg.astype(np.float32).astype(float), 4)).all()
    replayed = replay_body(run)
    assert replayed is not None
    assert replayed.difference == ""
    assert replayed.features > 0


def write_csv(folder: Path, ecg: Any) -> Path:
    path = folder / "body.csv"
    rows = np.column_stack([np.arange(len(ecg)) / RATE, ecg])
    np.savetxt(path, rows, delimiter=",", header="t_s,ecg", comments="", fmt="%.6f")
    return path


def write_edf(folder: Path, ecg: Any) -> Path:
    whole = ecg[: len(ecg) // RATE * RATE]  # records of one second
    edfio.Edf([edfio.EdfSignal(whole, RATE, label="ECG", physical_range=(-4, 4))]).write(folder / "body.edf")
    return folder / "body.edf"


def write_wfdb(folder: Path, ecg: Any) -> Path:
    """Header and 16-bit samples after the format's description (physionet.org/physiotools/wag), a gain of 1000/mV."""
    pytest.importorskip("wfdb", reason="WFDB is read by the extra `signals`")
    counts = np.round(1000.0 * ecg).astype("<i2")
    (folder / "body.dat").write_bytes(counts.tobytes())
    layout = f"16 1000(0)/mV 16 0 {counts[0]} {int(counts.astype(np.int64).sum()) & 0xFFFF} 0 MLII"
    (folder / "body.hea").write_text(f"body 1 {RATE} {len(ecg)}\nbody.dat {layout}\n")
    return folder / "body.hea"


@pytest.mark.parametrize("write", [write_csv, write_edf, write_wfdb])
def test_a_run_on_a_file_plays_what_stands_in_it(write: Callable[[Path, Any], Path], tmp_path: Path) -> None:
    ecg = body(3)[0]["ecg"]
    run, _ = play(tmp_path / "runs", f"file:{write(tmp_path, ecg)}", 2.0, lambda frame: None)
    found = ecg_of(run)
    assert len(found) >= 1.9 * RATE
    np.testing.assert_allclose(found, ecg[: len(found)], atol=1e-3)
