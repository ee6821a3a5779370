"""Motion of the tapping ball: down to a place, up again, and to rest above the next."""

from __future__ import annotations

import math

__all__ = ["Tap", "ball_motion"]

Tap = tuple[int, str, float, float, int]
"""Time of the touch [ns], "cord", "back" or "stomach", share of the cord's length, angle around it [rad], number."""

_HOVER, _FALL_S = 0.09, 0.14
"""Height of the resting ball above the surface [m], and duration of its way down or up [s]."""
_QUICK = 0.35
"""Largest share of the time between two touches for each way down or up; the rest is for the path between them."""


def ball_motion(since_s: float, until_s: float) -> tuple[float, float]:
    """Return the position of the tapping ball between two touches, continuous in position and velocity.

    Args:
        since_s: Since the touch before [s]; infinite where there was none.
        until_s: Until the coming touch [s]; negative after it.

    Returns:
        Share of the path from one place to the other, and how far the ball is over either [m]: 0 at a touch.
    """
    whole = max(since_s + until_s, 1e-9)
    fall_s = min(_FALL_S, _QUICK * whole)
    gap = _HOVER * _eased(min(abs(since_s), abs(until_s)) / fall_s)
    if math.isinf(since_s):
        return 1.0, gap
    return _eased((since_s - fall_s) / (whole - 2.0 * fall_s)), gap


def _eased(share: float) -> float:
    """Return a smooth step from 0 to 1, with zero slope at both ends."""
    share = min(max(share, 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)
