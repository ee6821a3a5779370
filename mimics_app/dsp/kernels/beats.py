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

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.beat_path import (
    PathModel,
    find_form,
    find_path,
    unroll,
)
from mimics_app.dsp.kernels.form_tuning import TUNING
from mimics_app.dsp.kernels.rhythm import (
    RHYTHM,
    T_WAVE,
    USUAL_RR,
    add_beat,
    off_beat,
    steadiness,
)
from mimics_app.dsp.kernels.sections import Floats
from mimics_app.dsp.kernels.templates import (
    COUNT,
    ENERGY,
    NEAR,
    SHIFT,
    SIGNAL,
    WHITE,
    Bank,
    learn_beat,
    learn_noise,
    mark_beat,
    score,
    whiten,
)

if TYPE_CHECKING:
    from mimics_app.dsp.record_types import FormStateRecord, PathRecord, Table

__all__ = ["FORM_STATE", "FormDetector", "choose_beats"]

FORM_STATE = np.dtype(
    [
        ("rhythm", RHYTHM),
        ("matched", "f8"),  # 1: templates decide
        ("candidate_at", "f8"),  # sample at which the candidate's form ends
        ("candidate", "f8"),  # its score
        ("back_at", "f8"),  # best rejected candidate
        ("back", "f8"),  # by how much its score exceeds the threshold
        ("n", "f8"),  # samples of the signal seen
        ("share", "f8"),  # of the beats found by templates
        ("energy_at", "f8"),  # strongest beat found by energy since the last beat
        ("energy", "f8"),  # its strength; 0: none
        ("variance", "f8"),  # of the whitened noise
        ("noise_count", "f8"),  # samples of noise
        ("fitted", "f8"),  # last beat found by templates [samples of the signal]
        ("provisional", "f8"),  # 1: the templates never stood out clearly
        ("searched", "f8"),  # last search of a form
        ("proven", "f8"),  # evidence for the provisional templates
        ("written", "f8"),  # beats written from the newest samples
        ("reliable", "f8"),  # share of the beats found by energy that were beats
        ("early", "f8"),  # 1: the last beat was one found by energy and taken early
    ],
    align=True,
)
"""State of the detector by forms; times are in samples of the ring buffer where nothing else is said."""

_LATER = 0.3
"""Time after which a sample is learnt as noise if no beat was found near it [s]."""
_EVERY = 0.1
"""Interval at which the noise's predictor is determined [s]."""
_APART = 0.3
"""Least distance of a beat that fills a gap from its neighbours [s]."""
_FOLLOW = 0.1
"""Weight of a beat in the share of beats found by templates, and in that of true ones among those found by energy."""
_SOON = 0.75
"""Share of the mean interval within which no beat follows an extrasystole."""


class FormDetector(NamedTuple):
    """The detector by forms.

    Attributes:
        state: See FORM_STATE, shape [1].
        bank: Templates and noise.
        out: Beats to report, shape [b, 2]: sample of the R peak and sample at which it is known.
        rate: Sampling rate of the ring buffer [Hz].
        step: Samples of the signal per sample of the ring buffer.
        delay: Group delay of the wide band-pass [samples of the signal].
        path: Receives the description of a path that is searched, shape [1], see `beat_path.PATH`.
    """

    state: Table[FormStateRecord]
    bank: Bank
    out: Floats
    rate: float
    step: int
    delay: float
    path: Table[PathRecord]


@kernel
def choose_beats(wide: Floats, found: Floats, detector: FormDetector) -> int:
    """Process samples and the beats found in them by energy; write the beats to report into `detector.out`.

    Args:
        wide: The signal through the wide band-pass, shape [n].
        found: Beats found by energy in these samples, shape [b, 3], see `ecg.EnergyDetector`.
        detector: The detector.

    Returns:
        Number of beats written.
    """
    state, step, rings, used = detector.state[0], detector.step, detector.bank.rings, 0
    state.written = 0.0
    for i in range(wide.shape[0]):
        now = int(state.n)
        state.n += 1.0
        n, new = now // step, now % step == 0
        if new:
            rings[SIGNAL, n % rings.shape[1]], rings[NEAR, n % rings.shape[1]] = wide[i], 0.0
        while used < found.shape[0] and found[used, 1] <= now:
            _take_found(found[used], n, detector)
            used += 1
        if new and _prepare(n, detector):
            _decide(n, detector)
    return int(state.written)


