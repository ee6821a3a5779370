"""Beats from two detectors: by energy while the signal is clear, by templates of the beats in noise.

`ecg` finds beats of any form by the energy of the QRS band. They are reported, and averaged into templates, as long as
the templates stand out clearly from the noise between beats. In noise the beats are those whose form fits: a candidate
is accepted by its score (`templates`) and its time in the rhythm. Where it leaves a gap, a beat found by energy fills
it: an extrasystole of a form not yet learnt. If gaps are filled more often than not, the forms have changed (a moved
electrode): the templates are discarded, and energy alone decides until there are new ones.

Templates that never stood out clearly, because the signal began in noise or the electrode moved in it, are provisional.
About once a second a form is searched in the last seconds (`beat_path`), which replaces them if it explains more.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.kernel import kernel
from mimics_app.dsp.kernels.beat_path import (
    BEATS,
    DEVIATION,
    EVIDENCE,
    LATEST,
    PATH,
    PERIOD,
    find_form,
    find_path,
    unroll,
)
from mimics_app.dsp.kernels.rhythm import LAST, PHASE, RHYTHM, RR, UNSTEADY, add_beat, off_beat, steadiness
from mimics_app.dsp.kernels.sections import Floats
from mimics_app.dsp.kernels.templates import (
    COUNT,
    ENERGY,
    NEAR,
    SHIFT,
    SIGNAL,
    WHITE,
    learn_beat,
    learn_noise,
    mark_beat,
    score,
    whiten,
)

__all__ = ["BEATS_STATE", "FITTED", "MATCHED", "PROVISIONAL", "Bank", "choose_beats"]

Bank = tuple[Floats, Floats, Floats, Floats, Floats]
"""Ring buffer [3, m], templates [k, l + p], whitened templates [k, l], their sizes [k, 2], noise [p + 2, p + 1]."""

(
    MATCHED,
    CAND_T,
    CAND_V,
    BACK_T,
    BACK_V,
    N,
    SHARE,
    ENERGY_T,
    ENERGY_V,
    VARIANCE,
    HEARD,
    FITTED,
    PROVISIONAL,
    SEARCHED,
    PROVEN,
) = range(RHYTHM, RHYTHM + 15)
BEATS_STATE = RHYTHM + 15
"""Length of the state vector: the rhythm, whether templates decide, candidate and its score, best rejected candidate
and by how much its score exceeds the threshold, samples seen, share of beats found by templates, strongest beat found
by energy since the last beat and its strength, variance of the whitened noise, samples of noise, last beat found by
templates, whether the templates are provisional, last search of a form, evidence for the provisional templates. Times
are in samples of the ring buffer; the samples seen and the last beat found by templates are samples of the signal."""

_LATER = 0.3
"""Time after which a sample is learnt as noise if no beat was found near it [s]."""
_EVERY = 0.1
"""Interval at which the noise's predictor is determined [s]."""
_APART = 0.3
"""Least distance of a beat that fills a gap from its neighbours [s]."""
_REFRACTORY = 0.36
"""A peak within this time of a beat [s] is its T wave, not a missed beat (Pan & Tompkins)."""
_USUAL_RR = 0.8
"""Expected interval while none is known [s]."""
_FOLLOW = 0.1
"""Weight of a beat in the share of beats found by templates."""


@kernel
def choose_beats(
    wide: Floats,
    found: Floats,
    state: Floats,
    bank: Bank,
    rate: float,
    step: int,
    delay: float,
    rhythm: Floats,
    tuning: Floats,
    out: Floats,
) -> int:
    """Process samples and the beats found in them by energy; write the beats to report.

    Args:
        wide: The signal through the wide band-pass, shape [n].
        found: Beats found by energy in these samples, shape [b, 3], see `ecg.find_beats`.
        state: See BEATS_STATE.
        bank: See Bank.
        rate: Sampling rate of the ring buffer [Hz].
        step: Samples of the signal per sample of the ring buffer.
        delay: Group delay of the wide band-pass [samples of the signal].
        rhythm: See `ecg.TUNING`.
        tuning: See `ecg.TEMPLATE_TUNING`.
        out: Beats, shape [b, 2]: sample of the R peak and sample at which it is known.

    Returns:
        Number of beats written.
    """
    used, count, rings = 0, 0, bank[0]
    for i in range(wide.shape[0]):
        now = int(state[N])
        state[N] += 1.0
        n, new = now // step, now % step == 0
        if new:
            rings[SIGNAL, n % rings.shape[1]], rings[NEAR, n % rings.shape[1]] = wide[i], 0.0
        while used < found.shape[0] and found[used, 1] <= now:
            count = _hear(found[used], n, state, bank, rate, step, delay, rhythm, tuning, out, count)
            used += 1
        if new and _prepare(n, state, bank, rate, tuning):
            count = _decide(n, state, bank, rate, step, delay, rhythm, tuning, out, count)
    return count


