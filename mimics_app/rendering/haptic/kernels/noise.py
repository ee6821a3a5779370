"""Noise and resolution of simulated sensors; random generators keep their state in the caller's memory."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel

__all__ = ["gauss", "quantised", "seed_noise", "uniform"]

_STEP, _MIX_1, _MIX_2 = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
"""Increment and multipliers of splitmix64 (Steele, Lea and Flood 2014)."""

_FOLD_1, _FOLD_2, _FOLD_3 = 30, 27, 31
"""Shifts of splitmix64 [bits]."""

_LEFT, _RIGHT, _LEFT_AGAIN = 13, 7, 17
"""Shifts of xorshift64 [bits]."""

_SPARE_BITS = 11
"""Bits of 64 beyond the 53 that a float64 holds exactly."""

_STEPS_OF_ONE = 9007199254740992.0
"""Numbers of `uniform` in [0, 1): 2^53."""


@kernel
def seed_noise(memory: NDArray[np.float64], place: int, seed: int) -> None:
    """Seed the generator whose 64-bit state is stored in memory[place], by one round of splitmix64."""
    z = np.uint64(seed) + np.uint64(_STEP)
    z = (z ^ (z >> np.uint64(_FOLD_1))) * np.uint64(_MIX_1)
    z = (z ^ (z >> np.uint64(_FOLD_2))) * np.uint64(_MIX_2)
    z = z ^ (z >> np.uint64(_FOLD_3))
    if z == np.uint64(0):
        z = np.uint64(1)
    memory[place : place + 1].view(np.uint64)[0] = z


@kernel
def uniform(memory: NDArray[np.float64], place: int) -> float:
    """Next number in [0, 1), 53 bits: xorshift64 (Marsaglia 2003)."""
    bits = memory[place : place + 1].view(np.uint64)
    x = bits[0]
    x ^= x << np.uint64(_LEFT)
    x ^= x >> np.uint64(_RIGHT)
    x ^= x << np.uint64(_LEFT_AGAIN)
    bits[0] = x
    return (x >> np.uint64(_SPARE_BITS)) * (1.0 / _STEPS_OF_ONE)


@kernel
def gauss(memory: NDArray[np.float64], place: int) -> float:
    """Next standard normal number (Box and Muller 1958, one of the pair)."""
    radius = math.sqrt(-2.0 * math.log(1.0 - uniform(memory, place)))
    return radius * math.cos(2.0 * math.pi * uniform(memory, place))


@kernel
def quantised(value: float, quantum: float) -> float:
    """Reading of a sensor with the resolution `quantum`, in the unit of value; 0: not quantised."""
    return math.floor(value / quantum + 0.5) * quantum if quantum > 0.0 else value
