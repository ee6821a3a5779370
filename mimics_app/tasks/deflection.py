"""The hand as a lever: its deflection from where a trial began."""

from __future__ import annotations

import math

__all__ = ["DEAD_ZONE", "deflection"]

DEAD_ZONE = 0.015
"""Displacement of the hand that counts as none [m]."""


def deflection(moved: float, full: float) -> float:
    """Return the share, -1 to 1, that a displacement of the hand [m] is of the full one, beyond the dead zone."""
    beyond = max(abs(moved) - DEAD_ZONE, 0.0) / (full - DEAD_ZONE)
    return math.copysign(min(beyond, 1.0), moved)
