"""The streaming processing of body signals against what truly happened, whatever the blocks, gains and gaps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.dsp.channel import Channel
from mimics_app.dsp.channel_kinds import feature_units
from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.dsp.channels.emg import Emg
from mimics_app.dsp.channels.gsr import Gsr
from mimics_app.dsp.channels.resp import Resp
from mimics_app.dsp.rhythm import Rhythm
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.inputs.physio.simulated.signals import Disturbance
from mimics_app.lab.physio.detection import Annotated
from mimics_app.lab.physio.noise_study import noise_of, noise_rows
from tests.support.body_signals import body, f1, feed

REAL = Path(__file__).resolve().parents[3] / "shared" / "data" / "physio"


@pytest.fixture(scope="module")
def two_minutes() -> Any:
    return body(120, power=lambda s: 0.8 if s > 60 else 0.0)


@pytest.mark.parametrize("kind", [Ecg, Gsr, Emg, Resp])
def test_blocks_of_any_size_give_the_same_to_the_bit(kind: type[Channel], two_minutes: Any) -> None:
    values = two_minutes[0][kind.name][:30_000].copy()
    values[12_000:12_700] = np.nan
    one = kind(1000.0)
    events, found = feed(one, values, 1000), one.found
    for block in (7, 20, 3333):
        other = kind(1000.0)
        assert feed(other, values, block) == events
        assert other.found == found


@pytest.mark.parametrize("gap", ["missing", "flat"])
def test_an_interval_over_a_gap_is_none_in_blocks_of_any_size(gap: str) -> None:
    """Before the quality counts, and with the gap's end within a block."""
    ecg = body(12, 3)[0]["ecg"]
    ecg[1_300:4_500] = np.nan if gap == "missing" else ecg[1_300]
    events = feed(Ecg(1000.0), ecg, 1)
    after = next(event for event in events if event.t_s > 4.6)
    assert after.value == 0.0
    for block in (7, 1000, 12_000):
        assert feed(Ecg(1000.0), ecg, block) == events


@pytest.mark.parametrize(("begin", "end"), [(20_000, 21_700), (20_000, 26_000), (20_250, 22_750)])
def test_after_a_gap_the_rhythm_begins_anew(begin: int, end: int) -> None:
    """No beat is found within the gap, and the first interval that is whole is told."""
    ecg = body(30, 3)[0]["ecg"]
    ecg[begin:end] = np.nan
    beats = [(event.t_s, event.value) for event in feed(Ecg(1000.0), ecg, 20)]
    assert not [at for at, _ in beats if begin <= 1000.0 * at < end]
    after = [(at, interval) for at, interval in beats if 1000.0 * at >= end]
    assert after[0][1] == 0.0
    assert after[1][1] == pytest.approx(after[1][0] - after[0][0])


@pytest.mark.parametrize("kind", [Ecg, Gsr, Emg, Resp])
def test_what_was_saved_goes_on_to_the_bit(kind: type[Channel], two_minutes: Any) -> None:
    values = two_minutes[0][kind.name]
    channel = kind(1000.0)
    feed(channel, values[:33_333], 20)
    saved = channel.save()
    events = feed(channel, values[33_333:60_000], 20)
    found = channel.found
    other = kind(1000.0)
    other.restore(saved)
    assert feed(other, values[33_333:60_000], 20) == events
    assert other.found == found


def test_nothing_after_an_event_was_looked_at(two_minutes: Any) -> None:
    """Causal: with the signal cut off when an event is known, the same events are known."""
    values = two_minutes[0]["ecg"]
    events = feed(Ecg(1000.0), values, 20)
    for event in events[10:60:10]:
        cut = feed(Ecg(1000.0), values[: round(event.known_s * 1000.0)], 20)
        assert cut == events[: len(cut)]
        assert event in cut


@pytest.mark.parametrize(("kind", "gain"), [("clean", 1.0), ("clean", -1.0), ("clean", 10.0), ("ectopic", 1.0)])
def test_r_peaks(kind: str, gain: float) -> None:
    signals, truth = body(120, 3, Disturbance(ectopic=0.05) if kind == "ectopic" else None)
    events = feed(Ecg(1000.0), gain * signals["ecg"] + 5.0, 20)
    assert f1(truth.beats, [event.t_s for event in events], 0.05) > 0.99
    late = np.array([event.known_s - event.t_s for event in events[5:]])
    assert np.median(late) <= 0.15
    assert np.quantile(late, 0.95) <= 0.25


