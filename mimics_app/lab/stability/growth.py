"""Deciding by simulation whether a motion dies away, and how fast it grows.

Two methods. Peaks: the amplitude of the motion in the quarters of a run is compared; the run is lengthened until the
result is clear. Lyapunov exponents: two perturbations of a motion are advanced and kept orthogonal (Benettin et al.
1980); the logarithms of their growth per tick add up to the exponents, also for an oscillating motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = ["LENGTHEN", "QUARTERS", "decay_sign", "dies_away", "largest_exponent", "note_peak", "orthonormalise"]


_CLEAR = 0.4
"""Logarithm of a ratio of peaks that is decisive without a longer run."""

_GONE = 1e-6
"""Ratio of the last to the first peak at which a motion has died away; what remains may be rounding."""

LENGTHEN = 4
"""Factor by which an indecisive run is lengthened."""

QUARTERS = 4
"""Parts of a run whose peaks are compared."""

_INDEPENDENT = 30.0
"""Difference of the sums of two perturbations from which their directions differ."""


@kernel
def note_peak(size: float, tick: int, ticks: int, large: float, peaks: Vec) -> bool:
    """Record the peak of each quarter of a run; return whether the motion has diverged.

    Args:
        size: Distance of the motion from rest, >= 0; NaN has diverged.
        tick: This tick, 0 .. ticks - 1.
        ticks: Length of the run.
        large: Distance from which the motion does not return; the peaks from this quarter on become infinite.
        peaks: Shape [4], zero at the start.
    """
    quarter = min(QUARTERS - 1, QUARTERS * tick // ticks)
    if not size < large:
        peaks[quarter:] = math.inf
        return True
    peaks[quarter] = max(peaks[quarter], size)
    return False


@kernel
def decay_sign(peaks: Vec, last: bool) -> int:
    """Return 1 for a motion that dies away, -1 for one that does not, 0 where a longer run must decide.

    A motion is a sum of decaying modes and possibly of one that grows from a small amplitude: it must have decayed
    since the second quarter and still be decaying in the last.

    Args:
        peaks: See `note_peak`.
        last: No longer run follows: the last two quarters decide.
    """
    if not peaks[3] < math.inf:
        return -1
    if peaks[3] < _GONE * peaks[0]:
        return 1
    since_second, since_third = math.log(peaks[3] / peaks[1]), math.log(peaks[3] / peaks[2])
    if last or (abs(since_second) > _CLEAR and since_second * since_third > 0.0):
        return 1 if since_third < 0.0 else -1
    return 0


def dies_away(run: Callable[[int], Vec], shortest: int, longest: int) -> bool:
    """Whether a motion dies away, see `decay_sign`.

    Args:
        run: Simulates a number of ticks and returns the peaks, shape [4].
        shortest: Ticks of the first run.
        longest: Ticks of the last run, which decides in any case.
    """
    ticks = shortest
    while not (sign := decay_sign(run(ticks), ticks >= longest)):
        ticks = min(longest, LENGTHEN * ticks)
    return sign > 0


@kernel
def orthonormalise(first: Vec, second: Vec, sums: Vec) -> None:
    """Make two perturbations, shape [2] each, orthonormal and add the logarithms of their growth to sums, shape [2]."""
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
    """Growth per tick, ln |lambda|, from the sums of `orthonormalise`.

    Where both perturbations grow alike (an oscillation) their mean is exact to rounding; else the larger is taken, with
    an error of the logarithm of the angle between the two modes, divided by the ticks.
    """
    if abs(sums[0] - sums[1]) < _INDEPENDENT:
        return float(0.5 * (sums[0] + sums[1]) / ticks)
    return float(max(sums[0], sums[1]) / ticks)
