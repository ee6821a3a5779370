"""Scraping follows the hand: all its frequencies are proportional to the sliding speed, its level to powers of both.

Oracles: the phonograph needle of FoleyAutomatic (K. van den Doel et al., 2001), by which a texture is met `speed` times
its spatial frequency times a second, and the measured power 3/4 of the sliding speed (roughness noise, 2019).
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.shared_memory import triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.director import SoundDirector
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

RATE, BLOCK = 48_000, 240
LOOP_S = 4.0
"""Length of the recipe's loop at 0.2 m/s [s]."""
SPEEDS = (0.1, 0.2, 0.4)


class Hand:
    """A hand that slides along a wall in front of the head, and the mixer that plays it."""

    def __init__(self, mixer: str) -> None:
        sounds = {"rub": SoundSpec(recipe="scrape")}
        settings = AudioSettings(sounds=sounds, triggers={}, scrape="rub", mixer=mixer, hrtf=False)
        self.clock, self.memory, bank = VirtualClock(), SessionMemory(), SoundBank(sounds, RATE)
        self.mixer = open_mixer(settings, bank, self.clock, latency=0, origin_ns=0)
        self.director = SoundDirector(self.memory, self.mixer, bank, settings, self.clock)

    def slide(self, speed: float, force: float, seconds: float, outwards: float = 0.0) -> np.ndarray:
        """Slide with a force [N] at a speed, moving out of the wall at another [m/s]; return both channels together."""
        blocks = []
        for _ in range(round(seconds * RATE / BLOCK)):
            snapshot = self.memory.audio_snapshots[triple_buffer.back_slot(self.memory.audio_words)]
            snapshot["wall_force"], snapshot["wall_normal"] = force, (0.0, 1.0, 0.0)
            snapshot["f_user_world"] = (-2.0 * speed, force, 0.0)  # and drag, which presses on no wall
            snapshot["hip_world"], snapshot["v_world"] = (0.0, 0.0, -1.0), (speed, outwards, 0.0)
            triple_buffer.publish(self.memory.audio_words)
            self.clock.sleep_until_ns(self.clock.now_ns() + BLOCK * 1_000_000_000 // RATE)
            self.director.listen()
            blocks.append(self.mixer.render(BLOCK).sum(axis=1))
        return np.concatenate(blocks).astype(np.float64)


@pytest.fixture(params=["openal", "spectral"])
def hand(request: pytest.FixtureRequest):
    hand = Hand(request.param)
    yield hand
    hand.mixer.close()


def whole_loop(hand: Hand, speed: float, force: float = 4.0) -> np.ndarray:
    """One whole round of the loop, which is longer the slower it is read."""
    seconds = LOOP_S * 0.2 / speed
    return hand.slide(speed, force, 0.1 + seconds)[RATE // 10 :]


def centre_hz(samples: np.ndarray) -> float:
    """Frequency below which half of the power is."""
    power = np.abs(np.fft.rfft(samples)) ** 2
    half = np.searchsorted(np.cumsum(power), 0.5 * power.sum())
    return float(np.fft.rfftfreq(len(samples), 1.0 / RATE)[half])


def level_db(samples: np.ndarray) -> float:
    return 10.0 * math.log10(np.mean(samples**2))


def test_its_band_is_proportional_to_the_speed_and_its_level_to_the_power_three_quarters(hand: Hand) -> None:
    sounds = [whole_loop(hand, speed) for speed in SPEEDS]
    for slow, fast in pairwise(sounds):
        assert centre_hz(fast) / centre_hz(slow) == pytest.approx(2.0, rel=0.04)
        assert level_db(fast) - level_db(slow) == pytest.approx(0.75 * 20.0 * math.log10(2.0), abs=0.3)


def test_its_level_follows_the_root_of_the_force_alone(hand: Hand) -> None:
    light, firm = (whole_loop(hand, 0.4, force) for force in (2.0, 8.0))
    assert level_db(firm) - level_db(light) == pytest.approx(0.5 * 20.0 * math.log10(4.0), abs=0.3)
    assert centre_hz(firm) == pytest.approx(centre_hz(light), rel=0.04)


def test_a_hand_that_rests_or_lets_go_is_silent_and_takes_no_voice(hand: Hand) -> None:
    assert np.abs(hand.slide(0.2, 4.0, 0.2)).max() > 0.01
    for speed, force in ((0.0, 4.0), (0.2, 0.0)):
        hand.slide(0.2, 4.0, 0.1)
        assert np.abs(hand.slide(speed, force, 0.7)[RATE // 20 :]).max() < 1e-4
        assert hand.director._handles[-1] == 0


def test_only_what_slides_along_the_wall_sounds(hand: Hand) -> None:
    """A hand that is pressed straight into the wall, or comes straight out of it, does not scrape."""
    for outwards in (-0.4, 0.4):
        assert np.abs(hand.slide(0.0, 8.0, 0.3, outwards)).max() < 1e-4
    along = whole_loop(hand, 0.4)
    hand.slide(0.0, 0.0, 0.7)
    askew = hand.slide(0.4, 4.0, 0.1 + LOOP_S * 0.5, -0.4)[RATE // 10 :]
    assert level_db(askew) == pytest.approx(level_db(along), abs=0.3)
    assert centre_hz(askew) == pytest.approx(centre_hz(along), rel=0.04)
