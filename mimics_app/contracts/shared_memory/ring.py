"""Single-producer single-consumer ring buffer of records; records that find it full are counted as dropped."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.atomics import load_acquire, now_ns, sleep_until_ns, store_release
from mimics_app.compiled.kernel import kernel
from mimics_app.compiled.record_copy import copy_front, prefetch_line
from mimics_app.contracts.arrays import Words
from mimics_app.contracts.shared_memory.shared_words import DROPPED, HEAD, TAIL

__all__ = [
    "drain",
    "peek",
    "position",
    "prefetch_front",
    "push",
    "push_front",
    "release",
    "room",
    "wait_for_records",
    "waiting",
]

Records = NDArray[np.void]

_CACHE_LINE = 64
"""[bytes]."""


@kernel
def push(words: Words, slots: Records, record: Records) -> bool:
    """Producer: append record[0] to slots (structured, shape [2**k]); False, and counted, if the ring is full."""
    if _is_full(words, slots):
        return False
    slots[words[HEAD] & (slots.shape[0] - 1)] = record[0]
    store_release(words, HEAD, words[HEAD] + 1)
    return True


@kernel
def push_front(words: Words, slots: Records, record: Records, size: int) -> bool:
    """Producer: `push` of the first `size` bytes of the record; the others of its slot stay as they are."""
    if _is_full(words, slots):
        return False
    copy_front(slots[words[HEAD] & (slots.shape[0] - 1)], record[0], size)
    store_release(words, HEAD, words[HEAD] + 1)
    return True


@kernel
def prefetch_front(words: Words, slots: Records, size: int) -> None:
    """Producer: begin to load the memory of the next `push_front`: nothing was there since the ring went round."""
    slot = slots[words[HEAD] & (slots.shape[0] - 1)]
    for offset in range(0, size, _CACHE_LINE):
        prefetch_line(slot, offset)


@kernel
def _is_full(words: Words, slots: Records) -> bool:
    """Return whether there is no free slot, and count the record that finds none."""
    full: bool = words[HEAD] - load_acquire(words, TAIL) >= slots.shape[0]
    words[DROPPED] += 1 if full else 0
    return full


@kernel
def room(words: Words, slots: Records) -> int:
    """Producer: return the number of free slots."""
    return slots.shape[0] - (words[HEAD] - load_acquire(words, TAIL))


@kernel
def waiting(words: Words) -> int:
    """Consumer: return the number of records to drain."""
    return load_acquire(words, HEAD) - words[TAIL]


@kernel
def drain(words: Words, slots: Records, out: Records) -> int:
    """Consumer: move up to len(out) records to out, oldest first; return their number."""
    tail = words[TAIL]
    count = min(load_acquire(words, HEAD) - tail, out.shape[0])
    for i in range(count):
        out[i] = slots[(tail + i) & (slots.shape[0] - 1)]
    store_release(words, TAIL, tail + count)
    return count


@kernel
def position(words: Words) -> int:
    """Consumer: return the number of records consumed since the ring was created."""
    return words[TAIL]


@kernel
def peek(words: Words, slots: Records, out: Records) -> int:
    """Consumer: copy up to len(out) records to out, oldest first; return their number; they stay until `release`."""
    tail = words[TAIL]
    count = min(load_acquire(words, HEAD) - tail, out.shape[0])
    for i in range(count):
        out[i] = slots[(tail + i) & (slots.shape[0] - 1)]
    return count


@kernel
def release(words: Words, count: int) -> None:
    """Consumer: remove the `count` oldest records, after they were stored elsewhere."""
    store_release(words, TAIL, words[TAIL] + count)


@kernel
def wait_for_records(words: Words, timespec: Words, deadline_ns: int, step_ns: int) -> bool:
    """Poll a ring every `step_ns` until it holds a record (True) or the deadline has passed (False)."""
    while waiting(words) == 0:
        now = now_ns(timespec)
        if now >= deadline_ns:
            return False
        sleep_until_ns(timespec, min(now + step_ns, deadline_ns))
    return True
