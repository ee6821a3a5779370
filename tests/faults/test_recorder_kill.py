"""The recorder keeps what it was given: app killed, recorder killed, both killed, at seeded random moments."""

from __future__ import annotations

import mmap
import os
import random
import signal
import time
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from mimics_app.app.play.launching import cut_off_notice
from mimics_app.contracts.errors import PartialDataError, SceneError
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.recover import recover
from mimics_app.recording.run import Run
from tests.support.recorder_app import CLOSED, PID, TICK, TRIALS, fake_samples, main

MOST_LOST_TICKS = 100


# Stand-ins are forked from a process that has imported everything: what takes time is their start.
_context = get_context("forkserver")
_context.set_forkserver_preload(["tests.support.recorder_app"])


class App:
    """The stand-in as a process of its own group, with the words it shares."""

    def __init__(self, folder: Path, seconds: float = 30.0) -> None:
        self.folder = folder / "20260101T000000Z_run"
        self.folder.mkdir(parents=True)
        path = folder / "words"
        path.write_bytes(b"\0" * 32)
        self._file = path.open("r+b")
        self.words = np.ndarray(4, np.int64, buffer=mmap.mmap(self._file.fileno(), 32))
        self.process = _context.Process(target=main, args=(self.folder, path, seconds))
        self.process.start()

    def wait_until(self, condition: Callable[[], bool], timeout: float = 60.0) -> None:
        deadline = time.monotonic() + timeout
        while not condition():
            assert self.process.is_alive() or self.words[CLOSED], "the stand-in ended on its own"
            assert time.monotonic() < deadline
            time.sleep(0.005)

    def wait_for_end_of(self, pid: int) -> None:
        deadline = time.monotonic() + 30
        while _runs(pid):
            assert time.monotonic() < deadline, "the recorder does not end"
            time.sleep(0.005)

    def end(self) -> None:
        if self.process.is_alive():
            self.kill_all()
        self.process.join()
        self._file.close()

    def kill_all(self) -> None:
        """The stand-in and its recorder: it made a group of its own."""
        os.killpg(self.process.pid, signal.SIGKILL)


def _runs(pid: int) -> bool:
    """Whether any thread of a process is left: the first may have ended while others still hold its files."""
    try:
        return any(_state(task) != "Z" for task in Path(f"/proc/{pid}/task").iterdir())
    except (FileNotFoundError, ProcessLookupError):
        return False


def _state(task: Path) -> str:
    return (task / "stat").read_text().rpartition(")")[2].split()[0]


def _assert_arrow_opens(folder: Path) -> None:
    for path in folder.glob("*.arrows"):
        reader = pa.ipc.open_stream(path)
        assert reader.schema.metadata[b"format"].startswith(b"mimics")
        try:
            while True:
                reader.read_next_batch()
        except (StopIteration, pa.ArrowInvalid, OSError):
            continue  # the last block of a stream nobody closed may be torn


def _assert_rows_are_those_pushed(run: Run) -> None:
    ticks = run.haptic["tick"].astype(int)
    expected = fake_samples(0, int(ticks.max()) + 1)[ticks]
    assert run.haptic.tobytes() == expected.tobytes()


def _moments(count: int) -> list[float]:
    return [random.Random(20 + i).uniform(0.05, 1.5) for i in range(count)]


def _start_apps(tmp_path: Path, count: int) -> list[App]:
    """Several at once: what takes time is their start."""
    apps = [App(tmp_path / str(i)) for i in range(count)]
    for app in apps:
        app.wait_until(lambda app=app: app.words[TICK] > 0)
    return apps


@pytest.mark.parametrize("moments", [_moments(10)[:5], _moments(10)[5:]], ids=["first five", "last five"])
@pytest.mark.requirement("R21")
@pytest.mark.fault(id="F11")
def test_app_killed_loses_at_most_100_ms_and_no_finished_trial(tmp_path: Path, moments: list[float]) -> None:
    _kill_apps(tmp_path, moments)


def test_the_standby_writes_what_a_starved_recorder_left_when_the_app_dies_with_it(tmp_path: Path) -> None:
    (app,) = _start_apps(tmp_path, 1)
    try:
        app.wait_until(lambda: app.words[TICK] > 300)
        recorder = int(app.words[PID])
        os.kill(recorder, signal.SIGSTOP)
        stopped_at = int(app.words[TICK])
        app.wait_until(lambda: app.words[TICK] > stopped_at + 5 * MOST_LOST_TICKS)
        shown = int(app.words[TICK])
        os.kill(recorder, signal.SIGKILL)
        os.kill(app.process.pid, signal.SIGKILL)
        deadline = time.monotonic() + 30
        while (run := Run.open(app.folder)).manifest is None:
            assert time.monotonic() < deadline, "no standby closes the run"
            time.sleep(0.05)
        assert run.manifest.restarts == 1 and run.haptic["tick"].max() >= shown
        _assert_rows_are_those_pushed(run)
    finally:
        app.end()


