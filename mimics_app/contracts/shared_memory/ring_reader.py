"""Consumer of a ring buffer in plain Python, for processes without compiled code."""

from __future__ import annotations

from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_memory.shared_words import DROPPED, HEAD, TAIL

__all__ = ["RingReader", "fence"]

_LOCK = Lock()


def fence() -> None:
    """Full memory fence, for processors that reorder loads.

    Releasing a lock keeps earlier accesses before it, acquiring it keeps later ones after it. x86-64 keeps the order of
    loads without it.
    """
    for _ in range(2):
        with _LOCK:
            pass


class RingReader:
    """Consumer of the records that `ring.push` appends; the only consumer of its ring.

    Args:
        words: Words of the ring, shape [RING_WORDS].
        slots: Records of the ring, shape [2**k].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[Any]) -> None:
        self._words, self._slots = words, slots

    @property
    def waiting(self) -> int:
        """Number of records to consume."""
        head = int(self._words[HEAD])
        fence()
        return head - int(self._words[TAIL])

    @property
    def position(self) -> int:
        """Number of records consumed since the ring was created."""
        return int(self._words[TAIL])

    @property
    def dropped(self) -> int:
        """Number of records dropped because the ring was full."""
        return int(self._words[DROPPED])

    def peek(self, out: NDArray[Any]) -> int:
        """Copy up to len(out) records to out, oldest first; return their number; they stay until `release`."""
        count = min(self.waiting, len(out))
        first = self.position % len(self._slots)
        until_end = min(count, len(self._slots) - first)
        out[:until_end] = self._slots[first : first + until_end]
        out[until_end:count] = self._slots[: count - until_end]
        return count

    def release(self, count: int) -> None:
        """Remove the `count` oldest records, after they were stored elsewhere."""
        fence()
        self._words[TAIL] += count
