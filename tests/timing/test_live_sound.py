"""From the tick of a contact to its sample at the monitor of a live sound server."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SCENE, fill_defaults
from mimics_app.lab.audio.live_latency import (
    Monitor,
    handed_out_ns,
    match_onsets,
    measure_live_latency,
    private_pulse_server,
    pulse_missing,
)
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.pulse_stream import PulseStream
from mimics_app.rendering.audio.queue_length import SETTLING_S
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

needs_pulse = pytest.mark.skipif(bool(pulse_missing()), reason=pulse_missing() or "PulseAudio is here")

MS = 1_000_000
ROUNDS = 8
LEAST = 10
CHUNK = 48  # frames: one millisecond
BOUND_MS = 20.0


def measure_heard(seconds: float, period: int = 64, mixer: str = "openal") -> dict[str, Any]:
    """A measurement in which every contact was heard.

    What the machine held back for 100 ms is not played, on purpose, and counted; such a round is measured again. So is
    one in which a stall of the whole machine cut a sound short, which no precedence among processes prevents: a mixer
    that loses sounds on its own does so in every round.
    """
    result: dict[str, Any] = {}
    for seed in range(ROUNDS):
        try:
            result = measure_live_latency(seconds, period, seed, mixer)
        except DeviceError as error:  # a private server that a busy machine kept from opening in time
            result = {"error": str(error)}
            continue
        heard = result["heard"] == result["played"] == result["events"] - result["stale"]
        if heard and result["events"] >= LEAST and result["stale"] == 0:
            return result
    pytest.fail(f"this machine was too busy for sound in each of {ROUNDS} rounds: {result}")


@needs_pulse
@pytest.mark.parametrize("mixer", ["openal", "spectral"])
def test_every_contact_is_heard_on_a_live_sound_server(mixer):
    """Recordings and what the force of a tap plays; how late the machine let each be is the slow test's to measure."""
    result = measure_heard(4.0, mixer=mixer)
    assert (result["sink"], result["hrtf"], result["rate"], result["mixer"]) == ("device", True, 48_000, mixer)
    assert result["struck"] == result["events"] // 2, "every second one is a tap, and sounds by its force"
    assert 0.0 < result["bound_ms"] <= BOUND_MS
    for kind in ("latency_ms", "struck_ms"):
        assert 0.0 < result[kind]["p50"] <= result[kind]["p95"] <= result[kind]["max"]


@needs_pulse
@pytest.mark.slow
@pytest.mark.parametrize("mixer", ["openal", "spectral"])
@pytest.mark.parametrize("period", [64, 128])
def test_contact_to_sample_stays_below_20_ms(period, mixer):
    """The bound of D2.1 6.3; the best of three, as other work on the machine is not the mixer's."""
    results = [measure_heard(15.0, period, mixer) for _ in range(3)]
    worst = [max(result[kind]["p95"] for kind in ("latency_ms", "struck_ms")) for result in results]
    assert min(worst) <= BOUND_MS, results


TONE_HZ = 440.0


def breaks(heard: np.ndarray) -> int:
    """How often a tone stops or jumps: a sine is 2 cos(w) times its last sample less the one before, a break is not."""
    loud = np.flatnonzero(np.abs(heard) > 1e-3)
    steady = heard[loud[0] + 4800 : loud[-1] - 4800].astype(float)  # without its beginning and its end
    assert len(steady) >= 48_000, "a second of it was heard"
    left = steady[2:] - 2.0 * np.cos(2.0 * np.pi * TONE_HZ / 48_000) * steady[1:-1] + steady[:-2]
    return int((np.diff(np.flatnonzero(np.abs(left) > 0.02 * np.abs(steady).max()), prepend=-1000) > 200).sum())


def test_a_tone_without_a_few_of_its_samples_is_broken():
    tone = np.sin(2.0 * np.pi * TONE_HZ * np.arange(96_000) / 48_000)
    assert breaks(tone) == 0
    tone[40_000:40_003] = 0.0
    assert breaks(tone) == 1


def play_tone(file: Path, mixer: str, seconds: float) -> np.ndarray:
    """A steady tone as loudspeakers would have been given it, shape [frames]."""
    soundfile.write(file, 0.5 * np.sin(2.0 * np.pi * TONE_HZ * np.arange(48_000) / 48_000), 48_000, subtype="FLOAT")
    memory, clock = SessionMemory(), MonotonicClock()
    with private_pulse_server() as environment, Monitor(environment) as monitor:
        tone = SoundSpec(file=file, loop=True)
        settings = AudioSettings(
            sounds={"tone": tone}, triggers={}, scrape="", emitters=("tone",), mixer=mixer, driver="pulse",
            environment=environment,
        )  # fmt: skip
        audio = AudioProcess(memory, settings)
        audio.start()
        assert audio.wait_ready(60.0).sink == "device"
        now, end = np.zeros(1, SOUND_SCENE), clock.now_ns() + round(seconds * 1e9)
        fill_defaults(now)
        now["gain"][0, 0], now["position"][0, 0] = 1.0, (0.0, 0.0, -1.0)
        while clock.now_ns() < end:
            now["t_ns"] = clock.now_ns()
            slot = triple_buffer.back_slot(memory.sound_scene_words)
            memory.sound_scenes[slot : slot + 1] = now
            triple_buffer.publish(memory.sound_scene_words)
            clock.sleep_until_ns(clock.now_ns() + 16 * MS)
        assert not audio.stop().crashed
        return monitor.frames()[:, 0]


