"""The mixer in spectra against closed forms and against the head it is given."""

from __future__ import annotations

import hashlib
import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import Timing
from mimics_app.lab.audio.hearing import hearing_errors, level_differences
from mimics_app.lab.audio.rendered import render_clicks
from mimics_app.lab.audio_bench import find_measured_head
from mimics_app.lab.audio_figures import errors_around_the_head
from mimics_app.lab.groups.spatialiser import listener_amid
from mimics_app.rendering.audio.bank import Sound, SoundBank
from mimics_app.rendering.audio.offline import render_offline
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.spectral.bins import add_moving, add_to_ears, move, set_shaped
from mimics_app.rendering.audio.spectral.computed_head import compute_head, sphere_response
from mimics_app.rendering.audio.spectral.fourier import BINS, SIZE, WORK, real_block, real_spectrum, turns_of
from mimics_app.rendering.audio.spectral.head import HeadResponses, delays_between_ears
from mimics_app.rendering.audio.spectral.head_table import BASE_DELAY, build_head_table
from mimics_app.rendering.audio.spectral.mixer import SpectralMixer
from mimics_app.rendering.audio.spectral.sofa import read_sofa
from tests.support.heads import some_head, write_sofa

RATE = 48_000
AHEAD = (0.0, 0.0, -1.0)
TICK = {"tick": SoundSpec(recipe="tick")}
# Goals: thresholds of a listener under the best conditions are 10 us and 0.5 dB.
ITD_MEDIAN_US, ITD_MAX_US, ITD_JUMP_US, ILD_MEDIAN_DB, ILD_P95_DB = 5.0, 10.0, 10.0, 0.3, 0.7
RESIDUAL_DBFS = -80.0


def mixer_of(sounds: dict[str, np.ndarray], **settings) -> SpectralMixer:
    """A mixer of samples, each placed as `specs` says."""
    specs = settings.pop("specs", {})
    bank = SoundBank({}, RATE)
    for name, samples in sounds.items():
        bank.sounds[name] = Sound(np.asarray(samples, np.float32), specs.get(name, SoundSpec()))
    return SpectralMixer(bank, AudioSettings(sounds={}, triggers={}, scrape="", mixer="spectral", **settings), Timing())


@kernel
def _there_and_back(blocks, turns, work, spectra, again):
    samples = blocks.reshape(-1)
    for n in range(blocks.shape[0]):
        real_spectrum(samples, SIZE * n, turns, spectra[n])
        real_block(spectra[n], turns, work, again[n])


def test_spectra_of_blocks_are_those_of_the_library_and_lead_back():
    random = np.random.default_rng(5)
    blocks = random.standard_normal((20, SIZE)).astype(np.float32)
    blocks[0], blocks[1], blocks[2] = 0.0, 1.0, np.arange(SIZE) == 3
    spectra, again = np.zeros((20, 2 * BINS), np.float32), np.zeros_like(blocks)
    _there_and_back(blocks, turns_of(), np.zeros(WORK, np.float32), spectra, again)
    expected = np.fft.rfft(blocks.astype(np.float64))
    # float32 and nine doublings: some 1e-7 of the largest bin
    assert np.abs(spectra[:, :BINS] + 1j * spectra[:, BINS:] - expected[:, :BINS]).max() < 1e-6 * np.abs(expected).max()
    expected[:, BINS:] = 0.0  # the highest bin is left out
    np.testing.assert_allclose(again, np.fft.irfft(expected, SIZE), atol=1e-6 * np.abs(blocks).max())


@kernel
def _filtered(spectrum, shelves, shape, table, before, after, sums, shaped):
    add_to_ears(spectrum, shelves, shape, table, table, after, sums, 0)
    add_moving(spectrum, shelves, shape, table, table, before, after, sums)
    set_shaped(spectrum, shelves, 0.7, shape, shaped)
    move(shaped, 3, shaped, 0, 2 * BINS - 3)


