"""Heart rate variability and beats against NeuroKit2, whole-array and offline: the same windows of the same ECG."""

from __future__ import annotations

import csv
import gzip
from typing import Any

import numpy as np
import pytest

from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.inputs.physio.simulated.signals import Disturbance
from tests.support.body_signals import body, f1, feed
from tests.support.shared_data import shared_folder

nk = pytest.importorskip("neurokit2", reason="NeuroKit2 is a rival to measure against, not a part of the product")
RATE = 1000
ENDS = (70, 100, 130)


def ours_at(ecg: Any) -> list[tuple[float, float, float, float]]:
    """RMSSD, SDNN and first and last beat of their windows, at each of ENDS."""
    channel, found = Ecg(RATE), []
    for second in range(len(ecg) // RATE):
        feed(channel, ecg[RATE * second : RATE * second + RATE], 20)
        if second + 1 in ENDS:
            features = channel.rhythm.features(second + 1.0)
            times, lengths, _ = channel.rhythm.intervals(second + 1.0 - 60.0)
            found.append((features["rmssd"], features["sdnn"], times[0] - lengths[0], times[-1]))
    return found


def theirs(peaks: Any, first: float, last: float) -> tuple[float, float]:
    window = peaks[(peaks / RATE > first - 0.05) & (peaks / RATE < last + 0.05)]
    reported = nk.hrv_time(window, sampling_rate=RATE)
    return float(reported.HRV_RMSSD[0]), float(reported.HRV_SDNN[0])


def ecg_of(kind: str) -> Any:
    if kind.startswith("theirs"):
        seed = int(kind[-1])
        return nk.ecg_simulate(
            duration=132, sampling_rate=RATE, heart_rate=70, heart_rate_std=3, random_state=seed, method="ecgsyn"
        )
    return body(132, int(kind[-1]))[0]["ecg"]


@pytest.mark.parametrize("kind", ["ours 1", "ours 2", "ours 3", "theirs 1", "theirs 2"])
def test_variability_of_clean_signals_is_theirs(kind: str) -> None:
    ecg = ecg_of(kind)
    peaks = nk.ecg_peaks(nk.ecg_clean(ecg, sampling_rate=RATE), sampling_rate=RATE)[1]["ECG_R_Peaks"]
    for rmssd, sdnn, first, last in ours_at(ecg):
        assert (rmssd, sdnn) == pytest.approx(theirs(peaks, first, last), rel=0.02)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_early_beats_hardly_change_it(seed: int) -> None:
    """Against the true intervals between normal beats, by the definitions NeuroKit2 uses."""
    signals, truth = body(132, seed, Disturbance(ectopic=0.05))
    assert len(truth.ectopic) >= 3
    beats, early = np.array(truth.beats), np.isin(truth.beats, truth.ectopic)
    for rmssd, sdnn, first, last in ours_at(signals["ecg"]):
        inside = (beats > first - 0.05) & (beats < last + 0.05)
        lengths = 1e3 * np.diff(beats[inside])
        normal = ~(early[inside][1:] | early[inside][:-1])
        steps = np.diff(lengths)[normal[1:] & normal[:-1]]
        assert rmssd == pytest.approx(np.sqrt(np.mean(steps**2)), rel=0.1)
        assert sdnn == pytest.approx(np.std(lengths[normal], ddof=1), rel=0.1)


RECORDS = {
    "nk_bio_resting_5min_100hz": 100.0,
    "nk_bio_resting_8min_100hz": 100.0,
    "nk_bio_eventrelated_100hz": 100.0,
    "biosppy_ecg_1000hz": 1000.0,
}
"""Records without annotation on which no detector here was tuned, with their rates [Hz]."""
DETECTORS = ("neurokit", "pantompkins1985", "elgendi2010", "hamilton2002")


def record(name: str) -> Any:
    folder = shared_folder("physio")
    if name.startswith("biosppy"):
        return np.load(folder / f"{name}.npz")["adc"] - 2048.0
    with gzip.open(folder / f"{name}.csv.gz", "rt") as file:
        return np.array([float(row["ECG"]) for row in csv.DictReader(file)])


def agreed(ecg: Any, rate: float) -> Any:
    """Times at which at least three of four detectors find a beat within 150 ms [s]."""
    found = []
    for method in DETECTORS:
        cleaned = nk.ecg_clean(ecg, sampling_rate=int(rate), method=method)
        found.append(nk.ecg_peaks(cleaned, sampling_rate=int(rate), method=method)[1]["ECG_R_Peaks"] / rate)
    beats: list[float] = []
    for at in np.sort(np.concatenate(found)).tolist():
        near = [each[np.abs(each - at) < 0.15][:1] for each in found]
        if sum(map(len, near)) >= 3 and (not beats or at - beats[-1] > 0.25):
            beats.append(float(np.median(np.concatenate(near))))
    return np.array(beats)


@pytest.mark.parametrize("name", RECORDS)
def test_beats_of_records_nobody_tuned_on_are_those_most_detectors_find(name: str) -> None:
    ecg, rate = record(name), RECORDS[name]
    found = [event.t_s for event in feed(Ecg(rate), ecg, round(0.02 * rate))]
    assert f1(agreed(ecg, rate), found, 0.15) >= 0.985
