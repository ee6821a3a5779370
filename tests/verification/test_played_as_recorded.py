"""Recordings that are not spatial (music, binaural): two channels, as they are in the file, in both mixers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import soundfile

from mimics_app.contracts.clock import VirtualClock
from mimics_app.lab.groups.spatialiser import listener_amid
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from tests.support.audio_scene import RATE

LENGTH = RATE // 5
ASIDE = (3.0, 0.0, 0.0)  # a place that nothing may be heard of
both_mixers = pytest.mark.parametrize("name", ["openal", "spectral"])


@pytest.fixture
def opened(tmp_path, request):
    """A mixer with a recording of 440 Hz on the left and 1 kHz, half as loud, on the right; once and as a loop."""
    time = np.arange(LENGTH) / RATE
    recorded = np.stack((0.5 * np.cos(2 * np.pi * 440 * time), 0.25 * np.cos(2 * np.pi * 1000 * time)), axis=1)
    soundfile.write(tmp_path / "music.wav", recorded, RATE, subtype="FLOAT")
    once = SoundSpec(file=tmp_path / "music.wav", spatial=False)
    specs = {"music": once, "loop": replace(once, loop=True), "tick": SoundSpec(recipe="tick", spatial=False)}
    name = request.getfixturevalue("name")
    voices = 2 if name == "spectral" else 1  # those of one recording: there, each channel has one
    settings = AudioSettings(sounds=specs, triggers={}, scrape="", mixer=name, voices=voices)
    mixer = open_mixer(settings, SoundBank(specs, RATE), VirtualClock(), latency=0, origin_ns=0)
    yield mixer, recorded
    mixer.close()


@both_mixers
def test_a_recording_is_heard_as_it_is(opened, name):
    mixer, recorded = opened
    mixer.render(777)
    start = mixer.start("music", 1_000_000_000 * 960 // RATE, ASIDE, 1.0)
    onset = mixer.first_sample(start, 0)[0] - 777
    heard = mixer.render(2 * LENGTH)
    assert np.abs(heard[: onset - 24]).max() < 1e-3 < np.abs(heard[onset : onset + 2]).min()
    # without its ends, where the spectral mixer's edge of the band rings
    inner = slice(100, LENGTH - 100)
    assert np.abs(heard[onset:][inner] - recorded[inner]).max() < 2e-3
    assert np.abs(heard[onset + LENGTH + 400 :]).max() < 1e-3


@pytest.mark.parametrize("name", ["openal"])
def test_a_recording_is_in_one_buffer_of_the_library(opened, name):
    mixer, _ = opened
    assert sorted(mixer._buffers) == ["loop", "music", "tick"]


@both_mixers
def test_one_channel_is_equal_on_both_sides(opened, name):
    mixer, _ = opened
    mixer.start("tick", 0, ASIDE, 1.0)
    heard = mixer.render(RATE // 10)
    assert np.array_equal(heard[:, 0], heard[:, 1]) and np.abs(heard).max() > 0.1


@both_mixers
def test_both_channels_follow_gain_and_stop(opened, name):
    mixer, _ = opened
    handle = mixer.start("loop", 0, ASIDE, 1.0).handle
    before = np.sqrt(np.mean(mixer.render(LENGTH)[LENGTH // 2 :] ** 2, axis=0))
    softer = listener_amid(np.array([handle]), np.array([ASIDE]))
    softer.gain[:] = 0.1
    mixer.set_listener(softer)
    after = np.sqrt(np.mean(mixer.render(LENGTH)[LENGTH // 2 :] ** 2, axis=0))
    assert after == pytest.approx(0.1 * before, rel=0.02)
    mixer.stop(handle)
    assert np.abs(mixer.render(LENGTH)[LENGTH // 2 :]).max() < 1e-6


@both_mixers
def test_a_louder_sound_takes_the_voices_of_both_channels(opened, name):
    mixer, _ = opened
    mixer.start("loop", 0, None, 0.01)
    mixer.render(2400)
    assert mixer.start("tick", 1_000_000_000 * 2400 // RATE, None, 1.0).handle
    mixer.render(LENGTH)
    assert np.abs(mixer.render(LENGTH)).max() < 1e-6
