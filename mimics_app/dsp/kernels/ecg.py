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

import numpy as np

from mimics_app.contracts.kernel import kernel
from mimics_app.dsp.kernels.rhythm import LAST, RHYTHM, RR, add_beat, off_beat, steadiness
from mimics_app.dsp.kernels.sections import Floats, run_sections, settle_sections

__all__ = ["ECG_STATE", "find_beats"]

(
    SPK,
    NPK,
    CAND_T,
    CAND_V,
    SUM,
    BACK_T,
    BACK_V,
    N,
    HELD,
    MISSING,
    LEARNT,
    KEPT,
    LOW2,
    LOW4,
    HIGH2,
    HIGH4,
    UPPER,
    BEGIN,
) = range(RHYTHM, RHYTHM + 18)
ECG_STATE = RHYTHM + 18
"""Length of the state vector: the rhythm, signal level and noise level, candidate and its energy, running sum of
squares, best rejected candidate, samples seen, last valid input, consecutive NaN, whether the levels are learnt,
candidates kept until then, means of the second and fourth power of the lower and of the upper band, share of the upper
band in the filtered signal, sample at which the learning phase began."""

_NEVER = 10.0
"""Time since the last beat that is assumed before the first one [s]."""

_USUAL_RR = 0.8
"""Expected interval while none is known [s]."""

_NOISE_CAP = 0.8
"""Largest contribution of a rejected peak to the noise level, as a share of the signal level."""

_REFRACTORY = 0.36
"""A peak within this time of a beat [s] is its T wave, not a missed beat (Pan & Tompkins)."""

_TINY = 1e-12
"""Keeps a ratio of levels finite [mV]."""
_STILL = 1e-9
"""Energy of a flat line: no candidate lies below [mV]."""
_MOST_GAIN = 8.0
"""Largest gain that scales the upper band to the amplitude of the lower one."""
_LEAST_FACTOR = 0.1
"""Smallest threshold between the noise level (0) and the signal level (1), however well a peak is in time."""


@kernel
def find_beats(
    x: Floats,
    sos: Floats,
    z: Floats,
    state: Floats,
    ring: Floats,
    kept: Floats,
    rate: float,
    delays: Floats,
    tuning: Floats,
    wide: Floats,
    out: Floats,
) -> int:
    """Process samples and write the beats found.

    Args:
        x: New samples, shape [n]; NaN where the sensor gave none.
        sos: Lower, upper and wide band-pass as second order sections, shape [3, s, 6].
        z: Filter states, shape [3, s, 2].
        state: See ECG_STATE.
        ring: Ring buffer of band-passed samples, shape [1, m].
        kept: Candidates of the learning phase, shape [k, 2]: sample and energy.
        rate: Sampling rate [Hz].
        delays: Group delays of the band-passes [samples], shape [3].
        tuning: See `ecg.TUNING`.
        wide: Receives the samples filtered by the wide band-pass, shape [n or more].
        out: Beats, shape [b, 3]: sample of the R peak, sample at which it is known, its energy over the noise level.

    Returns:
        Number of beats written.
    """
    window, hold, dead, learn = tuning[0] * rate, tuning[1] * rate, tuning[2] * rate, tuning[3] * rate
    w, m, count = int(window), ring.shape[1], 0
    for i in range(x.shape[0]):
        value = x[i]
        if np.isnan(value):
            state[MISSING] += 1.0
            value = state[HELD]
        else:
            if state[MISSING] > 0.5 * rate or state[MISSING] == state[N]:
                for band in range(sos.shape[0]):
                    settle_sections(value, sos[band], z[band])
                if state[LEARNT] == 0.0:
                    state[LAST], state[BEGIN], state[KEPT] = -1.0, state[N], 0.0
                else:
                    state[LAST] = state[N]
            state[MISSING] = 0.0
            state[HELD] = value
        wide[i] = run_sections(value, sos[2], z[2])
        value = _blend(run_sections(value, sos[0], z[0]), run_sections(value, sos[1], z[1]), state, rate, tuning)
        n = int(state[N])
        old = ring[0, (n - w) % m]
        state[SUM] = max(state[SUM] + value * value - old * old, 0.0)
        ring[0, n % m] = value
        energy = np.sqrt(state[SUM] / w)
        state[N] += 1.0
        if n < w:
            continue
        delay = delays[0] + state[UPPER] * (delays[1] - delays[0])
        count = _follow(n, energy, state, ring, kept, hold, dead, learn, delay, tuning, rate, out, count)
    return count


@kernel
def _blend(low: float, high: float, state: Floats, rate: float, tuning: Floats) -> float:
    """Return the filtered signal: a crossfade from the lower band to the upper one where beats stand out only there.

    Beats are rare and high, noise is not: the measure is the kurtosis, the mean fourth power over the squared second.
    """
    weight = 1.0 / (tuning[25] * rate)
    for power, value in ((LOW2, low), (HIGH2, high)):
        square = value * value
        state[power] += weight * (square - state[power])
        state[power + 1] += weight * (square * square - state[power + 1])
    below = state[LOW4] / max(state[LOW2] * state[LOW2], _TINY * _TINY)
    above = state[HIGH4] / max(state[HIGH2] * state[HIGH2], _TINY * _TINY)
    share = min(max((tuning[26] - below) / (tuning[26] - tuning[27]), 0.0), 1.0)
    share *= min(max((above / max(below, _TINY) - tuning[28]) / (tuning[29] - tuning[28]), 0.0), 1.0)
    if state[N] - state[BEGIN] < tuning[3] * rate:
        share = 0.0
    state[UPPER] += (share - state[UPPER]) / (tuning[30] * rate)
    gain = min(np.sqrt(state[LOW2] / max(state[HIGH2], _TINY * _TINY)), _MOST_GAIN)
    return low + state[UPPER] * (gain * high - low)


