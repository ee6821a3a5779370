"""The audio process when things are missing, late, or killed: the session always goes on, with one clear line."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
import wave
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cues.sound_stage import SoundStage
from mimics_app.contracts.errors import DeviceError, MimicsError
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import AudioReport, AudioStatus
from mimics_app.contracts.shared_memory.session_memory import Capacities, ControlWord, SessionMemory
from mimics_app.lab.audio.live_latency import private_pulse_server, pulse_missing
from mimics_app.rendering.audio import openal_library
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from tests.support.audio_scene import RATE, contact, first_sounding, place, push

ROOT = Path(__file__).resolve().parents[2]
TICK = {"tick": SoundSpec(recipe="tick")}
PATIENCE_S = 60.0


@pytest.fixture
def started():
    """Start audio processes and see to it that none is left behind."""
    running = []

    def start(memory: SessionMemory, **settings) -> AudioProcess:
        audio = AudioProcess(memory, AudioSettings(**settings))
        audio.start()
        running.append(audio)
        return audio

    yield start
    for audio in running:
        audio.stop()
        assert not audio.alive


def test_a_session_that_ends_before_its_sound_could_start_says_so(tmp_path, started):
    """As on a busy computer: the process is there and has not come so far."""
    audio = started(
        SessionMemory(),
        sink="file",
        file=tmp_path / "a.wav",
        sounds=TICK,
        triggers={"contact": "tick"},
        scrape="",
        stop_timeout_s=0.2,
    )
    os.kill(audio.pid, signal.SIGSTOP)
    report = audio.stop()
    said = "the session ended before its sound could start: nothing was played; picture and touch continued"
    assert report.status.notice == said
    assert not report.crashed, "it was held back, and has not failed"
    assert not report.rows
    assert not audio.alive


def test_a_sound_that_takes_long_to_start_is_told_once_and_what_comes_of_it(capsys):
    """Notices of a session: still starting, then nothing once it is there, then how it ended."""
    status, report = [None], AudioReport(AudioStatus("none", "null", False, 0, 0.0, notice="nothing was heard"))
    output = type("Output", (), {"ready": property(lambda self: status[0]), "stop": lambda self: report})()
    stage = SoundStage.__new__(SoundStage)
    stage.output, stage._notice, stage._begun_ns = output, "", None
    for seconds in range(4, 30):
        stage._show_notice(seconds * 1_000_000_000)
    assert capsys.readouterr().err.count("still starting") == 1
    status[0] = AudioStatus("pulse", "device", False, RATE, 6.0)
    stage._show_notice(40_000_000_000)
    assert capsys.readouterr().err == ""
    stage.stop()
    assert capsys.readouterr().err == "mimics: nothing was heard\n"


def wait_until(condition, seconds: float = PATIENCE_S) -> bool:
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return True
        time.sleep(0.02)
    return False


def gone(pid: int) -> bool:
    """No such process, or only its entry in the table."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] in "ZX"
    except OSError:
        return True


def read_mix(path) -> np.ndarray:
    with wave.open(str(path)) as file:
        assert file.getparams()[:3] == (2, 2, RATE)
        return np.frombuffer(file.readframes(file.getnframes()), "<i2").reshape(-1, 2)


def test_contacts_and_orders_stand_at_their_sample_in_the_file(tmp_path, started):
    memory = SessionMemory()
    push(memory, np.zeros_like(contact(0)))
    audio = started(memory, sink="file", file=tmp_path / "a.wav", sounds=TICK, triggers={"contact": "tick"}, scrape="")
    status = audio.wait_ready(PATIENCE_S)
    assert (status.device, status.sink, status.rate, status.notice) == ("loopback", "file", RATE, "")
    times = []
    for k in range(8):
        time.sleep(0.061 + 0.0013 * k)
        times.append(time.monotonic_ns())
        push(memory, contact(times[-1]))
    audio.play(SoundEvent("tick", time.monotonic_ns() + 50_000_000))
    audio.master(1.0)
    place(memory, 0)
    time.sleep(0.2)
    report = audio.stop()
    assert not report.crashed
    assert [row.t_ns for row in report.rows if row.cause == "contact"] == times
    assert [row.cause for row in report.rows].count("order") == 1
    mix = read_mix(report.file)
    for row in report.rows:
        constant = round(status.latency_ms * 1e-3 * RATE)
        wanted = ((row.t_ns - report.origin_ns) * RATE + 500_000_000) // 1_000_000_000 + constant
        if not row.late:  # late only where this machine slept through the two blocks of slack
            assert row.onset_sample == wanted
            assert row.latency_ms == pytest.approx(status.latency_ms, abs=0.03)
        assert 0 <= first_sounding(mix, max(0, row.onset_sample - 500)) - row.onset_sample <= 1
    summary = report.summary()
    assert summary["contacts"] == 8
    assert json.dumps(summary) and json.dumps(report.table())


