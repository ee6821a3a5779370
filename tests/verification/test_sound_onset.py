"""Every sound begins at its exact sample, in the place and at the level that physics requests."""

from __future__ import annotations

import hashlib
import wave

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.offline import OfflineAudio, render_offline
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.wav_file import WavWriter
from tests.support.audio_scene import RATE, contact, first_sounding, place, push

TICK = {"tick": SoundSpec(recipe="tick")}
AHEAD = (0.0, 0.0, -1.0)


def scattered_times(count: int, seed: int = 3) -> list[int]:
    """Times [ns] a quarter of a second apart plus a random share of it: no two in one place of a block."""
    random = np.random.default_rng(seed)
    return [k * 250_000_000 + int(random.integers(0, 150_000_000)) for k in range(count)]


def nearest_frame(t_ns: int) -> int:
    return (t_ns * RATE + 500_000_000) // 1_000_000_000


@pytest.mark.parametrize("hrtf", [False, True], ids=["stereo", "hrtf"])
def test_100_random_events_begin_at_their_sample(hrtf):
    times = scattered_times(100)
    mix, onsets = render_offline([SoundEvent("tick", t, AHEAD) for t in times], TICK, 26.0, hrtf=hrtf)
    pipeline = {onset - nearest_frame(t) for onset, t in zip(onsets, times, strict=True)}
    assert len(pipeline) == 1, "the delay from event to sample is one constant"
    assert next(iter(pipeline)) <= 16, "no more than a third of a millisecond"
    for onset in onsets:
        assert first_sounding(mix, max(0, onset - 2000)) == onset


def test_events_on_the_same_and_on_neighbouring_frames():
    frames = [1000, 1000, 1001, 1023, 1024, 1025]  # 1024 is the border of a block
    events = [SoundEvent("tick", round(f * 1e9 / RATE), AHEAD, 0.1) for f in frames]
    mix, onsets = render_offline(events, TICK, 0.2, hrtf=False)
    assert onsets == frames
    alone, _ = render_offline(events[:1], TICK, 0.2, hrtf=False)
    # what is mixed is the sum of what each would be alone; float32 sums of six
    expected = sum(np.roll(alone, f - frames[0], axis=0) for f in frames)
    np.testing.assert_allclose(mix, expected, atol=1e-6)


def test_the_same_events_give_the_same_bytes():
    events = [
        SoundEvent("tick", t, (x, 0.3, -1.0)) for t, x in zip(scattered_times(12), np.linspace(-2, 2, 12), strict=True)
    ]
    first, second = (render_offline(events, TICK, 3.5)[0].tobytes() for _ in range(2))
    assert first == second
    assert any(first)


@pytest.mark.parametrize(("x", "near", "far"), [(-1.0, 0, 1), (1.0, 1, 0)], ids=["left", "right"])
def test_the_nearer_ear_hears_it_louder_and_earlier(x, near, far):
    mix, _ = render_offline([SoundEvent("tick", 0, (x, 0.0, 0.0))], TICK, 0.1)
    energy = np.sum(mix.astype(float) ** 2, axis=0)
    assert 10 * np.log10(energy[near] / energy[far]) > 3.0
    correlation = np.correlate(mix[:4000, far].astype(float), mix[:4000, near].astype(float), "full")
    lag_us = (int(np.argmax(correlation)) - 3999) / RATE * 1e6
    # a head of 87.5 mm gives 656 us (Woodworth); ears are whole samples apart in this library: 21 us
    assert 450.0 < lag_us < 850.0


def test_a_source_ahead_is_centred_and_turning_the_head_moves_it():
    ahead, _ = render_offline([SoundEvent("tick", 0, AHEAD)], TICK, 0.1)
    level = np.sqrt(np.mean(ahead.astype(float) ** 2, axis=0))
    assert level[0] == pytest.approx(level[1], rel=0.06)  # half a decibel
    facing_right = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    turned, _ = render_offline([SoundEvent("tick", 0, AHEAD)], TICK, 0.1, facing_right)
    assert np.sum(turned[:, 0].astype(float) ** 2) > 2.0 * np.sum(turned[:, 1].astype(float) ** 2)


@pytest.mark.parametrize("distance", [2.0, 4.0, 8.0, 50.0, 400.0])
def test_level_falls_with_distance_and_stops_falling_at_the_limit(distance):
    def peak(z: float) -> float:
        return float(np.abs(render_offline([SoundEvent("tick", 0, (0.0, 0.0, -z))], TICK, 0.05, hrtf=False)[0]).max())

    assert peak(distance) == pytest.approx(peak(1.0) / min(distance, 50.0), rel=1e-3)


