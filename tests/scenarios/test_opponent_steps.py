"""An opponent who follows: heard from behind, louder as they come, each step at its contact with the ground."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.app.cues.sound_surroundings import GaitClock
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.rendering.audio.offline import render_offline
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

RATE = 48_000
# The law: 6 dB per halving of the distance down to 1 m, a floor at 30 m; air takes 5 dB per km in the middle band.
STEP = SoundSpec(recipe="step_asphalt", reference_distance=1.0, max_distance=30.0)


def level_behind(distance: float) -> np.ndarray:
    """Level in both ears of a tick behind the listener [dB], below 2 kHz."""
    sounds = {"tick": SoundSpec(recipe="tick", reference_distance=1.0, max_distance=30.0)}
    mix, _ = render_offline([SoundEvent("tick", 0, (0.0, 0.0, distance))], sounds, 0.05, mixer="spectral")
    return 10 * np.log10(np.sum(mix.astype(np.float64) ** 2, axis=0))


def test_level_grows_by_6_db_per_halving_and_has_a_floor():
    at = {d: level_behind(d) for d in (0.5, 1.0, 2.0, 4.0, 8.0, 30.0, 60.0)}
    for far, near in ((8.0, 4.0), (4.0, 2.0), (2.0, 1.0)):
        np.testing.assert_allclose(at[near] - at[far], 6.02, atol=0.25)
    np.testing.assert_allclose(at[1.0] - at[8.0], 18.06, atol=0.25)
    np.testing.assert_allclose(at[0.5], at[1.0], atol=0.25)
    np.testing.assert_allclose(at[1.0] - at[30.0], 29.5, atol=0.5)  # the air's share beside it
    np.testing.assert_allclose(at[60.0], at[30.0], atol=0.5)
    assert abs(at[4.0][0] - at[4.0][1]) < 0.5, "dead behind: the same in both ears"


def walk(speed: float, seconds: float) -> list:
    gait, triggers = GaitClock("asphalt"), []
    for frame in range(round(60 * seconds)):
        t_ns = frame * 1_000_000_000 // 60
        triggers += gait.step(t_ns, (0.0, 0.0, 8.0 - speed * t_ns * 1e-9))
    return triggers


@pytest.mark.parametrize("speed", [0.8, 1.4, 3.0])
def test_steps_come_evenly_with_the_speed_and_where_the_walker_is(speed):
    triggers = walk(speed, 6.0)
    spacing = np.diff([trigger.t_ns for trigger in triggers]) * 1e-9
    expected = 0.66 * math.sqrt(speed) / speed
    np.testing.assert_allclose(spacing, expected, atol=1e-6)  # not one frame's width off
    for trigger in triggers:
        assert trigger.position_world[2] == pytest.approx(8.0 - speed * trigger.t_ns * 1e-9, abs=1e-6)
        assert (trigger.kind, trigger.material) == ("step", "asphalt")


def test_who_stands_makes_no_step():
    gait = GaitClock("grass")
    assert not [t for frame in range(300) for t in gait.step(frame * 16_666_667, (1.0, 0.0, 2.0))]


def test_every_step_sounds_at_its_contact_to_the_sample():
    settings = AudioSettings(sounds={"step": STEP}, triggers={"step/asphalt": "step"}, scrape="")
    triggers = walk(1.4, 4.0)
    events = [SoundEvent(settings.sound_of(t.kind, t.material), t.t_ns, t.position_world, t.strength) for t in triggers]
    mix, onsets = render_offline(events, settings.sounds, 5.0, mixer="spectral")
    frames = [(t.t_ns * RATE + 500_000_000) // 1_000_000_000 for t in triggers]
    assert len({onset - frame for onset, frame in zip(onsets, frames, strict=True)}) == 1
    heard = [float(np.abs(mix[onset : onset + 4800]).max()) for onset in onsets]
    assert heard[-1] > 2.0 * heard[0], "they come nearer"