def test_no_device_goes_to_the_file_in_one_line_and_silently_on_stderr(tmp_path):
    file = tmp_path / "fallback.wav"
    done = subprocess.run(
        [sys.executable, "-m", "tests.support.audio_app", "device", str(file)],
        capture_output=True,
        cwd=ROOT,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0
    assert done.stderr == "", "the sound libraries' own lines must not reach the person"
    answer = json.loads(done.stdout)
    assert answer["sink"] == "file"
    assert answer["notice"] == f"no audio device: sound is rendered to {file}; picture and touch run on"
    assert not answer["crashed"]
    read_mix(file)


def test_no_device_and_no_file_drops_the_sound(started):
    memory = SessionMemory()
    audio = started(memory, driver="wave")
    status = audio.wait_ready(PATIENCE_S)
    assert status.sink == "null"
    assert status.notice == "no audio device: sound is dropped; picture and touch run on"
    for k in range(2000):  # more than the ring holds: somebody must empty it
        push(memory, contact(k))
        time.sleep(0.0001)
    report = audio.stop()
    assert (report.crashed, len(report.rows), report.dropped) == (False, 0, 0)


def test_missing_library_is_one_line_with_the_package(started):
    audio = started(SessionMemory(), library="/nowhere/libopenal.so.1")
    status = audio.wait_ready(PATIENCE_S)
    assert status.sink == "null"
    assert "/nowhere/libopenal.so.1" in status.notice
    assert "apt-get install libopenal1" in status.notice
    assert "\n" not in status.notice
    assert not audio.stop().crashed


@pytest.fixture
def no_openal_modules():
    """No trace of PyOpenAL among the imported modules during the test, and none of a false one after it."""

    def take() -> dict:
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "openal"}

    real = take()
    yield
    take()
    sys.modules.update(real)


@pytest.mark.parametrize("pyopenal", ["absent", "finds nothing"])
def test_library_that_nobody_finds_is_a_device_error(monkeypatch, tmp_path, no_openal_modules, pyopenal):
    if pyopenal == "absent":
        monkeypatch.setitem(sys.modules, "openal", None)
    else:
        (tmp_path / "openal").mkdir()
        (tmp_path / "openal" / "__init__.py").write_text("")
        (tmp_path / "openal" / "al_lib.py").write_text("raise RuntimeError('OpenAL library could not be found')")
        monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("ctypes.util.find_library", lambda name: None)
    monkeypatch.setattr(openal_library, "_USUAL_NAME", "libof.another.name")
    monkeypatch.setattr(openal_library, "_loaded", {})
    with pytest.raises(DeviceError, match="apt-get install libopenal1") as caught:
        openal_library.load_library(AudioSettings())
    assert caught.value.exit_code == 4


def test_other_library_in_place_of_openal_is_refused(monkeypatch):
    from ctypes.util import find_library

    monkeypatch.setattr(openal_library, "_loaded", {})
    with pytest.raises(DeviceError, match="is not OpenAL Soft"):
        openal_library.load_library(AudioSettings(library=find_library("m") or "libm.so.6"))


def test_child_dies_with_a_killed_parent_and_leaves_a_readable_file(tmp_path):
    file = tmp_path / "orphan.wav"
    parent = subprocess.Popen(
        [sys.executable, "-m", "tests.support.audio_app", "hold", str(file)],
        stdout=subprocess.PIPE,
        cwd=ROOT,
        text=True,
    )
    try:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        assert not gone(child)
        time.sleep(0.3)
    finally:
        parent.kill()
        parent.wait()
    assert wait_until(lambda: gone(child), 5.0)
    assert len(read_mix(file)) >= 0.2 * RATE


