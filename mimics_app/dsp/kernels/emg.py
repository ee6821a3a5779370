"""EMG: band-pass, moving RMS, onset by a double threshold over a baseline that follows the quiet muscle."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.kernel import kernel
from mimics_app.dsp.kernels.slow import run_sections

__all__ = ["EMG_STATE", "find_onsets"]

Floats = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

N, SUM, BASE, SPREAD, ABOVE, ACTIVE, BELOW, HELD, SINCE, TOTAL = range(10)
EMG_STATE = 10
"""Samples seen, running sum of squares, mean and spread of the quiet envelope, samples above in a row, whether active,
samples below in a row, last good input, when the envelope rose, sum of the envelope (integrated EMG)."""

_WINDOW, _ONSET, _SETTLES, _RELEASE = 0.05, 0.025, 0.2, 0.1
"""Of the envelope; above before it is an onset; at the start until the envelope means something; below before it ends
[s]."""

_SPREADS, _RISE = 6.0, 0.3
"""An onset lies so many spreads and this share of the baseline above the baseline."""

_LAG = 0.2
"""Of the window, by which the envelope rises later than the muscle."""


@kernel
def find_onsets(
    x: Floats, sos: Floats, z: Floats, state: Floats, ring: Floats, rate: float, out: Floats, envelope: Floats
) -> int:
    """Follow the envelope.

    Args:
        x: Samples [mV], shape [n].
        sos: Band-pass, shape [s, 6].
        z: Its state, shape [s, 2].
        state: See EMG_STATE.
        ring: The last band-passed samples, shape [m], at least a second.
        rate: [Hz]
        out: Onsets, shape [k, 3]: sample of the onset, sample at which it is known, envelope then.
        envelope: RMS of the last 50 ms, shape [n].

    Returns:
        How many onsets were written.
    """
    w, m, count = max(int(_WINDOW * rate), 2), ring.shape[0], 0
    least = _ONSET * rate
    for i in range(x.shape[0]):
        if not np.isnan(x[i]):
            state[HELD] = x[i]
        value = run_sections(state[HELD], sos, z)
        n = int(state[N])
        old = ring[(n - w) % m]
        state[SUM] = max(state[SUM] + value * value - old * old, 0.0)
        ring[n % m] = value
        state[N] += 1.0
        rms = np.sqrt(state[SUM] / w)
        envelope[i] = rms
        state[TOTAL] += rms / rate
        if n < _SETTLES * rate:
            continue
        if n < rate:
            share = 1.0 / (n - _SETTLES * rate + 1.0)
            state[BASE] += share * (rms - state[BASE])
            state[SPREAD] += share * (abs(rms - state[BASE]) - state[SPREAD])
            continue
        if rms > state[BASE] + _SPREADS * state[SPREAD] + _RISE * state[BASE]:
            state[BELOW] = 0.0
            if state[ABOVE] == 0.0:
                state[SINCE] = n
            state[ABOVE] += 1.0
            if state[ACTIVE] == 0.0 and state[ABOVE] >= least:
                state[ACTIVE] = 1.0
                if count < out.shape[0]:
                    out[count, 0], out[count, 1], out[count, 2] = state[SINCE] - _LAG * w, n, rms
                    count += 1
        else:
            state[ABOVE] = 0.0
            state[BELOW] += 1.0
            if state[BELOW] > _RELEASE * rate:
                state[ACTIVE] = 0.0
                state[BASE] += 0.5 / rate * (rms - state[BASE])
                state[SPREAD] += 0.5 / rate * (abs(rms - state[BASE]) - state[SPREAD])
    return count
