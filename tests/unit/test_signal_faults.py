"""Body signals with faults of the line: electrodes attached late or pulled off, gaps, and samples that are damaged."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mimics_app.dsp.channel import Channel
from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.dsp.channels.emg import Emg
from mimics_app.dsp.channels.gsr import Gsr
from mimics_app.dsp.channels.resp import Resp
from mimics_app.dsp.channels.speed import Speed
from tests.support.body_signals import body, f1, feed


@pytest.fixture(scope="module")
def minute() -> Any:
    return body(60)


@pytest.mark.parametrize("before", [np.nan, 0.0])
def test_the_levels_are_learnt_from_the_electrode_not_from_the_time_before_it(before: float, minute: Any) -> None:
    signals, truth = minute
    channel = Ecg(1000.0)
    events = feed(channel, np.concatenate([np.full(10_000, before), signals["ecg"]]), 20)
    assert f1([t + 10.0 for t in truth.beats if t > 5.0], [e.t_s for e in events if e.t_s > 15.0], 0.05) > 0.99
    assert channel.found.quality > 0.5


@pytest.mark.parametrize("gap", [np.nan, 0.0])
def test_after_half_a_minute_without_an_electrode_the_levels_are_learnt_anew(gap: float, minute: Any) -> None:
    """Behind it the heart is a thirtieth as large: with the old levels its beats would be noise."""
    signals, truth = minute
    ecg = signals["ecg"]
    begin = (len(ecg) + 35_000) / 1000.0
    events = feed(Ecg(1000.0), np.concatenate([ecg, np.full(35_000, gap), 0.03 * ecg]), 20)
    wanted = [begin + t for t in truth.beats if 4.0 < t < 15.0]
    assert f1(wanted, [e.t_s for e in events if begin + 4.0 < e.t_s < begin + 15.0], 0.05) > 0.9


@pytest.mark.parametrize("gap", [np.nan, 0.0])
def test_a_muscle_at_rest_is_at_rest_behind_a_missing_electrode(gap: float) -> None:
    rest = 0.004 * np.random.default_rng(1).standard_normal(10_000)
    late, pulled = Emg(1000.0), Emg(1000.0)
    assert not feed(late, np.concatenate([np.full(2000, gap), rest]), 20)
    feed(pulled, np.concatenate([rest, np.full(60_000, gap), rest]), 20)
    assert [channel.found.features["emg_active"] for channel in (late, pulled)] == [0.0, 0.0]


def test_an_artefact_leaves_nothing_in_the_envelope() -> None:
    """The sum over its window runs on: rounding errors of the largest number stayed in it, a third of the rest."""
    values = 0.003 * np.random.default_rng(1).standard_normal(20_000)
    marred = values.copy()
    marred[5000] = 1e6
    clean, after = Emg(1000.0), Emg(1000.0)
    feed(clean, values, 20)
    feed(after, marred, 20)
    assert after.found.features["emg"] == pytest.approx(clean.found.features["emg"], rel=1e-6)


def test_the_first_contact_of_the_skin_is_no_response(minute: Any) -> None:
    signals, truth = minute
    values = signals["gsr"][:12_000].copy()
    values[:500] = np.nan
    assert len(feed(Gsr(1000.0), values, 20)) <= sum(t < 12.0 for t in truth.responses)


def test_responses_are_counted_over_the_time_in_which_there_was_contact(minute: Any) -> None:
    """Of a minute without electrodes nothing is known: neither that there were responses nor that there were none."""
    channel = Gsr(1000.0)
    feed(channel, np.concatenate([minute[0]["gsr"], np.full(70_000, np.nan), minute[0]["gsr"][:5000]]), 100)
    assert channel.found.quality > 0.5
    assert "scr_rate" not in channel.found.features


def test_the_slope_of_the_level_is_that_of_time_over_losses_of_contact() -> None:
    """Nine seconds in fifteen without contact: the level rose by 1 uS a minute all the time."""
    times = np.arange(120_000) / 1000.0
    values = 5.0 + times / 60.0
    values[(times % 15.0 < 9.0) & (times > 30.0)] = np.nan
    channel = Gsr(1000.0)
    feed(channel, values, 100)
    assert channel.found.features["scl_slope"] == pytest.approx(1.0, rel=0.02)


def test_no_breath_lasts_over_a_gap(minute: Any) -> None:
    values = minute[0]["resp"].copy()
    values[20_000:22_000] = np.nan
    channel = Resp(1000.0)
    assert all(0.0 < event.value < 10.0 for event in feed(channel, values, 20))
    assert channel.found.features["breath_variability"] < 0.1


@pytest.mark.parametrize("bad", [np.inf, -1e300, 1e30])
@pytest.mark.parametrize("kind", [Ecg, Gsr, Emg, Resp])
def test_a_damaged_sample_counts_as_missing(kind: type[Channel], bad: float, minute: Any) -> None:
    values, missing = minute[0][kind.name].copy(), minute[0][kind.name].copy()
    values[20_000], missing[20_000] = bad, np.nan
    one, other = kind(1000.0), kind(1000.0)
    assert feed(one, values, 20) == feed(other, missing, 20)
    assert one.found == other.found


def test_speed_that_was_not_measured_is_not_zero() -> None:
    channel = Speed(60.0)
    feed(channel, np.where(np.arange(600) % 2, 0.2, np.nan), 1)
    assert channel.found.features["hand_speed"] == pytest.approx(0.2)
    assert channel.found.quality == 0.5
    nothing = Speed(60.0)
    feed(nothing, np.full(60, np.nan), 1)
    assert (nothing.found.quality, nothing.found.features) == (0.0, {})