def test_killed_child_hangs_nobody_and_its_file_reads_to_the_last_block(tmp_path, started):
    file = tmp_path / "killed.wav"
    memory = SessionMemory()
    audio = started(memory, sink="file", file=file)
    audio.wait_ready(PATIENCE_S)
    push(memory, contact(time.monotonic_ns()))
    time.sleep(0.3)
    os.kill(audio.pid, signal.SIGKILL)
    assert wait_until(lambda: not audio.alive)
    for k in range(100):
        audio.play(SoundEvent("goal", 0))
        place(memory, k)
    status = audio.ready
    assert status is not None
    assert status.notice == "the audio process has ended (SIGKILL): sound is dropped; picture and touch run on"
    report = audio.stop()
    assert report.crashed
    assert report.orders_dropped == 100
    assert report.file == str(file)
    size = file.stat().st_size
    frames = len(read_mix(file))
    assert 0 <= size - 44 - 4 * frames <= 4 * 240, "at most the block being written stands behind the end"
    assert np.abs(read_mix(file)).max() > 0


def test_child_killed_while_starting_is_started_once_more(started):
    audio = started(SessionMemory(), driver="null")
    first = audio.pid
    os.kill(first, signal.SIGKILL)
    status = audio.wait_ready(PATIENCE_S)
    assert (status.sink, status.notice) == ("device", "")
    assert audio.pid != first and gone(first)
    assert not audio.stop().crashed


def test_child_killed_at_each_start_is_noticed_at_once(started):
    audio = started(SessionMemory())
    first = audio.pid
    os.kill(first, signal.SIGKILL)
    assert wait_until(lambda: audio.ready is not None or audio.pid != first)
    os.kill(audio.pid, signal.SIGKILL)
    begin = time.monotonic()
    status = audio.wait_ready(PATIENCE_S)
    assert status.notice == "the audio process has ended (SIGKILL): sound is dropped; picture and touch run on"
    assert time.monotonic() - begin < PATIENCE_S / 2
    assert audio.stop().crashed


@pytest.mark.skipif(not hasattr(resource, "RLIMIT_RTTIME"), reason="limits of real-time work are Linux's")
def test_limit_of_real_time_work_that_a_haptic_loop_left_does_not_end_the_start(started):
    """The limit is the whole process's and its children's: SIGXCPU ends a real-time thread that computes so long."""
    before = resource.getrlimit(resource.RLIMIT_RTTIME)
    resource.setrlimit(resource.RLIMIT_RTTIME, (100_000, before[1]))
    try:
        audio = started(SessionMemory(), mixer="spectral", driver="null")
    finally:
        resource.setrlimit(resource.RLIMIT_RTTIME, before)
    status = audio.wait_ready(PATIENCE_S)
    assert (status.sink, status.mixer, status.notice) == ("device", "spectral", "")
    assert audio.starts == 1
    assert not audio.stop().crashed


def test_stopped_child_blocks_neither_start_nor_play_nor_stop(started):
    audio = started(SessionMemory(), start_timeout_s=0.2, stop_timeout_s=0.3)
    os.kill(audio.pid, signal.SIGSTOP)
    status = audio.wait_ready()
    assert status.notice == "the audio process did not start in time: sound is dropped; picture and touch run on"
    for k in range(5000):  # far more than the pipe holds
        audio.play(SoundEvent("goal", k))
    report = audio.stop()
    assert report.crashed
    assert report.orders_dropped > 0


def test_ctrl_c_is_left_to_the_app(started, capfd):
    audio = started(SessionMemory(), driver="wave")
    first = audio.pid
    for _ in range(10):  # while it starts, too
        os.kill(first, signal.SIGINT)
        time.sleep(0.02)
    audio.wait_ready(PATIENCE_S)
    os.kill(first, signal.SIGINT)
    time.sleep(0.2)
    assert audio.alive and audio.pid == first
    assert capfd.readouterr().err == ""
    assert not audio.stop().crashed


def test_closed_word_ends_the_child(started):
    memory = SessionMemory()
    audio = started(memory, driver="wave")
    audio.wait_ready(PATIENCE_S)
    memory.control[ControlWord.CLOSED] = 1
    assert wait_until(lambda: not audio.alive)
    assert not audio.stop().crashed


def test_ring_overflow_is_counted(tmp_path, started):
    memory = SessionMemory(Capacities(events=16))
    pushed = sum(push(memory, contact(k)) for k in range(40))
    assert pushed == 16
    audio = started(memory, sink="file", file=tmp_path / "a.wav")
    audio.wait_ready(PATIENCE_S)
    report = audio.stop()
    assert report.dropped == 24
    assert report.stale == 16