@needs_pulse
@pytest.mark.parametrize("mixer", ["openal", "spectral"])
def test_a_steady_tone_has_no_gaps(mixer, tmp_path):
    """With two periods queued a device, or two short blocks a stream, it had some in every second of a busy machine."""
    found = []
    for _ in range(ROUNDS):
        found.append(breaks(play_tone(tmp_path / "tone.wav", mixer, 3.0)))
        if found[-1] == 0:
            return
    pytest.fail(f"breaks in each of {ROUNDS} rounds: {found}")


def stop_and_go(mixer: str) -> AudioReport:
    """Stop the process of sound for 60 ms, let it go on, and strike once."""
    memory, clock = SessionMemory(), MonotonicClock()
    event = np.zeros(1, EVENT)
    ring.push(memory.audio_event_words, memory.audio_events, event)  # compiles the call
    event["kind"], event["speed"], event["force"], event["body_b"] = EventKind.CONTACT_BEGIN, 0.6, 10.0, -1
    with private_pulse_server() as environment, Monitor(environment):  # which keeps the sink from idling
        settings = AudioSettings(
            sounds={"contact": SoundSpec(recipe="tick")}, triggers={"contact": "contact"}, scrape="", mixer=mixer,
            driver="pulse", environment=environment,
        )  # fmt: skip
        audio = AudioProcess(memory, settings)
        audio.start()
        assert audio.wait_ready(60.0).sink == "device"
        clock.sleep_until_ns(clock.now_ns() + round((SETTLING_S + 0.5) * 1e9))
        os.kill(audio.pid, signal.SIGSTOP)
        clock.sleep_until_ns(clock.now_ns() + 60 * MS)
        os.kill(audio.pid, signal.SIGCONT)
        clock.sleep_until_ns(clock.now_ns() + 300 * MS)
        event["t_ns"] = clock.now_ns()
        ring.push(memory.audio_event_words, memory.audio_events, event)
        clock.sleep_until_ns(clock.now_ns() + 200 * MS)
        return audio.stop()


@needs_pulse
@pytest.mark.parametrize("mixer", ["openal", "spectral"])
def test_a_process_that_was_stopped_counts_the_silence_and_queues_more(mixer):
    """The contact after it is heard at the new latency, which keeps the bound.

    Of a sound server that the machine kept from working at the same time the silence is shorter: measured again.
    """
    for _ in range(ROUNDS):
        report = stop_and_go(mixer)
        assert not report.crashed and report.underruns >= 1
        if report.queue["least_left_ms"] < -30.0:
            break
    assert report.queue["least_left_ms"] < -30.0
    assert 18.0 < report.queue["latency_ms"] <= BOUND_MS
    assert report.queue["ms"] == report.queue["longest_ms"], "whatever it had become in the calm before"
    assert len(report.rows) == 1 and report.queue["ms"] < report.rows[0].latency_ms


@needs_pulse
def test_silence_that_an_idle_device_has_played_ahead_is_no_delay_of_it(monkeypatch):
    """Two seconds when the sink becomes idle; about half a second of them is left at the second opening."""
    clock = MonotonicClock()
    with private_pulse_server() as environment:
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        PulseStream(48_000, 64, clock).close()
        clock.sleep_until_ns(clock.now_ns() + 1400 * MS)
        stream = PulseStream(48_000, 64, clock)
        begun = clock.now_ns()
        stream.write(np.zeros((960, 2), np.float32))
        while stream.left() > 900:
            clock.sleep_until_ns(clock.now_ns() + MS)
        stream.left()
        stream.close()
    assert clock.now_ns() - begun > 50 * MS, "there was some"
    assert stream.behind == 128


def recording(late_ms: dict[int, int], chunks: int = 1000) -> tuple[np.ndarray, np.ndarray]:
    """Ends and arrivals [ns] of chunks of a millisecond, in order; some of them held up, and what follows with them."""
    ends = CHUNK * np.arange(1, chunks + 1)
    arrivals = ends * 1_000_000_000 // 48_000
    for chunk, late in late_ms.items():
        arrivals[chunk] += late * MS
    return ends, np.maximum.accumulate(arrivals)


def test_a_listener_that_is_held_up_dates_every_frame_all_the_same():
    """Half a second behind, for half a second: the frames were handed out in time."""
    frames = np.array([10 * CHUNK, 200 * CHUNK, 440 * CHUNK, 900 * CHUNK])
    ends, arrivals = recording({100: 500})
    assert (arrivals[[200, 440]] - ends[[200, 440]] * 1_000_000_000 // 48_000 > 150 * MS).all()
    times = handed_out_ns(frames, ends, arrivals)
    assert np.abs(times - frames * 1_000_000_000 // 48_000).max() <= 1


def test_a_sound_that_is_really_late_is_late():
    """The clock is not bent to fit: what stands later in the recording was handed out later."""
    ends, arrivals = recording({100: 500})
    on_time, late = handed_out_ns(np.array([300 * CHUNK, 340 * CHUNK]), ends, arrivals)
    assert late - on_time == 40 * MS


def test_contacts_are_matched_to_their_own_onsets_only():
    pushed = [k * 210 * MS for k in range(4)]
    assert match_onsets(pushed, [t + 7 * MS for t in pushed]) == [7.0] * 4
    assert match_onsets(pushed, [pushed[0] + 99 * MS, pushed[2] + 5 * MS]) == [5.0, 99.0], "two were not heard"
    assert match_onsets(pushed, []) == match_onsets([], [5]) == []
