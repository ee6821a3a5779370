"""Random numbers that are equal on every machine: PCG in integers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

__all__ = ["Rng"]

Item = TypeVar("Item")

_MASK64 = (1 << 64) - 1
_MULTIPLIER = 6364136223846793005


class Rng:
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
