"""A ring seen by others than its consumer: its newest records are copied and stay; a writer for rings without one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_memory.ring_reader import fence
from mimics_app.contracts.shared_memory.shared_words import HEAD

__all__ = ["HistoryWriter", "RingHistory"]


class HistoryWriter:
    """Producer of a ring that nobody consumes: the oldest records are overwritten.

    Args:
        words: Words of the ring, shape [RING_WORDS].
        slots: Records of the ring, shape [2**k].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[Any]) -> None:
        self._words, self._slots = words, slots

    def append(self, records: NDArray[Any]) -> None:
        """Append records, shape [n]; of more than half a ring only the newest."""
        records = records[-(len(self._slots) // 2) :]
        head = int(self._words[HEAD])
        first = head % len(self._slots)
        until_end = min(len(records), len(self._slots) - first)
        self._slots[first : first + until_end] = records[:until_end]
        self._slots[: len(records) - until_end] = records[until_end:]
        fence()
        self._words[HEAD] = head + len(records)


class RingHistory:
    """Reader of the newest records of a ring, beside its consumer.

    A record that the producer may have overwritten during the copy is left out. Producers write at most half a ring at
    once, so the older half is never trusted.

    Args:
        words: Words of the ring, shape [RING_WORDS].
        slots: Records of the ring, shape [2**k].

    Attributes:
        skipped: Records that were overwritten before they were read.
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[Any]) -> None:
        self._words, self._slots = words, slots
        self._next = int(words[HEAD])
        self.skipped = 0

    def take(self) -> NDArray[Any]:
        """Return a copy of the records since the last call, oldest first."""
        head = int(self._words[HEAD])
        fence()
        first = max(self._next, head - len(self._slots) // 2)
        records = self._slots[np.arange(first, head) % len(self._slots)]
        fence()
        safe = int(self._words[HEAD]) - len(self._slots) // 2
        lost = min(max(0, safe - first), len(records))
        self.skipped += first - self._next + lost
        self._next = head
        return records[lost:]
