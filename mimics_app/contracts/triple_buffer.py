"""Newest-value exchange between one writer and one reader: wait-free on both sides, never torn, never backwards.

Three slots and one shared word. The writer fills its back slot and swaps it with the shared one; the reader swaps the
shared one with its front slot when it is fresh. Every swap is one atomic exchange. The payload lives in arrays whose
first axis is the slot.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.atomics import exchange, load_acquire
from mimics_app.contracts.kernel import kernel

__all__ = ["WORDS", "acquire", "back_slot", "initialise", "publish"]

Words = NDArray[np.int64]

WORDS = 24
"""Length of the word array: three words, each on a cache line of its own."""

_SHARED, _BACK, _FRONT = 0, 8, 16
_FRESH = 4


@kernel
def initialise(words: Words) -> None:
    """Give slot 0 to the exchange, 1 to the writer, 2 to the reader; nothing is fresh."""
    words[_SHARED] = 0
    words[_BACK] = 1
    words[_FRONT] = 2


@kernel
def back_slot(words: Words) -> int:
    """Writer: the slot that may be filled now."""
    return words[_BACK]


@kernel
def publish(words: Words) -> int:
    """Writer: offer the filled back slot and return the next one to fill (its content is old: write all of it)."""
    old = exchange(words, _SHARED, words[_BACK] | _FRESH)
    words[_BACK] = old & 3
    return words[_BACK]


@kernel
def acquire(words: Words) -> tuple[int, bool]:
    """Reader: (front slot, whether it is newer than at the last call). The slot is the reader's until the next call."""
    if load_acquire(words, _SHARED) & _FRESH:
        old = exchange(words, _SHARED, words[_FRONT])
        words[_FRONT] = old & 3
        return words[_FRONT], True
    return words[_FRONT], False
