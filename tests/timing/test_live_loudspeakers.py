"""Loudspeakers live: each channel of 5.1 and 7.1 at the monitor of a sound server, its direction and its pitch."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import soundfile

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SCENE, fill_defaults
from mimics_app.lab.audio.live_latency import Monitor, private_pulse_server, pulse_missing
from mimics_app.rendering.audio.engine import open_engine
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec, Speakers
from tests.support.pipewire_server import pipewire_missing, private_pipewire_server

SERVERS = {"pulseaudio": private_pulse_server, "pipewire": private_pipewire_server}
MISSING = {"pulseaudio": pulse_missing(), "pipewire": pipewire_missing()}

MS = 1_000_000
PLACES: Mapping[Speakers, Mapping[str, float | None]] = {
    "5.1": {
        "front-left": -30.0, "front-right": 30.0, "rear-left": -110.0, "rear-right": 110.0, "front-center": 0.0,
        "lfe": None,
    },
    "7.1": {
        "front-left": -30.0, "front-right": 30.0, "rear-left": -150.0, "rear-right": 150.0, "front-center": 0.0,
        "lfe": None, "side-left": -90.0, "side-right": 90.0,
    },
}  # fmt: skip
"""Positions of a sink in the order of sound cards, which is another than that of files, with their angles to the right
[degrees] (ITU-R BS.775 for 5.1)."""


def tones_at(speakers: Speakers) -> dict[str, tuple[float, float]]:
    """A frequency [Hz] for each place with an angle [degrees]: none is a harmonic of another."""
    angles = {place: angle for place, angle in PLACES[speakers].items() if angle is not None}
    return {place: (331.0 + 97.0 * k, angle) for k, (place, angle) in enumerate(angles.items())}


def play_all_around(server: str, speakers: Speakers, rate: int, folder: Path) -> np.ndarray:
    """A tone from where each loudspeaker stands, as the loudspeakers would have been given it, shape [n, channels]."""
    tones, sounds = tones_at(speakers), {}
    for place, (pitch, _) in tones.items():
        sounds[place] = SoundSpec(file=folder / f"{place}.wav", loop=True)
        wave = 0.3 * np.sin(2.0 * np.pi * pitch * np.arange(48_000) / 48_000)
        soundfile.write(sounds[place].file, wave, 48_000, subtype="FLOAT")
    memory, clock = SessionMemory(), MonotonicClock()
    places = tuple(PLACES[speakers])
    with SERVERS[server](rate, places) as environment, Monitor(environment, rate, places) as monitor:
        settings = AudioSettings(
            sounds=sounds, triggers={}, scrape="", emitters=tuple(sounds), mixer="spectral", driver="pulse",
            environment=environment, hrtf=False, speakers=speakers,
        )  # fmt: skip
        audio = AudioProcess(memory, settings)
        audio.start()
        try:
            status = audio.wait_ready(240.0)
            assert (status.sink, status.channels) == ("device", len(places)), status.notice
            now, end = np.zeros(1, SOUND_SCENE), clock.now_ns() + 3000 * MS
            fill_defaults(now)
            for k, (_, angle) in enumerate(tones.values()):
                now["gain"][0, k] = 1.0
                now["position"][0, k] = np.sin(np.radians(angle)), 0.0, -np.cos(np.radians(angle))
            while clock.now_ns() < end:
                now["t_ns"] = clock.now_ns()
                slot = triple_buffer.back_slot(memory.sound_scene_words)
                memory.sound_scenes[slot : slot + 1] = now
                triple_buffer.publish(memory.sound_scene_words)
                clock.sleep_until_ns(clock.now_ns() + 16 * MS)
        finally:
            report = audio.stop()
        assert not report.crashed
        return monitor.frames()


def spectrum_of(heard: np.ndarray, rate: int) -> np.ndarray:
    """Amplitudes at whole Hertz of one second in the middle of what was heard, shape [frequencies, channels]."""
    loud = np.flatnonzero(np.abs(heard).max(axis=1) > 1e-3)
    middle = (loud[0] + loud[-1]) // 2
    second = heard[middle - rate // 2 : middle + rate - rate // 2]
    assert len(second) == rate
    window = np.hanning(rate)[:, None]
    return np.abs(np.fft.rfft(second * window, axis=0)) / (0.25 * rate)


@pytest.mark.parametrize("server", ["pulseaudio", pytest.param("pipewire", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("speakers", "rate"),
    [
        ("5.1", 44_100),
        ("7.1", 48_000),
        pytest.param("5.1", 48_000, marks=pytest.mark.slow),
        pytest.param("7.1", 44_100, marks=pytest.mark.slow),
    ],
)
def test_each_loudspeaker_has_what_is_where_it_stands(
    server: str, speakers: Speakers, rate: int, tmp_path: Path
) -> None:
    """A tone is in the channel of its direction alone, at its pitch whatever the rate of the device; a gap that a busy
    machine made would blur the spectrum, so one round of three counts."""
    if MISSING[server]:
        pytest.skip(MISSING[server])
    for last in (False, False, True):
        found = spectrum_of(play_all_around(server, speakers, rate, tmp_path), rate)
        try:
            check_channels(found, speakers)
        except AssertionError:
            if last:
                raise
        else:
            return


def check_channels(found: np.ndarray, speakers: Speakers) -> None:
    """Each channel has one line, at the pitch of its tone to 0.5 Hz; that of low frequencies is silent."""
    tones = tones_at(speakers)
    for channel, place in enumerate(PLACES[speakers]):
        if place not in tones:
            assert found[:, channel].max() < 1e-3, place
            continue
        pitch = round(tones[place][0])
        line = found[pitch, channel]
        assert found[:, channel].argmax() == pitch, place
        assert line > 0.05
        for other, (else_pitch, _) in tones.items():
            assert other == place or found[round(else_pitch), channel] < 0.02 * line, (place, other)
        assert np.delete(found[:, channel], range(pitch - 3, pitch + 4)).max() < 0.02 * line, place


def test_a_mix_that_no_device_plays_is_refused_in_words(tmp_path: Path) -> None:
    settings = AudioSettings(
        sounds={"tap": SoundSpec(recipe="tap")}, triggers={}, scrape="", mixer="spectral", hrtf=False,
        speakers="ambisonic", file=tmp_path / "sound.wav",
    )  # fmt: skip
    engine = open_engine(settings, MonotonicClock())
    engine.close()
    assert "no live device supports ambisonic sound of 16 channels: sound is rendered to" in engine.status.notice
    assert engine.status.channels == 16
