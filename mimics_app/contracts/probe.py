"""What cost probes share: the shortest of a few runs, and the loop that every cost is compared with.

A virtual machine's clock rate, and what else runs on it, change from minute to minute. The ratio of a cost to a
reference loop timed in the same run holds where microseconds do not.
"""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.kernel import kernel

__all__ = ["REFERENCE_STEPS", "reference_us", "run_reference", "shortest_us"]

REFERENCE_STEPS = 100
"""Steps of the reference loop that count as one call: about as much work as a haptic tick's force law."""

_CALLS = 200
_REPEATS = 5

_STIFFNESS, _DAMPING, _DT = 400.0, 0.02, 1e-3
"""Of the reference loop: a mass of 1 kg [N/m, N s/m, s]."""


@kernel
def run_reference(calls: int, x: float, v: float) -> float:
    """A spring-damper of 1 kHz stepped semi-implicitly, `REFERENCE_STEPS` steps a call: a chain of dependent sums.

    Args:
        calls: How many calls.
        x: Place at the start [m].
        v: Velocity at the start [m/s].

    Returns:
        Place at the end [m], so that nothing can be left out.
    """
    for _ in range(calls * REFERENCE_STEPS):
        v -= _DT * (_STIFFNESS * x + _DAMPING * v)
        x += _DT * v
    return x


def shortest_us(work: Callable[[], object], calls: int = 1, repeats: int = _REPEATS) -> float:
    """Shortest of a few runs of `work`, after one that compiles it, divided by the calls it makes [us per call]."""
    clock = MonotonicClock()
    work()
    shortest = float("inf")
    for _ in range(repeats):
        started = clock.now_ns()
        work()
        shortest = min(shortest, clock.now_ns() - started)
    return shortest * 1e-3 / calls


def reference_us() -> float:
    """Cost of one call of the reference loop here and now [us]."""
    return shortest_us(lambda: run_reference(_CALLS, 1e-3, 0.0), _CALLS)