def test_a_session_under_way_is_not_repaired_before_its_end(tmp_path: Path) -> None:
    """Repairing takes the files from under the recorder: what it wrote after that would be lost."""
    (app,) = _start_apps(tmp_path, 1)
    try:
        app.wait_until(lambda: app.words[TICK] > 300)
        assert Run.open(app.folder).problems()[0] == "the run is being recorded"
        assert cut_off_notice(app.folder.parent) == ""
        with pytest.raises(SceneError, match="this run is being recorded"):
            recover(app.folder)
        os.kill(app.process.pid, signal.SIGKILL)
        app.wait_for_end_of(int(app.words[PID]))
        assert recover(app.folder).verdict.status == "interrupted"
        _assert_rows_are_those_pushed(Run.open(app.folder))
    finally:
        app.end()


def test_the_launcher_names_a_session_that_a_power_failure_cut_off(tmp_path: Path) -> None:
    (app,) = _start_apps(tmp_path, 1)
    try:
        app.wait_until(lambda: app.words[TICK] > 300)
        app.kill_all()
        app.process.join()
        app.wait_for_end_of(int(app.words[PID]))
        assert cut_off_notice(app.folder.parent).endswith(f"mimics record recover {app.folder}")
        recover(app.folder)
        assert cut_off_notice(app.folder.parent) == ""
    finally:
        app.end()


@pytest.mark.slow
@pytest.mark.parametrize("first", range(10, 100, 5))
def test_app_killed_ninety_times_more(tmp_path: Path, first: int) -> None:
    """No loss in 100 kills: the share of bad ones is below 3 % with 95 % confidence (1 - 0.05^(1/100))."""
    _kill_apps(tmp_path, _moments(100)[first : first + 5])


def _kill_apps(tmp_path: Path, moments: list[float]) -> None:
    apps = _start_apps(tmp_path, len(moments))
    try:
        start = time.monotonic()
        for app, moment in sorted(zip(apps, moments, strict=True), key=lambda pair: pair[1]):
            time.sleep(max(0.0, start + moment - time.monotonic()))
            os.kill(app.process.pid, signal.SIGKILL)
        for app in apps:
            _check_after_kill_of_app(app)
    finally:
        for app in apps:
            app.end()


def _check_after_kill_of_app(app: App) -> None:
    app.process.join()
    pushed, trials, recorder = (int(app.words[i]) for i in (TICK, TRIALS, PID))
    app.wait_for_end_of(recorder)
    run = Run.open(app.folder)
    assert run.status == "interrupted"
    assert run.haptic["tick"][-1] >= pushed - MOST_LOST_TICKS
    assert len(run.haptic) == run.haptic["tick"][-1] + 1, "rows are missing in the middle"
    assert len(run.trials) >= trials
    assert run.manifest is not None and run.manifest.state_hash == run.state_hash()
    assert not run.disagreements() and not run.damages and not run.gaps
    assert set(run.parameters) == {1}
    _assert_rows_are_those_pushed(run)
    _assert_arrow_opens(app.folder)


def test_everything_killed_at_once_loses_at_most_100_ms(tmp_path: Path) -> None:
    """Nobody is left to drain the ring."""
    apps = _start_apps(tmp_path, 3)
    try:
        for app in apps:
            time.sleep(0.31)
            app.kill_all()
        for app in apps:
            _check_after_kill_of_all(app)
    finally:
        for app in apps:
            app.end()


def _check_after_kill_of_all(app: App) -> None:
    app.process.join()
    app.wait_for_end_of(int(app.words[PID]))
    run = Run.open(app.folder)
    assert run.status == "open"
    assert run.haptic["tick"][-1] >= app.words[TICK] - MOST_LOST_TICKS
    assert len(run.trials) >= app.words[TRIALS] - 1, "a trial in the pipe dies with both ends, one on disk does not"
    _assert_arrow_opens(app.folder)
    recover(app.folder)
    again = Run.open(app.folder)
    manifest = again.manifest
    assert manifest is not None
    assert again.status == "recovered" and not again.damages
    assert manifest.rows == len(again.haptic) == len(run.haptic)
    assert pa.ipc.open_stream(app.folder / "haptic.arrows").read_all().num_rows == manifest.rows
    _assert_rows_are_those_pushed(again)


