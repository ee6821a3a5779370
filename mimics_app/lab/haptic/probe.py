"""Common parts of the probes of haptic methods: reference loop, and numbers of bodies or contacts.

A probe times a compiled loop around the kernel of the tick, so that a call costs as much as there: inlined, without the
interpreter.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.probe import shortest_us

__all__ = ["SIZES", "reference_us"]

SIZES = (1, 10, 100, 1000)
"""Numbers of bodies or contacts at which the cost of a tick is measured."""

_REFERENCE_CALLS = 100_000

_PULL = 0.1
"""Keeps the value of the reference loop near 1."""


@kernel
def _reference_loop(calls: int) -> float:
    x = 1.0
    for _ in range(calls):
        x = math.sqrt(1.0 + 0.5 * x * x) / (1.0 + _PULL * x)
    return x


def reference_us() -> float:
    """Return the cost of one iteration of the reference loop [us]: a dependent square root and division."""
    return shortest_us(lambda: _reference_loop(_REFERENCE_CALLS), _REFERENCE_CALLS)