@kernel
def _follow(
    n: int,
    energy: float,
    state: Floats,
    ring: Floats,
    kept: Floats,
    hold: float,
    dead: float,
    learn: float,
    delay: float,
    tuning: Floats,
    rate: float,
    out: Floats,
    count: int,
) -> int:
    """Track the energy to its next peak and classify it; return the number of beats written so far."""
    if energy > max(state[CAND_V], _STILL):
        state[CAND_V], state[CAND_T] = energy, n
    elif state[CAND_V] > 0.0 and (energy < tuning[4] * state[CAND_V] or n - state[CAND_T] > hold):
        t, v = int(state[CAND_T]), state[CAND_V]
        state[CAND_V] = 0.0
        if n - state[BEGIN] < learn:
            _keep(t, v, state, kept)
        else:
            count = _judge(t, v, n, state, ring, dead, delay, tuning, rate, out, count)
    if n - state[BEGIN] >= learn and state[LEARNT] == 0.0:
        count = _learn(n, state, ring, kept, dead, delay, tuning, rate, out, count)
    if state[RR] > 0.0 and state[BACK_V] > 0.0 and n - state[LAST] > tuning[5] * state[RR]:
        threshold = state[NPK] + tuning[6] * (state[SPK] - state[NPK])
        if state[BACK_V] > threshold:
            count = _accept(int(state[BACK_T]), state[BACK_V], n, state, ring, delay, tuning, rate, out, count)
        state[BACK_V] = 0.0
    if n - max(state[LAST], state[BEGIN] + learn) > 2.0 * rate:  # no beat for so long: the amplitude has dropped
        state[SPK] *= 1.0 - tuning[12] / rate
    return count


@kernel
def _keep(t: int, v: float, state: Floats, kept: Floats) -> None:
    k = int(state[KEPT])
    if k < kept.shape[0]:
        kept[k, 0], kept[k, 1] = t, v
        state[KEPT] += 1.0


@kernel
def _learn(
    n: int,
    state: Floats,
    ring: Floats,
    kept: Floats,
    dead: float,
    delay: float,
    tuning: Floats,
    rate: float,
    out: Floats,
    count: int,
) -> int:
    """Set both levels from the candidates of the learning phase and classify these again; a flat line restarts it."""
    k = int(state[KEPT])
    if k == 0:
        state[BEGIN] = n
        return count
    state[LEARNT] = 1.0
    sizes = np.sort(kept[:k, 1])
    state[SPK], state[NPK] = tuning[13] * sizes[max(k - 2, 0)], 0.5 * sizes[k // 2]
    for j in range(k):
        count = _judge(int(kept[j, 0]), kept[j, 1], n, state, ring, dead, delay, tuning, rate, out, count)
    return count


@kernel
def _judge(
    t: int,
    v: float,
    n: int,
    state: Floats,
    ring: Floats,
    dead: float,
    delay: float,
    tuning: Floats,
    rate: float,
    out: Floats,
    count: int,
) -> int:
    """Classify a peak of the energy as a beat or as noise."""
    since = t - state[LAST] if state[LAST] >= 0.0 else _NEVER * rate
    if since < dead:
        return count
    expected = state[RR] if state[RR] > 0.0 else _USUAL_RR * rate
    share = min(since / expected, 2.0)
    factor = tuning[7] + (tuning[8] - tuning[7]) * max(1.0 - share / tuning[9], 0.0)
    factor = max(factor + _rhythm(off_beat(t, share, state), state, tuning), _LEAST_FACTOR)
    if v > state[NPK] + factor * (state[SPK] - state[NPK]):
        return _accept(t, v, n, state, ring, delay, tuning, rate, out, count)
    state[NPK] += tuning[11] * (min(v, _NOISE_CAP * state[SPK]) - state[NPK])
    if v > state[BACK_V] and since > _REFRACTORY * rate:
        state[BACK_V], state[BACK_T] = v, t
    return count


@kernel
def _trust(state: Floats, tuning: Floats) -> float:
    """Return the weight of the rhythm, 0 to 1: 0 where beats stand out clearly or the intervals are irregular."""
    clear = state[SPK] / max(state[NPK], _TINY)
    noisy = min(max((tuning[16] - clear) / (tuning[16] - tuning[17]), 0.0), 1.0)
    return noisy * steadiness(state, tuning[20])


@kernel
def _rhythm(off: float, state: Floats, tuning: Floats) -> float:
    """Return what the threshold is raised by for a peak at an offset from the expected beat; negative in time."""
    return _trust(state, tuning) * tuning[18] * (0.5 - np.exp(-((off / tuning[19]) ** 2)))


@kernel
def _accept(
    t: int,
    v: float,
    n: int,
    state: Floats,
    ring: Floats,
    delay: float,
    tuning: Floats,
    rate: float,
    out: Floats,
    count: int,
) -> int:
    """Write a beat and update the levels; its R peak is the largest deflection in the window of its energy."""
    m, best, at = ring.shape[1], -1.0, t
    for j in range(max(t - int(tuning[0] * rate), 0, n - m + 1), t + 1):
        if abs(ring[0, j % m]) > best:
            best, at = abs(ring[0, j % m]), j
    add_beat(t, state, _trust(state, tuning), rate, tuning)
    state[SPK] += tuning[10] * (min(v, tuning[15] * state[SPK]) - state[SPK])
    state[BACK_V] = 0.0
    if count < out.shape[0]:
        out[count, 0], out[count, 1], out[count, 2] = at - delay, n, v / max(state[NPK], _TINY)
        count += 1
    return count
