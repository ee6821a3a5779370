"""What is struck sounds by the 1 kHz force of its contact: in proportion, darker the longer it takes, live as offline.

The forces stand in the ring as the haptic loop writes them; that it does so is held by test_contact_forces.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.loop.contact_force import FOLLOWED
from mimics_app.contracts.ports.audio_port import Timing
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.bank import LIVE_VOICES, SoundBank
from mimics_app.rendering.audio.director import SoundDirector
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.modal import FORCE_RATE, ModalVoice, ModeBank
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.synth_scene import MATERIALS
from tests.support.audio_scene import RATE, contact, first_sounding, push, push_forces

MS = 1_000_000
BEGIN = 100 * MS


def half_sine(newton: float, ms: int) -> np.ndarray:
    """Force of a contact in each tick, its first one included, and 0 after it."""
    return np.append(newton * np.sin(np.pi * (np.arange(ms) + 1.0) / (ms + 1.0)), 0.0)


def strike_by_force(material: str, force: np.ndarray) -> np.ndarray:
    """Response of an object to a contact force, until a quarter of a second after it."""
    voice = ModalVoice(ModeBank(MATERIALS[material], 10.0, RATE))
    return voice.play(force, len(force) * (RATE // FORCE_RATE) + RATE // 4).astype(np.float32)


def centroid(samples: np.ndarray) -> float:
    power = np.abs(np.fft.rfft(samples)) ** 2
    return float(np.sum(power * np.fft.rfftfreq(len(samples), 1 / RATE)) / np.sum(power))


@pytest.mark.parametrize("material", MATERIALS)
def test_a_modal_voice_is_linear_in_the_force_and_darker_the_longer_the_contact(material):
    soft, hard = (strike_by_force(material, half_sine(newton, 4)) for newton in (1.0, 2.0))
    np.testing.assert_allclose(hard, 2.0 * soft, atol=1e-6)
    slower = [strike_by_force(material, half_sine(2.0, ms)).astype(np.float64) for ms in (1, 4, 24)]
    assert all(centroid(long) < centroid(short) for short, long in pairwise(slower))
    assert centroid(slower[-1]) < 0.7 * centroid(slower[0])
    level = [np.sqrt(np.mean(s[: RATE // 20] ** 2)) for s in slower]
    assert all(long < 0.9 * short for short, long in pairwise(level)), "the same force, slower, makes less sound"
    resting = strike_by_force(material, np.full(400, 2.0)).astype(np.float64)
    assert np.abs(resting[-RATE // 10 :]).max() < 1e-3 * np.abs(resting).max()
    gone = strike_by_force(material, half_sine(2.0, 9)).astype(np.float64)
    assert abs(gone.sum()) < 1e-3 * np.abs(np.fft.rfft(gone)).max(), "no constant part of a force that is gone"


def test_a_modal_voice_is_the_convolution_of_its_modes_with_the_change_of_force():
    """The ticks advance the modes by their exact solution; the sum over the pulse response says the same."""
    modes, force = ModeBank(MATERIALS["cup"], 10.0, RATE), half_sine(3.0, 7)
    change = np.repeat(np.diff(force, prepend=0.0) / modes.ramp, modes.ramp)
    pulse = ModalVoice(modes).play((1.0,), RATE // 4)  # to a change that takes one tick
    alone = np.zeros(RATE // 4)
    for tick, step in enumerate(np.diff(force, prepend=0.0)):
        alone[tick * modes.ramp :] += step * pulse[: len(alone) - tick * modes.ramp]
    np.testing.assert_allclose(ModalVoice(modes).play(force, RATE // 4), alone, atol=1e-12)
    assert change.sum() == pytest.approx(force[-1])


class Session:
    """Ring, director and mixer of a session on a virtual clock, the mix gathered."""

    def __init__(self, mixer: str, **spec: float) -> None:
        sounds = {"cup": SoundSpec(recipe="cup", full_force=20.0, **spec)}
        settings = AudioSettings(sounds=sounds, triggers={"contact": "cup"}, scrape="", mixer=mixer, hrtf=False)
        self.memory, self.clock = SessionMemory(), VirtualClock()
        self.bank = SoundBank(sounds, RATE)
        self.mixer = open_mixer(settings, self.bank, self.clock, latency=0, origin_ns=0)
        self.director = SoundDirector(self.memory, self.mixer, self.bank, settings, self.clock)
        self.mixed: list[np.ndarray] = []

    def until(self, t_ns: int, behind: int = 0) -> None:
        """Read the rings and mix up to a time, or to some frames before it."""
        self.clock.sleep_until_ns(t_ns)
        self.director.take_contacts()
        frames = t_ns * RATE // 1_000_000_000 - behind - self.mixer.position
        self.mixed.append(self.mixer.render(max(0, frames)))

    def close(self, seconds: float = 0.8) -> np.ndarray:
        self.director.decay()
        self.mixed.append(self.mixer.render(round(seconds * RATE) - self.mixer.position))
        self.mixer.close()
        return np.concatenate(self.mixed)[:, 0].astype(np.float64)


def heard(mixer: str, force: np.ndarray, frame_ms: int = 16, seconds: float = 0.8) -> np.ndarray:
    """The left channel of a contact with these forces, sent and mixed a frame at a time."""
    session = Session(mixer)
    followed = np.concatenate((force[1:], np.zeros(FOLLOWED - len(force) + 1)))
    for end in range(frame_ms * MS, round(seconds * 1e9), frame_ms * MS):
        if end - frame_ms * MS < BEGIN <= end:
            push(session.memory, contact(BEGIN, force=float(force[0]), speed=0.1))
        ticks = [k for k in range(FOLLOWED) if end - frame_ms * MS < BEGIN + (k + 1) * MS <= end]
        if ticks:
            push_forces(session.memory, BEGIN + ticks[0] * MS, followed[ticks])
        session.until(end)
    return session.close(seconds)


@pytest.mark.parametrize("mixer", ["openal", "spectral"])
def test_a_contact_sounds_by_its_force_from_its_own_sample_on(mixer):
    """Doubled force: 6.02 dB at every frequency. Longer contact: darker. First sample: that of its event."""
    short, loud, long = (heard(mixer, half_sine(n, ms)) for n, ms in ((2.0, 2), (4.0, 2), (2.0, 24)))
    np.testing.assert_allclose(loud, 2.0 * short, atol=2e-5 * np.abs(loud).max())
    assert centroid(long) < 0.75 * centroid(short)
    assert np.sum(long**2) < 0.25 * np.sum(short**2)
    onset = first_sounding(np.repeat(short[:, None], 2, axis=1), 0)
    early = 40 if mixer == "spectral" else 0  # the spectral mixer's constant, of which the filter's ringing is a part
    assert BEGIN * RATE // 10**9 <= onset <= BEGIN * RATE // 10**9 + early + 1


def test_how_often_the_rings_are_read_changes_no_sample():
    """Live they are read every millisecond, offline every frame: what is heard is the same."""
    force = half_sine(3.0, 9)
    for mixer in ("openal", "spectral"):
        once, often = (heard(mixer, force, frame_ms) for frame_ms in (16, 2))
        # -54 dB: the spectral mixer leaves out what is at half the rate, block by block
        np.testing.assert_allclose(once, often, atol=2e-3 * np.abs(once).max())


def test_a_tick_that_is_late_leaves_no_gap_and_one_that_never_comes_no_silence():
    """Without a single force after the event the thing rings as after a step; nothing jumps when a force is late."""
    session = Session("spectral")
    push(session.memory, contact(BEGIN, force=2.0))
    session.until(BEGIN + 8 * MS)
    push_forces(session.memory, BEGIN + 8 * MS, half_sine(2.0, 4))
    session.until(BEGIN + 400 * MS)
    late = session.close()
    step = heard("spectral", np.array([2.0]))
    assert np.abs(late[: BEGIN * RATE // 10**9]).max() < 1e-3 * np.abs(late).max()
    assert np.abs(np.diff(late)).max() <= 1.5 * np.abs(np.diff(step)).max()
    session = Session("spectral")
    push(session.memory, contact(BEGIN, force=2.0))
    session.until(BEGIN + 8 * MS)
    session.until(700 * MS)
    assert np.abs(session.close()).max() > 0.01


def test_a_fifth_contact_at_once_is_a_recording_and_forces_of_unknown_contacts_are_passed_over():
    session = Session("spectral")
    for k in range(LIVE_VOICES + 1):
        push(session.memory, contact(BEGIN + k * MS, force=2.0, body=k))
    push_forces(session.memory, BEGIN + 10 * MS, half_sine(2.0, 3), body=77)
    push_forces(session.memory, BEGIN + 20 * MS, np.array([np.nan, np.inf]))
    session.until(BEGIN + 50 * MS)
    names = [row.sound for row in session.director.rows]
    assert names[:LIVE_VOICES] == [f"cup:live:{k}" for k in range(LIVE_VOICES)]
    assert names[LIVE_VOICES].startswith("cup:") and "live" not in names[LIVE_VOICES]
    assert np.isfinite(session.close()).all()


def test_a_library_without_shared_memory_of_sounds_plays_recordings(monkeypatch):
    from mimics_app.rendering.audio.openal_library import OpenALLibrary

    monkeypatch.setattr(OpenALLibrary, "maps", False, raising=False)
    session = Session("openal")
    session.mixer._filled.clear()
    assert session.mixer.lead is None
    director = SoundDirector(
        session.memory,
        session.mixer,
        session.bank,
        AudioSettings(sounds={"cup": SoundSpec(recipe="cup")}, triggers={"contact": "cup"}, scrape=""),
        session.clock,
    )
    director.play_contacts(contact(0, force=2.0))
    assert "live" not in director.rows[0].sound
    session.close()


def test_the_head_of_the_spectral_mixer_is_reported_once_and_not_by_the_live_sounds():
    """Live sounds are among those that the mixer packs: their rows are written, no other sound's."""
    session = Session("spectral")
    before = session.mixer._bank.samples.copy()
    push(session.memory, contact(BEGIN, force=2.0))
    session.until(BEGIN + 20 * MS)
    changed = np.flatnonzero(session.mixer._bank.samples != before)
    row = session.mixer._rows["cup:live:0"]
    first = session.mixer._bank.begin[row]
    assert len(changed) and changed.min() >= first and changed.max() < first + session.mixer._bank.length[row]
    assert session.mixer.timing == Timing(0, 0, session.mixer.timing.pipeline)
