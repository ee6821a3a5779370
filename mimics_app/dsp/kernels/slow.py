"""Skin conductance responses and breaths: extrema of a filtered signal, confirmed by its return from them."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.sections import Floats, run_sections, settle_sections

__all__ = ["TURN_STATE", "find_breaths", "find_responses"]

N, RISING, LOW, LOW_T, HIGH, HIGH_T, SIZE, HELD, MISSING, LAST_T, MARK, MARK_T, ROSE = range(13)
TURN_STATE = 13
"""Samples seen, whether the signal rises, last trough and its sample, last crest and its sample, mean depth of a
breath, last valid input, consecutive NaN, sample of the trough before (0: unknown), value and sample from which the
steepness of a rise is taken, and the rise up to there over the same time."""

_BEGINS = 0.4
"""Rise at which a response begins, as a share of the smallest amplitude."""

_SLOWEST_RISE = 1.5
"""A rise that takes longer to reach it is a drift [s]."""

_STEEPER = 1.5
"""Ratio of a rise to the one before it above which a response begins on a drift."""

_BACK, _LEAST_BACK = 0.02, 0.03
"""Return that confirms the peak of a response: the larger of a share of it and a share of the smallest amplitude."""

_SHORTEST_RESPONSE, _LONGEST_RESPONSE = 0.3, 8.0
"""Range of the rise time, from onset to peak [s]."""

_WAY_BACK = 0.35
"""Return that confirms an extremum, as a share of the mean depth of a breath."""

_SETTLES, _FIRST = 0.5, 5.0
"""Settling time of the filter, and time at whose end the range of the signal is the first mean depth [s]."""

_NOTHING = 1e-9
"""Smallest return, in a signal at rest [its unit]."""

_SHORTEST_PHASE, _SHORTEST_BREATH, _LONGEST_BREATH = 0.2, 0.8, 20.0
"""Shortest in-breath or out-breath, shortest and longest whole breath [s]."""

_SIZE_SHARE, _LARGEST_BREATH = 0.25, 3.0
"""Weight of a breath in the mean depth, and upper limit of its depth in mean ones."""

_PAUSE, _FADE = 10.0, 0.2
"""After this time without a breath [s] the mean depth decays by this share a second."""


@kernel
def _held(value: float, state: Floats, sos: Floats, z: Floats, rate: float) -> float:
    """Return the sample, or the last valid one where it is missing; at the first one and after a long gap, restart."""
    if np.isnan(value):
        state[MISSING] += 1.0
        return state[HELD]
    if state[MISSING] == state[N] or state[MISSING] > rate:
        settle_sections(value, sos, z)
        state[RISING], state[LOW], state[HIGH], state[LAST_T] = 0.0, np.inf, -np.inf, 0.0
    state[MISSING], state[HELD] = 0.0, value
    return value


@kernel
def _await_rise(n: float, value: float, state: Floats, rate: float, least: float) -> None:
    """Follow the signal down and along slow drifts, to the onset of a rise that is steep enough for a response."""
    if value < state[LOW] or n - state[LOW_T] > _SLOWEST_RISE * rate:
        state[LOW], state[LOW_T] = value, n
    elif value > state[LOW] + _BEGINS * least:
        state[RISING], state[HIGH], state[HIGH_T] = 1.0, value, n
        state[MARK], state[MARK_T], state[ROSE] = value, n, np.inf


@kernel
def _levels_off(n: float, value: float, state: Floats, rate: float, least: float) -> bool:
    """Return whether a rise has become a slow drift; a response that begins on a faster drift gets an onset of its own.

    Both are seen from one stretch of `_SLOWEST_RISE` to the next.
    """
    if n - state[MARK_T] <= _SLOWEST_RISE * rate:
        return False
    rise = value - state[MARK]
    if rise > _STEEPER * state[ROSE] + _BEGINS * least:
        state[LOW], state[LOW_T] = state[MARK], state[MARK_T]
    state[MARK], state[MARK_T], state[ROSE] = value, n, rise
    return rise < _BEGINS * least


@kernel
def find_responses(
    x: Floats, sos: Floats, z: Floats, state: Floats, rate: float, least: float, out: Floats, smooth: Floats
) -> int:
    """Write the SCRs found: rises of at least `least` [uS] within 0.3 to 8 s.

    Args:
        x: Samples [uS], shape [n].
        sos: Low-pass, shape [s, 6].
        z: Filter state, shape [s, 2].
        state: See TURN_STATE.
        rate: Sampling rate [Hz].
        least: Smallest amplitude [uS].
        out: SCRs, shape [k, 4]: sample of the peak, sample at which it is known, amplitude, sample of the onset.
        smooth: The low-passed signal, shape [n].

    Returns:
        Number of SCRs written.
    """
    count = 0
    for i in range(x.shape[0]):
        value = run_sections(_held(x[i], state, sos, z, rate), sos, z)
        smooth[i] = value
        n = state[N]
        state[N] += 1.0
        if state[RISING] == 0.0:
            _await_rise(n, value, state, rate, least)
            continue
        if value > state[HIGH]:
            state[HIGH], state[HIGH_T] = value, n
        size = state[HIGH] - state[LOW]
        falls = value < state[HIGH] - max(_BACK * size, _LEAST_BACK * least)
        if falls or _levels_off(n, value, state, rate, least):
            rise = (state[HIGH_T] - state[LOW_T]) / rate
            if size >= least and _SHORTEST_RESPONSE <= rise <= _LONGEST_RESPONSE and count < out.shape[0]:
                out[count, 0], out[count, 1], out[count, 2], out[count, 3] = state[HIGH_T], n, size, state[LOW_T]
                count += 1
            state[RISING], state[LOW], state[LOW_T] = 0.0, value, n
    return count


@kernel
def _first_range(n: float, value: float, state: Floats, rate: float) -> bool:
    """Take the range of the first seconds as the first mean depth; return whether they last."""
    if n < _SETTLES * rate:
        state[LOW], state[HIGH] = value, value
    elif n < _FIRST * rate:
        state[LOW], state[HIGH] = min(state[LOW], value), max(state[HIGH], value)
        state[SIZE] = state[HIGH] - state[LOW]
    elif n < _FIRST * rate + 1.0:  # in the middle of a breath: its crest comes first
        state[RISING], state[HIGH], state[HIGH_T] = 1.0, value, n
    return n < _FIRST * rate


@kernel
def find_breaths(x: Floats, sos: Floats, z: Floats, state: Floats, rate: float, out: Floats) -> int:
    """Write the breaths found: trough, crest and next trough, each confirmed by a return of a third of the mean depth.

    Args:
        x: Samples, shape [n].
        sos: Band-pass, shape [s, 6].
        z: Filter state, shape [s, 2].
        state: See TURN_STATE.
        rate: Sampling rate [Hz].
        out: Breaths, shape [k, 5]: sample of the trough that ends it, sample at which it is known, depth, length of the
            in-breath and of the whole [samples].

    Returns:
        Number of breaths written.
    """
    count = 0
    for i in range(x.shape[0]):
        value = run_sections(_held(x[i], state, sos, z, rate), sos, z)
        n = state[N]
        state[N] += 1.0
        if _first_range(n, value, state, rate):
            continue
        usual = state[SIZE] if state[SIZE] > 0.0 else state[HIGH] - state[LOW]
        back = _WAY_BACK * usual + _NOTHING
        if state[RISING] == 0.0:
            if value < state[LOW]:
                state[LOW], state[LOW_T] = value, n
            elif value > state[LOW] + back and n - state[LOW_T] > _SHORTEST_PHASE * rate:
                whole = state[LOW_T] - state[LAST_T]
                depth = state[HIGH] - state[LOW]
                if (
                    state[LAST_T] > 0.0
                    and count < out.shape[0]
                    and _SHORTEST_BREATH * rate < whole < _LONGEST_BREATH * rate
                ):
                    out[count, 0], out[count, 1], out[count, 2] = state[LOW_T], n, depth
                    out[count, 3], out[count, 4] = state[HIGH_T] - state[LAST_T], whole
                    count += 1
                state[LAST_T] = state[LOW_T]
                state[RISING], state[HIGH], state[HIGH_T] = 1.0, value, n
        elif value > state[HIGH]:
            state[HIGH], state[HIGH_T] = value, n
        elif value < state[HIGH] - back and n - state[HIGH_T] > _SHORTEST_PHASE * rate:
            size = state[HIGH] - state[LOW]
            usual = state[SIZE]
            state[SIZE] = size if usual == 0.0 else usual + _SIZE_SHARE * (min(size, _LARGEST_BREATH * usual) - usual)
            state[RISING], state[LOW], state[LOW_T] = 0.0, value, n
        if n - max(state[LOW_T], state[HIGH_T]) > _PAUSE * rate:
            state[SIZE] *= 1.0 - _FADE / rate
    return count
