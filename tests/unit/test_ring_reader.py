"""The plain end of a ring against the compiled producer: nothing lost or torn, round the end and while it runs."""

from __future__ import annotations

import threading

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.ring_reader import RingReader
from mimics_app.contracts.shared_memory.shared_words import RING_WORDS

RECORD = np.dtype([("k", "f8"), ("v", "f8", (7,))])


def new_ring(size: int) -> tuple[np.ndarray, np.ndarray, RingReader]:
    words, slots = np.zeros(RING_WORDS, np.int64), np.zeros(size, RECORD)
    return words, slots, RingReader(words, slots)


def push_numbers(words: np.ndarray, slots: np.ndarray, first: int, count: int) -> int:
    record, taken = np.zeros(1, RECORD), 0
    for k in range(first, first + count):
        record["k"], record["v"] = k, k
        taken += ring.push(words, slots, record)
    return taken


@kernel
def _push_all(words, slots, record, count):
    """Push the numbers up to a count, waiting for room."""
    k = 0
    while k < count:
        record[0].k = k
        for i in range(record[0].v.shape[0]):
            record[0].v[i] = k
        if ring.room(words, slots) > 0:
            ring.push(words, slots, record)
            k += 1


def test_records_come_in_order_across_the_end_of_the_ring_and_losses_are_counted() -> None:
    words, slots, reader = new_ring(8)
    out = np.zeros(6, RECORD)
    assert (reader.waiting, reader.peek(out)) == (0, 0)
    assert push_numbers(words, slots, 0, 6) == 6
    assert reader.peek(out) == 6
    assert list(out["k"]) == [0, 1, 2, 3, 4, 5]
    assert reader.position == 0  # they stay until they are safe
    reader.release(5)
    assert (reader.position, reader.waiting) == (5, 1)
    assert push_numbers(words, slots, 6, 9) == 7
    assert (reader.waiting, reader.dropped) == (8, 2)
    assert reader.peek(out) == 6
    assert list(out["k"]) == [5, 6, 7, 8, 9, 10]
    reader.release(6)
    assert reader.peek(out) == 2
    assert list(out["k"][:2]) == [11, 12]


def test_nothing_is_torn_or_lost_while_a_compiled_producer_runs() -> None:
    words, slots, reader = new_ring(256)
    record, count = np.zeros(1, RECORD), 200_000
    _push_all(words, slots, record, 1)  # compiled before the race
    reader.release(1)
    writer = threading.Thread(target=_push_all, args=(words, slots, record, count))
    writer.start()
    out, seen = np.zeros(64, RECORD), 0
    while seen < count:
        taken = reader.peek(out)
        part = out[:taken]
        assert np.array_equal(part["k"], np.arange(seen, seen + taken))
        assert np.all(part["v"] == part["k"][:, None])
        reader.release(taken)
        seen += taken
    writer.join()
    assert reader.dropped == 0