@kernel
def _take_found(beat: Floats, n: int, detector: FormDetector) -> None:
    """Take a beat found by energy: report and learn it, or keep it for a gap."""
    state, bank, rate = detector.state[0], detector.bank, detector.rate
    rings = bank.rings
    at = int(np.round((beat[0] + detector.delay) / detector.step))
    due = n > max(TUNING.search_from_s * rate, state.searched + TUNING.search_every_s * rate)
    if due and state.provisional > 0.0 and state.variance > 0.0:
        _search(at, n, detector)
    if state.matched > 0.0:
        if abs(at - state.rhythm.last) < TUNING.near_s * rate:
            _rate(1.0, state)
        if beat[2] > max(state.energy, TUNING.gap_strong) and at - state.rhythm.last > _APART * rate:
            state.energy_at, state.energy = at, beat[2]
        return
    if beat[0] - state.fitted > TUNING.refractory_s * rate * detector.step:
        _write(beat[0], beat[1], detector)
    after = int(np.round(TUNING.after_s * rate))
    before = bank.templates.shape[1] - after
    inside = at - before - SHIFT > max(n - rings.shape[1], 0) and at + after + SHIFT <= n
    known = bank.sizes[:, COUNT].max() >= TUNING.usable
    fits = False
    if beat[2] > TUNING.strong and inside:
        fits = learn_beat(at, bank, before, TUNING.same, TUNING.weight)
    if fits or not known:
        add_beat(at, state.rhythm, 0.0, rate)
        mark_beat(at, n, rings, int(TUNING.near_s * rate))


@kernel
def _search(at: int, n: int, detector: FormDetector) -> None:
    """Search a form that explains the last seconds better than the provisional templates, beginning with one beat."""
    state, bank, rate = detector.state[0], detector.bank, detector.rate
    rings, templates, sizes = bank.rings, bank.templates, bank.sizes
    hold = int(TUNING.hold_s * rate)
    model = PathModel(state.variance, TUNING.freedom, rate, hold, TUNING.spread, TUNING.missed)
    signal, white, path = np.empty(rings.shape[1]), np.empty(rings.shape[1]), detector.path[0]
    unroll(n, rings[SIGNAL], signal)
    unroll(n, rings[WHITE], white)
    state.proven *= max(1.0 - (n - state.searched) / (TUNING.fade_s * rate), 0.0)
    state.searched = n
    if sizes[:, COUNT].max() >= TUNING.usable:
        shares = np.full(sizes.shape[0], -np.inf)
        for k in range(sizes.shape[0]):
            if sizes[k, COUNT] >= TUNING.usable:
                shares[k] = np.log(sizes[k, COUNT] / sizes[:, COUNT].sum())
        find_path(bank.whitened, shares, white, model, path)
        state.proven = max(state.proven, path.evidence)
    after = int(np.round(TUNING.after_s * rate))
    begin = signal.shape[0] - 1 - n + at + after - templates.shape[1]
    if begin < 0 or begin + templates.shape[1] > signal.shape[0]:
        return
    form = signal[begin : begin + templates.shape[1]].copy()
    find_form(form, signal, white, bank.error, model, path)
    covered = path.beats * path.period > TUNING.covered * min(n, signal.shape[0])
    if covered and path.evidence > max(state.proven, TUNING.evidence):
        templates[0], sizes[:, COUNT] = form, 0.0
        sizes[0, COUNT], state.proven = path.beats, path.evidence
        state.rhythm.rr, state.rhythm.unsteady = path.period, path.deviation
        state.rhythm.phase = n + path.latest - after + 1


@kernel
def _prepare(n: int, detector: FormDetector) -> bool:
    """Learn the noise, whiten the newest sample and choose the detector; return whether templates decide."""
    state, bank, rate = detector.state[0], detector.bank, detector.rate
    rings, error = bank.rings, bank.error
    m, p = rings.shape[1], error.shape[0] - 1
    at = n - int(_LATER * rate)
    if at > p and state.rhythm.last >= 0.0 and rings[NEAR, at % m] == 0.0:
        state.noise_count += 1.0
        learn_noise(at, bank, max(1.0 / state.noise_count, 1.0 / (TUNING.noise_s * rate)))
    due = n % max(int(_EVERY * rate), 1) == 0
    if due:
        state.variance = whiten(bank)
    value = 0.0
    for i in range(p + 1):
        value += error[i] * rings[SIGNAL, (n - i) % m]
    rings[WHITE, n % m] = value
    if due:
        _switch(state, bank.sizes)
    return state.matched > 0.0


@kernel
def _switch(state: FormStateRecord, sizes: Floats) -> None:
    """Let templates decide in noise, and energy on a clear signal or where the templates do not fit any more."""
    largest = 0.0
    for k in range(sizes.shape[0]):
        if sizes[k, COUNT] >= TUNING.usable:
            largest = max(largest, sizes[k, ENERGY])
    clear = np.sqrt(largest / state.variance)
    if state.matched == 0.0:
        if clear >= TUNING.noisy:
            state.provisional = 0.0
        elif clear > 0.0:
            state.matched, state.share = 1.0, 1.0
            state.candidate = state.back = -np.inf
            state.energy = 0.0
    elif clear > TUNING.clear:
        state.matched = state.provisional = 0.0
    elif state.share < TUNING.fitting:
        state.matched, state.provisional, state.proven = 0.0, 1.0, 0.0
        sizes[:, COUNT] = 0.0