def test_rows_of_bins_are_filtered_as_their_formulas_say():
    random = np.random.default_rng(6)
    spectrum, shelves, table = (random.standard_normal(n).astype(np.float32) for n in (2 * BINS, 4 * BINS, 16 * BINS))
    places = (0.3, -1.4), table, (0.8, 1, 5), (-1.3, 3, 60)
    found, expected = ((np.ones((3, 4 * BINS), np.float32), np.zeros(2 * BINS, np.float32)) for _ in range(2))
    _filtered(spectrum, shelves, *places, *found)
    _filtered.py_func(spectrum, shelves, *places, *expected)
    for ours, plain in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours, plain, atol=1e-6 * np.abs(plain).max())


def test_a_sphere_doubles_high_tones_in_front_shades_them_behind_and_leaves_low_ones():
    """Limits of the series: 1 for waves longer than the head; 2 at a wall; the bright spot opposite the source."""
    low, high = np.abs(sphere_response(np.array([20.0, 16_000.0]), np.radians([0.0, 150.0, 180.0]), 0.0875)).T
    np.testing.assert_allclose(low, 1.0, atol=0.01)
    assert high[0] == pytest.approx(2.0, abs=0.03)
    assert high[1] < 0.4 < high[2]


def test_a_mixed_block_is_the_convolution_with_the_head_s_response():
    """Against direct convolution with the response that the mixer gives a click from there."""
    noise = np.random.default_rng(3).standard_normal(2400).astype(np.float32)
    place = (0.6, 0.3, -0.7)
    click = np.zeros(16)
    click[0] = 1.0
    mixer = mixer_of({"click": click, "noise": noise})
    mixer.start("click", 0, place, 1.0)
    response = mixer.render(2400)
    mixer.start("noise", 2400 * 1_000_000_000 // RATE, place, 1.0)
    mixed = mixer.render(2400)
    for ear in range(2):
        direct = np.convolve(noise.astype(np.float64), response[:600, ear].astype(np.float64))[:2400]
        # what of a response reaches beyond what a block leaves comes round: white noise to the highest tone, -70 dB
        assert np.abs(mixed[:, ear] - direct).max() < 3e-4 * np.abs(direct).max()


def check_goals(head: HeadResponses, sofa) -> None:
    errors = hearing_errors(
        render_clicks(head.directions, sofa=sofa), RATE, head, lambda directions: render_clicks(directions, sofa=sofa)
    )
    assert errors.itd_median <= ITD_MEDIAN_US and errors.itd_max <= ITD_MAX_US, errors
    assert errors.itd_jump <= ITD_JUMP_US, errors
    assert errors.ild_median <= ILD_MEDIAN_DB and errors.ild_p95 <= ILD_P95_DB, errors


def test_delay_and_level_between_the_ears_are_those_of_the_loaded_head(tmp_path):
    """A head of 44.1 kHz from a SOFA file, all its directions."""
    head = some_head()
    check_goals(head, write_sofa(tmp_path / "head.sofa", head))


@pytest.mark.skipif(find_measured_head() is None, reason="no measured head: apt-get install libmysofa1")
def test_delay_and_level_between_the_ears_are_those_of_a_measured_head():
    path = find_measured_head()
    check_goals(read_sofa(path), path)


def test_the_figure_of_the_ears_shows_the_head_and_the_mixer_as_one():
    rows = errors_around_the_head().rows
    ways = {row["method"]: [] for row in rows}
    for row in rows:
        ways[row["method"]].append((row["x"], row["delay_us"], row["level_db"]))
    head, ours, openal = (np.array(sorted(points)) for points in ways.values())
    assert len(head) >= 36 and (head[:, 0] == ours[:, 0]).all()
    assert np.abs(head[:, 1] - ours[:, 1]).max() <= ITD_MAX_US < np.abs(head[:, 1] - openal[:, 1]).max()
    assert head[head[:, 0] > 0.0, 1][1:-1].min() > 0.0 > head[head[:, 0] < 0.0, 1][1:-1].max(), "right is positive"


def test_exchanged_ears_are_noticed():
    """The goals' test can fail: with left for right nothing of it holds."""
    head = some_head(RATE, 20, 0.152)
    rendered = render_clicks(head.directions)
    errors = hearing_errors(rendered[:, ::-1], RATE, head)
    assert errors.itd_median > 100.0 and errors.ild_median > 3.0
    assert (
        np.sign(level_differences(rendered, RATE)[:, 5]).tolist()
        != np.sign(level_differences(rendered[:, ::-1], RATE)[:, 5]).tolist()
    )


def test_a_wider_head_hears_a_longer_delay():
    """In proportion: 644 us of 152 mm, so 50 us more of 12 mm more."""
    right = np.array([[1.0, 0.0, 0.0]])
    delays = []
    for width in (0.152, 0.164):
        head = compute_head(width)
        near = int(np.argmax(head.directions @ right[0]))
        delays.append(float(delays_between_ears(head.responses[near : near + 1], head.rate)[0]))
    assert delays[1] / delays[0] == pytest.approx(164 / 152, rel=0.01)


def first_loud(mix: np.ndarray, begin: int, level: float) -> int:
    """Frame of the first sample beyond a level from `begin` on."""
    return begin + int(np.argmax(np.abs(mix[begin:]).max(axis=1) > level))


def test_100_random_events_begin_at_their_sample():
    """One constant from event to sample; with one of them a millisecond later the test sees it."""
    random = np.random.default_rng(5)
    times = [k * 50_000_000 + int(random.integers(0, 40_000_000)) for k in range(100)]
    mix, onsets = render_offline([SoundEvent("tick", t, AHEAD) for t in times], TICK, 5.1, mixer="spectral")
    frames = [(t * RATE + 500_000_000) // 1_000_000_000 for t in times]
    assert [onset - frame for onset, frame in zip(onsets, frames, strict=True)] == [BASE_DELAY] * 100
    level = 0.25 * float(np.abs(mix).max())
    heard = [first_loud(mix, max(0, onset - 400), level) - onset for onset in onsets]
    assert len(set(heard)) == 1 and 0 <= heard[0] <= 2


def test_a_dropped_and_a_shifted_event_are_seen():
    """The same measure on a mix with the 30th event missing and the 60th a millisecond late."""
    times = [k * 50_000_000 for k in range(100)]
    events = [SoundEvent("tick", t + (1_000_000 if k == 60 else 0), AHEAD) for k, t in enumerate(times) if k != 30]
    mix, _ = render_offline(events, TICK, 5.1, mixer="spectral")
    level = 0.25 * float(np.abs(mix).max())
    onsets = [t * RATE // 1_000_000_000 + BASE_DELAY for t in times]
    heard = [first_loud(mix, max(0, onset - 400), level) - onset for onset in onsets]
    wrong = [k for k, late in enumerate(heard) if not 0 <= late <= 2]
    assert wrong == [30, 60]
    assert heard[60] - heard[0] == RATE // 1000


def test_the_same_events_give_the_same_bytes_in_blocks_of_any_length():
    events = [SoundEvent("tick", k * 90_000_000, (math.sin(k), 0.2, -1.0)) for k in range(10)]
    digests = {
        hashlib.sha256(render_offline(events, TICK, 1.0, mixer="spectral")[0].tobytes()).hexdigest() for _ in "ab"
    }
    assert len(digests) == 1
    tone = np.random.default_rng(1).standard_normal(4000)
    whole, parts = mixer_of({"a": tone}), mixer_of({"a": tone})
    for mixer in (whole, parts):
        mixer.start("a", 3_000_000, (1.0, 0.0, 0.0), 0.5)
    together = np.concatenate([parts.render(n) for n in (1, 7, 240, 241, 500, 1011)])
    # what of a response reaches beyond what a block leaves, and comes round: -70 dB of a noise of 4 standard deviations
    np.testing.assert_allclose(together, whole.render(2000), atol=1.3e-3)


def high_band_dbfs(samples: np.ndarray) -> float:
    """Peak above 4 kHz [dBFS]: what of a click a 200 Hz tone does not hide; the record's ends are faded first."""
    fade = np.ones(len(samples))
    fade[:480] = 0.5 - 0.5 * np.cos(np.pi * np.arange(480) / 480)
    fade[-480:] = fade[:480][::-1]
    spectrum = np.fft.rfft(samples * fade)
    spectrum[np.fft.rfftfreq(len(samples), 1 / RATE) < 4000.0] = 0.0
    return 20.0 * math.log10(float(np.abs(np.fft.irfft(spectrum, len(samples))[600:-600]).max()) + 1e-12)


@pytest.mark.parametrize("change", ["gain", "stop", "jump of 90 degrees", "5 degrees a block"])
def test_nothing_clicks(change):
    tone = 0.25 * np.sin(2 * np.pi * 200 * np.arange(RATE) / RATE)
    mixer = mixer_of({"tone": tone}, specs={"tone": SoundSpec(loop=True)})
    handle = np.array([mixer.start("tone", 0, AHEAD, 1.0).handle])
    still = listener_amid(handle, np.array([AHEAD]))
    still.gain[:] = 1.0
    mixer.set_listener(still)
    parts = [mixer.render(4860)]  # ends inside a period of the tone, not at its zero
    if change == "gain":
        still.gain[:] = 0.1
        mixer.set_listener(still)
    elif change == "stop":
        mixer.stop(int(handle[0]))
    elif change == "jump of 90 degrees":
        still.position[:] = (1.0, 0.0, 0.0)
        mixer.set_listener(still)
    else:
        for block in range(1, 19):
            angle = math.radians(5.0 * block)
            still.position[:] = (math.sin(angle), 0.0, -math.cos(angle))
            mixer.set_listener(still)
            parts.append(mixer.render(240))
    parts.append(mixer.render(4800))
    mixed = np.concatenate(parts)
    assert max(high_band_dbfs(mixed[:, ear].astype(np.float64)) for ear in range(2)) <= RESIDUAL_DBFS
    if change == "stop":
        assert np.abs(mixed[-3000:]).max() < 1e-6


def test_a_turn_of_the_head_does_not_delay_a_live_block_and_sounds_reach_their_directions():
    """It brings new directions to all sounds at once, each of which takes up to a sixth of a live block's time."""
    tone = 0.1 * np.sin(2 * np.pi * 300 * np.arange(RATE) / RATE)
    bank, count = SoundBank({}, RATE), 24
    bank.sounds["tone"] = Sound(tone.astype(np.float32), SoundSpec(loop=True))
    settings = AudioSettings(sounds={}, triggers={}, scrape="", mixer="spectral")
    table = build_head_table(compute_head(settings.head_width, RATE), RATE)
    most, heard = [], []
    for live in (True, False):
        table.cells.filled[3:] = 0  # the first three are those of sounds without a direction
        mixer = SpectralMixer(bank, settings, Timing(), table, live=live)
        handles = np.array([mixer.start("tone", 0, AHEAD, 1.0).handle for _ in range(count)])
        new = []
        for block in range(20 + count):
            angle = 2.0 * np.pi * np.arange(count) / count + 0.03 * min(block, 20)
            places = np.stack((np.sin(angle), 0.0 * angle, -np.cos(angle)), axis=1)
            mixer.set_listener(listener_amid(handles, places))
            before = table.cells.filled.sum()
            mixer.render(80)
            new.append(table.cells.filled.sum() - before)
        most.append(max(new[1:]))
        heard.append(mixer.render(480))
    assert most[0] <= 2 < most[1]
    np.testing.assert_allclose(heard[0], heard[1], atol=1e-6)
