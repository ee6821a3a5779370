"""The beats that explain some seconds of noise best: their form, interval and times at once.

The score of a form (`templates`) has peaks along the signal, true beats among them. A path through the peaks is a
sequence of beats. Its evidence is the sum of the scores and of the logarithms of the probability density of the
intervals, a Gaussian about a period; a beat may be missed at a cost. The best path for a period follows from dynamic
programming (Viterbi, IEEE Trans. Information Theory 13(2), 1967), the period from trying all. A form is found by
turns: the best path for the form, then the average of the signal along the path, beginning with any one beat.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.sections import Floats
from mimics_app.dsp.kernels.templates import log_ratio, whiten_form

if TYPE_CHECKING:
    from mimics_app.dsp.record_types import PathRecord

__all__ = [
    "PATH",
    "PathModel",
    "find_form",
    "find_path",
    "unroll",
]

PATH = np.dtype(
    [
        ("evidence", "f8"),  # logarithm of its probability over that of noise alone
        ("period", "f8"),  # mean interval [samples]
        ("latest", "f8"),  # end of the form at the latest beat [samples before the newest one, negative]
        ("beats", "f8"),  # their number
        ("deviation", "f8"),  # mean relative deviation of the intervals from the period
    ],
    align=True,
)
"""Description of a path."""

_AT, _SCORE, _SUM, _FROM, _REST = range(5)
_ROWS = 5
"""Rows of the peaks: sample at which the form ends, score, evidence of the best path that ends there, the peak before
on that path (-1: none), energy of what the form leaves."""

_PEAKS = 512
"""Largest number of peaks: more than ten seconds have, with one in 53 ms."""
_LEAST_SCORE = 1.5
"""A peak with a lower score is less probable than a missed beat."""
_SHORTEST, _LONGEST = 0.38, 1.5
"""Range of the periods that are tried [s]."""
_FARTHEST = 3.4
"""Longest step of a path, in periods: up to two beats in a row may be missed."""
_LARGEST_DEVIATION = 3.0
"""Largest deviation of an interval from the period, in standard deviations."""
_MOST_SIZE = 1.2
"""Largest size of a beat relative to a form that is not averaged yet."""
_ROUNDS = 4
"""Paths that are found for a form, with an average between two."""


class PathModel(NamedTuple):
    """What is assumed of noise and rhythm when a path is searched.

    Attributes:
        variance: Of the whitened noise [mV^2].
        freedom: Degrees of freedom of its distribution.
        rate: Sampling rate [Hz].
        hold: Samples without a larger score after which a peak is complete.
        spread: Standard deviation of the intervals, as a share of the period.
        missed: Cost of a missed beat, in the logarithm of the probability.
    """

    variance: float
    freedom: float
    rate: float
    hold: int
    spread: float
    missed: float


@kernel
def unroll(n: int, ring: Floats, line: Floats) -> None:
    """Copy a ring buffer, shape [m], whose newest sample is `n`, to an array in the order of time."""
    first = (n + 1) % ring.shape[0]
    line[: ring.shape[0] - first] = ring[first:]
    line[ring.shape[0] - first :] = ring[:first]


@kernel
def find_form(form: Floats, signal: Floats, white: Floats, error: Floats, model: PathModel, path: PathRecord) -> None:
    """Improve a form by the beats that resemble it, and describe the path of these beats.

    Args:
        form: First guess, any one beat; becomes the average of the beats found, shape [l + p].
        signal: Shape [m].
        white: The signal through the error filter, shape [m].
        error: Error filter, shape [p + 1].
        model: Noise and rhythm.
        path: Receives the description of the path, see PATH.
    """
    whitened, share = np.empty((1, form.shape[0] - error.shape[0] + 1)), np.zeros(1)
    peaks = np.empty((_ROWS, _PEAKS))
    for turn in range(_ROUNDS):
        whiten_form(form, error, whitened[0])
        largest = _MOST_SIZE if turn < _ROUNDS - 1 else 0.0
        end = _follow(whitened, share, white, model, largest, peaks, path)
        if end < 0:
            return
        if turn < _ROUNDS - 1:
            _average(end, peaks, signal, model.freedom * model.variance, form)


@kernel
def find_path(whitened: Floats, shares: Floats, white: Floats, model: PathModel, path: PathRecord) -> None:
    """Describe the most probable path for given forms.

    Args:
        whitened: Whitened forms, shape [k, l].
        shares: Logarithm of the share of the beats that each form has, minus infinity to leave it out, shape [k].
        white: The signal through the error filter, shape [m].
        model: Noise and rhythm.
        path: Receives the description of the path, see PATH.
    """
    _follow(whitened, shares, white, model, 0.0, np.empty((_ROWS, _PEAKS)), path)


@kernel
def _follow(
    whitened: Floats, shares: Floats, white: Floats, model: PathModel, largest: float, peaks: Floats, path: PathRecord
) -> int:
    """List the peaks, find the best path of all periods, describe it; return the peak at its end, -1 without one."""
    path.evidence = path.period = path.latest = path.beats = path.deviation = 0.0
    count = _list_peaks(whitened, shares, white, model, largest, peaks)
    if count == 0:
        return -1
    period, best = _SHORTEST * model.rate, 0.0
    while period < _LONGEST * model.rate:
        end = _link(count, peaks, period, model)
        if peaks[_SUM, end] > path.evidence:
            path.evidence, best = peaks[_SUM, end], period
        period *= 1.0 + model.spread
    if best == 0.0:
        return -1
    end = _link(count, peaks, best, model)
    _describe(end, peaks, best, path)
    path.latest = peaks[_AT, end] - (white.shape[0] - 1)
    return end


@kernel
def _list_peaks(
    whitened: Floats, shares: Floats, white: Floats, model: PathModel, largest: float, peaks: Floats
) -> int:
    """Write the peaks of the largest score of the forms, and return their number."""
    length, count, best, at, left = whitened.shape[1], 0, _LEAST_SCORE, 0, 0.0
    energies = (whitened * whitened).sum(axis=1)
    without = (white[: length - 1] ** 2).sum()
    for t in range(length - 1, white.shape[0]):
        without += white[t] ** 2
        for k in range(whitened.shape[0]):
            if shares[k] == -np.inf:
                continue
            rest = _rest(whitened[k], energies[k], white, t, without, largest)
            if rest >= without:
                continue
            value = log_ratio(without, rest, model.variance, model.freedom, length) + shares[k]
            if value > best:
                best, at, left = value, t, rest
        if best > _LEAST_SCORE and t - at > model.hold:
            if count < peaks.shape[1]:
                peaks[_AT, count], peaks[_SCORE, count], peaks[_REST, count] = at, best, left
                count += 1
            best = _LEAST_SCORE
        without -= white[t - length + 1] ** 2
    return count


@kernel
def _rest(whitened: Floats, energy: float, white: Floats, t: int, without: float, largest: float) -> float:
    """Return the energy that is left when the form is subtracted so that it ends at sample `t`.

    Where `largest` is not 0 the form has the size that leaves least, up to that one.
    """
    both, begin = 0.0, t - whitened.shape[0] + 1
    for i in range(whitened.shape[0]):
        both += white[begin + i] * whitened[i]
    size = 1.0 if largest == 0.0 else min(max(both / energy, 0.0), largest)
    return max(without - 2.0 * size * both + size * size * energy, 0.0)


@kernel
def _link(count: int, peaks: Floats, period: float, model: PathModel) -> int:
    """Find the best path to each peak for a period, and return the peak at the end of the best one."""
    end, density = 0, -np.log(np.sqrt(2.0 * np.pi) * model.spread * period)
    for j in range(count):
        best, before = density, -1
        for i in range(j - 1, -1, -1):
            steps = (peaks[_AT, j] - peaks[_AT, i]) / period
            if steps > _FARTHEST:
                break
            beats = max(np.floor(steps + 0.5), 1.0)
            away = (steps / beats - 1.0) / model.spread
            value = peaks[_SUM, i] + density - 0.5 * away * away - (beats - 1.0) * model.missed
            if abs(away) <= _LARGEST_DEVIATION and value > best:
                best, before = value, i
        peaks[_SUM, j], peaks[_FROM, j] = peaks[_SCORE, j] + best, before
        if peaks[_SUM, j] > peaks[_SUM, end]:
            end = j
    return end


@kernel
def _describe(end: int, peaks: Floats, period: float, path: PathRecord) -> None:
    """Write the number of beats of a path, their mean interval and its mean relative deviation from the period."""
    j, i, periods = end, int(peaks[_FROM, end]), 0.0
    path.beats = 1.0
    while i >= 0:
        steps = (peaks[_AT, j] - peaks[_AT, i]) / period
        beats = max(np.floor(steps + 0.5), 1.0)
        path.deviation += abs(steps / beats - 1.0)
        path.beats += 1.0
        periods += beats
        j, i = i, int(peaks[_FROM, i])
    path.deviation /= max(path.beats - 1.0, 1.0)
    path.period = (peaks[_AT, end] - peaks[_AT, j]) / periods if periods > 0.0 else period


@kernel
def _average(end: int, peaks: Floats, signal: Floats, noise: float, form: Floats) -> None:
    """Average the signal along a path; a beat counts the less, the more of it the form does not explain."""
    form[:] = 0.0
    weights, j = 0.0, end
    while j >= 0:
        weight, begin = 1.0 / (noise + peaks[_REST, j]), int(peaks[_AT, j]) - form.shape[0] + 1
        for i in range(form.shape[0]):
            form[i] += weight * signal[begin + i]
        weights += weight
        j = int(peaks[_FROM, j])
    form /= weights
