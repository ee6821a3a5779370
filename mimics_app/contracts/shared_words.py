"""Layout of the int64 words beside rings and triple buffers, for compiled code and for processes without a compiler."""

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
    "TAIL",
    "initialise_exchange",
]

RING_WORDS = 24
"""Length of a ring's word array: head, tail and the count of dropped records, each on a cache line of its own."""

HEAD, TAIL, DROPPED = 0, 8, 16
"""Records appended since the ring was made, records consumed, and records that found no room; the consumer writes the
second, the producer the others."""

EXCHANGE_WORDS = 24
"""Length of a triple buffer's word array: three words, each on a cache line of its own."""

SHARED, BACK, FRONT = 0, 8, 16
"""The slot in exchange, the writer's and the reader's."""


def initialise_exchange(words: NDArray[np.int64]) -> None:
    """Give slot 0 to the exchange, 1 to the writer, 2 to the reader; nothing is fresh."""
    words[SHARED], words[BACK], words[FRONT] = 0, 1, 2
