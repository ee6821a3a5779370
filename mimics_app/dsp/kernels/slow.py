"""Skin conductance responses and breaths: extrema of a filtered signal, confirmed by its return from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.sections import Floats, run_sections, start_steady

if TYPE_CHECKING:
    from mimics_app.dsp.record_types import TurnStateRecord

__all__ = ["TURN_STATE", "find_breaths", "find_responses"]

TURN_STATE = np.dtype(
    [
        ("n", "f8"),  # samples seen
        ("rising", "f8"),  # 1: the signal rises
        ("low", "f8"),  # last trough
        ("low_at", "f8"),  # its sample
        ("high", "f8"),  # last crest
        ("high_at", "f8"),  # its sample
        ("size", "f8"),  # mean depth of a breath
        ("held", "f8"),  # last valid input
        ("missing", "f8"),  # consecutive NaN
        ("last_at", "f8"),  # sample of the trough before; 0: unknown
        ("mark", "f8"),  # value from which the steepness of a rise is taken
        ("mark_at", "f8"),  # its sample
        ("rose", "f8"),  # rise up to there over the same time
    ],
    align=True,
)
"""State of a signal that is followed from trough to crest."""

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

_STEADY_S, _FIRST = 0.5, 5.0
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
def _held(value: float, state: TurnStateRecord, sos: Floats, z: Floats, rate: float) -> float:
    """Return the sample, or the last valid one where it is missing; at the first one and after a long gap, restart."""
    if np.isnan(value):
        state.missing += 1.0
        return state.held
    if state.missing == state.n or state.missing > rate:
        start_steady(value, sos, z)
        state.rising, state.low, state.high, state.last_at = 0.0, np.inf, -np.inf, 0.0
    state.missing, state.held = 0.0, value
    return value


@kernel
def _await_rise(n: float, value: float, state: TurnStateRecord, rate: float, least: float) -> None:
    """Follow the signal down and along slow drifts, to the onset of a rise that is steep enough for a response."""
    if value < state.low or n - state.low_at > _SLOWEST_RISE * rate:
        state.low, state.low_at = value, n
    elif value > state.low + _BEGINS * least:
        state.rising, state.high, state.high_at = 1.0, value, n
        state.mark, state.mark_at, state.rose = value, n, np.inf


@kernel
def _levels_off(n: float, value: float, state: TurnStateRecord, rate: float, least: float) -> bool:
    """Return whether a rise has become a slow drift; a response that begins on a faster drift gets an onset of its own.

    Both are seen from one stretch of `_SLOWEST_RISE` to the next.
    """
    if n - state.mark_at <= _SLOWEST_RISE * rate:
        return False
    rise = value - state.mark
    if rise > _STEEPER * state.rose + _BEGINS * least:
        state.low, state.low_at = state.mark, state.mark_at
    state.mark, state.mark_at, state.rose = value, n, rise
    return rise < _BEGINS * least


@kernel
def find_responses(
    x: Floats, sos: Floats, z: Floats, state: TurnStateRecord, rate: float, least: float, out: Floats, smooth: Floats
) -> int:
    """Write the SCRs found: rises of at least `least` [uS] within 0.3 to 8 s.

    Args:
        x: Samples [uS], shape [n].
        sos: Low-pass, shape [s, 6].
        z: Filter state, shape [s, 2].
        state: See TURN_STATE; it is advanced.
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
        n = state.n
        state.n += 1.0
        if state.rising == 0.0:
            _await_rise(n, value, state, rate, least)
            continue
        if value > state.high:
            state.high, state.high_at = value, n
        size = state.high - state.low
        falls = value < state.high - max(_BACK * size, _LEAST_BACK * least)
        if falls or _levels_off(n, value, state, rate, least):
            rise = (state.high_at - state.low_at) / rate
            if size >= least and _SHORTEST_RESPONSE <= rise <= _LONGEST_RESPONSE and count < out.shape[0]:
                out[count, 0], out[count, 1], out[count, 2], out[count, 3] = state.high_at, n, size, state.low_at
                count += 1
            state.rising, state.low, state.low_at = 0.0, value, n
    return count


@kernel
def _first_range(n: float, value: float, state: TurnStateRecord, rate: float) -> bool:
    """Take the range of the first seconds as the first mean depth; return whether they last."""
    if n < _STEADY_S * rate:
        state.low, state.high = value, value
    elif n < _FIRST * rate:
        state.low, state.high = min(state.low, value), max(state.high, value)
        state.size = state.high - state.low
    elif n < _FIRST * rate + 1.0:  # in the middle of a breath: its crest comes first
        state.rising, state.high, state.high_at = 1.0, value, n
    return n < _FIRST * rate


@kernel
def find_breaths(x: Floats, sos: Floats, z: Floats, state: TurnStateRecord, rate: float, out: Floats) -> int:
    """Write the breaths found: trough, crest and next trough, each confirmed by a return of a third of the mean depth.

    Args:
        x: Samples, shape [n].
        sos: Band-pass, shape [s, 6].
        z: Filter state, shape [s, 2].
        state: See TURN_STATE; it is advanced.
        rate: Sampling rate [Hz].
        out: Breaths, shape [k, 5]: sample of the trough that ends it, sample at which it is known, depth, length of the
            in-breath and of the whole [samples].

    Returns:
        Number of breaths written.
    """
    count = 0
    for i in range(x.shape[0]):
        value = run_sections(_held(x[i], state, sos, z, rate), sos, z)
        n = state.n
        state.n += 1.0
        if _first_range(n, value, state, rate):
            continue
        usual = state.size if state.size > 0.0 else state.high - state.low
        back = _WAY_BACK * usual + _NOTHING
        if state.rising == 0.0:
            if value < state.low:
                state.low, state.low_at = value, n
            elif value > state.low + back and n - state.low_at > _SHORTEST_PHASE * rate:
                whole = state.low_at - state.last_at
                depth = state.high - state.low
                if (
                    state.last_at > 0.0
                    and count < out.shape[0]
                    and _SHORTEST_BREATH * rate < whole < _LONGEST_BREATH * rate
                ):
                    out[count, 0], out[count, 1], out[count, 2] = state.low_at, n, depth
                    out[count, 3], out[count, 4] = state.high_at - state.last_at, whole
                    count += 1
                state.last_at = state.low_at
                state.rising, state.high, state.high_at = 1.0, value, n
        elif value > state.high:
            state.high, state.high_at = value, n
        elif value < state.high - back and n - state.high_at > _SHORTEST_PHASE * rate:
            size = state.high - state.low
            usual = state.size
            state.size = size if usual == 0.0 else usual + _SIZE_SHARE * (min(size, _LARGEST_BREATH * usual) - usual)
            state.rising, state.low, state.low_at = 0.0, value, n
        if n - max(state.low_at, state.high_at) > _PAUSE * rate:
            state.size *= 1.0 - _FADE / rate
    return count
