"""What happens to a sound on its way: distance, cones, motion, walls and their edges, rooms, loudspeakers."""

from __future__ import annotations

import math
import wave
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.contracts.clock import VirtualClock
from mimics_app.lab.groups.spatialiser import listener_amid
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.engine import open_engine_in_step
from mimics_app.rendering.audio.obstacles import BAND_HZ, Box, diffraction_db, passes_of, transmission_db
from mimics_app.rendering.audio.settings import AudioSettings, BusSpec, SoundSpec
from tests.verification.test_spectral_mixer import AHEAD, RATE, mixer_of

TONE = 0.25 * np.sin(2 * np.pi * 1000.0 * np.arange(RATE) / RATE)
WALL = Box(np.eye(4), np.array([2.0, 2.0, 0.05]), 20.0)


def level_of(spec: SoundSpec, place, **head) -> float:
    """Level at the left ear of a tone from a place [dB]."""
    mixer = mixer_of({"tone": TONE}, specs={"tone": spec})
    handle = np.array([mixer.start("tone", 0, tuple(place), 1.0).handle])
    state = listener_amid(handle, np.array([place], float))
    state.gain[:] = 1.0
    for name, value in head.items():
        getattr(state, name)[:] = value
    mixer.set_listener(state)
    return 20 * math.log10(float(np.sqrt(np.mean(mixer.render(9600)[4800:, 0] ** 2))) + 1e-9)


@pytest.mark.parametrize("distance", [1.0, 2.0, 4.0, 16.0])
@pytest.mark.parametrize(
    ("model", "law"),
    [
        ("inverse", lambda d: 1.0 / d),
        ("linear", lambda d: 1.0 - (d - 1.0) / 19.0),
        ("exponential", lambda d: d**-1.0),
    ],
)
def test_level_follows_the_law_of_distance(model, law, distance):
    spec = SoundSpec(loop=True, distance_model=model, max_distance=20.0)
    fall = level_of(spec, (0.0, 0.0, -distance)) - level_of(spec, AHEAD)
    air = 5e-3 * (distance - 1.0)  # dB in the middle band
    assert fall == pytest.approx(20 * math.log10(law(distance)) - air, abs=0.1)


@pytest.mark.parametrize("model", ["inverse", "exponential"])
def test_beyond_its_largest_distance_and_within_the_reference_only_the_air_dampens(model):
    spec = SoundSpec(loop=True, distance_model=model, max_distance=20.0)
    for near, far in ((20.0, 30.0), (0.5, 1.0)):
        fall = level_of(spec, (0.0, 0.0, -far)) - level_of(spec, (0.0, 0.0, -near))
        assert fall == pytest.approx(-5e-3 * (far - near), abs=0.05)


@pytest.mark.parametrize(("turned", "gain"), [(0.0, 1.0), (60.0, 0.6), (180.0, 0.2)])
def test_a_cone_is_loud_ahead_and_quiet_behind(turned, gain):
    """Inner 60, outer 180 degrees, 0.2 behind: half way between the two at 60 degrees off its axis."""
    spec = SoundSpec(loop=True, cone_inner=math.radians(60), cone_outer=math.radians(180), cone_gain=0.2)
    angle = math.radians(turned)
    towards = (math.sin(angle), 0.0, math.cos(angle))
    change = level_of(spec, AHEAD, forward=towards) - level_of(SoundSpec(loop=True), AHEAD)
    assert change == pytest.approx(20 * math.log10(gain), abs=0.05)


