"""Shared parts of cost probes: the shortest of a few runs, and the reference loop.

Clock rate and load of a virtual machine change from minute to minute. The ratio of a cost to a reference loop timed in
the same run is reproducible where microseconds are not.
"""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.clock import MonotonicClock

__all__ = ["reference_us", "run_reference", "shortest_us"]

_REFERENCE_STEPS = 100
"""Steps of the reference loop per call: about the work of a haptic tick's force law."""

_CALLS = 200
_REPEATS = 5

_STIFFNESS, _DAMPING, _DT = 400.0, 0.02, 1e-3
"""Stiffness [N/m], damping [N s/m] and step [s] of the reference loop, with a mass of 1 kg."""


@kernel
def run_reference(calls: int, x: float, v: float) -> float:
    """Step a spring-damper semi-implicitly at 1 kHz, `_REFERENCE_STEPS` steps per call: a chain of dependent sums.

    Args:
        calls: Number of calls.
        x: Initial position [m].
        v: Initial velocity [m/s].

    Returns:
        Final position [m], so that the compiler cannot remove the loop.
    """
    for _ in range(calls * _REFERENCE_STEPS):
        v -= _DT * (_STIFFNESS * x + _DAMPING * v)
        x += _DT * v
    return x


def shortest_us(work: Callable[[], object], calls: int = 1, repeats: int = _REPEATS) -> float:
    """Return the shortest of a few runs of `work`, after a first one that compiles it, per call [us]."""
    clock = MonotonicClock()
    work()
    shortest = float("inf")
    for _ in range(repeats):
        started = clock.now_ns()
        work()
        shortest = min(shortest, clock.now_ns() - started)
    return shortest * 1e-3 / calls


def reference_us() -> float:
    """Return the present cost of one call of the reference loop [us]."""
    return shortest_us(lambda: run_reference(_CALLS, 1e-3, 0.0), _CALLS)
