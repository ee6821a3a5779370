"""Deciding by simulation whether a motion dies away, and how fast it grows.

Two methods. Peaks: how far the motion swings in the second and in the fourth quarter of a run; the run is made longer
until the answer is plain. Exponents: two neighbours of a motion are followed and kept square to each other (Benettin
et al. 1980); each tick's stretching adds up to the growth per tick, exact also where the motion turns as it grows.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel

__all__ = ["dies_away", "largest_exponent", "note_peak", "square_up"]


_PLAIN = 0.4
"""Logarithm of a ratio of peaks that needs no longer run."""

_GONE = 1e-6
"""A motion that has shrunk this much has died; what is left may be rounding, which never does."""

_LENGTHEN = 4

_QUARTERS = 4
"""Of a run."""

_OVERFLOWS = 1e200
"""A motion that far from rest counts as infinite: its square must stay finite."""


@kernel
def note_peak(size: float, tick: int, ticks: int, peaks: Vec) -> None:
    """Keep the largest size of each quarter of a run.

    Args:
        size: How far the motion is from where it should rest, >= 0; NaN counts as infinite.
        tick: This tick, 0 .. ticks - 1.
        ticks: Length of the run.
        peaks: Shape [4], zero at the start.
    """
    quarter = min(3, _QUARTERS * tick // ticks)
    if not size < _OVERFLOWS:
        for i in range(quarter, _QUARTERS):
            peaks[i] = math.inf
    elif size > peaks[quarter]:
        peaks[quarter] = size


def dies_away(run: Callable[[int], Vec], shortest: int, longest: int) -> bool:
    """Whether a motion shrinks in the second half of a run.

    A motion is made of parts that die and perhaps one that grows from little: it must have shrunk since the second
    quarter and still be shrinking in the last, else the run is made longer.

    Args:
        run: Simulates so many ticks and returns the peaks, shape [4].
        shortest: Ticks of the first try.
        longest: Ticks of the last try, whose answer is taken however close it is.
    """
    ticks = shortest
    while True:
        peaks = run(ticks)
        if not math.isfinite(peaks[3]):
            return False
        if peaks[3] < _GONE * peaks[0]:
            return True
        since_second = math.log(peaks[3] / peaks[1])
        since_third = math.log(peaks[3] / peaks[2])
        if ticks >= longest:
            return since_third < 0.0
        if since_second < -_PLAIN and since_third < 0.0:
            return True
        if since_second > _PLAIN and since_third > 0.0:
            return False
        ticks = min(longest, _LENGTHEN * ticks)


@kernel
def square_up(first: Vec, second: Vec, sums: Vec) -> None:
    """Add the logarithms of the stretching of two neighbours, shape [2] each, to sums, and make them square again."""
    length = math.sqrt(first[0] * first[0] + first[1] * first[1])
    first[0] /= length
    first[1] /= length
    along = first[0] * second[0] + first[1] * second[1]
    second[0] -= along * first[0]
    second[1] -= along * first[1]
    rest = math.sqrt(second[0] * second[0] + second[1] * second[1])
    second[0] /= rest
    second[1] /= rest
    sums[0] += math.log(length)
    sums[1] += math.log(rest)


def largest_exponent(sums: Vec, ticks: int) -> float:
    """Growth per tick, ln |lambda|, from the sums of `square_up`.

    Where both neighbours grow alike (a turning motion) the mean is exact to rounding; else the first is taken, which
    errs by the logarithm of how slanted the two directions are, over the ticks.
    """
    if abs(sums[0] - sums[1]) < 30.0:
        return float(0.5 * (sums[0] + sums[1]) / ticks)
    return float(max(sums[0], sums[1]) / ticks)
