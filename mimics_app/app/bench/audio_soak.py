"""`mimics bench audio --soak`: the audio process beside the load of `bench realtime`, for a requested time.

The load is a whole session in a process of its own, with its haptic loop, frames as fast as they can be drawn, and 8 ms
of Python per frame. The spectral mixer plays to the null sink of a private PulseAudio server, which takes blocks in
real time as a sound card does; without PulseAudio to OpenAL's null device. As a session does, it takes the length of
the queue that earlier ones needed on this machine, and keeps what it needed itself.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.app.bench.stall_witness import StallWitness, explain_gaps
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SCENE, fill_defaults
from mimics_app.lab.audio.live_latency import private_pulse_server, pulse_missing
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.queue_need import keep_needed_ms, known_needed_ms
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mimics_app.contracts.ports.audio_port import AudioReport

__all__ = ["measure_soak"]

_VOICES = 64
_FRAME_NS = 16_666_667
_START_S = 60.0
"""Time-out of the start of the audio process [s]."""
_SPARE_S = 120.0
"""Time-out of the load beyond its length [s]."""

Row = dict[str, Any]


def measure_soak(scene: Path, seconds: float, *, load: bool = True) -> dict[str, Any]:
    """Measure the number of blocks mixed and missed, and the cost of a block.

    Args:
        scene: Scene of the load.
        seconds: Length of the measurement [s].
        load: False: without the load.

    Returns:
        `seconds, voices, block_ms, turns`; `block_us` with p50, p99 and max of the work of a turn in which blocks were
        mixed, and their `count`; `missed`, the number of blocks that the device requested too early, each an audible
        gap; `queue`, its length over time and the latency it gives (contracts/ports/audio_port.py: AudioReport);
        `late_turns`, turns that began more than half a millisecond late, which the queue compensates; `device`;
        `stalls`, the gaps held against the stalls of the machine (stall_witness.py: explain_gaps), absent where
        real-time priority is refused; `loop`, the row of the load's haptic loop. OpenAL's null device takes several
        blocks at once after a delay of its own thread, which counts as missed too.

    Raises:
        DeviceError: There is no OpenAL library, the server did not start, or the audio process ended early.
    """
    empty: Mapping[str, str] = {}
    witness = StallWitness()
    try:
        with nullcontext(empty) if pulse_missing() else private_pulse_server() as environment:
            report, loop = _play(scene, seconds, environment, load=load)
    finally:
        stalls = witness.stop()
    if report.crashed:
        raise DeviceError("the audio process ended on its own")
    row = {
        "seconds": seconds,
        "voices": _VOICES,
        "block_ms": LIVE_BLOCK / report.status.rate * 1e3,
        "turns": report.blocks,
        "block_us": dict(report.block_us),
        "missed": report.underruns,
        "queue": dict(report.queue),
        "late_turns": report.late_blocks,
        "device": report.status.device,
        "load": str(scene) if load else "none",
        "loop": loop,
    }
    if stalls is not None:
        row["stalls"] = explain_gaps(stalls, report.queue.get("empty", ()), seconds)
    return row


def _play(scene: Path, seconds: float, environment: Mapping[str, str], *, load: bool) -> tuple[AudioReport, Row]:
    """Play moving voices; return the report of the audio process and the row of the load's haptic loop.

    Args:
        scene: Scene of the load.
        seconds: Length [s].
        environment: Environment variables of a PulseAudio server; {}: OpenAL's null device.
        load: Whether the load runs.
    """
    names = [f"hum_{k}" for k in range(_VOICES)]
    sounds = {name: SoundSpec(recipe="scrape", gain=0.02, loop=True) for name in names}
    settings = AudioSettings(
        sounds=sounds,
        triggers={},
        scrape="",
        emitters=tuple(names),
        mixer="spectral",
        voices=_VOICES,
        driver="pulse" if environment else "null",
        queue_ms=known_needed_ms(),
        environment=dict(environment),
    )
    memory, clock = SessionMemory(), MonotonicClock()
    audio = AudioProcess(memory, settings)
    audio.start()
    loop: Row = {}
    try:
        status = audio.wait_ready(_START_S)
        if status.sink != "device":
            raise DeviceError(f"nothing to play on: {status.notice}")
        child = _begin_load(scene, seconds) if load else None
        _move_voices(memory, clock, seconds)
        if child is not None:
            loop = json.loads(child.communicate(timeout=seconds + _SPARE_S)[0] or "{}")
    finally:
        report = audio.stop()
    keep_needed_ms(report.queue)
    return report, loop


def _begin_load(scene: Path, seconds: float) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "mimics_app.app.bench.realtime_load", "product", str(scene), str(seconds)]
    return subprocess.Popen(command, stdout=subprocess.PIPE)


def _move_voices(memory: SessionMemory, clock: Clock, seconds: float) -> None:
    """Move all voices in circles around the head, frame by frame as the main thread of a session."""
    now = np.zeros(1, SOUND_SCENE)
    fill_defaults(now)
    angle = np.arange(_VOICES) * (2.0 * math.pi / _VOICES)
    now["gain"][0, :_VOICES] = 1.0
    end, due = clock.now_ns() + round(seconds * 1e9), clock.now_ns()
    while due < end:
        due += _FRAME_NS
        clock.sleep_until_ns(due)
        angle += 0.5 * _FRAME_NS * 1e-9
        now["t_ns"] = clock.now_ns()
        now["position"][0, :_VOICES] = 2.0 * np.stack((np.sin(angle), np.zeros(_VOICES), -np.cos(angle)), axis=1)
        slot = triple_buffer.back_slot(memory.sound_scene_words)
        memory.sound_scenes[slot : slot + 1] = now
        triple_buffer.publish(memory.sound_scene_words)
