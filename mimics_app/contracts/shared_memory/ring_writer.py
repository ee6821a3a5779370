"""Producer of a ring buffer in plain Python, for processes without compiled code."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_memory.ring_reader import fence
from mimics_app.contracts.shared_memory.shared_words import DROPPED, HEAD, TAIL

__all__ = ["RingWriter"]


class RingWriter:
    """Producer of the records that `RingReader` consumes; the only producer of its ring.

    Args:
        words: Words of the ring, shape [RING_WORDS].
        slots: Records of the ring, shape [2**k].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[Any]) -> None:
        self._words, self._slots = words, slots

    @property
    def room(self) -> int:
        """Number of free slots."""
        return len(self._slots) - int(self._words[HEAD] - self._words[TAIL])

    def push(self, record: tuple[object, ...]) -> bool:
        """Append a record; return False, and count it as dropped, if the ring is full."""
        head = int(self._words[HEAD])
        if not self.room:
            self._words[DROPPED] += 1
            return False
        fence()
        self._slots[head % len(self._slots)] = record
        fence()
        self._words[HEAD] = head + 1
        return True
