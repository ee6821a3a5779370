"""The consumer's end of a ring in plain Python: for a process that has no use for a compiler but this."""

from __future__ import annotations

from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_words import DROPPED, HEAD, TAIL

__all__ = ["RingReader"]

_LOCK = Lock()


def _fence() -> None:
    """What is before it happens before what is behind it, on processors that reorder loads, too.

    Giving back a lock keeps what is before from sinking below it, taking it again what is behind from rising above.
    x86-64 keeps the order of loads on its own.
    """
    for _ in range(2):
        with _LOCK:
            pass


class RingReader:
    """Consumes what `ring.push` appends; the only consumer of its ring.

    Args:
        words: Of the ring, shape [RING_WORDS].
        slots: Its records, shape [2**k].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[Any]) -> None:
        self._words, self._slots = words, slots

    @property
    def waiting(self) -> int:
        """How many records can be consumed now."""
        head = int(self._words[HEAD])
        _fence()
        return head - int(self._words[TAIL])

    @property
    def position(self) -> int:
        """How many records were consumed since the ring was made."""
        return int(self._words[TAIL])

    @property
    def dropped(self) -> int:
        """How many records found no room."""
        return int(self._words[DROPPED])

    def peek(self, out: NDArray[Any]) -> int:
        """Copy up to len(out) records into out, oldest first, and return how many; they stay until `release`."""
        count = min(self.waiting, len(out))
        first = self.position % len(self._slots)
        until_end = min(count, len(self._slots) - first)
        out[:until_end] = self._slots[first : first + until_end]
        out[until_end:count] = self._slots[: count - until_end]
        return count

    def release(self, count: int) -> None:
        """Give up the `count` oldest records, once they are safe elsewhere."""
        _fence()
        self._words[TAIL] += count
