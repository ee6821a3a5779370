"""Causal R peaks, sample by sample: band-pass, short-time energy, and a threshold that knows the rhythm.

The energy of the QRS band is compared with a level between those of the last beats and of what lies between them; the
level is high just after a beat and sinks until the next one is due, so that a T wave or a burst of noise in mid-cycle
must be as strong as a beat, while a weak beat that comes in time is taken. As far as noise comes near the beats and the
rhythm is steady, when a peak comes counts for more than how strong it is. After Pan & Tompkins, IEEE TBME 32(3), 1985,
with the time-dependent threshold of Engelse & Zeelenberg, Computers in Cardiology, 1979.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.kernel import kernel

__all__ = ["ECG_STATE", "find_beats"]

Floats = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

SPK, NPK, LAST, CAND_T, CAND_V, RR, SUM, BACK_T, BACK_V, N, HELD, MISSING, LEARNT, KEPT, UNSTEADY, PHASE = range(16)
ECG_STATE = 16
"""Length of the state vector: levels of beats and of noise, sample of the last beat, the candidate and its energy, mean
RR, running sum of squares, best refused candidate, samples seen, last good input, NaN in a row, whether the levels are
learnt, candidates kept until then, mean share by which intervals differ from the usual one, sample of the last beat of
the rhythm itself."""

_NEVER = 10.0
"""So long ago counts the last beat where there was none [s]."""

_USUAL_RR, _LONGEST_RR = 0.8, 1.2
"""The interval expected where none is known, and the longest that is believed of the first one [s]."""

_NOISE_CAP = 0.8
"""A refused peak counts for the level of noise with this share of the level of beats at most."""

_REFRACTORY = 0.36
"""A peak within this time of a beat [s] is its T wave and no missed beat (Pan & Tompkins)."""

_FASTEST_RR, _MISSED_RR = 0.25, 1.7
"""An interval is believed from this time [s] on, and below so many mean ones: else a beat was made up or missed."""

_DOUBTFUL_SHARE, _DOUBTFUL_RR = 0.05, 2.0
"""An interval that is not believed moves the mean by this share, and counts as so long at most [s]."""

_TINY = 1e-12
"""Keeps a ratio of levels finite [mV]."""
_FOLLOW = 0.1
"""Weight of a new interval in how unsteady the rhythm is."""
_LEAST_FACTOR = 0.1
"""The threshold stays so far of the way to the beats above the noise, however well a peak is in time."""
_MOST_UNSTEADY = 0.5
"""An interval differs from the usual one by at most this share of it."""


@kernel
def find_beats(
    x: Floats,
    sos: Floats,
    z: Floats,
    state: Floats,
    ring: Floats,
    kept: Floats,
    rate: float,
    delay: float,
    tuning: Floats,
    out: Floats,
) -> int:
    """Take samples and write beats.

    Args:
        x: New samples, shape [n]; NaN where the sensor gave none.
        sos: Band-pass, second order sections, shape [s, 6].
        z: Its state, shape [s, 2].
        state: See ECG_STATE.
        ring: The last band-passed samples and their squares' window, shape [2, m].
        kept: Candidates of the first seconds, shape [k, 2]: sample and energy.
        rate: [Hz]
        delay: Of the band-pass [samples].
        tuning: See `ecg.TUNING`.
        out: Beats, shape [b, 3]: sample of the R peak, sample at which it is known, its energy over the noise's.

    Returns:
        How many beats were written.
    """
    window, hold, dead, learn = tuning[0] * rate, tuning[1] * rate, tuning[2] * rate, tuning[3] * rate
    w, m, count = int(window), ring.shape[1], 0
    for i in range(x.shape[0]):
        value = x[i]
        if np.isnan(value):
            state[MISSING] += 1.0
            value = state[HELD]
        else:
            if state[MISSING] > 0.5 * rate or state[N] == 0.0:
                _settle(value, sos, z)
                state[LAST] = -1.0 if state[N] == 0.0 else state[N]
            state[MISSING] = 0.0
            state[HELD] = value
        for s in range(sos.shape[0]):
            y = sos[s, 0] * value + z[s, 0]
            z[s, 0] = sos[s, 1] * value - sos[s, 4] * y + z[s, 1]
            z[s, 1] = sos[s, 2] * value - sos[s, 5] * y
            value = y
        n = int(state[N])
        old = ring[0, (n - w) % m]
        state[SUM] = max(state[SUM] + value * value - old * old, 0.0)
        ring[0, n % m] = value
        energy = np.sqrt(state[SUM] / w)
        state[N] += 1.0
        if n < w:
            continue
        count = _follow(n, energy, state, ring, kept, hold, dead, learn, delay, tuning, rate, out, count)
    return count


@kernel
def _settle(value: float, sos: Floats, z: Floats) -> None:
    """Put the filter where a constant input would have brought it: all sections after the first see zero."""
    for s in range(sos.shape[0]):
        gain = (sos[s, 0] + sos[s, 1] + sos[s, 2]) / (1.0 + sos[s, 4] + sos[s, 5])
        y = gain * value
        z[s, 1] = sos[s, 2] * value - sos[s, 5] * y
        z[s, 0] = sos[s, 1] * value - sos[s, 4] * y + z[s, 1]
        value = y


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
    """Follow the energy to its next peak and judge it; beats written so far."""
    if energy > state[CAND_V]:
        state[CAND_V], state[CAND_T] = energy, n
    elif state[CAND_V] > 0.0 and (energy < tuning[4] * state[CAND_V] or n - state[CAND_T] > hold):
        t, v = int(state[CAND_T]), state[CAND_V]
        state[CAND_V] = 0.0
        if n < learn:
            _keep(t, v, state, kept)
        else:
            count = _judge(t, v, n, state, ring, dead, delay, tuning, rate, out, count)
    if n >= learn and state[LEARNT] == 0.0:
        count = _learn(n, state, ring, kept, dead, delay, tuning, rate, out, count)
    if state[RR] > 0.0 and state[BACK_V] > 0.0 and n - state[LAST] > tuning[5] * state[RR]:
        threshold = state[NPK] + tuning[6] * (state[SPK] - state[NPK])
        if state[BACK_V] > threshold:
            count = _accept(int(state[BACK_T]), state[BACK_V], n, state, ring, delay, tuning, rate, out, count)
        state[BACK_V] = 0.0
    if n - max(state[LAST], learn) > 2.0 * rate:  # nothing for so long: the signal became smaller
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
    """Take levels from the first seconds and judge their candidates again."""
    state[LEARNT] = 1.0
    k = int(state[KEPT])
    if k == 0:
        return count
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
    """Take a peak of the energy as a beat, or as noise."""
    since = t - state[LAST] if state[LAST] >= 0.0 else _NEVER * rate
    if since < dead:
        return count
    expected = state[RR] if state[RR] > 0.0 else _USUAL_RR * rate
    share = min(since / expected, 2.0)
    factor = tuning[7] + (tuning[8] - tuning[7]) * max(1.0 - share / tuning[9], 0.0)
    factor = max(factor + _rhythm(_off(t, share, state), state, tuning), _LEAST_FACTOR)
    if v > state[NPK] + factor * (state[SPK] - state[NPK]):
        return _accept(t, v, n, state, ring, delay, tuning, rate, out, count)
    state[NPK] += tuning[11] * (min(v, _NOISE_CAP * state[SPK]) - state[NPK])
    if v > state[BACK_V] and since > _REFRACTORY * rate:
        state[BACK_V], state[BACK_T] = v, t
    return count


@kernel
def _off(t: float, share: float, state: Floats) -> float:
    """How far a peak is from where the rhythm has a beat, as a share of the usual interval."""
    if state[RR] == 0.0:
        return share - 1.0
    since = (t - state[PHASE]) / state[RR]
    return since - max(np.floor(since + 0.5), 1.0)


@kernel
def _trust(state: Floats, tuning: Floats) -> float:
    """How much the rhythm counts, 0 to 1: not where beats stand out, or where the intervals have been unlike."""
    clear = state[SPK] / max(state[NPK], _TINY)
    noisy = min(max((tuning[16] - clear) / (tuning[16] - tuning[17]), 0.0), 1.0)
    return noisy * max(1.0 - state[UNSTEADY] / tuning[20], 0.0)


@kernel
def _rhythm(off: float, state: Floats, tuning: Floats) -> float:
    """What the threshold is raised by for a peak so far from a beat of the rhythm; less than 0 in time."""
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
    """Write a beat: its R peak is the largest deflection in the window of its energy."""
    m, best, at = ring.shape[1], -1.0, t
    for j in range(max(t - int(tuning[0] * rate), 0, n - m + 1), t + 1):
        if abs(ring[0, j % m]) > best:
            best, at = abs(ring[0, j % m]), j
    if state[RR] > 0.0 and _trust(state, tuning) > tuning[21]:
        _entrain(t, state, tuning)
    elif state[LAST] >= 0.0:
        state[PHASE] = t
        rr = t - state[LAST]
        if state[RR] > 0.0:
            state[UNSTEADY] += _FOLLOW * (min(abs(rr / state[RR] - 1.0), _MOST_UNSTEADY) - state[UNSTEADY])
        if state[RR] == 0.0:
            state[RR] = min(rr, _LONGEST_RR * rate)
        elif _FASTEST_RR * rate < rr < _MISSED_RR * state[RR]:
            state[RR] += tuning[14] * (rr - state[RR])
        else:
            state[RR] += _DOUBTFUL_SHARE * (min(rr, _DOUBTFUL_RR * rate) - state[RR])
    else:
        state[PHASE] = t
    state[LAST] = t
    state[SPK] += tuning[10] * (min(v, tuning[15] * state[SPK]) - state[SPK])
    state[BACK_V] = 0.0
    if count < out.shape[0]:
        out[count, 0], out[count, 1], out[count, 2] = at - delay, n, v / max(state[NPK], _TINY)
        count += 1
    return count


@kernel
def _entrain(t: int, state: Floats, tuning: Floats) -> None:
    """Let the rhythm follow a beat that is near one of its own; one that is not says nothing, until there are many."""
    off = _off(t, 1.0, state)
    if abs(off) < tuning[22]:
        near = max(np.floor((t - state[PHASE]) / state[RR] + 0.5), 1.0)
        state[PHASE] = t - (1.0 - tuning[23]) * off * state[RR]
        state[RR] *= 1.0 + tuning[14] * off / near
        state[UNSTEADY] += _FOLLOW * (min(abs(off), _MOST_UNSTEADY) - state[UNSTEADY])
        return
    state[UNSTEADY] += tuning[24] * (_MOST_UNSTEADY - state[UNSTEADY])
