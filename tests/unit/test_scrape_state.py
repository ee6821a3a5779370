"""What of the haptic snapshots reaches the mixer."""

import numpy as np
import pytest

from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.director import SoundDirector
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

RATE = 48_000


@pytest.fixture
def session():
    """Memory, director, and the values that its mixer was given."""
    sounds = {"rub": SoundSpec(recipe="cup")}
    settings = AudioSettings(sounds=sounds, triggers={}, scrape="rub", mixer="openal", hrtf=False)
    memory, clock, bank = SessionMemory(), VirtualClock(), SoundBank(sounds, RATE)
    mixer = open_mixer(settings, bank, clock, latency=0, origin_ns=0)
    states = []
    mixer.set_listener = states.append
    yield memory, SoundDirector(memory, mixer, bank, settings, clock), states
    mixer.close()


def publish(memory, force=0.0):
    """A snapshot of a hand that moves, pressed against a wall with a force [N]."""
    snapshot = memory.audio_snapshots[triple_buffer.back_slot(memory.audio_words)]
    snapshot["wall_force"], snapshot["wall_normal"], snapshot["f_user_world"] = (
        force,
        (1.0, 0.0, 0.0),
        (force, 0.0, 0.0),
    )
    snapshot["hip_world"], snapshot["v_world"] = (0.1, 0.2, 0.3), (0.0, 0.2, 0.0)
    triple_buffer.publish(memory.audio_words)


def test_a_hand_that_touches_nothing_gives_the_mixer_no_work(session):
    memory, director, states = session
    for _ in range(5):
        publish(memory)
        director.listen()
    assert states == []


def test_scraping_is_heard_from_its_place_and_falls_silent(session):
    memory, director, states = session
    for force in (0.0, 4.0, 0.0, 0.0):
        publish(memory, force)
        director.listen()
    gains = [each.gain[-1] for each in states]
    assert len(gains) == 2 and gains[0] > 0.05 and gains[1] == 0.0
    np.testing.assert_allclose(states[0].position[-1], (0.1, 0.2, 0.3))
