"""Period of the live loop, stability margin, and the linear stability condition near the origin.

A wall of stiffness K and damping B, touched through a device with damping b of its own, is stable while (linear
condition of Gil et al. 2004, Hulin et al. 2014)

    K < (b + B) / (T / 2 + delay)

and several contacts at once where this holds in each direction (`directions`). It holds for small damping only; the
whole region is in `closed_region`. T / 2 is the mean age of a force that is
held for a period T. Where periods differ, a force held for T_i is T_i / 2 old on average and acts for the fraction
T_i / sum(T) of the time, so that T is the mean weighted by length, sum(T_i^2) / sum(T_i): a stall counts although the
ticks that catch up after it bring the plain mean back to nominal.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel

__all__ = [
    "LARGEST_MARGIN",
    "follow_period",
    "margin_of",
    "spring_share",
]

LARGEST_MARGIN = 99.0
"""Upper bound of a margin [-], and the margin without any stiffness."""

_MEMORY = 0.25
"""Time constant of the measured period [s]."""


@kernel
def follow_period(total: float, squares: float, length: float, nominal: float) -> tuple[float, float]:
    """Count one hold in the running sums; the measured period [s] is squares / total.

    Args:
        total: Decaying sum of the lengths [s]; nominal at first.
        squares: Decaying sum of their squares [s^2]; nominal^2 at first.
        length: From the last wake-up to this one [s].
        nominal: Period requested [s].
    """
    keep = 1.0 - nominal / _MEMORY
    return keep * total + (1.0 - keep) * length, keep * squares + (1.0 - keep) * length * length


@kernel
def margin_of(limit: float, stiffness: float) -> float:
    """Stability margin limit / stiffness - 1 [-], at most LARGEST_MARGIN; below 0 the contact may be unstable."""
    if stiffness * (1.0 + LARGEST_MARGIN) <= limit or stiffness <= 0.0:
        return LARGEST_MARGIN
    return limit / stiffness - 1.0


@kernel
def spring_share(stiffness: float, limit: float, margin: float) -> float:
    """Share 0-1 of a spring [N/m] that keeps a margin [-] to a limit [N/m]; its damper is not scaled."""
    allowed = max(0.0, limit) / (1.0 + margin)
    return allowed / stiffness if stiffness > allowed else 1.0