@kernel
def _decide(n: int, detector: FormDetector) -> None:
    """Track the score to its next peak and classify it; fill gaps."""
    state, rate = detector.state[0], detector.rate
    value = score(n, detector.bank, state.variance, TUNING.freedom, TUNING.usable)
    t, fits = -1, 1.0
    if value > state.candidate:
        state.candidate, state.candidate_at = value, n
    elif n - state.candidate_at > TUNING.hold_s * rate:
        t = _classify(_peak(state, rate), state, rate)
    if t < 0:
        t = _search_back(n, state, rate)
    if t < 0:
        t, fits = _fill(n, state, rate), 0.0
    elif state.energy > 0.0 and t - state.rhythm.last > TUNING.gap * state.rhythm.rr > 0.0:
        if state.energy_at < t - _APART * rate:
            _accept(int(state.energy_at), n, 0.0, detector)
    if t >= 0:
        _accept(t, n, fits, detector)


@kernel
def _fill(n: int, state: FormStateRecord, rate: float) -> int:
    """Return the beat found by energy that fills a gap, or is taken early where energy is reliable; -1 without one."""
    t = int(state.energy_at)
    if state.rhythm.rr == 0.0 or state.energy == 0.0:
        return -1
    if n - state.rhythm.last > TUNING.gap * state.rhythm.rr + _EVERY * rate:
        return t
    early = state.reliable > TUNING.reliable and n - t > TUNING.wait_s * rate
    return t if early and state.candidate < _threshold(_peak(state, rate), state, rate) else -1


@kernel
def _classify(t: int, state: FormStateRecord, rate: float) -> int:
    """Return the sample of the candidate if it is a beat, else -1."""
    over, since = state.candidate - _threshold(t, state, rate), t - state.rhythm.last
    state.candidate = -np.inf
    if since <= TUNING.refractory_s * rate:
        return -1
    if over > 0.0:
        return t
    if over > state.back and since > T_WAVE * rate:
        state.back, state.back_at = over, t
    return -1


@kernel
def _threshold(t: int, state: FormStateRecord, rate: float) -> float:
    """Return the threshold of the score at sample `t`: lower when a beat is due, and near an expected one."""
    share = min((t - state.rhythm.last) / (state.rhythm.rr if state.rhythm.rr > 0.0 else USUAL_RR * rate), 2.0)
    in_time = np.exp(-((off_beat(t, share, state.rhythm) / TUNING.width) ** 2))
    threshold = TUNING.due + TUNING.higher * max(1.0 - share / TUNING.decay, 0.0)
    return threshold + TUNING.range * steadiness(state.rhythm, TUNING.unsteady) * (0.5 - in_time)


@kernel
def _search_back(n: int, state: FormStateRecord, rate: float) -> int:
    """Return the best rejected candidate if it is good enough and has waited: for a better one, or too long, else -1.

    Near an expected beat the wait is short, so that the beat is known 0.25 s after its R peak.
    """
    if state.rhythm.rr == 0.0 or state.back == -np.inf:
        return -1
    t, over = int(state.back_at), state.back
    in_time = abs(off_beat(t, 1.0, state.rhythm)) < TUNING.width and n - t > TUNING.wait_s * rate
    if in_time and state.candidate - _threshold(_peak(state, rate), state, rate) > over:
        return -1
    if not in_time and n - state.rhythm.last <= TUNING.late * state.rhythm.rr:
        return -1
    state.back = -np.inf
    return t if over > TUNING.below else -1


@kernel
def _peak(state: FormStateRecord, rate: float) -> int:
    """Return the sample of the R peak of the candidate, whose form ends later."""
    return int(state.candidate_at) - int(np.round(TUNING.after_s * rate)) + 1


@kernel
def _accept(t: int, n: int, fits: float, detector: FormDetector) -> None:
    """Write a beat in noise and update the rhythm."""
    state, rate = detector.state[0], detector.rate
    early = fits == 0.0 and n - state.rhythm.last <= TUNING.gap * state.rhythm.rr
    if state.early > 0.0:  # it was a beat unless another one followed soon
        _rate(1.0 if t - state.rhythm.last > _SOON * state.rhythm.rr else 0.0, state)
    elif state.energy > 0.0 and not early:
        _rate(1.0 if abs(t - state.energy_at) < TUNING.near_s * rate else 0.0, state)
    state.early = early
    state.share += _FOLLOW * (fits - state.share)
    add_beat(t, state.rhythm, steadiness(state.rhythm, TUNING.unsteady), rate)
    mark_beat(t, n, detector.bank.rings, int(TUNING.near_s * rate))
    state.back, state.energy = -np.inf, 0.0
    state.fitted = t * detector.step - detector.delay
    _write(state.fitted, n * detector.step, detector)


@kernel
def _rate(right: float, state: FormStateRecord) -> None:
    """Note whether a beat found by energy was a beat (1) or not (0)."""
    state.reliable += _FOLLOW * (right - state.reliable)


@kernel
def _write(at: float, known: float, detector: FormDetector) -> None:
    state, out = detector.state[0], detector.out
    count = int(state.written)
    if count < out.shape[0]:
        out[count, 0], out[count, 1] = at, known
        state.written += 1.0
