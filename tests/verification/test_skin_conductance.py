"""Skin conductance of known responses: slow rises, noise, coarse converters, slow sampling."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.dsp.channel import Event
from mimics_app.dsp.channels.gsr import Gsr
from mimics_app.dsp.filters import low_pass
from mimics_app.dsp.kernels.slow import TURN_STATE, find_responses

Floats = NDArray[np.float64]
ONSETS = (20.0, 38.0, 52.0, 71.0, 90.0)
FAST, SLOW = 0.9, 3.5
PEAK = float(np.log(SLOW / FAST) * SLOW * FAST / (SLOW - FAST))
"""Time from onset to peak [s]."""


def skin(rate: float, size: float = 0.4, seconds: float = 105.0, drift: float = 0.0) -> Floats:
    """A level of 6 uS, five responses, and a drift [uS/s]."""
    t = np.arange(round(seconds * rate)) / rate
    values = 6.0 + drift * t
    top = np.exp(-PEAK / SLOW) - np.exp(-PEAK / FAST)
    for onset in ONSETS:
        since = np.maximum(t - onset, 0.0)
        values += size / top * (np.exp(-since / SLOW) - np.exp(-since / FAST))
    return values


def measured(values: Floats, rate: int) -> tuple[list[Event], Floats]:
    """The events, and the quality of each second from the eleventh on."""
    channel = Gsr(float(rate))
    events, quality = [], []
    for begin in range(0, len(values) - rate + 1, rate):
        events += channel.push(values[begin : begin + rate])
        quality.append(channel.found.quality)
    return events, np.array(quality[10:])


def right(events: list[Event]) -> int:
    return sum(any(abs(event.t_s - onset - PEAK) < 1.2 for event in events) for onset in ONSETS)


@pytest.mark.parametrize("noise", [0.0, 0.0005, 0.001, 0.002])
@pytest.mark.parametrize("drift", [-0.005, 0.001, 0.002, 0.005, 0.007])
@pytest.mark.parametrize("size", [0.1, 0.6])
def test_responses_over_a_level_that_drifts(size: float, drift: float, noise: float) -> None:
    """The cleaner the amplifier, the more were lost: a slow rise before a response counted as its own."""
    values = skin(100, size, drift=drift)
    events, _ = measured(values + noise * np.random.default_rng(7).standard_normal(len(values)), 100)
    assert right(events) == len(ONSETS)
    assert len(events) <= len(ONSETS) + 2
    assert np.array([event.value for event in events if right([event])]) == pytest.approx(size, rel=0.3)


@pytest.mark.parametrize(("share", "wanted"), [(0.8, 0), (1.2, len(ONSETS))])
def test_a_response_smaller_than_the_smallest_is_none(share: float, wanted: int) -> None:
    """Rises without noise or drift, on either side of the limit."""
    out, least = np.zeros((16, 4)), 0.02
    x, state, sos = skin(100, share * least), np.zeros(1, TURN_STATE), low_pass(2, 2.0, 100.0)
    assert find_responses(x, sos, np.zeros((len(sos), 2)), state[0], 100.0, least, out, np.zeros_like(x)) == wanted


def test_the_onset_of_a_response() -> None:
    values, rate = skin(100), 100.0
    out, sos = np.zeros((16, 4)), low_pass(2, 2.0, rate)
    count = find_responses(
        values, sos, np.zeros((1, 2)), np.zeros(1, TURN_STATE)[0], rate, 0.02, out, np.zeros(len(values))
    )
    assert out[:count, 3] / rate == pytest.approx(ONSETS, abs=0.5)
    assert (out[:count, 0] - out[:count, 3]) / rate == pytest.approx(PEAK, abs=0.5)


@pytest.mark.parametrize(("rate", "noise"), [(4, 0.02), (16, 0.03), (50, 0.03), (50, 0.3), (50, 3.0), (250, 0.1)])
def test_noise_is_no_skin(rate: int, noise: float) -> None:
    """A wire without a person: no arousal may come of it, as its quality is bad and its responses are few."""
    values = 10.0 + noise * np.random.default_rng(2).standard_normal(105 * rate)
    events, quality = measured(values, rate)
    assert (quality < 0.2).mean() > 0.95
    assert len(events) <= 8


@pytest.mark.parametrize(("rate", "noise"), [(4, 0.001), (16, 0.003), (50, 0.005), (250, 0.01), (1000, 0.03)])
def test_a_little_noise_is_good_contact(rate: int, noise: float) -> None:
    values = skin(rate)
    events, quality = measured(values + noise * np.random.default_rng(2).standard_normal(len(values)), rate)
    assert quality.mean() > 0.8
    assert (right(events), len(events)) == (len(ONSETS), len(ONSETS))


@pytest.mark.parametrize(("rate", "step"), [(4, 0.0), (4, 0.01), (4, 0.02), (10, 0.01), (32, 0.02), (1000, 0.012)])
def test_coarse_but_right_conductance_is_good_contact(rate: int, step: float) -> None:
    """Wrist bands send four samples a second, small amplifiers steps of 0.01 to 0.02 uS."""
    values = skin(rate)
    if step:
        values = np.round(values / step) * step
    events, quality = measured(values, rate)
    assert (quality > 0.9).mean() > 0.95
    assert (right(events), len(events)) == (len(ONSETS), len(ONSETS))


@pytest.mark.parametrize("level", [0.0, np.nan, 200.0])
def test_an_open_electrode_is_bad_contact(level: float) -> None:
    _, quality = measured(np.full(4000, level), 100)
    assert (quality == 0.0).all()


def test_a_converter_that_hangs_is_bad_contact() -> None:
    """A fine one at once, a coarse one after a while: skin that rests for 40 s on one step is rare."""
    fine = skin(100)[:3000]
    _, quality = measured(np.append(fine, np.full(3000, fine[-1])), 100)
    assert (quality[25:] == 0.0).all()
    coarse = np.round(fine / 0.02) * 0.02
    _, quality = measured(np.append(coarse, np.full(9000, coarse[-1])), 100)
    assert (quality[65:] == 0.0).all()
