"""Newest-value exchange between one writer and one reader: wait-free on both sides, never torn, never backwards.

Three slots and one shared word. The writer fills its back slot and swaps it with the shared one; the reader swaps the
shared one with its front slot when it is fresh. Every swap is one atomic exchange. The payload lives in arrays whose
first axis is the slot.
"""

from __future__ import annotations

from mimics_app.contracts.arrays import Words
from mimics_app.contracts.atomics import exchange, load_acquire
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.shared_words import BACK, FRONT, SHARED

__all__ = ["acquire", "back_slot", "publish"]


_FRESH = 4
"""Bit of the shared word: its slot is newer than the reader's."""


@kernel
def back_slot(words: Words) -> int:
    """Writer: the slot that may be filled now."""
    return words[BACK]


@kernel
def publish(words: Words) -> int:
    """Writer: offer the filled back slot and return the next one to fill (its content is old: write all of it)."""
    old = exchange(words, SHARED, words[BACK] | _FRESH)
    words[BACK] = old & 3
    return words[BACK]


@kernel
def acquire(words: Words) -> tuple[int, bool]:
    """Reader: (front slot, whether it is newer than at the last call). The slot is the reader's until the next call."""
    if load_acquire(words, SHARED) & _FRESH:
        old = exchange(words, SHARED, words[FRONT])
        words[FRONT] = old & 3
        return words[FRONT], True
    return words[FRONT], False
