"""Causal R-peak detection, sample by sample: band-pass, short-time energy, adaptive threshold, rhythm model.

The energy of the QRS band is compared with a threshold between the signal level and the noise level. The threshold is
high just after a beat and decays until the next one is due, so that a T wave or a burst of noise in mid-cycle must be
as strong as a beat, while a weak beat in time is accepted. As the noise level approaches the signal level in a steady
rhythm, the timing of a peak counts for more than its amplitude. Electrode motion disturbs the lower band of the QRS,
muscle noise the upper one: the lower band is used, with a crossfade to the upper one where the beats stand out there
and not below. After Pan & Tompkins, IEEE TBME 32(3), 1985, with the time-dependent threshold of Engelse & Zeelenberg,
Computers in Cardiology, 1979.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.rhythm import RHYTHM, T_WAVE, USUAL_RR, add_beat, off_beat, steadiness
from mimics_app.dsp.kernels.sections import Floats, run_sections, start_steady

if TYPE_CHECKING:
    from mimics_app.dsp.record_types import EnergyStateRecord, Table

__all__ = ["ENERGY_STATE", "EnergyDetector", "Filters", "find_beats"]

ENERGY_STATE = np.dtype(
    [
        ("rhythm", RHYTHM),
        ("signal_level", "f8"),  # energy of a beat
        ("noise_level", "f8"),  # energy of a rejected peak
        ("candidate_at", "f8"),  # sample of the candidate
        ("candidate", "f8"),  # its energy; 0: none
        ("squares", "f8"),  # running sum of squares
        ("back_at", "f8"),  # sample of the best rejected candidate
        ("back", "f8"),  # its energy
        ("n", "f8"),  # samples seen
        ("held", "f8"),  # last valid input
        ("missing", "f8"),  # consecutive missing samples
        ("learnt", "f8"),  # 1: the levels are learnt
        ("kept", "f8"),  # candidates kept until then
        ("low2", "f8"),  # mean second power of the lower band
        ("low4", "f8"),  # ... fourth power
        ("high2", "f8"),  # mean second power of the upper band
        ("high4", "f8"),  # ... fourth power
        ("upper", "f8"),  # share of the upper band in the filtered signal
        ("begin", "f8"),  # sample at which the learning phase began
        ("found", "f8"),  # beats found in the newest samples
        ("same", "f8"),  # consecutive samples of one value
        ("far", "f8"),  # peaks in succession that are far above a signal level that faded in noise
        ("far_at", "f8"),  # sample of the last of them
        ("pairs", "f8"),  # share of the beats that a second peak follows
        ("paired", "f8"),  # 1: one followed the last beat
        ("last_beat", "f8"),  # energy of the last beat
        ("waiting_at", "f8"),  # sample of a peak that waits for a second one
        ("waiting", "f8"),  # its energy; 0: none
    ],
    align=True,
)
"""State of the detector by energy."""

_FLAT_S = 2.0
"""Time after which samples of one value are as good as missing [s]: a flat line is no heart at rest."""
_FORGET_S = 30.0
"""Time without a signal after which the levels are learnt anew [s]: the electrode may lie elsewhere."""

_FAR, _FAR_UNCLEAR, _FAR_COUNT, _FAR_S = 6.0, 3.0, 3.0, 3.0
"""So many peaks, each above so many signal levels and within so many seconds of the one before, are the heart again,
where the levels had faded to the noise: their ratio is below the second figure."""

_NEVER = 10.0
"""Time since the last beat that is assumed before the first one [s]."""

_NOISE_CAP = 0.8
"""Largest contribution of a rejected peak to the noise level, as a share of the signal level."""

_TINY = 1e-12
"""Keeps a ratio of levels finite [mV]."""
_STILL = 1e-9
"""Energy of a flat line: no candidate lies below [mV]."""
_MOST_GAIN = 8.0
"""Largest gain that scales the upper band to the amplitude of the lower one."""
_LEAST_FACTOR = 0.1
"""Smallest threshold between the noise level (0) and the signal level (1), however well a peak is in time."""


_PAIR_FROM, _PAIR_SIZE = 0.11, 0.5
"""A second peak later than this after a beat [s], within the refractory time, and at least so large a share of it in
energy is the QRS behind a P wave that is as steep: no T wave is."""
_PAIR_FOLLOW, _MOSTLY_PAIRS = 0.25, 0.75
"""Weight of a beat in the share of pairs, and share from which on a peak waits for the second one."""


class _Tuning(NamedTuple):
    """Parameters of the detector by energy.

    From a random search over the six MIT-BIH records with and without synthetic noise and the four of the noise stress
    test; those of the rhythm over the six with real electrode noise added, without the stress test; those of the bands
    by hand over simulated electrode noise alone (decision 203). docs/guide/physiology.md has the results for other
    records and other noise.
    """

    window_s: float = 0.101  # of the energy
    hold_s: float = 0.091  # a peak of the energy is complete when nothing larger followed for this time
    falls: float = 0.601  # ... or when the energy fell below this share of the peak
    refractory_s: float = 0.218
    learn_s: float = 3.0  # learning phase at the beginning: two beats of a slow heart
    late: float = 1.813  # mean intervals without a beat after which one is taken as missed
    back: float = 0.126  # search back: threshold for rejected peaks between noise level (0) and signal level (1)
    due: float = 0.45  # threshold between noise level (0) and signal level (1) when a beat is due
    after: float = 1.011  # ... and just after a beat
    decay: float = 1.242  # share of the mean interval in which it decays from the latter to the former
    signal_weight: float = 0.245  # of a new beat in the signal level
    noise_weight: float = 0.152  # of a rejected peak in the noise level
    fade_per_s: float = 0.024  # decay rate of the signal level without beats
    first: float = 1.0  # first signal level, as a share of the second largest candidate
    most: float = 1.625  # upper limit of a beat in its weight, in signal levels
    clear: float = 6.21  # ratio of signal level to noise level below which the rhythm begins to count
    unclear: float = 1.84  # ... and counts fully
    range: float = 1.1  # over which the rhythm moves the threshold, half up and half down, in units of the threshold
    width: float = 0.173  # of the window around an expected beat, as a share of the mean interval
    unsteady: float = 0.2  # relative deviation of the intervals at which the rhythm counts for nothing
    power_s: float = 4.0  # time constant of the powers of the two bands
    peaky: float = 12.0  # kurtosis of the lower band below which the crossfade to the upper one begins
    flat: float = 8.0  # ... and is limited by the next two values alone
    better: float = 1.0  # ratio of the kurtosis of the upper band to that of the lower one from which it begins
    best: float = 1.2  # ... and is complete
    crossfade_s: float = 1.0  # time constant of the crossfade


_TUNING = _Tuning()


class Filters(NamedTuple):
    """The band-passes of an ECG: lower and upper band of the QRS, and the wide one of its forms.

    Attributes:
        sos: Second order sections, shape [3, s, 6].
        z: Their states, shape [3, s, 2].
        delays: Group delays [samples], shape [3].
    """

    sos: Floats
    z: Floats
    delays: Floats


class EnergyDetector(NamedTuple):
    """The detector by energy.

    Attributes:
        state: See ENERGY_STATE, shape [1].
        ring: Ring buffer of band-passed samples, shape [m].
        kept: Candidates of the learning phase, shape [k, 2]: sample and energy.
        out: Beats found, shape [b, 3]: sample of the R peak, sample at which it is known, its energy over the noise.
        rate: Sampling rate [Hz].
    """

    state: Table[EnergyStateRecord]
    ring: Floats
    kept: Floats
    out: Floats
    rate: float


@kernel
def find_beats(x: Floats, filters: Filters, detector: EnergyDetector, wide: Floats, missing: Floats) -> int:
    """Process samples and write the beats found into `detector.out`.

    Args:
        x: New samples, shape [n]; NaN where the sensor gave none.
        filters: Band-passes.
        detector: The detector.
        wide: Receives the samples filtered by the wide band-pass, shape [n or more].
        missing: Receives for each sample how many up to it are missing in a row, shape [n or more].

    Returns:
        Number of beats written.
    """
    state, ring, rate = detector.state[0], detector.ring, detector.rate
    sos, z = filters.sos, filters.z
    w, m = int(_TUNING.window_s * rate), ring.shape[0]
    state.found = 0.0
    for i in range(x.shape[0]):
        value = _next_value(x[i], filters, state, rate)
        missing[i] = state.missing
        wide[i] = run_sections(value, sos[2], z[2])
        value = _blend(run_sections(value, sos[0], z[0]), run_sections(value, sos[1], z[1]), state, rate)
        n = int(state.n)
        old = ring[(n - w) % m]
        state.squares = max(state.squares + value * value - old * old, 0.0)
        ring[n % m] = value
        state.n += 1.0
        if n >= w:
            delay = filters.delays[0] + state.upper * (filters.delays[1] - filters.delays[0])
            _follow(n, np.sqrt(state.squares / w), delay, detector)
    return int(state.found)


@kernel
def _next_value(value: float, filters: Filters, state: EnergyStateRecord, rate: float) -> float:
    """Return the sample, or the last valid one where it is missing; after a gap filters and rhythm begin anew."""
    state.same = state.same + 1.0 if value == state.held else 0.0
    if np.isnan(value) or state.same > _FLAT_S * rate:
        state.missing += 1.0
        return state.held
    gap = state.missing
    if gap > 0.5 * rate or gap == state.n:
        for band in range(filters.sos.shape[0]):
            start_steady(value, filters.sos[band], filters.z[band])
        if state.learnt == 0.0 or gap > _FORGET_S * rate:
            state.rhythm.last, state.begin, state.kept, state.learnt = -1.0, state.n, 0.0, 0.0
            state.signal_level, state.noise_level, state.rhythm.rr, state.back = 0.0, 0.0, 0.0, 0.0
        else:
            state.rhythm.last = state.n
    state.missing, state.held = 0.0, value
    return value


@kernel
def _blend(low: float, high: float, state: EnergyStateRecord, rate: float) -> float:
    """Return the filtered signal: a crossfade from the lower band to the upper one where beats stand out only there.

    Beats are rare and high, noise is not: the measure is the kurtosis, the mean fourth power over the squared second.
    """
    weight = 1.0 / (_TUNING.power_s * rate)
    square = low * low
    state.low2 += weight * (square - state.low2)
    state.low4 += weight * (square * square - state.low4)
    square = high * high
    state.high2 += weight * (square - state.high2)
    state.high4 += weight * (square * square - state.high4)
    below = state.low4 / max(state.low2 * state.low2, _TINY * _TINY)
    above = state.high4 / max(state.high2 * state.high2, _TINY * _TINY)
    share = min(max((_TUNING.peaky - below) / (_TUNING.peaky - _TUNING.flat), 0.0), 1.0)
    share *= min(max((above / max(below, _TINY) - _TUNING.better) / (_TUNING.best - _TUNING.better), 0.0), 1.0)
    if state.n - state.begin < _TUNING.learn_s * rate:
        share = 0.0
    state.upper += (share - state.upper) / (_TUNING.crossfade_s * rate)
    gain = min(np.sqrt(state.low2 / max(state.high2, _TINY * _TINY)), _MOST_GAIN)
    return low + state.upper * (gain * high - low)


@kernel
def _follow(n: int, energy: float, delay: float, detector: EnergyDetector) -> None:
    """Track the energy to its next peak and classify it."""
    state, rate = detector.state[0], detector.rate
    learn = _TUNING.learn_s * rate
    if energy > max(state.candidate, _STILL):
        state.candidate, state.candidate_at = energy, n
    elif state.candidate > 0.0 and (
        energy < _TUNING.falls * state.candidate or n - state.candidate_at > _TUNING.hold_s * rate
    ):
        t, v = int(state.candidate_at), state.candidate
        state.candidate = 0.0
        if n - state.begin < learn:
            _keep(t, v, state, detector.kept)
        else:
            _classify(t, v, n, delay, detector)
    _end_wait(n, delay, detector)
    if n - state.begin >= learn and state.learnt == 0.0:
        _learn(n, delay, detector)
    if state.rhythm.rr > 0.0 and state.back > 0.0 and n - state.rhythm.last > _TUNING.late * state.rhythm.rr:
        threshold = state.noise_level + _TUNING.back * (state.signal_level - state.noise_level)
        if state.back > threshold:
            _accept(int(state.back_at), state.back, n, delay, detector)
        state.back = 0.0
    quiet = n - max(state.rhythm.last, state.begin + learn) > 2.0 * rate
    if quiet and state.missing == 0.0:  # no beat for so long: the amplitude has dropped
        state.signal_level *= 1.0 - _TUNING.fade_per_s / rate


@kernel
def _keep(t: int, v: float, state: EnergyStateRecord, kept: Floats) -> None:
    k = int(state.kept)
    if k < kept.shape[0]:
        kept[k, 0], kept[k, 1] = t, v
        state.kept += 1.0


@kernel
def _learn(n: int, delay: float, detector: EnergyDetector) -> None:
    """Set both levels from the candidates of the learning phase and classify these again; a flat line restarts it."""
    state, kept = detector.state[0], detector.kept
    k = int(state.kept)
    if k == 0:
        state.begin = n
        return
    state.learnt = 1.0
    sizes = np.sort(kept[:k, 1])
    state.signal_level, state.noise_level = _TUNING.first * sizes[max(k - 2, 0)], 0.5 * sizes[k // 2]
    for j in range(k):
        _classify(int(kept[j, 0]), kept[j, 1], n, delay, detector)


@kernel
def _classify(t: int, v: float, n: int, delay: float, detector: EnergyDetector) -> None:
    """Classify a peak of the energy as a beat or as noise."""
    state, rate = detector.state[0], detector.rate
    if state.waiting > 0.0:
        if _is_second(t - state.waiting_at, v, state.waiting, rate):
            _note_pair(1.0, state)
            state.waiting = 0.0
            _accept(t, v, n, delay, detector)
        return
    since = t - state.rhythm.last if state.rhythm.last >= 0.0 else _NEVER * rate
    if state.paired == 0.0 and _is_second(since, v, state.last_beat, rate):
        state.paired = 1.0
        _note_pair(1.0, state)
    if since < _TUNING.refractory_s * rate:
        return
    expected = state.rhythm.rr if state.rhythm.rr > 0.0 else USUAL_RR * rate
    share = min(since / expected, 2.0)
    factor = _TUNING.due + (_TUNING.after - _TUNING.due) * max(1.0 - share / _TUNING.decay, 0.0)
    factor = max(factor + _rhythm(off_beat(t, share, state.rhythm), state), _LEAST_FACTOR)
    if v > state.noise_level + factor * (state.signal_level - state.noise_level):
        _rise_from_noise(t, v, state, rate)
        _accept_or_wait(t, v, n, delay, detector)
        return
    state.noise_level += _TUNING.noise_weight * (min(v, _NOISE_CAP * state.signal_level) - state.noise_level)
    if v > state.back and since > T_WAVE * rate:
        state.back, state.back_at = v, t


@kernel
def _is_second(since: float, v: float, first: float, rate: float) -> bool:
    """Return whether a peak is the QRS behind a P wave that was taken for the beat."""
    return _PAIR_FROM * rate < since < _TUNING.refractory_s * rate and v > _PAIR_SIZE * first > 0.0


@kernel
def _note_pair(share: float, state: EnergyStateRecord) -> None:
    state.pairs += _PAIR_FOLLOW * (share - state.pairs)


@kernel
def _accept_or_wait(t: int, v: float, n: int, delay: float, detector: EnergyDetector) -> None:
    """Take a peak as a beat, or wait for the second one where most beats are pairs."""
    state = detector.state[0]
    if state.paired == 0.0:
        _note_pair(0.0, state)
    if state.pairs > _MOSTLY_PAIRS:
        state.waiting_at, state.waiting = t, v
        return
    _accept(t, v, n, delay, detector)
    state.paired, state.last_beat = 0.0, v


@kernel
def _end_wait(n: int, delay: float, detector: EnergyDetector) -> None:
    """Take the peak that waits as the beat when no second one came."""
    state = detector.state[0]
    if state.waiting > 0.0 and n - state.waiting_at > (_TUNING.refractory_s + _TUNING.hold_s) * detector.rate:
        _note_pair(0.0, state)
        v, state.waiting = state.waiting, 0.0
        _accept(int(state.waiting_at), v, n, delay, detector)


@kernel
def _rise_from_noise(t: int, v: float, state: EnergyStateRecord, rate: float) -> None:
    """Set the signal level anew where an electrode is back after noise in which it had faded to nothing."""
    again = state.far > 0.0 and t - state.far_at < _FAR_S * rate
    faded = again or state.signal_level < _FAR_UNCLEAR * state.noise_level
    if not faded or v < _FAR * state.signal_level:
        return
    state.far = state.far + 1.0 if again else 1.0
    state.far_at = t
    if state.far >= _FAR_COUNT:
        state.signal_level, state.far = v, 0.0


@kernel
def _trust(state: EnergyStateRecord) -> float:
    """Return the weight of the rhythm, 0 to 1: 0 where beats stand out clearly or the intervals are irregular."""
    clear = state.signal_level / max(state.noise_level, _TINY)
    noisy = min(max((_TUNING.clear - clear) / (_TUNING.clear - _TUNING.unclear), 0.0), 1.0)
    return noisy * steadiness(state.rhythm, _TUNING.unsteady)


@kernel
def _rhythm(off: float, state: EnergyStateRecord) -> float:
    """Return what the threshold is raised by for a peak at an offset from the expected beat; negative in time."""
    return _trust(state) * _TUNING.range * (0.5 - np.exp(-((off / _TUNING.width) ** 2)))


@kernel
def _accept(t: int, v: float, n: int, delay: float, detector: EnergyDetector) -> None:
    """Write a beat and update the levels; its R peak is the largest deflection in the window of its energy."""
    state, ring, out = detector.state[0], detector.ring, detector.out
    m, best, at = ring.shape[0], -1.0, t
    for j in range(max(t - int(_TUNING.window_s * detector.rate), 0, n - m + 1), t + 1):
        if abs(ring[j % m]) > best:
            best, at = abs(ring[j % m]), j
    add_beat(t, state.rhythm, _trust(state), detector.rate)
    state.signal_level += _TUNING.signal_weight * (min(v, _TUNING.most * state.signal_level) - state.signal_level)
    state.back = 0.0
    count = int(state.found)
    if count < out.shape[0]:
        out[count, 0], out[count, 1], out[count, 2] = at - delay, n, v / max(state.noise_level, _TINY)
        state.found += 1.0
