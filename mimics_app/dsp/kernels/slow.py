"""Skin responses and breaths: turning points of a filtered signal, found by how far it has gone back."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.kernel import kernel

__all__ = ["TURN_STATE", "find_breaths", "find_responses", "run_sections"]

Floats = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

N, RISING, LOW, LOW_T, HIGH, HIGH_T, SIZE, HELD, MISSING, LAST_T = range(10)
TURN_STATE = 10
"""Samples seen, whether it rises, last trough and when, last crest and when, usual size, last good input, NaN in a row,
the trough before."""

_BEGINS = 0.3
"""A response begins when the signal has risen by this share of the least amplitude."""

_SLOWEST_RISE = 6.0
"""A rise that takes longer before it shows is a drift [s]."""

_BACK, _LEAST_BACK = 0.02, 0.03
"""A response has peaked when the signal has gone back by this share of it, and of the least amplitude."""

_SHORTEST_RESPONSE, _LONGEST_RESPONSE = 0.3, 8.0
"""From onset to peak [s]."""

_WAY_BACK = 0.2
"""Of the usual breath, by which the signal goes back before it has turned."""

_NOTHING = 1e-9
"""Least way back, of a signal that is still [its unit]."""

_SHORTEST_PHASE, _SHORTEST_BREATH, _LONGEST_BREATH = 0.2, 0.8, 20.0
"""Of one direction, and of a whole breath [s]."""

_SIZE_SHARE, _LARGEST_BREATH = 0.25, 3.0
"""A breath moves the usual size by this share, and counts as so many usual ones at most."""

_PAUSE, _FADE = 10.0, 0.2
"""After so long without a breath [s] the usual size falls by this share a second."""


@kernel
def run_sections(value: float, sos: Floats, z: Floats) -> float:
    """One sample through second order sections [s, 6] with state [s, 2]."""
    for s in range(sos.shape[0]):
        y = sos[s, 0] * value + z[s, 0]
        z[s, 0] = sos[s, 1] * value - sos[s, 4] * y + z[s, 1]
        z[s, 1] = sos[s, 2] * value - sos[s, 5] * y
        value = y
    return value


@kernel
def _settle(value: float, sos: Floats, z: Floats) -> None:
    for s in range(sos.shape[0]):
        gain = (sos[s, 0] + sos[s, 1] + sos[s, 2]) / (1.0 + sos[s, 4] + sos[s, 5])
        y = gain * value
        z[s, 1] = sos[s, 2] * value - sos[s, 5] * y
        z[s, 0] = sos[s, 1] * value - sos[s, 4] * y + z[s, 1]
        value = y


@kernel
def _held(value: float, state: Floats, sos: Floats, z: Floats, rate: float) -> float:
    """The sample, or the last good one where there is none; after a long gap the filter begins anew."""
    if np.isnan(value):
        state[MISSING] += 1.0
        return state[HELD]
    if state[N] == 0.0 or state[MISSING] > rate:
        _settle(value, sos, z)
        state[RISING], state[LOW], state[HIGH] = 0.0, np.inf, -np.inf
    state[MISSING], state[HELD] = 0.0, value
    return value


@kernel
def find_responses(
    x: Floats, sos: Floats, z: Floats, state: Floats, rate: float, least: float, out: Floats, smooth: Floats
) -> int:
    """SCRs: rises of at least `least` [uS] within 0.3 to 6 s.

    Args:
        x: Samples [uS], shape [n].
        sos: Low-pass, shape [s, 6].
        z: Its state, shape [s, 2].
        state: See TURN_STATE.
        rate: [Hz]
        least: Smallest amplitude [uS].
        out: SCRs, shape [k, 4]: sample of the peak, sample at which it is known, amplitude, sample of the onset.
        smooth: The low-passed signal, shape [n].

    Returns:
        How many were written.
    """
    count = 0
    for i in range(x.shape[0]):
        value = run_sections(_held(x[i], state, sos, z, rate), sos, z)
        smooth[i] = value
        n = state[N]
        state[N] += 1.0
        if state[RISING] == 0.0:
            if value < state[LOW]:
                state[LOW], state[LOW_T] = value, n
            elif value > state[LOW] + _BEGINS * least:
                state[RISING], state[HIGH], state[HIGH_T] = 1.0, value, n
            elif n - state[LOW_T] > _SLOWEST_RISE * rate:  # a slow drift is no response
                state[LOW], state[LOW_T] = value, n
            continue
        if value > state[HIGH]:
            state[HIGH], state[HIGH_T] = value, n
        size = state[HIGH] - state[LOW]
        if value < state[HIGH] - max(_BACK * size, _LEAST_BACK * least):
            rise = (state[HIGH_T] - state[LOW_T]) / rate
            if size >= least and _SHORTEST_RESPONSE <= rise <= _LONGEST_RESPONSE and count < out.shape[0]:
                out[count, 0], out[count, 1], out[count, 2], out[count, 3] = state[HIGH_T], n, size, state[LOW_T]
                count += 1
            state[RISING], state[LOW], state[LOW_T] = 0.0, value, n
    return count


@kernel
def find_breaths(x: Floats, sos: Floats, z: Floats, state: Floats, rate: float, out: Floats) -> int:
    """Breaths: a trough, a crest and the next trough, each followed by a way back of a fifth of the usual size.

    Args:
        x: Samples, shape [n].
        sos: Band-pass, shape [s, 6].
        z: Its state, shape [s, 2].
        state: See TURN_STATE.
        rate: [Hz]
        out: Breaths, shape [k, 5]: sample of the trough that ends it, sample at which it is known, depth, length of the
            in-breath and of the whole [samples].

    Returns:
        How many were written.
    """
    count = 0
    for i in range(x.shape[0]):
        value = run_sections(_held(x[i], state, sos, z, rate), sos, z)
        n = state[N]
        state[N] += 1.0
        if n < 0.5 * rate:
            state[LOW], state[HIGH] = value, value
            continue
        back = _WAY_BACK * state[SIZE] + _NOTHING
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
