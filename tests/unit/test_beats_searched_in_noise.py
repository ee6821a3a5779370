"""R peaks of a signal that begins in noise: the form of the beats is searched along with their times."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.dsp.kernels.beat_path import PATH, PathModel, find_form, find_path
from mimics_app.dsp.kernels.form_tuning import TUNING
from mimics_app.inputs.physio.simulated.signals import Disturbance
from tests.support.body_signals import body, f1, feed

Floats = NDArray[np.float64]

RATE, SECONDS, PERIOD_S = 180.0, 10, 0.8
MODEL = PathModel(1.0, TUNING.freedom, RATE, 9, TUNING.spread, TUNING.missed)
ERROR = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
"""Error filter of noise that is white."""


def coloured_noise(seconds: int, rate: float, size: float, seed: int) -> Floats:
    """Noise whose power falls with the third power of the frequency from 1 Hz on, of that RMS [mV]."""
    n = round(seconds * rate)
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(n))
    noise = np.fft.irfft(spectrum / np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 1.0) ** 1.5, n)
    return np.asarray(size * noise / noise.std())


def buried(size: float, seed: int) -> tuple[Floats, Floats, list[int]]:
    """White noise of variance 1 with beats of one form, the form, and where each begins [samples]."""
    rng = np.random.default_rng(seed)
    signal, form = rng.standard_normal(round(SECONDS * RATE)), np.hanning(23) * np.sin(np.linspace(0.0, 7.0, 23))
    form *= size / np.sqrt(form @ form)
    begins, at = [], 0.3
    while at < SECONDS - 0.3:
        begins.append(round(at * RATE))
        signal[begins[-1] : begins[-1] + 23] += form
        at += PERIOD_S * (1.0 + 0.03 * rng.standard_normal())
    return signal, form, begins


def searched(signal: Floats, begin: int) -> tuple[Floats, Floats]:
    """Return the form that was found from the beat at a sample, and the description of its path."""
    form, path = signal[begin : begin + 23].copy(), np.zeros(1, PATH)[0]
    find_form(form, signal, signal, ERROR, MODEL, path)
    return form, path


@pytest.mark.parametrize("size", [2.5, 3.0])
def test_beats_are_found_where_the_signal_was_never_clear(size: float) -> None:
    """By energy alone F1 is .79 and .73."""
    signals, truth = body(60, 8, Disturbance())
    channel = Ecg(1000.0)
    found = [event.t_s for event in feed(channel, signals["ecg"] + coloured_noise(60, 1000.0, size, 8), 20)]
    assert channel._forms.state["matched"] == channel._forms.state["provisional"] == 1.0
    assert f1([t for t in truth.beats if t > 12.0], [t for t in found if t > 12.0], 0.1) > 0.9


def test_blocks_and_a_restored_state_give_the_same_while_forms_are_searched() -> None:
    ecg = body(40, 8, Disturbance())[0]["ecg"] + coloured_noise(40, 1000.0, 2.5, 8)
    ecg[25_000:25_900] = np.nan
    whole = Ecg(1000.0)
    events = feed(whole, ecg, 1000)
    assert whole._forms.state["provisional"] == 1.0, "this tests nothing unless forms are searched"
    assert feed(Ecg(1000.0), ecg, 7) == events
    begun, continued = Ecg(1000.0), Ecg(1000.0)
    feed(begun, ecg[:21_234], 20)
    continued.restore(begun.save())
    assert feed(continued, ecg[21_234:], 20) == [event for event in events if event.known_s > 21.234]


def test_a_form_with_much_evidence_is_not_replaced_by_waves_that_begin_later() -> None:
    """Waves larger than a beat, of one form and almost periodic, fit their own form better than the beats theirs."""
    signals, truth = body(60, 5, Disturbance())
    rng, ecg = np.random.default_rng(5), signals["ecg"].copy()
    ecg += 0.15 * rng.standard_normal(len(ecg))
    t = np.arange(-60, 60) / 1000.0
    wave = 1.2 * np.exp(-((t / 0.012) ** 2)) * np.cos(150.0 * t)
    for at in 30_000 + np.cumsum(550.0 * (1.0 + 0.02 * rng.standard_normal(40))).astype(int):
        ecg[at - 60 : at + 60] += wave
    channel = Ecg(1000.0)
    found = feed(channel, ecg[:30_000], 20)
    assert channel._forms.state["provisional"] == 1.0, "this tests nothing unless forms are searched"
    times = [event.t_s for event in found + feed(channel, ecg[30_000:52_000], 20)]
    assert f1([t for t in truth.beats if 32.0 < t < 51.0], [t for t in times if 32.0 < t < 51.0], 0.1) > 0.9


def test_one_beat_in_noise_leads_to_the_form_and_the_interval_of_all() -> None:
    """The first guess is as much noise as beat; the average of a dozen beats is not."""
    signal, form, begins = buried(6.0, 3)
    found, path = searched(signal, begins[4])
    guess = signal[begins[4] : begins[4] + 23]
    assert np.corrcoef(guess, form)[0, 1] < 0.85
    assert np.corrcoef(found, form)[0, 1] > 0.92
    assert path["evidence"] > TUNING.evidence
    assert path["period"] == pytest.approx(np.diff(begins).mean(), rel=0.01)
    assert path["beats"] == len(begins)


def test_noise_alone_is_no_evidence_of_beats() -> None:
    signal = np.random.default_rng(4).standard_normal(round(SECONDS * RATE))
    assert max(searched(signal, begin)[1]["evidence"] for begin in range(100, 1700, 80)) < TUNING.evidence


def test_a_path_passes_over_a_missing_beat_and_not_through_one_out_of_time() -> None:
    signal, form, begins = buried(8.0, 5)
    signal[begins[5] : begins[5] + 23] -= form
    extra = (begins[8] + begins[9]) // 2
    signal[extra : extra + 23] += form
    whitened, path = form[None, 4:].copy(), np.zeros(1, PATH)[0]
    find_path(whitened, np.zeros(1), signal, MODEL, path)
    assert path["beats"] == len(begins) - 1
    assert path["period"] == pytest.approx(np.diff(begins).mean(), rel=0.01)