@pytest.mark.parametrize("sign", [signal.SIGKILL, signal.SIGSTOP])
@pytest.mark.fault(id="F12")
def test_recorder_killed_is_replaced_and_says_so(tmp_path: Path, sign: int) -> None:
    """The ring holds what comes in between, so not one row is lost; a stopped one only catches up."""
    app = App(tmp_path, seconds=4.0)
    try:
        app.wait_until(lambda: app.words[TICK] > 700)
        first = int(app.words[PID])
        os.kill(first, sign)
        if sign == signal.SIGSTOP:
            time.sleep(1.0)
            os.kill(first, signal.SIGCONT)
        app.wait_until(lambda: bool(app.words[CLOSED]))
        run = Run.open(app.folder)
        assert run.manifest is not None
        assert run.status == "clean"
        assert run.manifest.restarts == (1 if sign == signal.SIGKILL else 0)
        assert len(run.lines_of("recorder", "gap")) == run.manifest.restarts
        frames = [line["frame"] for line in run.lines_of("app", "frame")]
        assert frames == sorted(set(frames))
        assert len(frames) >= 238, "at most what one pass had read and not written dies with it"
        assert [row["trial"] for row in run.trials] == list(range(20))
        assert not run.gaps and run.haptic["tick"][-1] == app.words[TICK]
        assert run.state_hash() == run.manifest.state_hash and not run.disagreements()
        assert run.manifest.parameters == len(run.parameters) and not run.losses()
        _assert_rows_are_those_pushed(run)
    finally:
        app.end()


def test_recorder_stopped_for_good_is_woken(tmp_path: Path) -> None:
    """SIGSTOP, and nobody to continue it: 2 s later the app does, and not one row is lost."""
    app = App(tmp_path, seconds=5.0)
    try:
        app.wait_until(lambda: app.words[TICK] > 700)
        os.kill(int(app.words[PID]), signal.SIGSTOP)
        app.wait_until(lambda: bool(app.words[CLOSED]))
        run = Run.open(app.folder)
        assert run.manifest is not None and run.status == "clean" and run.manifest.restarts == 0
        assert not run.gaps and run.haptic["tick"][-1] == app.words[TICK]
    finally:
        app.end()


@pytest.mark.slow
def test_recorder_that_cannot_be_woken_is_replaced(tmp_path: Path) -> None:
    app = App(tmp_path, seconds=12.0)
    try:
        app.wait_until(lambda: app.words[TICK] > 700)
        first = int(app.words[PID])
        while _runs(first):
            os.kill(first, signal.SIGSTOP)
            time.sleep(0.002)
            assert not app.words[CLOSED], "it was never replaced"
        app.wait_until(lambda: bool(app.words[CLOSED]))
        run = Run.open(app.folder)
        assert run.manifest is not None and run.status == "clean" and run.manifest.restarts == 1
    finally:
        app.end()


def test_interrupt_of_the_group_is_left_to_the_app(tmp_path: Path) -> None:
    """Ctrl-C reaches the recorder too; it must go on until the app has closed."""
    app = App(tmp_path, seconds=1.0)
    try:
        app.wait_until(lambda: app.words[PID] > 0)
        for sign in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            os.kill(int(app.words[PID]), sign)
        app.wait_until(lambda: bool(app.words[CLOSED]))
        run = Run.open(app.folder)
        assert run.manifest is not None and run.status == "clean" and run.manifest.restarts == 0
    finally:
        app.end()


def test_interrupt_of_the_group_while_it_starts_is_left_to_the_app(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """An interpreter that starts would end with a traceback of its imports."""
    recorder = Recorder(SessionMemory(), tmp_path, {"seed": 1})
    recorder.start(wait=False)
    first = recorder.pid
    for _ in range(20):
        for sign in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            os.kill(first or 0, sign)
        time.sleep(0.005)
    recorder.wait_until_ready()
    assert recorder.pid == first
    assert recorder.close().status == "clean"
    assert capfd.readouterr().err == ""


def test_recorder_killed_while_it_starts_is_reported_by_its_signal(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """It leaves no message of its own to refer to."""
    recorder = Recorder(SessionMemory(), tmp_path, {"seed": 1})
    recorder.start(wait=False)
    os.kill(recorder.pid or 0, signal.SIGKILL)
    with pytest.raises(PartialDataError, match="does not start; it was ended by SIGKILL"):
        recorder.wait_until_ready()
    assert capfd.readouterr().err == ""
