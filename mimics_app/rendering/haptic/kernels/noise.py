"""Random numbers whose state lives in the caller's memory: the same seed gives the same run, bit for bit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel

__all__ = ["gauss", "seed_noise", "uniform"]


@kernel
def seed_noise(memory: NDArray[np.float64], place: int, seed: int) -> None:
    """Start the generator in memory[place] (64 bits, not a number) from a seed, by one round of splitmix64."""
    z = np.uint64(seed) + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    if z == np.uint64(0):
        z = np.uint64(1)
    memory[place : place + 1].view(np.uint64)[0] = z


@kernel
def uniform(memory: NDArray[np.float64], place: int) -> float:
    """Next number in [0, 1), 53 bits: xorshift64 (Marsaglia 2003)."""
    bits = memory[place : place + 1].view(np.uint64)
    x = bits[0]
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    bits[0] = x
    return (x >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@kernel
def gauss(memory: NDArray[np.float64], place: int) -> float:
    """Next normal number of mean 0 and deviation 1 (Box and Muller 1958, one of the pair)."""
    radius = math.sqrt(-2.0 * math.log(1.0 - uniform(memory, place)))
    return radius * math.cos(2.0 * math.pi * uniform(memory, place))