def test_a_lost_electrode_is_no_heart_beat(two_minutes: Any) -> None:
    signals, truth = two_minutes
    ecg = signals["ecg"].copy()
    ecg[40_000:60_000] = np.nan
    channel = Ecg(1000.0)
    events = feed(channel, ecg[:60_000], 20)
    assert not [event for event in events if 40.5 < event.t_s < 60.0]
    assert channel.found.quality == 0.0
    assert not channel.found.features
    events = feed(channel, ecg[60_000:], 20)
    assert channel.found.quality > 0.5
    assert f1([t for t in truth.beats if t > 63.0], [e.t_s for e in events if e.t_s > 63.0], 0.05) > 0.95


def test_a_flat_and_a_saturated_signal_are_reported() -> None:
    flat = Ecg(1000.0)
    feed(flat, np.zeros(5000), 20)
    assert flat.found.quality == 0.0
    signals, _ = body(20)
    railed = Ecg(1000.0)
    feed(railed, np.clip(signals["ecg"], -0.02, 0.02), 20)
    assert railed.found.quality < 0.5


@pytest.mark.skipif(not REAL.exists(), reason="the annotated records are not on this machine")
@pytest.mark.parametrize(
    ("record", "least"), [("mitdb_100", 0.999), ("mitdb_106", 0.99), ("mitdb_114", 0.99), ("nst_118e24", 0.99)]
)
def test_real_beats(record: str, least: float) -> None:
    data = np.load(REAL / f"{record}.npz")
    rate = int(data["fs"])
    values = data["ecg_adc"][: 120 * rate] / float(data["gain_per_mV"])
    beats = data["beats"][data["beats"] < 120 * rate] / rate
    found = feed(Ecg(float(rate)), values, max(1, rate // 50))
    assert f1(beats.tolist(), [event.t_s for event in found], 0.15) >= least


@pytest.mark.seconds
def test_the_table_of_noise_counts_every_kind_and_lays_what_two_excerpts_differ_by(tmp_path: Path) -> None:
    """A heart in two sizes of one noise: what is laid upon it anew is that noise, and more of it costs more beats."""
    signals, truth = body(20, 3)
    heart, beats = signals["ecg"], np.array(truth.beats)
    noise = 0.3 * np.sin(2.0 * np.pi * 11.0 * np.arange(len(heart)) / 1000.0 + np.cumsum(np.sin(np.arange(len(heart)))))
    sizes = {"mitdb_1": 0.0, "nst_118e00": 1.0, "nst_118e06": 10.0**-0.3, "nst_118e24": 10.0**-1.2}
    for name, size in sizes.items():
        values = {"ecg_adc": heart + size * noise, "gain_per_mV": 1.0, "fs": 1000, "beats": np.round(beats * 1000.0)}
        np.savez(tmp_path / f"{name}.npz", **values)
    rows = {row.kind: row for row in noise_rows(tmp_path)}
    assert rows["records as they are"].f1 > 0.95
    parts = [rows[f"noise stress test, {db} dB"] for db in ("00", "06", "24")]
    whole = rows["noise stress test, all"]
    assert (whole.beats, whole.missed, whole.invented) == tuple(
        sum(getattr(part, name) for part in parts) for name in ("beats", "missed", "invented")
    )
    assert rows["record 118, electrode noise added again, 4.6 dB"].beats == 20 * len(beats)
    assert all(0.0 <= row.worst <= row.f1 + 1e-12 <= 1.0 + 1e-12 for row in rows.values())
    laid = noise_of(*(Annotated(name, 1000.0, heart + sizes[name] * noise, beats) for name in list(sizes)[1:3]))
    np.testing.assert_allclose(laid, noise, atol=1e-9)


def test_a_record_without_a_beat_that_is_found_has_no_latency(tmp_path: Path) -> None:
    flat = {"ecg_adc": np.zeros(20_000), "gain_per_mV": 1.0, "fs": 1000, "beats": np.arange(1000.0, 19_000.0, 800.0)}
    np.savez(tmp_path / "flat.npz", **flat)
    row = next(noise_rows(tmp_path))
    assert (row.missed, row.f1) == (row.beats, 0.0)
    assert np.isnan(row.latency_ms["p50"]) and np.isnan(row.latency_ms["p95"])


def test_variability_of_intervals_that_are_known() -> None:
    """RMSSD of an alternation between two lengths is their difference; SDNN half of it."""
    rhythm, t = Rhythm(), 0.0
    for i in range(90):
        t += 0.82 if i % 2 else 0.78
        rhythm.beat(t)
    found = rhythm.features(t)
    assert found["rmssd"] == pytest.approx(40.0, abs=1e-6)
    assert found["sdnn"] == pytest.approx(20.0, rel=0.02)
    assert found["heart_rate"] == pytest.approx(75.0, rel=0.01)
    assert found["pnn50"] == 0.0


def test_a_step_over_an_interval_that_is_left_out_is_none() -> None:
    rhythm, t = Rhythm(), 0.0
    for i in range(70):
        t += 0.7 + 0.002 * i
        if i % 10 != 9:  # every tenth beat is missed
            rhythm.beat(t)
    found = rhythm.features(t)
    assert rhythm.counts["missed"] >= 5
    assert found["rmssd"] == pytest.approx(2.0, abs=1e-6)


def test_a_known_slow_wave_is_found_in_its_band() -> None:
    rhythm, t = Rhythm(), 0.0
    while t < 190.0:
        t += 0.8 + 0.03 * np.sin(2.0 * np.pi * 0.1 * t)
        rhythm.beat(t)
    found = rhythm.features(t)
    assert found["lf"] == pytest.approx(0.5 * 30.0**2, rel=0.1)
    assert found["lf_hf"] > 10.0


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_early_and_missed_beats_do_not_pass_for_variability(share: float) -> None:
    rng = np.random.default_rng(5)
    clean, marred, t = Rhythm(), Rhythm(), 0.0
    for i in range(75):
        t += 0.8 + 0.02 * rng.standard_normal()
        clean.beat(t)
        early = i > 10 and rng.random() < share
        marred.beat(t - 0.3 if early else t)
    wanted, found = clean.features(t)["rmssd"], marred.features(t)["rmssd"]
    assert found == pytest.approx(wanted, rel=0.1 if share else 1e-12)
    assert (marred.counts["ectopic"] > 0) == (share > 0.0)


def test_a_beat_that_is_late_on_its_own_is_none_of_the_variability() -> None:
    """No short interval before it tells it, and it is no beat that was missed."""
    rng = np.random.default_rng(5)
    intervals = 0.8 + 0.02 * rng.standard_normal(75)
    clean, marred = Rhythm(), Rhythm()
    late = intervals.copy()
    late[40] = 1.15
    for rhythm, lengths in ((clean, intervals), (marred, late)):
        for t in np.cumsum(lengths):
            rhythm.beat(float(t))
    assert marred.counts["ectopic"] == 1 and clean.counts["ectopic"] == 0
    now = float(np.sum(late))
    assert marred.features(now)["rmssd"] == pytest.approx(clean.features(now - 0.35)["rmssd"], rel=0.1)


def test_skin_responses() -> None:
    signals, truth = body(300, 4, demand=lambda s: 0.9 if s > 60 else float("nan"))
    events = feed(Gsr(1000.0), signals["gsr"], 20)
    assert len(truth.responses) > 20
    assert f1(truth.responses, [event.t_s for event in events], 1.0) > 0.9
    assert np.median([event.known_s - event.t_s for event in events]) <= 0.5


@pytest.mark.parametrize("seed", [2, 5])
def test_skin_responses_of_others(seed: int) -> None:
    signals, truth = body(150, seed, demand=lambda s: 0.6)
    events = feed(Gsr(1000.0), signals["gsr"], 1000)
    assert f1(truth.responses, [event.t_s for event in events], 1.0) >= 0.9


def test_breath_rate(two_minutes: Any) -> None:
    """Every second from half a minute on, against the breaths that began in the 25 s before."""
    signals, truth = two_minutes
    channel, away = Resp(1000.0), []
    for second in range(120):
        feed(channel, signals["resp"][1000 * second : 1000 * second + 1000], 1000)
        recent = [t for t in truth.breaths if second - 25.0 < t <= second]
        if second >= 30:
            away.append(channel.found.features["breath_rate"] - 60.0 / np.mean(np.diff(recent)))
    assert np.mean(np.abs(away)) <= 0.5


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_muscle_onsets(seed: int) -> None:
    rng = np.random.default_rng(seed)
    noise = np.diff(rng.standard_normal(40_001))
    wanted = [5.0 + 3.5 * i for i in range(10)]
    size = np.full(40_000, 0.01)
    for onset in wanted:
        size[round(1000 * onset) : round(1000 * onset) + 1500] = 0.05
    events = feed(Emg(1000.0), noise * size, 20)
    assert len(events) == len(wanted)
    away = np.array([event.t_s for event in events]) - wanted
    assert np.abs(away).mean() <= 0.03
    assert np.median([event.known_s for event in events] - np.array(wanted)) <= 0.1


def test_a_tired_muscle_has_a_lower_median_frequency() -> None:
    rng = np.random.default_rng(2)
    fresh = rng.standard_normal(30_000)
    tired = np.convolve(fresh, np.ones(4) / 2.0, "same")
    medians = []
    for values in (fresh, tired):
        channel = Emg(1000.0)
        feed(channel, np.concatenate([0.01 * rng.standard_normal(3000), values]), 20)
        medians.append(channel.found.features["emg_median_hz"])
    assert medians[1] < 0.7 * medians[0]


def test_a_signal_that_stops_says_nothing_any_more(two_minutes: Any) -> None:
    dsp = PhysioDsp()
    for second in range(60):
        piece = two_minutes[0]["ecg"][1000 * second : 1000 * second + 1000]
        frame = dsp.process([SignalBlock("ecg", 1000.0, second * 10**9, piece)], (second + 1) * 10**9)
    assert "heart_rate" in frame.values
    for second in range(61, 66):
        frame = dsp.process([], second * 10**9)
    assert frame.quality["ecg"] == 0.0
    assert "heart_rate" not in frame.values


def test_the_stage_goes_on_from_what_was_saved(two_minutes: Any) -> None:
    def second(i: int) -> list[SignalBlock]:
        return [SignalBlock(n, 1000.0, i * 10**9, v[1000 * i : 1000 * i + 1000]) for n, v in two_minutes[0].items()]

    one, other = PhysioDsp(), PhysioDsp()
    for i in range(40):
        one.process(second(i), i * 10**9)
    other.restore(one.save())
    for i in range(40, 60):
        assert one.process(second(i), i * 10**9) == other.process(second(i), i * 10**9)
    json.dumps(dict(one.process([], 61 * 10**9).values), allow_nan=False)


def test_every_feature_has_a_unit() -> None:
    """Four minutes give all of them: variability needs two, fatigue a muscle that is active after a rest."""
    signals, _ = body(240)
    rng = np.random.default_rng(3)
    signals["emg"] = rng.standard_normal(240_000) * np.where(np.arange(240_000) < 3000, 0.01, 1.0)
    moving = {name: np.abs(rng.standard_normal(240_000)) for name in ("speed", "power", "leg_power", "head")}
    dsp, names = PhysioDsp(), set[str]()
    for i in range(240):
        second = slice(1000 * i, 1000 * i + 1000)
        blocks = [SignalBlock(name, 1000.0, i * 10**9, v[second]) for name, v in (signals | moving).items()]
        names |= set(dsp.process(blocks, (i + 1) * 10**9).values)
    assert names == set(feature_units())


@pytest.mark.parametrize("rate", [0.0, 50.0, 1e6])
def test_a_rate_that_cannot_be_is_refused(rate: float) -> None:
    with pytest.raises(DeviceError, match="Hz"):
        PhysioDsp().process([SignalBlock("ecg", rate, 0, np.zeros(4))], 0)


def test_a_rate_that_changes_is_refused() -> None:
    dsp = PhysioDsp()
    dsp.process([SignalBlock("ecg", 500.0, 0, np.zeros(4))], 0)
    with pytest.raises(DeviceError, match="from 500 Hz to 250 Hz"):
        dsp.process([SignalBlock("ecg", 250.0, 0, np.zeros(4))], 10**9)