@kernel
def _hear(
    beat: Floats,
    n: int,
    state: Floats,
    bank: Bank,
    rate: float,
    step: int,
    delay: float,
    rhythm: Floats,
    tuning: Floats,
    out: Floats,
    count: int,
) -> int:
    """Take a beat found by energy: report and learn it, or keep it for a gap; return the beats written so far."""
    rings, templates, _, sizes, _ = bank
    at = int(np.round((beat[0] + delay) / step))
    due = n > max(tuning[29] * rate, state[SEARCHED] + tuning[27] * rate)
    if due and state[PROVISIONAL] > 0.0 and state[VARIANCE] > 0.0:
        _search(at, n, state, bank, rate, tuning)
    if state[MATCHED] > 0.0:
        if beat[2] > max(state[ENERGY_V], tuning[22]) and at - state[LAST] > _APART * rate:
            state[ENERGY_T], state[ENERGY_V] = at, beat[2]
        return count
    if beat[0] - state[FITTED] > tuning[18] * rate * step and count < out.shape[0]:
        out[count, 0], out[count, 1] = beat[0], beat[1]
        count += 1
    after = int(np.round(tuning[1] * rate))
    before = templates.shape[1] - after
    inside = at - before - SHIFT > max(n - rings.shape[1], 0) and at + after + SHIFT <= n
    known = sizes[:, COUNT].max() >= tuning[8]
    fits = False
    if beat[2] > tuning[5] and inside:
        fits = learn_beat(at, rings, templates, sizes, before, tuning[6], tuning[7])
    if fits or not known:
        add_beat(at, state, 0.0, rate, rhythm)
        mark_beat(at, n, rings, int(tuning[4] * rate))
    return count


@kernel
def _search(at: int, n: int, state: Floats, bank: Bank, rate: float, tuning: Floats) -> None:
    """Search a form that explains the last seconds better than the provisional templates, beginning with one beat."""
    rings, templates, whitened, sizes, noise = bank
    variance, error, hold = state[VARIANCE], noise[noise.shape[1]], int(tuning[17] * rate)
    signal, white, path = np.empty(rings.shape[1]), np.empty(rings.shape[1]), np.zeros(PATH)
    unroll(n, rings[SIGNAL], signal)
    unroll(n, rings[WHITE], white)
    state[PROVEN] *= max(1.0 - (n - state[SEARCHED]) / (tuning[28] * rate), 0.0)
    state[SEARCHED] = n
    if sizes[:, COUNT].max() >= tuning[8]:
        shares = np.full(sizes.shape[0], -np.inf)
        for k in range(sizes.shape[0]):
            if sizes[k, COUNT] >= tuning[8]:
                shares[k] = np.log(sizes[k, COUNT] / sizes[:, COUNT].sum())
        find_path(whitened, shares, white, variance, tuning[2], rate, hold, tuning[24], tuning[25], path)
        state[PROVEN] = max(state[PROVEN], path[EVIDENCE])
    after = int(np.round(tuning[1] * rate))
    begin = signal.shape[0] - 1 - n + at + after - templates.shape[1]
    if begin < 0 or begin + templates.shape[1] > signal.shape[0]:
        return
    form = signal[begin : begin + templates.shape[1]].copy()
    find_form(form, signal, white, error, variance, tuning[2], rate, hold, tuning[24], tuning[25], path)
    covered = path[BEATS] * path[PERIOD] > tuning[30] * min(n, signal.shape[0])
    if covered and path[EVIDENCE] > max(state[PROVEN], tuning[26]):
        templates[0], sizes[:, COUNT] = form, 0.0
        sizes[0, COUNT], state[PROVEN] = path[BEATS], path[EVIDENCE]
        state[RR], state[UNSTEADY] = path[PERIOD], path[DEVIATION]
        state[PHASE] = n + path[LATEST] - after + 1


@kernel
def _prepare(n: int, state: Floats, bank: Bank, rate: float, tuning: Floats) -> bool:
    """Learn the noise, whiten the newest sample and choose the detector; return whether templates decide."""
    rings, templates, whitened, sizes, noise = bank
    m, p = rings.shape[1], noise.shape[1] - 1
    at = n - int(_LATER * rate)
    if at > p and state[LAST] >= 0.0 and rings[NEAR, at % m] == 0.0:
        state[HEARD] += 1.0
        learn_noise(at, rings, noise, max(1.0 / state[HEARD], 1.0 / (tuning[3] * rate)))
    due = n % max(int(_EVERY * rate), 1) == 0
    if due:
        state[VARIANCE] = whiten(templates, whitened, sizes, noise)
    value = 0.0
    for i in range(p + 1):
        value += noise[p + 1, i] * rings[SIGNAL, (n - i) % m]
    rings[WHITE, n % m] = value
    if due:
        _switch(state, sizes, tuning)
    return state[MATCHED] > 0.0


