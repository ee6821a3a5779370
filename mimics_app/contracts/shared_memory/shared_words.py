"""Layout of the int64 words of rings and triple buffers, for compiled code and for processes without it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BACK",
    "DROPPED",
    "EXCHANGE_WORDS",
    "FRONT",
    "HEAD",
    "RING_WORDS",
    "SHARED",
    "STOP_STRIDE",
    "TAIL",
    "initialise_exchange",
]

RING_WORDS = 24
"""Length of a ring's word array: head, tail and the count of dropped records, one cache line each."""

HEAD, TAIL, DROPPED = 0, 8, 16
"""Records appended, consumed and dropped since the ring was created; the consumer writes the second, the producer the
others."""

EXCHANGE_WORDS = 24
"""Length of a triple buffer's word array: three words, one cache line each."""

STOP_STRIDE = 8
"""Words from the stop word of one source of commands to that of the next: one cache line."""

SHARED, BACK, FRONT = 0, 8, 16
"""Words with the exchanged slot, the writer's slot and the reader's slot."""


def initialise_exchange(words: NDArray[np.int64]) -> None:
    """Assign slot 0 to the exchange, 1 to the writer, 2 to the reader; none is fresh."""
    words[SHARED], words[BACK], words[FRONT] = 0, 1, 2
