"""Latency from contact to sound, measured on a live device that can be recorded: a private PulseAudio server.

A null sink plays nothing but has a monitor, which delivers what loudspeakers would have received. The figure excludes
the converter of a real sound card (about one period) and wireless headphones (100-300 ms).

The time of a sample is that of the device's clock, not of its arrival: on a busy machine samples arrive late and in
bursts, but their frames are still 1/48000 s apart. See `handed_out_ns`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F4, I8
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.ports.audio_port import AudioReport, percentiles_ms
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.queue_length import SETTLING_S
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.worker import FIFO_PRIORITY, ask_for_fifo

__all__ = ["Monitor", "handed_out_ns", "match_onsets", "measure_live_latency", "private_pulse_server", "pulse_missing"]


_RATE = 48_000
_SAMPLE_BYTES = 4
_SINK = "mimics"
_STEREO = ("front-left", "front-right")
_THRESHOLD = 0.02
_QUIET_FRAMES = 1500
_SETTLING_NS = 2_500_000_000  # the monitor's stream drops sound at first; the player's does not
_OPENING_NS = round((SETTLING_S + 0.7) * 1e9)
"""Time until the stream has stabilised, and the queue ahead of it is as short as the machine allows [ns]."""

_PAUSE_NS = (200_000_000, 240_000_000)
"""Shortest and longest time between two contacts [ns]. A contact read later than 100 ms is not played, so the onsets
of two played contacts are at least 100 ms apart however late the mixer is."""

_LONGEST_NS = _PAUSE_NS[0]
"""Time after a contact within which the first onset is taken as its sound [ns]."""

_CALM_NS = 2_000_000_000
"""Chunks that arrive within this time of a frame bound its time [ns]; the sink's clock drifts by 0.3 ms/s at most."""

_START_TIMEOUT_NS = 10_000_000_000

_BLOW_N = tuple(12.0 * np.sin(np.pi * np.arange(1, 9) / 8.0))
"""Force of a tap in each tick [N]: a half sine of 12 N and 8 ms."""

_STRUCK_BODY = 1
"""Id of the tapped body in events; its sound is force-driven."""


def pulse_missing() -> str:
    """Return why the measurement cannot be made here, "" when it can."""
    missing = [name for name in ("pulseaudio", "parec") if shutil.which(name) is None]
    return f"no {' and '.join(missing)}: apt-get install pulseaudio pulseaudio-utils" if missing else ""


def measure_live_latency(
    seconds: float = 10.0, period: int = 64, seed: int = 1, mixer: str = "openal"
) -> dict[str, Any]:
    """Push contacts into a session's ring as the haptic loop does, and record them at the monitor of a null sink.

    Every second contact plays a recording; the others are taps with a force-driven sound (`modal.py`).

    Args:
        seconds: Length of the measurement, about four contacts a second.
        period: Frames per period of the device, see AudioSettings.
        seed: Seed of the random contact times.
        mixer: Mixer that plays.

    Returns:
        `events` pushed, `played` by the mixer, `heard` at the monitor, `stale` (read too late to be played);
        `latency_ms` of recordings and `struck_ms` of taps, each with p50, p95 and max from the time of the tick to the
        sample at the monitor, absent where nothing was heard; `struck`, taps whose sound was force-driven;
        `modelled_ms`, latency of all as the session's report computes it; `bound_ms`, its upper bound at the end, from
        the lengths of all buffers; and `device, sink, hrtf, rate, period`.

    Raises:
        DeviceError: PulseAudio is not installed, or its server or our device did not come up.
    """
    why = pulse_missing()
    if why:
        raise DeviceError(why)
    with private_pulse_server() as environment, Monitor(environment) as recorder:
        pushed, report = _play_contacts(environment, seconds, period, seed, mixer)
    onsets, status = recorder.onsets(), report.status
    recorded, struck = match_onsets(pushed[::2], onsets), match_onsets(pushed[1::2], onsets)
    figures = {
        "latency_ms": percentiles_ms(recorded),
        "struck_ms": percentiles_ms(struck),
        "modelled_ms": dict(report.latency_ms()),
    }
    return {
        "events": len(pushed),
        "played": len(report.rows),
        "struck": sum(":live:" in row.sound for row in report.rows),
        "heard": len(recorded) + len(struck),
        "stale": report.stale,
        **{name: _rounded(values) for name, values in figures.items() if values["p50"] is not None},
        "bound_ms": round(report.queue.get("latency_ms", status.latency_ms), 2),
        "mixer": status.mixer,
        "device": status.device,
        "sink": status.sink,
        "hrtf": status.hrtf,
        "rate": status.rate,
        "period": period,
    }


