"""How long from a touch to its sound, measured on a live device that can be listened to: a private PulseAudio server.

A null sink plays nothing but has a monitor; what the monitor hands out is what loudspeakers would have been given. Not
in the figure: the converter behind a real sound card (about a period more) and wireless headphones (100-300 ms).
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts import ring
from mimics_app.contracts.audio_port import AudioReport
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.haptic import EVENT, EventKind
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

__all__ = ["measure_live_latency", "private_pulse_server", "pulse_missing"]

_RATE = 48_000
_FRAME_BYTES = 8
_SINK = "mimics"
_THRESHOLD = 0.02
_QUIET_FRAMES = 1500
_SETTLE_NS = 2_500_000_000  # a young recording loses stretches of sound; the player's stream does not
_LONGEST_NS = 200_000_000
_START_TIMEOUT_NS = 10_000_000_000


def pulse_missing() -> str:
    """Why the measurement cannot be made here, "" when it can."""
    missing = [name for name in ("pulseaudio", "parec") if shutil.which(name) is None]
    return f"no {' and '.join(missing)}: apt-get install pulseaudio pulseaudio-utils" if missing else ""


def measure_live_latency(seconds: float = 10.0, period: int = 128, seed: int = 1) -> dict[str, Any]:
    """Contacts pushed into a session's ring as the haptic loop does, heard at the monitor of a null sink.

    Args:
        seconds: Length of the measurement, about nine contacts a second.
        period: Frames per period of the device, see AudioSettings.
        seed: Of the random times of the contacts.

    Returns:
        `events` pushed, `played` by the mixer, `heard` at the monitor, `stale` ones that were read too late to be
        played; `p50_ms`, `p95_ms`, `max_ms` from the tick's time to the sample at the monitor; `modelled_p95_ms` as
        the session's report has it; and `device, sink, hrtf, rate, period`.

    Raises:
        DeviceError: PulseAudio is not installed, or its server or our device did not come up.
    """
    why = pulse_missing()
    if why:
        raise DeviceError(why)
    with private_pulse_server() as environment, _Recorder(environment) as recorder:
        pushed, report = _play_contacts(environment, seconds, period, seed)
    latencies = _match(pushed, recorder.onsets()) if pushed else []
    modelled = report.latency_ms()["p95"]
    return {
        "events": len(pushed),
        "played": len(report.rows),
        "heard": len(latencies),
        "stale": report.stale,
        **{f"{name}_ms": _rank(latencies, share) for name, share in (("p50", 0.5), ("p95", 0.95), ("max", 1.0))},
        "modelled_p95_ms": None if modelled is None else round(modelled, 2),
        "device": report.status.device,
        "sink": report.status.sink,
        "hrtf": report.status.hrtf,
        "rate": report.status.rate,
        "period": period,
    }


@contextmanager
def private_pulse_server() -> Iterator[dict[str, str]]:
    """A PulseAudio server of our own with one null sink; yields the environment that leads a client to it.

    Raises:
        DeviceError: The server did not come up within 10 s.
    """
    with tempfile.TemporaryDirectory(prefix="mimics-pulse-", ignore_cleanup_errors=True) as folder:
        socket = Path(folder) / "native"
        homes = dict.fromkeys(("XDG_RUNTIME_DIR", "PULSE_RUNTIME_PATH", "PULSE_STATE_PATH", "XDG_CONFIG_HOME"), folder)
        environment = {**homes, "PULSE_SERVER": f"unix:{socket}"}
        server = subprocess.Popen(
            [
                "pulseaudio",
                "-n",
                "--daemonize=no",
                "--use-pid-file=no",
                "--exit-idle-time=-1",
                f"--load=module-null-sink sink_name={_SINK} rate={_RATE} channels=2",
                f"--load=module-native-protocol-unix socket={socket} auth-anonymous=1",
            ],
            env={**os.environ, **homes},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            _wait_for(socket, server)
            yield environment
        finally:
            server.terminate()
            try:
                server.wait(3.0)
            except subprocess.TimeoutExpired:
                server.kill()
                server.wait()


def _wait_for(socket: Path, server: subprocess.Popen[bytes]) -> None:
    clock = MonotonicClock()
    deadline = clock.now_ns() + _START_TIMEOUT_NS
    while not socket.exists():
        if server.poll() is not None or clock.now_ns() > deadline:
            raise DeviceError("the private PulseAudio server did not start")
        clock.sleep_until_ns(clock.now_ns() + 20_000_000)


class _Recorder:
    """Listens to the monitor; each chunk of samples is kept with the time it arrived."""

    def __init__(self, environment: dict[str, str]) -> None:
        self._environment = environment
        self._chunks: list[tuple[int, bytes]] = []

    def __enter__(self) -> _Recorder:
        command = ["parec", "-d", f"{_SINK}.monitor", "--raw", "--format=float32le", f"--rate={_RATE}", "--channels=2"]
        self._process = subprocess.Popen(
            [*command, "--latency-msec=1"],
            env={**os.environ, **self._environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        self._thread = threading.Thread(target=self._read, name="monitor", daemon=True)
        self._thread.start()
        clock = MonotonicClock()
        clock.sleep_until_ns(clock.now_ns() + _SETTLE_NS)
        return self

    def __exit__(self, *exception: object) -> None:
        self._process.terminate()
        self._process.wait()
        self._thread.join(2.0)

    def _read(self) -> None:
        clock = MonotonicClock()
        assert self._process.stdout is not None
        pipe = self._process.stdout.fileno()
        while chunk := os.read(pipe, 65536):
            self._chunks.append((clock.now_ns(), chunk))

    def onsets(self) -> list[int]:
        """Times at which the first samples after a quiet stretch were handed out [ns]."""
        raw = b"".join(chunk for _, chunk in self._chunks)
        frames = np.frombuffer(raw[: len(raw) // _FRAME_BYTES * _FRAME_BYTES], np.float32).reshape(-1, 2)
        loud = np.flatnonzero(np.abs(frames).max(axis=1) > _THRESHOLD) if len(frames) else np.zeros(0, np.int64)
        first = loud[np.flatnonzero(np.diff(loud, prepend=-_QUIET_FRAMES - 1) > _QUIET_FRAMES)]
        ends = np.cumsum([len(chunk) for _, chunk in self._chunks]) // _FRAME_BYTES
        arrivals = [t for t, _ in self._chunks]
        return [self._handed_out(int(frame), ends, arrivals) for frame in first]

    @staticmethod
    def _handed_out(frame: int, ends: NDArray[np.int64], arrivals: list[int]) -> int:
        """A chunk arrives with its last frame; an earlier frame of it was due that much earlier."""
        chunk = int(np.searchsorted(ends, frame, side="right"))
        return arrivals[chunk] - (int(ends[chunk]) - frame) * 1_000_000_000 // _RATE


def _play_contacts(
    environment: dict[str, str], seconds: float, period: int, seed: int
) -> tuple[list[int], AudioReport]:
    clock = MonotonicClock()
    memory = SessionMemory()
    sounds = {"contact": SoundSpec(recipe="tick")}
    audio = AudioProcess(
        memory, AudioSettings(sounds=sounds, scrape="", period=period, driver="pulse", environment=environment)
    )
    audio.start()
    try:
        status = audio.wait_ready(30.0)
        if status.sink != "device":
            raise DeviceError(f"no live device on the private PulseAudio server: {status.notice}")
        clock.sleep_until_ns(clock.now_ns() + 700_000_000)  # the stream's buffers settle
        pushed = _push_contacts(memory, clock, seconds, np.random.default_rng(seed))
        clock.sleep_until_ns(clock.now_ns() + 300_000_000)
    finally:
        report = audio.stop()
    return pushed, report


def _push_contacts(
    memory: SessionMemory, clock: MonotonicClock, seconds: float, random: np.random.Generator
) -> list[int]:
    pushed: list[int] = []
    end = clock.now_ns() + round(seconds * 1e9)
    event = np.zeros(1, EVENT)
    ring.push(memory.audio_event_words, memory.audio_events, event)  # of no kind: compiles the call
    event["kind"], event["body_b"], event["speed"], event["force"] = EventKind.CONTACT_BEGIN, -1, 0.6, 10.0
    event["position_world"] = (0.0, 0.0, -1.0)
    while clock.now_ns() < end:
        clock.sleep_until_ns(clock.now_ns() + int(random.integers(90_000_000, 130_000_000)))
        event["tick"], event["t_ns"] = len(pushed), clock.now_ns()
        ring.push(memory.audio_event_words, memory.audio_events, event)
        pushed.append(int(event["t_ns"][0]))
    return pushed


def _match(pushed: list[int], onsets: list[int]) -> list[float]:
    """Latency [ms] of every event that was heard: the first onset after it, before the next event's turn."""
    latencies = []
    heard = np.asarray(onsets, np.int64)
    for t, following in zip(pushed, [*pushed[1:], pushed[-1] + _LONGEST_NS], strict=True):
        k = int(np.searchsorted(heard, t))
        if k < len(heard) and heard[k] < following:
            latencies.append((int(heard[k]) - t) * 1e-6)
    return sorted(latencies)


def _rank(ordered: list[float], share: float) -> float | None:
    """Nearest-rank percentile, None where nothing was heard."""
    if not ordered:
        return None
    return round(ordered[max(0, int(np.ceil(share * len(ordered))) - 1)], 2)