@pytest.mark.skipif(bool(pulse_missing()), reason=pulse_missing() or "PulseAudio is here")
@pytest.mark.fault(id="F08")
def test_device_that_goes_away_is_replaced_by_the_file(tmp_path, started):
    """The sound server ends in mid-session, as when the last output is unplugged; what was counted is reported."""
    memory = SessionMemory()
    push(memory, np.zeros_like(contact(0)))
    file = tmp_path / "rest.wav"
    with private_pulse_server() as environment:
        audio = started(memory, file=file, driver="pulse", environment=environment)
        assert audio.wait_ready(PATIENCE_S).sink == "device"
        time.sleep(2.2)  # until an idle sink has played the silence that it had ahead
        os.kill(audio.pid, signal.SIGSTOP)
        time.sleep(0.06)
        os.kill(audio.pid, signal.SIGCONT)
        time.sleep(0.1)
        push(memory, contact(time.monotonic_ns()))
        time.sleep(0.1)
    assert wait_until(lambda: audio.ready is not None and audio.ready.sink == "file", 10.0)
    assert audio.ready.notice == f"the audio device is gone: sound is rendered to {file}; picture and touch run on"
    push(memory, contact(time.monotonic_ns()))
    time.sleep(0.1)
    report = audio.stop()
    assert [row.onset_sample >= 0 for row in report.rows] == [True, True]
    assert report.underruns >= 1
    assert np.abs(read_mix(file)).max() > 0


def pactl(environment: dict[str, str], *words: str) -> str:
    done = subprocess.run(
        ["pactl", *words], env={**os.environ, **environment}, capture_output=True, text=True, timeout=60, check=True
    )
    return done.stdout.strip()


@pytest.mark.skipif(bool(pulse_missing()), reason=pulse_missing() or "PulseAudio is here")
@pytest.mark.parametrize("mixer", ["openal", "spectral"])
@pytest.mark.fault(id="F08")
def test_device_that_returns_is_played_on_again(tmp_path, started, mixer):
    """The output is unplugged and plugged in: the rest goes to the file, then to the device, then to a second file."""
    memory = SessionMemory()
    push(memory, np.zeros_like(contact(0)))
    file = tmp_path / "rest.wav"
    with private_pulse_server() as environment:
        audio = started(memory, mixer=mixer, file=file, driver="pulse", environment=environment)
        assert audio.wait_ready(PATIENCE_S).sink == "device"
        audio.master(0.5)
        for name in ("rest.wav", "rest-2.wav"):
            pactl(environment, "unload-module", "module-null-sink")
            assert wait_until(lambda: audio.ready.sink == "file")
            assert audio.ready.notice.endswith(f"sound is rendered to {tmp_path / name}; picture and touch run on")
            push(memory, contact(time.monotonic_ns()))
            time.sleep(0.2)
            pactl(environment, "load-module", "module-null-sink", "sink_name=mimics", "rate=48000", "channels=2")
            assert wait_until(lambda: audio.ready.sink == "device")
            assert audio.ready.notice == ""
            push(memory, contact(time.monotonic_ns()))
            time.sleep(0.2)
        report = audio.stop()
    assert not report.crashed
    assert len(report.rows) == 4
    loudest = [int(np.abs(read_mix(tmp_path / name)).max()) for name in ("rest.wav", "rest-2.wav")]
    assert min(loudest) > 0
    assert max(loudest) < 0.5 * 32767, "as loud as the session set it"


def test_silent_session_starts_no_process():
    audio = AudioProcess(SessionMemory(), AudioSettings(sink="null"))
    audio.start()
    assert audio.pid is None
    audio.play(SoundEvent("goal", 0))
    assert audio.ready is not None and audio.ready.sink == "null"
    assert not audio.stop().crashed


def test_unknown_sound_is_named_with_the_nearest():
    audio = AudioProcess(SessionMemory(), AudioSettings(sink="null"))
    with pytest.raises(MimicsError, match=r'no sound "gaol".*did you mean "goal"'):
        audio.play(SoundEvent("gaol", 0))


def test_device_that_draws_in_real_time_reports_its_buffers(started):
    """The library's own null device: a live one with nobody listening."""
    memory = SessionMemory()
    push(memory, np.zeros_like(contact(0)))
    audio = started(memory, driver="null")
    status = audio.wait_ready(PATIENCE_S)
    assert (status.sink, status.hrtf) == ("device", True)
    assert 0.0 < status.latency_ms <= 20.0
    for k in range(3):
        time.sleep(0.06)
        push(memory, contact(time.monotonic_ns(), speed=0.1 + k))
    time.sleep(0.05)
    report = audio.stop()
    assert [row.cause for row in report.rows] == ["contact"] * 3
    assert all(row.t_ns < row.submitted_ns < row.output_ns for row in report.rows)
    assert all(row.onset_sample == -1 for row in report.rows)
