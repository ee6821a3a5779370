"""What the probes of the haptic methods share: a loop to compare costs with, and how many there may be of a thing.

A probe times a loop compiled around the very kernel the tick runs, so that a call costs what it costs there: no
interpreter, and inlined.
"""

from __future__ import annotations

import math

from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.probe import shortest_us

__all__ = ["SIZES", "reference_us"]

SIZES = (1, 10, 100, 1000)
"""Numbers of bodies or contacts at which the cost of a tick is measured."""

_REFERENCE_CALLS = 100_000

_PULL = 0.1
"""Keeps the chain of the reference loop near 1."""


@kernel
def _reference_loop(calls: int) -> float:
    x = 1.0
    for _ in range(calls):
        x = math.sqrt(1.0 + 0.5 * x * x) / (1.0 + _PULL * x)
    return x


def reference_us() -> float:
    """Cost [us] of one turn of the reference loop: a square root and a division that wait for one another."""
    return shortest_us(lambda: _reference_loop(_REFERENCE_CALLS), _REFERENCE_CALLS)
