"""Newest value of a variable length in shared memory: one writer, any number of readers, in plain Python."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_memory.ring_reader import fence

__all__ = ["NEWEST_WORDS", "NewestReader", "NewestWriter"]

_NUMBER, _LENGTHS = 0, 8
"""Number of values written, on a cache line of its own, and the lengths of the two slots."""

NEWEST_WORDS = 16
"""Length of the word array."""


class NewestWriter:
    """Writer of a value; it fills the two slots by turns.

    Args:
        words: Words of the value, shape [NEWEST_WORDS].
        slots: The two slots, shape [2, capacity].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[np.uint8]) -> None:
        self._words, self._slots = words, slots

    def write(self, *parts: bytes | memoryview) -> bool:
        """Publish the parts as one value; False where they are too long, and the old value stays."""
        number = int(self._words[_NUMBER]) + 1
        slot = self._slots[number % 2]
        if sum(map(len, parts)) > len(slot):
            return False
        begin = 0
        for part in parts:
            slot[begin : begin + len(part)] = np.frombuffer(part, np.uint8)
            begin += len(part)
        self._words[_LENGTHS + number % 2] = begin
        fence()
        self._words[_NUMBER] = number
        return True


class NewestReader:
    """Reader of a value.

    The writer returns to a slot only after it has published the other one: a copy is whole if the number is the same
    after it as before.

    Args:
        words: Words of the value, shape [NEWEST_WORDS].
        slots: The two slots, shape [2, capacity].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[np.uint8]) -> None:
        self._words, self._slots = words, slots
        self._seen = 0

    def read(self) -> bytes | None:
        """Return the value; None where it is the same as at the last call, or was replaced meanwhile."""
        number = int(self._words[_NUMBER])
        if number == self._seen:
            return None
        fence()
        length = int(self._words[_LENGTHS + number % 2])
        value = self._slots[number % 2, :length].tobytes()
        fence()
        if int(self._words[_NUMBER]) != number:
            return None
        self._seen = number
        return value
