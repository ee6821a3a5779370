"""What the probes of the haptic methods share: a stopwatch for compiled loops, and a loop to tell costs against.

A probe times a loop compiled around the very kernel the tick runs, so that a call costs what it costs there: no
interpreter, and inlined.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.kernel import kernel

__all__ = ["SIZES", "reference_us", "shortest_us"]

SIZES = (1, 10, 100, 1000)
"""Numbers of bodies or contacts at which the cost of a tick is measured."""

_REPEATS = 5
_REFERENCE_CALLS = 100_000


@kernel
def _reference_loop(calls: int) -> float:
    x = 1.0
    for _ in range(calls):
        x = math.sqrt(1.0 + 0.5 * x * x) / (1.0 + 0.1 * x)
    return x


def shortest_us(work: Callable[[], object], calls: int) -> float:
    """Shortest of a few runs of `work`, after one to compile it, divided by its calls [us]."""
    clock = MonotonicClock()
    work()
    shortest = 1 << 62
    for _ in range(_REPEATS):
        started = clock.now_ns()
        work()
        shortest = min(shortest, clock.now_ns() - started)
    return shortest * 1e-3 / calls


def reference_us() -> float:
    """Cost [us] of one turn of the reference loop: a square root and a division that wait for one another."""
    return shortest_us(lambda: _reference_loop(_REFERENCE_CALLS), _REFERENCE_CALLS)