def _rounded(values: Mapping[str, float | None]) -> dict[str, float]:
    return {name: round(value, 2) for name, value in values.items() if value is not None}


@contextmanager
def private_pulse_server(rate: int = _RATE, positions: Sequence[str] = _STEREO) -> Iterator[dict[str, str]]:
    """Run a private PulseAudio server with one null sink; yield the environment variables of its clients.

    Args:
        rate: Frames per second of the sink.
        positions: PulseAudio's names of the positions of its channels.

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
                f"--load=module-null-sink sink_name={_SINK} rate={rate} {_layout(positions)}",
                f"--load=module-native-protocol-unix socket={socket} auth-anonymous=1",
            ],
            env={**os.environ, **homes},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            _wait_for(socket, server)
            _prefer(server)  # after it has set its own niceness
            yield environment
        finally:
            server.terminate()
            try:
                server.wait(3.0)
            except subprocess.TimeoutExpired:
                server.kill()
                server.wait()


def _prefer(process: subprocess.Popen[bytes]) -> None:
    """Give a process real-time priority where the system allows it: it stands for a sound card, which no load delays.

    A server that is delayed by more than two periods drops what it missed. PulseAudio gives real-time priority to its
    sinks, but not to the thread that receives the sound of its clients.
    """
    ask_for_fifo(process.pid, FIFO_PRIORITY + 1)


def _wait_for(socket: Path, server: subprocess.Popen[bytes]) -> None:
    clock = MonotonicClock()
    deadline = clock.now_ns() + _START_TIMEOUT_NS
    while not socket.exists():
        if server.poll() is not None or clock.now_ns() > deadline:
            raise DeviceError("the private PulseAudio server did not start")
        clock.sleep_until_ns(clock.now_ns() + 20_000_000)


def _layout(positions: Sequence[str]) -> str:
    """Return the arguments of a module for these channels."""
    return f"channels={len(positions)} channel_map={','.join(positions)}"


class Monitor:
    """Records the monitor of a private server; each chunk of samples is kept with its time of arrival.

    Args:
        environment: Environment variables of the server's clients.
        rate: Frames per second of the sink.
        positions: PulseAudio's names of the positions of its channels.
    """

    def __init__(self, environment: Mapping[str, str], rate: int = _RATE, positions: Sequence[str] = _STEREO) -> None:
        self._environment, self._rate, self._positions = environment, rate, positions
        self._chunks: list[tuple[int, bytes]] = []

    def __enter__(self) -> Monitor:
        layout = (f"--channels={len(self._positions)}", f"--channel-map={','.join(self._positions)}")
        command = ["parec", "-d", f"{_SINK}.monitor", "--raw", "--format=float32le", f"--rate={self._rate}", *layout]
        self._process = subprocess.Popen(
            [*command, "--latency-msec=1"],
            env={**os.environ, **self._environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        _prefer(self._process)
        self._thread = threading.Thread(target=self._read, name="monitor", daemon=True)
        self._thread.start()
        clock = MonotonicClock()
        clock.sleep_until_ns(clock.now_ns() + _SETTLING_NS)
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

    def frames(self) -> F4:
        """Return the recording so far, shape [n, channels]."""
        raw, channels = b"".join(chunk for _, chunk in self._chunks), len(self._positions)
        return np.frombuffer(raw[: len(raw) // self._frame_bytes * self._frame_bytes], np.float32).reshape(-1, channels)

    @property
    def _frame_bytes(self) -> int:
        return _SAMPLE_BYTES * len(self._positions)

    def onsets(self) -> list[int]:
        """Return the times of the first samples after silence [ns], by the device's clock."""
        frames = self.frames()
        loud = np.flatnonzero(np.abs(frames).max(axis=1) > _THRESHOLD) if len(frames) else np.zeros(0, np.int64)
        first = loud[np.flatnonzero(np.diff(loud, prepend=-_QUIET_FRAMES - 1) > _QUIET_FRAMES)]
        ends = np.cumsum([len(chunk) for _, chunk in self._chunks]) // self._frame_bytes
        arrivals = np.array([t for t, _ in self._chunks], np.int64)
        return handed_out_ns(first, np.asarray(ends, np.int64), arrivals).tolist()


