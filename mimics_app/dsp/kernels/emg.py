"""EMG: band-pass, moving RMS, onset by a double threshold (level and duration) over an adaptive baseline."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.sections import Floats, run_sections

if TYPE_CHECKING:
    from mimics_app.dsp.record_types import EmgStateRecord

__all__ = ["EMG_STATE", "find_onsets"]

EMG_STATE = np.dtype(
    [
        ("n", "f8"),  # samples seen
        ("squares", "f8"),  # running sum of squares
        ("base", "f8"),  # mean of the envelope at rest
        ("spread", "f8"),  # its mean deviation
        ("above", "f8"),  # consecutive samples above the threshold
        ("active", "f8"),  # 1: the muscle is active
        ("below", "f8"),  # consecutive samples below the threshold
        ("held", "f8"),  # last valid input
        ("since", "f8"),  # sample at which the envelope rose
        ("total", "f8"),  # sum of the envelope (integrated EMG)
        ("learnt", "f8"),  # samples of signal from which the baseline was learnt
    ],
    align=True,
)
"""State of the muscle."""

_WINDOW, _ONSET, _STEADY_S, _RELEASE, _LEARN = 0.05, 0.025, 0.2, 0.1, 1.0
"""Window of the envelope; time above the threshold before an onset counts; settling time of the filter at the start;
time below before the activity ends; signal from which the first baseline is learnt, settling included [s]."""

_SPREADS, _RISE = 6.0, 0.3
"""The threshold lies so many spreads plus this share of the baseline above the baseline."""

_LAG = 0.2
"""Delay of the envelope's rise behind the muscle, as a share of the window."""

_FOLLOW = 0.5
"""Rate at which the baseline follows the envelope of the muscle at rest [1/s]."""

_STILL = 1e-9
"""RMS below which the line is flat: no electrode is attached [mV]."""


@kernel
def find_onsets(
    x: Floats, sos: Floats, z: Floats, state: EmgStateRecord, ring: Floats, rate: float, out: Floats, envelope: Floats
) -> int:
    """Compute the envelope and write the onsets found.

    Neither missing samples nor a flat line move the baseline: else any signal after them would count as activity.

    Args:
        x: Samples [mV], shape [n]; NaN where the sensor gave none.
        sos: Band-pass, shape [s, 6].
        z: Filter state, shape [s, 2].
        state: See EMG_STATE.
        ring: Ring buffer of band-passed samples, shape [m], at least a second.
        rate: Sampling rate [Hz].
        out: Onsets, shape [k, 3]: sample of the onset, sample at which it is known, envelope at that time.
        envelope: RMS of the last 50 ms, shape [n].

    Returns:
        Number of onsets written.
    """
    w, m, count = max(int(_WINDOW * rate), 2), ring.shape[0], 0
    for i in range(x.shape[0]):
        if not np.isnan(x[i]):
            state.held = x[i]
        value = run_sections(state.held, sos, z)
        n = int(state.n)
        old = ring[(n - w) % m]
        ring[n % m] = value
        state.squares = max(state.squares + value * value - old * old, 0.0)
        if n % w == 0:
            state.squares = _sum_of_squares(n, w, ring)
        state.n += 1.0
        rms = np.sqrt(state.squares / w)
        envelope[i] = rms
        state.total += rms / rate
        signal = rms > _STILL and not np.isnan(x[i])
        if state.learnt < _LEARN * rate:
            _learn(rms, signal, state, rate)
        elif _begins(rms, signal, n, state, rate) and count < out.shape[0]:
            out[count, 0], out[count, 1], out[count, 2] = state.since - _LAG * w, n, rms
            count += 1
    return count


@kernel
def _sum_of_squares(n: int, w: int, ring: Floats) -> float:
    """Return the sum over the window: the running one keeps the rounding errors of every artefact for ever."""
    total = 0.0
    for k in range(w):
        value = ring[(n - k) % ring.shape[0]]
        total += value * value
    return total


@kernel
def _begins(rms: float, signal: bool, n: int, state: EmgStateRecord, rate: float) -> bool:
    """Follow activity; return whether it begins: the envelope was above the threshold for long enough."""
    if rms > state.base + _SPREADS * state.spread + _RISE * state.base:
        state.below = 0.0
        if state.above == 0.0:
            state.since = n
        state.above += 1.0
        if state.active == 0.0 and state.above >= _ONSET * rate:
            state.active = 1.0
            return True
        return False
    state.above = 0.0
    state.below += 1.0
    if state.below > _RELEASE * rate:
        state.active = 0.0
        if signal:
            _adapt(rms, _FOLLOW / rate, state)
    return False


@kernel
def _learn(rms: float, signal: bool, state: EmgStateRecord, rate: float) -> None:
    """Let the first baseline be the mean of the envelope, once the filter has stabilised."""
    if signal:
        since = state.learnt - _STEADY_S * rate
        state.learnt += 1.0
        if since >= 0.0:
            _adapt(rms, 1.0 / (since + 1.0), state)


@kernel
def _adapt(rms: float, share: float, state: EmgStateRecord) -> None:
    """Move the baseline and its spread to the envelope by a share of the difference."""
    state.base += share * (rms - state.base)
    state.spread += share * (abs(rms - state.base) - state.spread)