def test_gain_is_linear_and_place_none_is_at_the_listener():
    loud, quiet = (render_offline([SoundEvent("tick", 0, None, g)], TICK, 0.05, hrtf=False)[0] for g in (1.0, 0.25))
    np.testing.assert_allclose(quiet, 0.25 * loud, atol=1e-6)
    far_away = ((100.0, 5.0, 3.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
    elsewhere, _ = render_offline([SoundEvent("tick", 0, None)], TICK, 0.05, far_away, hrtf=False)
    np.testing.assert_allclose(elsewhere, loud, atol=1e-6)


def test_more_sounds_than_voices_keeps_the_loudest():
    events = [SoundEvent("tick", 0, AHEAD, 0.01)] * 64 + [SoundEvent("tick", 0, AHEAD, 1.0)]
    _, onsets = render_offline(events, TICK, 0.05)
    assert onsets[-1] >= 0
    _, onsets = render_offline(events[:65][::-1], TICK, 0.05)
    assert onsets[0] >= 0
    assert onsets.count(-1) == 1


def test_a_sound_of_higher_priority_keeps_its_voice():
    specs = {"quiet": SoundSpec(recipe="tick", priority=100.0), "loud": SoundSpec(recipe="tick")}
    quiet = [SoundEvent("quiet", 0, AHEAD, 0.1)] * 64
    assert render_offline([*quiet, SoundEvent("loud", 0, AHEAD, 1.0)], specs, 0.05)[1][-1] == -1
    loud = [SoundEvent("loud", 0, AHEAD, 1.0)] * 64
    assert render_offline([*loud, SoundEvent("quiet", 0, AHEAD, 0.1)], specs, 0.05)[1][-1] >= 0


def read_file(path: str) -> np.ndarray:
    """The frames of a 16-bit file in [-1, 1], shape [n, 2]."""
    with wave.open(path) as file:
        return np.frombuffer(file.readframes(file.getnframes()), "<i2").reshape(-1, 2) / 32767


def run_offline(folder, contacts, seconds=2.0, frame_ns=16_666_667, **changes):
    """A headless session: contacts appear in the ring at their tick, the frame advances the sound."""
    memory = SessionMemory()
    settings = AudioSettings(sink="file", file=folder / "session.wav", **changes)
    audio = OfflineAudio(memory, settings)
    audio.start()
    place(memory, 0)
    waiting = sorted(contacts, key=lambda event: int(event["t_ns"][0]))
    for now in range(frame_ns, round(seconds * 1e9), frame_ns):
        while waiting and waiting[0]["t_ns"][0] <= now:
            assert push(memory, waiting.pop(0))
        audio.advance(now)
    report = audio.stop()
    assert audio.stop() is report
    return report


def test_contacts_of_a_headless_session_stand_at_their_sample_in_the_file(tmp_path):
    times = [t + 5_000_000 for t in scattered_times(20)]
    report = run_offline(
        tmp_path, [contact(t) for t in times], 5.5, sounds=TICK, triggers={"contact": "tick"}, scrape=""
    )
    assert [row.t_ns for row in report.rows] == times
    assert not any(row.late for row in report.rows)
    mix = read_file(report.file)
    for row in report.rows:
        assert row.onset_sample - nearest_frame(row.t_ns) == 10
        # 16 bit hides the filter's first, smallest sample at most
        assert 0 <= first_sounding(mix, row.onset_sample - 2000) - row.onset_sample <= 1
    assert report.latency_ms()["max"] < 1.0


def test_none_of_120_contacts_is_lost_between_ring_and_mixer(tmp_path):
    times = [100_000_000 + k * 7_000_000 for k in range(120)]
    events = [contact(t, body=k) for k, t in enumerate(times)]  # each of a pair of its own: none is merged
    report = run_offline(tmp_path, events, 1.2, sounds=TICK, triggers={"contact": "tick"}, scrape="", voices=128)
    assert [row.t_ns for row in report.rows] == times
    assert (report.merged, report.stale, report.refused) == (0, 0, 0)


def test_headless_sound_is_the_same_file_twice(tmp_path):
    contacts = [contact(t, speed=0.1 * k, position=(0.1 * k, 0.0, -0.5)) for k, t in enumerate(scattered_times(6), 1)]
    hashes = set()
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        report = run_offline(tmp_path / name, contacts)
        hashes.add(hashlib.sha256((tmp_path / name / "session.wav").read_bytes()).hexdigest())
        assert len(report.rows) == 6
    assert len(hashes) == 1


def test_chatter_is_merged_and_old_contacts_are_not_played(tmp_path):
    chatter = [contact(1_000_000_000 + k * 1_000_000) for k in range(40)]
    report = run_offline(tmp_path, chatter)
    assert (len(report.rows), report.merged) == (1, 39)
    report = run_offline(tmp_path, [contact(0)], frame_ns=150_000_000)
    assert (len(report.rows), report.stale) == (0, 1)


def test_contact_level_reaches_the_file(tmp_path):
    report = run_offline(tmp_path, [contact(10**8, speed=0.05, force=0.2), contact(10**9, speed=1.0, force=20.0)])
    soft, hard = report.rows
    assert hard.gain > 3 * soft.gain
    assert soft.sound != hard.sound


def test_rub_sounds_while_the_wall_is_pressed_and_the_hand_slides(tmp_path):
    memory = SessionMemory()
    audio = OfflineAudio(memory, AudioSettings(sink="file", file=tmp_path / "rub.wav", triggers={}, hrtf=False))
    audio.start()
    for now in range(16_000_000, 1_500_000_000, 16_000_000):
        slot = triple_buffer.back_slot(memory.audio_words)
        snapshot = memory.audio_snapshots[slot : slot + 1]
        pressed = 500_000_000 < now < 1_000_000_000
        snapshot["t_ns"], snapshot["hip_world"] = now, AHEAD
        snapshot["f_user_world"], snapshot["v_world"] = (0.0, 8.0, 0.0), (0.2, 0.0, 0.0)
        snapshot["wall_force"], snapshot["wall_normal"] = (8.0 if pressed else 0.0), (0.0, 1.0, 0.0)
        triple_buffer.publish(memory.audio_words)
        audio.advance(now)
    report = audio.stop()
    mix = read_file(report.file)
    rms = [
        float(np.sqrt(np.mean(mix[int(a * RATE) : int(b * RATE)] ** 2))) for a, b in ((0, 0.49), (0.6, 0.9), (1.1, 1.4))
    ]
    assert rms[0] == 0.0
    assert rms[1] > 0.003
    assert rms[2] < 0.01 * rms[1]


def high_band_peak(samples: np.ndarray) -> float:
    """Peak above 4 kHz, the part of a click that is not in a 200 Hz tone; the record's ends are faded first."""
    fade = np.ones(len(samples))
    fade[:480] = 0.5 - 0.5 * np.cos(np.pi * np.arange(480) / 480)
    fade[-480:] = fade[:480][::-1]
    spectrum = np.fft.rfft(samples * fade)
    spectrum[np.fft.rfftfreq(len(samples), 1 / RATE) < 4000.0] = 0.0
    return float(np.abs(np.fft.irfft(spectrum, len(samples))[600:-600]).max())


@pytest.mark.parametrize("hrtf", [False, True], ids=["stereo", "hrtf"])
def test_stopping_a_sounding_voice_does_not_click(tmp_path, hrtf):
    from mimics_app.contracts.clock import VirtualClock
    from mimics_app.rendering.audio.bank import SoundBank
    from mimics_app.rendering.audio.engine import open_mixer

    tone = (0.25 * np.sin(2 * np.pi * 200 * np.arange(RATE) / RATE)).astype(np.float32)
    writer = WavWriter(tmp_path / "tone.wav", RATE)
    writer.append(np.repeat(tone[:, None], 2, axis=1))
    writer.close()
    specs = {"tone": SoundSpec(file=tmp_path / "tone.wav", loop=True)}
    settings = AudioSettings(sounds=specs, triggers={}, scrape="", hrtf=hrtf)
    mixer = open_mixer(settings, SoundBank(specs, RATE), VirtualClock(), latency=0, origin_ns=0)
    handle = mixer.start("tone", 0, AHEAD, 1.0).handle
    mixer.render(RATE // 2)
    before = mixer.render(4860)  # ends inside a period of the tone, not at its zero
    mixer.stop(handle)
    after = mixer.render(4800)
    again = mixer.start("tone", 0, AHEAD, 1.0).handle
    mixer.close()
    assert again != handle
    assert np.abs(after[-960:]).max() == 0.0
    # -60 dBFS; the library's own stop measures -23
    assert high_band_peak(np.concatenate([before, after])[:, 0].astype(float)) < 1e-3


def test_emitter_follows_its_place_its_gain_and_the_master(tmp_path):
    sounds, memory = {"sea": SoundSpec(recipe="scrape")}, SessionMemory()
    settings = AudioSettings(
        sink="file", file=tmp_path / "sea.wav", sounds=sounds, triggers={}, scrape="", emitters=("sea",)
    )
    audio = OfflineAudio(memory, settings)
    audio.start()
    plan = [(-1.0, 0.5, 1.0), (1.0, 0.5, 1.0), (1.0, 0.5, 0.5), (1.0, 0.0, 1.0)]
    for second, (x, gain, master) in enumerate(plan, 1):
        place(memory, (second - 1) * 1_000_000_000, [((x, 0.0, 0.0), gain)])
        audio.master(master)
        audio.advance(second * 1_000_000_000)
    mix = read_file(audio.stop().file)
    # the second half of each second: the ramps are over
    level = np.array([np.sqrt(np.mean(mix[int((k + 0.5) * RATE) : (k + 1) * RATE] ** 2, axis=0)) for k in range(4)])
    assert level[0, 0] > 1.4 * level[0, 1]
    assert level[1, 1] > 1.4 * level[1, 0]
    # the loop repeats every 2 s, so half a second of it is like another within a few decibels of noise
    assert level[2, 1] == pytest.approx(0.5 * level[1, 1], rel=0.3)
    assert level[3].max() == 0.0


def test_a_device_cannot_play_what_the_virtual_clock_mixes(tmp_path, capsys):
    words = [
        "run",
        "wavy_tunnel",
        "--headless",
        "--seconds",
        "0.1",
        "--sound",
        "device",
        "--runs",
        str(tmp_path / "runs"),
    ]
    assert main(words) == 2
    assert "the virtual clock is too fast for a sound device; write --sound file" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists(), "no run began"