def handed_out_ns(frames: I8, ends: I8, arrivals_ns: I8) -> I8:
    """Return when a device with a steady clock delivered frames of a recording, however late the chunks arrived.

    A chunk cannot arrive before its last frame was delivered, and earlier frames were due correspondingly earlier: each
    chunk from a frame's own on bounds the frame's time from above, and the least delayed one gives the time.

    Args:
        frames: Indices of the frames, shape [n].
        ends: Number of frames recorded by the end of each chunk, ascending, shape [chunks].
        arrivals_ns: Time of arrival of each chunk [ns], ascending, shape [chunks].

    Returns:
        Times [ns], shape [n].
    """
    starts = arrivals_ns - ends * 1_000_000_000 // _RATE  # bound on the time of frame 0 by each chunk
    own = np.searchsorted(ends, frames, side="right")
    last = np.searchsorted(arrivals_ns, arrivals_ns[own] + _CALM_NS, side="right")
    calm = np.array([starts[i:j].min() for i, j in zip(own, last, strict=True)], np.int64)
    return calm + frames * 1_000_000_000 // _RATE


def _play_contacts(
    environment: dict[str, str], seconds: float, period: int, seed: int, mixer: str
) -> tuple[list[int], AudioReport]:
    clock = MonotonicClock()
    memory = SessionMemory()
    settings = AudioSettings(
        sounds={"contact": SoundSpec(recipe="tick"), "tap": SoundSpec(recipe="tap")},
        triggers={"contact": "contact", "contact/object": "tap"},
        materials=("", "object"),
        body_materials=(1,),
        scrape="",
        mixer=mixer,
        period=period,
        driver="pulse",
        environment=environment,
    )
    audio = AudioProcess(memory, settings)
    audio.start()
    try:
        status = audio.wait_ready(60.0)
        if status.sink != "device":
            raise DeviceError(f"no live device on the private PulseAudio server: {status.notice}")
        clock.sleep_until_ns(clock.now_ns() + _OPENING_NS)
        pushed = _push_contacts(memory, clock, seconds, np.random.default_rng(seed))
        clock.sleep_until_ns(clock.now_ns() + 300_000_000)
    finally:
        report = audio.stop()
    return pushed, report


def _push_contacts(
    memory: SessionMemory, clock: MonotonicClock, seconds: float, random: np.random.Generator
) -> list[int]:
    """Push contacts for some seconds, alternately with a recording and a tap; return their times [ns]."""
    pushed: list[int] = []
    end = clock.now_ns() + round(seconds * 1e9)
    event, force = np.zeros(1, EVENT), np.zeros(1, CONTACT_FORCE)
    ring.push(memory.audio_event_words, memory.audio_events, event)  # a record of no kind: compiles the call
    ring.push(memory.audio_force_words, memory.audio_forces, force)  # likewise
    event["kind"], event["speed"], event["position_world"] = EventKind.CONTACT_BEGIN, 0.6, (0.0, 0.0, -1.0)
    while clock.now_ns() < end:
        clock.sleep_until_ns(clock.now_ns() + int(random.integers(*_PAUSE_NS)))
        taps = len(pushed) % 2 == 1
        event["body_b"], event["force"] = (_STRUCK_BODY, _BLOW_N[0]) if taps else (-1, 10.0)
        event["tick"], event["t_ns"] = len(pushed), clock.now_ns()
        ring.push(memory.audio_event_words, memory.audio_events, event)
        pushed.append(int(event["t_ns"][0]))
        if taps:
            _push_forces(memory, clock, pushed[-1])
    return pushed


def _push_forces(memory: SessionMemory, clock: MonotonicClock, begin_ns: int) -> None:
    """Push the remaining forces of a tap, one per tick."""
    row = np.zeros(1, CONTACT_FORCE)
    row["body_a"], row["body_b"] = 0, _STRUCK_BODY
    for tick, newton in enumerate(_BLOW_N[1:], 1):
        clock.sleep_until_ns(begin_ns + tick * 1_000_000)
        row["t_ns"], row["force"] = begin_ns + tick * 1_000_000, newton
        ring.push(memory.audio_force_words, memory.audio_forces, row)


def match_onsets(pushed: Sequence[int], onsets: Sequence[int]) -> list[float]:
    """Return the latency [ms] of every event that was heard, ascending, by the first onset within `_LONGEST_NS` of it.

    Args:
        pushed: Times of the events [ns], ascending, more than `_LONGEST_NS` apart.
        onsets: Times of the sounds [ns], ascending.
    """
    recorded = np.asarray(onsets, np.int64)
    latencies = []
    for t in pushed:
        k = int(np.searchsorted(recorded, t))
        if k < len(recorded) and recorded[k] < t + _LONGEST_NS:
            latencies.append((int(recorded[k]) - t) * 1e-6)
    return sorted(latencies)
