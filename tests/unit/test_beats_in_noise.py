"""R peaks under electrode motion: templates learnt while the signal is clear, noise whitened by a linear predictor."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import sosfilt

from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.dsp.filters import low_pass
from mimics_app.dsp.kernels.templates import COUNT, ENERGY, SIGNAL, WHITE, Bank, learn_beat, learn_noise, score, whiten
from mimics_app.inputs.physio.simulated.signals import Disturbance
from tests.support.body_signals import body, f1, feed

Floats = NDArray[np.float64]

CLEAR, END = 30, 90
"""Electrode motion begins and ends at these times [s]; the signal lasts half a minute longer."""


def electrode_motion(seconds: int, rate: float, size: float, seed: int = 1) -> Floats:
    """Waves of an electrode that is pushed twice a second and returns within a quarter of one, of that RMS [mV]."""
    rng, n = np.random.default_rng(seed), round(seconds * rate)
    pushes = np.where(rng.random(n) < 2.0 / rate, rng.standard_normal(n), 0.0)
    returns = np.exp(-np.arange(round(rate)) / (0.25 * rate))
    noise = sosfilt(low_pass(2, 12.0, rate), np.convolve(pushes, returns)[:n])
    return np.asarray(size * noise / noise.std())


@pytest.fixture(scope="module")
def moved() -> Any:
    """Two minutes with a minute of electrode motion, and the true beats."""
    signals, truth = body(END + 30, 5, Disturbance(ectopic=0.03))
    ecg = signals["ecg"].copy()
    ecg[CLEAR * 1000 : END * 1000] += electrode_motion(END - CLEAR, 1000.0, 8.0)
    return ecg, np.array(truth.beats)


def empty_bank(samples: int, forms: int, length: int, order: int = 0) -> Bank:
    """A bank without content."""
    shapes = (3, samples), (forms, length + order), (forms, length), (forms, 2), (order + 1, order + 1), (order + 1,)
    return Bank(*(np.zeros(shape) for shape in shapes))


def score_between(beats: Floats, found: list[Any], begin: float, end: float, offset: float = 0.0) -> float:
    times = [event.t_s + offset for event in found]
    return f1(beats[(beats > begin) & (beats < end)].tolist(), [t for t in times if begin < t < end], 0.1)


def test_what_was_learnt_while_clear_finds_the_beats_in_noise(moved: Any) -> None:
    """The same noise is much harder for a detector that never saw the beats without it."""
    ecg, beats = moved
    whole, late = feed(Ecg(1000.0), ecg, 20), feed(Ecg(1000.0), ecg[CLEAR * 1000 :], 20)
    knows = score_between(beats, whole, CLEAR + 5, END)
    assert knows > 0.95
    assert score_between(beats, late, CLEAR + 5, END, CLEAR) < knows - 0.1
    assert score_between(beats, whole, END + 5, END + 30) > 0.98


def test_blocks_and_a_restored_state_give_the_same_in_noise(moved: Any) -> None:
    ecg = moved[0][: 60 * 1000].copy()
    ecg[45_000:45_900] = np.nan
    whole = Ecg(1000.0)
    events = feed(whole, ecg, 1000)
    assert whole._forms.state["matched"] == 1.0, "this tests nothing unless templates decide"
    for block in (7, 3333):
        assert feed(Ecg(1000.0), ecg, block) == events
    begun, continued = Ecg(1000.0), Ecg(1000.0)
    feed(begun, ecg[:41_234], 20)
    continued.restore(begun.save())
    assert feed(continued, ecg[41_234:], 20) == [event for event in events if event.known_s > 41.234]


@pytest.mark.parametrize("rate", [200, 360, 2000])
def test_every_sampling_rate_has_the_same_templates(rate: int, moved: Any) -> None:
    ecg, beats = moved
    t = np.arange(round(len(ecg) / 1000.0 * rate)) / rate
    smooth = np.convolve(ecg, np.ones(max(1000 // rate, 1)) / max(1000 // rate, 1), "same")
    found = feed(Ecg(float(rate)), np.interp(t, np.arange(len(ecg)) / 1000.0, smooth), max(rate // 50, 1))
    assert score_between(beats, found, CLEAR + 5, END) > 0.93


def test_a_form_that_changes_in_noise_is_not_waited_for(moved: Any) -> None:
    """An electrode slips: beats of another form, not yet learnt, are found by energy as soon as the noise allows."""
    ecg, beats = moved
    changed = ecg.copy()
    heart = ecg.copy()
    heart[CLEAR * 1000 : END * 1000] -= electrode_motion(END - CLEAR, 1000.0, 8.0)
    slow = np.hanning(60) / np.hanning(60).sum()
    changed[50_000:] -= heart[50_000:] + 1.8 * np.convolve(heart, slow, "same")[50_000:]
    channel = Ecg(1000.0)
    found = feed(channel, changed, 20)
    assert score_between(beats, found, END + 10, END + 30) > 0.95


def test_the_error_filter_of_the_noise_is_that_of_its_process() -> None:
    """Noise of an autoregressive process of order two: its coefficients, and the variance of what drives it."""
    rng, n = np.random.default_rng(2), 4000
    bank = empty_bank(n, 1, 8, 4)
    signal = bank.rings[SIGNAL]
    for i in range(2, n):
        signal[i] = 1.5 * signal[i - 1] - 0.8 * signal[i - 2] + 0.1 * rng.standard_normal()
    for i in range(10, n):
        learn_noise(i, bank, 1.0 / (i - 9))
    variance = whiten(bank)
    assert bank.error == pytest.approx([1.0, -1.5, 0.8, 0.0, 0.0], abs=0.06)
    assert variance == pytest.approx(0.01, rel=0.06)


def test_beats_of_two_forms_have_two_templates() -> None:
    forms = np.sin(np.outer([1.0, 2.0], np.linspace(0.0, 2.0 * np.pi, 24)))
    bank = empty_bank(100, 3, 24)
    sizes = bank.sizes
    for k in (0, 1, 0, 0, 1):
        shift = 2 * k  # found two samples late: it is aligned
        bank.rings[SIGNAL] = 0.0
        bank.rings[SIGNAL, 40 - shift : 64 - shift] = forms[k]
        learn_beat(52 - shift if sizes[k, COUNT] == 0.0 else 52, bank, 12, 0.8, 0.1)
    assert bank.templates[:2] == pytest.approx(forms, abs=1e-12)
    assert sizes[:, COUNT] == pytest.approx([3 * 0.98, 2.0], rel=0.05) or sizes[2, COUNT] == 0.0


@pytest.mark.parametrize(("size", "worse"), [(0.0, True), (4.0, True), (-1.0, True), (1.1, False)])
def test_only_a_wave_of_the_size_of_a_beat_is_one(size: float, worse: bool) -> None:
    """A matched filter would take a wave four times as large for a very sure beat."""
    form = np.hanning(20)
    bank = empty_bank(40, 1, 20)
    bank.whitened[0] = form
    bank.sizes[0, COUNT], bank.sizes[0, ENERGY] = 20.0, form @ form
    background = 0.2 * np.random.default_rng(1).standard_normal(20)

    def at(factor: float) -> float:
        bank.rings[WHITE, 20:] = factor * form + background
        return score(39, bank, 0.04, 8.0, 5.0)

    assert (at(size) < 0.5 * at(1.0)) == worse


def known_late(found: list[Any], begin: float, end: float) -> float:
    """The 95th percentile of the time from an R peak to its detection [s]."""
    return float(np.quantile([event.known_s - event.t_s for event in found if begin < event.t_s < end], 0.95))


def test_beats_in_noise_are_known_within_a_quarter_of_a_second(moved: Any) -> None:
    """A doubtful beat waits for a better one that long, not until the next one is due."""
    assert known_late(feed(Ecg(1000.0), moved[0], 20), CLEAR + 5, END) < 0.25


def test_extrasystoles_of_a_form_not_learnt_are_known_as_soon_where_energy_is_reliable() -> None:
    """Moderate noise from the first second on: templates decide before there is one of the extrasystoles."""
    signals, truth = body(90, 9, Disturbance(ectopic=0.08))
    ecg, t = signals["ecg"] + 0.2 * np.random.default_rng(6).standard_normal(90_000), np.arange(90_000) / 1000.0
    for at in truth.ectopic:
        ecg += 1.5 * np.exp(-(((t - at) / 0.02) ** 2)) - 0.8 * np.exp(-(((t - at - 0.05) / 0.02) ** 2))
    found = feed(Ecg(1000.0), ecg, 20)
    others = [event for event in found if min(abs(event.t_s - at) for at in truth.ectopic) < 0.1]
    assert sum(event.t_s > 30.0 for event in others) >= 4
    assert known_late(others, 30.0, 90.0) < 0.25
    assert f1([at for at in truth.beats if at > 5.0], [event.t_s for event in found if event.t_s > 5.0], 0.1) > 0.98