@kernel
def _switch(state: Floats, sizes: Floats, tuning: Floats) -> None:
    """Let templates decide in noise, and energy on a clear signal or where the templates do not fit any more."""
    largest = 0.0
    for k in range(sizes.shape[0]):
        if sizes[k, COUNT] >= tuning[8]:
            largest = max(largest, sizes[k, ENERGY])
    clear = np.sqrt(largest / state[VARIANCE])
    if state[MATCHED] == 0.0:
        if clear >= tuning[9]:
            state[PROVISIONAL] = 0.0
        elif clear > 0.0:
            state[MATCHED], state[SHARE] = 1.0, 1.0
            state[CAND_V] = state[BACK_V] = -np.inf
            state[ENERGY_V] = 0.0
    elif clear > tuning[10]:
        state[MATCHED] = state[PROVISIONAL] = 0.0
    elif state[SHARE] < tuning[23]:
        state[MATCHED], state[PROVISIONAL], state[PROVEN] = 0.0, 1.0, 0.0
        sizes[:, COUNT] = 0.0


@kernel
def _decide(
    n: int,
    state: Floats,
    bank: Bank,
    rate: float,
    step: int,
    delay: float,
    rhythm: Floats,
    tuning: Floats,
    out: Floats,
    count: int,
) -> int:
    """Track the score to its next peak and classify it; fill gaps; return the number of beats written so far."""
    rings, _, whitened, sizes, _ = bank
    value = score(n, rings, whitened, sizes, state[VARIANCE], tuning[2], tuning[8])
    t, fits = -1, 1.0
    if value > state[CAND_V]:
        state[CAND_V], state[CAND_T] = value, n
    elif n - state[CAND_T] > tuning[17] * rate:
        t = _judge(int(state[CAND_T]) - int(np.round(tuning[1] * rate)) + 1, state, rate, tuning)
    if t < 0:
        t = _search_back(n, state, tuning)
    gap = tuning[21] * state[RR]
    filled = gap > 0.0 and state[ENERGY_V] > 0.0
    if t < 0 and filled and n - state[LAST] > gap + _EVERY * rate:
        t, fits = int(state[ENERGY_T]), 0.0
    elif t - state[LAST] > gap and filled and state[ENERGY_T] < t - _APART * rate:
        count = _accept(int(state[ENERGY_T]), n, 0.0, state, rings, rate, step, delay, rhythm, tuning, out, count)
    if t >= 0:
        count = _accept(t, n, fits, state, rings, rate, step, delay, rhythm, tuning, out, count)
    return count


@kernel
def _judge(t: int, state: Floats, rate: float, tuning: Floats) -> int:
    """Return the sample of the candidate if it is a beat, else -1."""
    value = state[CAND_V]
    state[CAND_V] = -np.inf
    since = t - state[LAST]
    if since <= tuning[18] * rate:
        return -1
    share = min(since / (state[RR] if state[RR] > 0.0 else _USUAL_RR * rate), 2.0)
    threshold = tuning[11] + tuning[12] * max(1.0 - share / tuning[13], 0.0)
    in_time = np.exp(-((off_beat(t, share, state) / tuning[15]) ** 2))
    threshold += tuning[14] * steadiness(state, tuning[16]) * (0.5 - in_time)
    if value > threshold:
        return t
    if value - threshold > state[BACK_V] and since > _REFRACTORY * rate:
        state[BACK_V], state[BACK_T] = value - threshold, t
    return -1


@kernel
def _search_back(n: int, state: Floats, tuning: Floats) -> int:
    """Return the best rejected candidate if no beat was found for too long and it is good enough, else -1."""
    if state[RR] == 0.0 or n - state[LAST] <= tuning[19] * state[RR] or state[BACK_V] == -np.inf:
        return -1
    over = state[BACK_V]
    state[BACK_V] = -np.inf
    return int(state[BACK_T]) if over > tuning[20] else -1


@kernel
def _accept(
    t: int,
    n: int,
    fits: float,
    state: Floats,
    rings: Floats,
    rate: float,
    step: int,
    delay: float,
    rhythm: Floats,
    tuning: Floats,
    out: Floats,
    count: int,
) -> int:
    """Write a beat in noise and update the rhythm; return the number of beats written so far."""
    state[SHARE] += _FOLLOW * (fits - state[SHARE])
    add_beat(t, state, steadiness(state, tuning[16]), rate, rhythm)
    mark_beat(t, n, rings, int(tuning[4] * rate))
    state[BACK_V], state[ENERGY_V] = -np.inf, 0.0
    if count < out.shape[0]:
        state[FITTED] = t * step - delay
        out[count, 0], out[count, 1] = state[FITTED], n * step
        count += 1
    return count
