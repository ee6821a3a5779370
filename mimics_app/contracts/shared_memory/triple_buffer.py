"""Triple buffer: newest-value exchange between one writer and one reader, wait-free, never torn, never backwards.

Three slots and one shared word. The writer fills its back slot and swaps it with the shared one; the reader swaps the
shared one with its front slot when it is fresh. Every swap is one atomic exchange. The payload is in arrays whose first
axis is the slot.
"""

from __future__ import annotations

from mimics_app.compiled.atomics import exchange, load_acquire
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Words
from mimics_app.contracts.shared_memory.shared_words import BACK, FRONT, SHARED

__all__ = ["acquire", "back_slot", "publish"]


_FRESH = 4
"""Bit of the shared word: the shared slot is newer than the reader's."""


@kernel
def back_slot(words: Words) -> int:
    """Writer: return the slot to fill."""
    return words[BACK]


@kernel
def publish(words: Words) -> int:
    """Writer: publish the filled back slot and return the next one to fill (with old content: write all of it)."""
    old = exchange(words, SHARED, words[BACK] | _FRESH)
    words[BACK] = old & 3
    return words[BACK]


@kernel
def acquire(words: Words) -> tuple[int, bool]:
    """Reader: return (front slot, True if newer than at the last call). The slot is valid until the next call."""
    if load_acquire(words, SHARED) & _FRESH:
        old = exchange(words, SHARED, words[FRONT])
        words[FRONT] = old & 3
        return words[FRONT], True
    return words[FRONT], False
