"""Random numbers that are equal on every machine: PCG in integers, and a hash of lattice points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from mimics_app.contracts.arrays import F8, I8, U4

__all__ = ["Chance", "hash_noise", "mixed_bits", "pixels", "smooth_noise", "smooth_step"]

Item = TypeVar("Item")

_MASK64 = (1 << 64) - 1
_MULTIPLIER = 6364136223846793005


class Chance:
    """PCG-XSH-RR 64/32 (O'Neill 2014).

    Args:
        seed: Any whole number.
        stream: Name of the use: equal seeds of different streams are not related.
    """

    def __init__(self, seed: int, stream: str = "") -> None:
        self._increment = (int.from_bytes(stream.encode()[:8].ljust(8, b"\0"), "little") << 1 | 1) & _MASK64
        self._state = 0
        self._next()
        self._state = (self._state + seed) & _MASK64
        self._next()

    def below(self, bound: int) -> int:
        """Return an integer of [0, bound), each equally likely to within 2^-32."""
        return self._next() * bound >> 32

    def share(self) -> float:
        """Return a number of [0, 1) in steps of 2^-32."""
        return self._next() / 4294967296.0

    def between(self, low: float, high: float) -> float:
        """Return a number of [low, high), rounded to a thousandth."""
        return round(low + (high - low) * self.share(), 3)

    def pick(self, items: Sequence[Item]) -> Item:
        """Return one of the items."""
        return items[self.below(len(items))]

    def happens(self, share: float) -> bool:
        """Return True with this probability."""
        return self.share() < share

    def _next(self) -> int:
        state = self._state
        self._state = (state * _MULTIPLIER + self._increment) & _MASK64
        mixed = ((state >> 18) ^ state) >> 27 & 0xFFFFFFFF
        turn = state >> 59
        return (mixed >> turn | mixed << (-turn & 31)) & 0xFFFFFFFF


def hash_noise(x: I8, y: I8, seed: int) -> F8:
    """Return white noise of [0, 1) at lattice points.

    Args:
        x: Lattice points, int64, any shape.
        y: Of the same shape.
        seed: Seed of the noise.
    """
    value = (x.astype(np.uint32) * np.uint32(0x9E3779B1)) ^ (y.astype(np.uint32) * np.uint32(0x85EBCA77))
    return mixed_bits(value ^ np.uint32((seed * 0xC2B2AE3D) & 0xFFFFFFFF))


def mixed_bits(value: U4) -> F8:
    """Return numbers of [0, 1) in which every bit of a value counts: the low-bias 32-bit hash of Wellons (2018)."""
    for shift, factor in ((15, 0x2C1B3C6D), (12, 0x297A2D39)):
        value = (value ^ (value >> np.uint32(shift))) * np.uint32(factor)
    return (value ^ (value >> np.uint32(15))) / 4294967296.0


def smooth_noise(height: int, width: int, cells_y: int, cells_x: int, seed: int) -> F8:
    """Tileable value noise of [0, 1), float64 [height, width]: lattice values blended by 3t^2 - 2t^3.

    Only sums and products of single elements are used, which every machine rounds alike.
    """
    y = np.arange(height) * cells_y / height
    x = np.arange(width) * cells_x / width
    row, column = y.astype(np.int64)[:, None], x.astype(np.int64)[None, :]
    fy, fx = (y - np.floor(y))[:, None], (x - np.floor(x))[None, :]
    fy, fx = fy * fy * (3.0 - 2.0 * fy), fx * fx * (3.0 - 2.0 * fx)

    def corner(dy: int, dx: int) -> F8:
        at_y, at_x = np.broadcast_arrays((row + dy) % cells_y, (column + dx) % cells_x)
        return hash_noise(at_x, at_y, seed)

    top = corner(0, 0) * (1.0 - fx) + corner(0, 1) * fx
    bottom = corner(1, 0) * (1.0 - fx) + corner(1, 1) * fx
    return top * (1.0 - fy) + bottom * fy


def pixels(width: int, height: int) -> tuple[I8, I8]:
    """Return column and row of every pixel of an image, [height, width] each."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return x.astype(np.int64), y.astype(np.int64)


def smooth_step(low: float, high: float, value: F8) -> F8:
    """Return 0 below `low`, 1 above `high`, smooth between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))