def pitch_heard(source_velocity, head_velocity=(0.0, 0.0, 0.0)) -> float:
    """Frequency of a tone of 1 kHz ahead [Hz], by its phase over a third of a second."""
    mixer = mixer_of({"tone": TONE}, specs={"tone": SoundSpec(loop=True, rolloff=0.0)})
    handle = np.array([mixer.start("tone", 0, AHEAD, 1.0).handle])
    state = listener_amid(handle, np.array([AHEAD]))
    state.velocity[:], state.head_velocity[:] = source_velocity, head_velocity
    mixer.set_listener(state)
    mixed = mixer.render(RATE // 2)[RATE // 8 :, 0].astype(np.float64)
    crossings = np.flatnonzero((mixed[:-1] < 0) & (mixed[1:] >= 0))
    places = crossings - mixed[crossings] / (mixed[crossings + 1] - mixed[crossings])
    return float((len(places) - 1) / (places[-1] - places[0]) * RATE)


@pytest.mark.parametrize(
    ("source", "head", "ratio"),
    [
        ((0.0, 0.0, 34.3), (0.0, 0.0, 0.0), 1.0 / 0.9),  # towards at a tenth of the speed of sound: 1111.1 Hz
        ((0.0, 0.0, -34.3), (0.0, 0.0, 0.0), 1.0 / 1.1),
        ((0.0, 0.0, 0.0), (0.0, 0.0, -34.3), 1.1),  # the listener moves
        ((34.3, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0),  # across
        ((0.0, 0.0, 3430.0), (0.0, 0.0, 0.0), 2.0),  # ten times the speed of sound: held at half of it
    ],
)
def test_motion_changes_the_pitch(source, head, ratio):
    assert pitch_heard(source, head) == pytest.approx(1000.0 * ratio, rel=2e-4)


def test_an_edge_dampens_by_maekawa_and_a_wall_by_its_mass():
    """A wall 4 m wide between two points 2 m on each side: a detour of 2 sqrt(8) - 4 m around its edge."""
    detour = 2.0 * math.hypot(2.0, 2.0) - 4.0
    for band, frequency in enumerate(BAND_HZ):
        expected = 10 * math.log10(3 + 20 * 2 * detour * frequency / 343.0)
        assert diffraction_db(detour)[band] == pytest.approx(expected, abs=1e-9)
        assert transmission_db(20.0)[band] == pytest.approx(max(0.0, 20 * math.log10(frequency * 20.0) - 47), abs=1e-9)
    thin = Box(np.eye(4), np.array([2.0, 2.0, 1e-4]), 1e6)  # nothing goes through
    heard = 20 * np.log10(passes_of(np.array([0.0, 0.0, 2.0]), np.array([0.0, 0.0, -2.0]), [thin]))
    np.testing.assert_allclose(heard, -diffraction_db(detour), atol=1.0)


def test_a_sound_that_comes_round_an_edge_gets_louder_without_a_step():
    """Past the edge of a wall in steps of a centimetre: monotone, and no step of a decibel."""
    head = np.array([0.0, 0.0, 2.0])
    levels = np.array(
        [20 * np.log10(passes_of(head, np.array([x, 0.0, -2.0]), [WALL])) for x in np.arange(0.0, 8.0, 0.01)]
    )
    assert levels[0].max() < -5.0 and np.abs(levels[-1]).max() < 0.2
    assert np.diff(levels, axis=0).min() > -0.05
    assert np.abs(np.diff(levels, axis=0)).max() < 1.0
    assert (levels[0][:-1] > levels[0][1:]).all(), "high tones are dampened more"


def test_a_source_at_the_listener_and_one_that_is_nowhere_are_heard_and_finite():
    for place in ((0.0, 0.0, 0.0), (1e-9, 0.0, 0.0), (float("nan"), 0.0, 0.0)):
        mixer = mixer_of({"tone": TONE})
        mixer.start("tone", 0, place, 1.0)
        mixed = mixer.render(2400)
        assert np.isfinite(mixed).all() and np.abs(mixed).max() > 0.05


def test_a_place_that_is_no_number_leaves_the_sound_where_it_was():
    mixer = mixer_of({"tone": TONE}, specs={"tone": SoundSpec(loop=True)})
    handle = np.array([mixer.start("tone", 0, (1.0, 0.0, 0.0), 1.0).handle])
    before = mixer.render(4800)[-480:]
    state = listener_amid(handle, np.array([[math.nan, 0.0, 0.0]]))
    state.gain[:] = 1.0
    mixer.set_listener(state)
    np.testing.assert_allclose(mixer.render(4800)[-480:], before, atol=1e-3)


def test_ten_thousand_voices_asked_leave_the_loudest():
    mixer = mixer_of({"tone": TONE}, voices=64)
    starts = [mixer.start("tone", 0, AHEAD, 0.001 * (1 + k % 7)) for k in range(10_000)]
    loud = mixer.start("tone", 0, AHEAD, 1.0)
    assert loud.handle != 0 and mixer.refused > 9000
    assert np.isfinite(mixer.render(2400)).all()
    assert sum(start.handle != 0 for start in starts) >= 64


def test_priority_outweighs_level():
    specs = {"quiet": SoundSpec(priority=100.0), "loud": SoundSpec()}
    mixer = mixer_of({"quiet": TONE, "loud": TONE}, specs=specs, voices=1)
    first = mixer.start("quiet", 0, AHEAD, 0.1)
    assert first.handle and mixer.start("loud", 0, AHEAD, 1.0).handle == 0


def test_a_voice_turns_the_others_down_and_lets_them_back():
    """The therapist's voice: 12 dB down while it sounds, back after."""
    specs = {"crowd": SoundSpec(loop=True), "voice": SoundSpec(bus="therapist", gain=1e-4)}
    buses = {"therapist": BusSpec(ducks=("main",), duck_gain=0.25)}
    mixer = mixer_of({"crowd": TONE, "voice": TONE[: RATE // 2]}, specs=specs, buses=buses)
    mixer.start("crowd", 0, AHEAD, 1.0)
    alone = mixer.render(RATE // 4)[-2400:]
    mixer.start("voice", RATE // 4 * 1_000_000_000 // RATE, AHEAD, 1.0)
    under = mixer.render(RATE // 2)[-2400:]
    after = mixer.render(2 * RATE)[-2400:]
    down, back = (20 * math.log10(np.sqrt(np.mean(x**2) / np.mean(alone**2))) for x in (under, after))
    assert down == pytest.approx(-12.04, abs=0.1)
    assert back == pytest.approx(0.0, abs=0.1)


def test_mute_silences_every_group_and_the_room_without_a_click_and_lets_them_back():
    """Panic comes after everything that sounds: within a block there is nothing, not even an echo."""
    specs = {"crowd": SoundSpec(loop=True), "voice": SoundSpec(loop=True, bus="therapist")}
    tone = 0.25 * np.sin(2 * np.pi * 200.0 * np.arange(RATE) / RATE)
    mixer = mixer_of({"crowd": tone, "voice": tone}, specs=specs, buses={"therapist": BusSpec(gain=2.0)})
    handles = np.array([mixer.start(name, 0, AHEAD, 1.0).handle for name in specs])
    state = listener_amid(handles, np.array([AHEAD, AHEAD]))
    state.gain[:] = 0.3
    mixer.set_listener(replace(state, room_level=0.5, room_time=1.0))
    before = mixer.render(RATE // 2)
    mixer.master(0.0)
    fading = mixer.render(240)
    assert np.abs(before[-240:]).max() > 0.1
    assert not mixer.render(4800).any()
    mixer.master(1.0)
    back = mixer.render(4800)
    assert np.abs(back[-240:]).max() == pytest.approx(np.abs(before[-240:]).max(), rel=0.2)  # the room still fills
    turned_off = np.concatenate((before, fading, np.zeros((2400, 2), np.float32)))[-4800:, 0]
    high = np.fft.rfft(turned_off * np.hanning(4800))[400:]  # above 4 kHz
    assert 20 * math.log10(np.abs(np.fft.irfft(np.concatenate((np.zeros(400), high)))).max()) < -80.0


@pytest.mark.requirement("R29")
def test_peaks_are_bent_after_all_groups_and_the_master(tmp_path):
    """However loud groups and master are, a file has the mix's sign everywhere and nothing beyond full scale."""
    file, specs = tmp_path / "loud.wav", {"crowd": SoundSpec(recipe="crowd", gain=4.0, bus="loud")}
    settings = AudioSettings(
        sounds=specs, triggers={}, scrape="", mixer="spectral", buses={"loud": BusSpec(gain=4.0)}, voices=8
    )
    bank = SoundBank(specs, RATE)
    engines = [open_engine_in_step(settings, bank, VirtualClock(), where, 0, 0) for where in (file, None)]
    for engine in engines:
        for _ in range(8):
            engine.mixer.start("crowd", 0, AHEAD, 1.0)
        engine.mixer.master(4.0)
    engines[0].render_to(RATE // 4, 240)
    engines[0].close()
    mix = engines[1].mixer.render(RATE // 4)
    with wave.open(str(file)) as reader:
        written = np.frombuffer(reader.readframes(RATE // 4), "<i2").reshape(-1, 2)
    assert np.abs(mix).max() > 4.0, "it is far beyond full scale"
    assert np.abs(written.astype(int)).max() <= 32767 and engines[0].writer.clipped > 1000
    clear = np.abs(mix) > 1e-3
    assert (np.sign(written)[clear] == np.sign(mix)[clear]).all()


def test_a_room_answers_for_as_long_as_it_says():
    """Level of the tail at two times: 60 dB in the time that was requested, low tones, within a tenth."""
    burst = np.zeros(RATE)
    burst[:4800] = TONE[:4800] * np.hanning(4800)
    burst = np.convolve(burst, np.hanning(97) / 48.0)[:RATE]
    mixer = mixer_of({"burst": burst})
    state = listener_amid(np.zeros(0, np.int64), np.zeros((0, 3)))
    object.__setattr__(state, "room_level", 1.0)
    object.__setattr__(state, "room_time", 0.8)
    mixer.set_listener(state)
    mixer.start("burst", 0, AHEAD, 1.0)
    mixed = mixer.render(RATE)[:, 0].astype(np.float64)
    rms = [20 * math.log10(np.sqrt(np.mean(mixed[a : a + 4800] ** 2)) + 1e-12) for a in (12000, 31200)]
    fall = (rms[0] - rms[1]) / 0.4 * 0.8
    assert fall == pytest.approx(60.0, rel=0.25)


CHANNELS = {"stereo": 2, "5.1": 6, "7.1": 8}


@pytest.mark.parametrize("speakers", list(CHANNELS))
@pytest.mark.parametrize("azimuth", [-110.0, -30.0, 0.0, 12.0, 30.0, 75.0, 110.0, 180.0])
def test_loudspeakers_share_the_power_and_point_to_the_sound(speakers, azimuth):
    """Power is kept; two loudspeakers beside the direction play; their gains point to it (Pulkki 1997)."""
    angles = {0: -30.0, 1: 30.0, 2: 0.0, 4: -110.0, 5: 110.0}
    if speakers == "7.1":
        angles |= {4: -150.0, 5: 150.0, 6: -90.0, 7: 90.0}
    mixer = mixer_of({"tone": TONE}, specs={"tone": SoundSpec(loop=True)}, hrtf=False, speakers=speakers)
    angle = math.radians(azimuth)
    mixer.start("tone", 0, (math.sin(angle), 0.0, -math.cos(angle)), 1.0)
    mixed = mixer.render(4800)
    assert mixed.shape == (4800, CHANNELS[speakers])
    level = np.sqrt(np.mean(mixed[2400:].astype(np.float64) ** 2, axis=0)) / (0.25 / math.sqrt(2))
    assert np.sum(level**2) == pytest.approx(1.0, abs=0.01)
    assert np.count_nonzero(level > 1e-3) <= 2
    if speakers != "stereo":
        x = sum(level[c] * math.sin(math.radians(a)) for c, a in angles.items())
        z = sum(level[c] * math.cos(math.radians(a)) for c, a in angles.items())
        assert math.degrees(math.atan2(x, z)) % 360.0 == pytest.approx(azimuth % 360.0, abs=0.5)


def test_harmonics_point_to_the_sound_and_have_the_norm_of_sn3d():
    """First order: y, z, x of the direction; every order has the same power in SN3D."""
    mixer = mixer_of({"tone": TONE}, specs={"tone": SoundSpec(loop=True)}, hrtf=False, speakers="ambisonic")
    place = np.array([0.6, 0.48, -0.64])
    mixer.start("tone", 0, tuple(place), 1.0)
    mixed = mixer.render(4800)[2400:].astype(np.float64)
    reference = mixed[:, 0]
    gains = mixed.T @ reference / (reference @ reference)
    np.testing.assert_allclose(gains[:4], [1.0, -0.6, 0.48, 0.64], atol=1e-3)
    for order in range(4):
        assert np.sum(gains[order**2 : (order + 1) ** 2] ** 2) == pytest.approx(1.0, abs=2e-3)
