"""Shared-memory exchange with both sides in free-running compiled loops: nothing torn, nothing lost, order kept.

The degeneracy that makes such a test blind is a machine on which the two sides never run at once: then even a plain
copy is never torn. So the same run is made with a planted plain copy, which must be caught.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import sys
import threading

import numpy as np
import pytest

from mimics_app.compiled.atomics import load_acquire, now_ns, store_release
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import BodyFlag
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.segment import Segment
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.shared_words import EXCHANGE_WORDS, RING_WORDS, initialise_exchange
from mimics_app.rendering.haptic.objects import new_object_work
from tests.support.haptic_bench import patient_bench

ROOM = ObjectCapacities(bodies=99)
PAYLOAD = 64
WORDS = [("words", (EXCHANGE_WORDS,), np.int64), ("slots", (3, PAYLOAD), np.float64)]
RING = [("words", (RING_WORDS,), np.int64), ("slots", (4096,), np.dtype([("k", "f8"), ("v", "f8", (7,))]))]
CONTROL = [("control", (32,), np.int64)]
STOP, WRITES = 0, 8


@kernel
def _write(words, slots, control, planted):
    """Publish 64 times the count, again and again, until it is stopped. Planted: a plain copy into slot 0."""
    k = np.int64(0)
    while load_acquire(control, STOP) == 0:
        k += 1
        slot = 0 if planted else triple_buffer.back_slot(words)
        for i in range(slots.shape[1]):
            slots[slot, i] = float(k)
        if not planted:
            triple_buffer.publish(words)
        if k & 255 == 0:
            store_release(control, WRITES, k)
    store_release(control, WRITES, k)
    return k


@kernel
def _read(words, slots, duration_ns, planted, result):
    """Read for a time: result = reads, torn, backwards, fresh."""
    timespec = np.zeros(2, np.int64)
    end = now_ns(timespec) + duration_ns
    copy = np.zeros(slots.shape[1])
    last = 0.0
    while now_ns(timespec) < end:
        for _ in range(200):
            slot, fresh = (0, True) if planted else triple_buffer.acquire(words)
            for i in range(copy.shape[0]):
                copy[i] = slots[slot, i]
            result[0] += 1
            result[3] += 1 if fresh else 0
            for i in range(1, copy.shape[0]):
                if copy[i] != copy[0]:
                    result[1] += 1
                    break
            if copy[0] < last:
                result[2] += 1
            last = copy[0]


def _exchange(seconds: float, planted: bool) -> dict[str, int]:
    segment = Segment.for_arrays(WORDS + CONTROL)
    arrays = segment.arrays(WORDS + CONTROL)
    initialise_exchange(arrays["words"])
    result = np.zeros(4, np.int64)
    stopped = np.zeros(32, np.int64)
    stopped[STOP] = 1
    _write(arrays["words"], arrays["slots"], stopped, planted)  # compile before the threads start
    _read(arrays["words"], arrays["slots"], 0, planted, np.zeros(4, np.int64))
    args = (arrays["words"], arrays["slots"], arrays["control"], planted)
    writer = threading.Thread(target=_write, args=args, daemon=True)
    writer.start()
    _read(arrays["words"], arrays["slots"], int(seconds * 1e9), planted, result)
    arrays["control"][STOP] = 1
    writer.join(10.0)
    assert not writer.is_alive()
    names = ("reads", "torn", "backwards", "fresh")
    return dict(zip(names, result.tolist(), strict=True)) | {"writes": int(arrays["control"][WRITES])}


@pytest.mark.parametrize(
    ("seconds", "reads"), [(2.0, 1_000_000), pytest.param(10.5, 10_000_000, marks=pytest.mark.slow)]
)
def test_what_is_read_from_a_triple_buffer_is_whole_and_never_older(seconds: float, reads: int):
    """So many reads of 64 float64, for so long, while the two sides do meet."""
    result = _exchange(seconds, planted=False)
    more = 0.0
    # Where others use both cores, a side waits for whole time slices.
    while not _has_met(result, reads) and more < 40.0:
        extra = _exchange(2.0, planted=False)
        result = {name: result[name] + extra[name] for name in result}
        more += 2.0
    assert _has_met(result, reads), result
    assert (result["torn"], result["backwards"]) == (0, 0)


def _has_met(result: dict[str, int], reads: int) -> bool:
    return result["reads"] >= reads and result["fresh"] > 500 and result["writes"] > 10_000


def test_a_planted_plain_copy_is_caught():
    torn = 0
    for _ in range(10):
        torn += _exchange(1.0, planted=True)["torn"]
        if torn > 100:
            break
    assert torn > 100


@kernel
def _fill(words, slots, records, control):
    """Push `records` counted records, waiting for room; one record in 64 is pushed without waiting."""
    record = np.zeros(1, slots.dtype)
    for k in range(1, records + 1):
        record[0].k = float(k)
        for i in range(7):
            record[0].v[i] = k + 0.125 * i
        while ring.room(words, slots) == 0 and load_acquire(control, STOP) == 0:
            pass
        ring.push(words, slots, record)
    return records


@kernel
def _empty(words, slots, out, records, deadline_ns, result):
    """Drain until `records` came or time is up: result = received, wrong order, torn."""
    timespec = np.zeros(2, np.int64)
    end = now_ns(timespec) + deadline_ns
    while result[0] < records and now_ns(timespec) < end:
        count = ring.drain(words, slots, out)
        for j in range(count):
            result[0] += 1
            if out[j].k != float(result[0]):
                result[1] += 1
            for i in range(7):
                if out[j].v[i] != out[j].k + 0.125 * i:
                    result[2] += 1


@pytest.mark.parametrize("records", [300_000, pytest.param(2_000_000, marks=pytest.mark.slow)])
def test_ring_between_threads_loses_nothing_and_keeps_the_order(records: int):
    arrays = Segment.for_arrays(RING + CONTROL).arrays(RING + CONTROL)
    out, result = np.zeros(512, RING[1][2]), np.zeros(3, np.int64)
    _fill(arrays["words"], arrays["slots"], 0, arrays["control"])
    _empty(arrays["words"], arrays["slots"], out, 0, 0, result)
    args = (arrays["words"], arrays["slots"], records, arrays["control"])
    producer = threading.Thread(target=_fill, args=args, daemon=True)
    producer.start()
    _empty(arrays["words"], arrays["slots"], out, records, 60_000_000_000, result)
    arrays["control"][STOP] = 1
    producer.join(10.0)
    assert result.tolist() == [records, 0, 0]
    assert arrays["words"][ring.DROPPED] == 0


def test_full_ring_counts_what_it_drops_and_keeps_what_it_has():
    arrays = Segment.for_arrays(RING).arrays(RING)
    record = np.zeros(1, RING[1][2])
    for k in range(5000):
        record["k"] = k
        assert ring.push(arrays["words"], arrays["slots"], record) == (k < 4096)
    assert arrays["words"][ring.DROPPED] == 5000 - 4096
    out = np.zeros(5000, RING[1][2])
    assert ring.drain(arrays["words"], arrays["slots"], out) == 4096
    assert np.array_equal(out["k"][:4096], np.arange(4096))


def _other_process(segment: Segment, records: int, seconds: float) -> None:
    """Writer side of both exchanges in a process of its own."""
    arrays = segment.arrays(WORDS + CONTROL)
    more = segment.arrays(BETWEEN)
    writer = threading.Thread(target=_write, args=(arrays["words"], arrays["slots"], arrays["control"], False))
    writer.start()
    _fill(more["ring_words"], more["ring_slots"], records, arrays["control"])
    writer.join()


BETWEEN = [*WORDS, *CONTROL, ("ring_words", *RING[0][1:]), ("ring_slots", *RING[1][1:])]


def test_between_two_processes():
    segment = Segment.for_arrays(BETWEEN)
    arrays = segment.arrays(BETWEEN)
    initialise_exchange(arrays["words"])
    result, ringed, out = np.zeros(4, np.int64), np.zeros(3, np.int64), np.zeros(512, RING[1][2])
    _read(arrays["words"], arrays["slots"], 0, False, np.zeros(4, np.int64))
    _empty(arrays["ring_words"], arrays["ring_slots"], out, 0, 0, ringed)
    child = multiprocessing.get_context("spawn").Process(target=_other_process, args=(segment, 300_000, 2.0))
    child.start()
    try:
        _empty(arrays["ring_words"], arrays["ring_slots"], out, 300_000, 60_000_000_000, ringed)
        for _ in range(40):  # a busy machine gives either process its turn seldom
            _read(arrays["words"], arrays["slots"], 1_500_000_000, False, result)
            if result[3] > 1000:
                break
    finally:
        arrays["control"][STOP] = 1
        child.join(20.0)
    assert child.exitcode == 0
    assert ringed.tolist() == [300_000, 0, 0]
    assert result[1:3].tolist() == [0, 0] and result[3] > 1000


def free_bodies(velocities: np.ndarray, omegas: np.ndarray, positions: np.ndarray) -> Rows:
    """Bodies that nothing touches: they fly and turn as they were set going."""
    rows = new_rows(ROOM)
    count = len(velocities)
    bodies = rows.bodies[:count]
    bodies["flags"] = BodyFlag.TRANSLATION | BodyFlag.ROTATION
    bodies["spawn"], bodies["mass"], bodies["inertia"] = 1, 1.0, np.eye(3)
    bodies["position"], bodies["velocity"], bodies["omega"] = positions, velocities, omegas
    bodies["orientation"] = (0.0, 0.0, 0.0, 1.0)
    return rows


def test_a_hundred_bodies_pass_through_the_same_buffers():
    """99 turning and flying bodies: poses as the closed form says, in the slot the snapshot is in."""
    rng = np.random.default_rng(8)
    positions, velocities = rng.uniform(-1, 1, (99, 3)), rng.uniform(-0.5, 0.5, (99, 3))
    omegas = rng.uniform(-7, 7, (99, 3))
    omegas[0] = 0.0
    bench = patient_bench(capacities={"objects": ROOM}, objects=new_object_work(ROOM))
    bench.publish(rows=free_bodies(velocities, omegas, positions), objects__bodies=99)
    start = bench.engine.ticks
    for _ in range(100):
        bench.engine.advance(17)
        snapshot = bench.engine.snapshot()
    t = (bench.engine.ticks - start) * 1e-3
    assert np.allclose(snapshot.poses[:, :3], positions + t * velocities, atol=1e-11)
    rate = np.linalg.norm(omegas, axis=1)
    axis = np.divide(omegas, rate[:, None], out=np.zeros((99, 3)), where=rate[:, None] > 0)
    expected = np.concatenate([np.sin(rate * t / 2)[:, None] * axis, np.cos(rate * t / 2)[:, None]], axis=1)
    assert np.allclose(snapshot.poses[:, 3:], expected, atol=1e-11)  # 1700 products of unit quaternions


def test_more_bodies_than_there_is_room_for_are_refused():
    bench = patient_bench()
    with pytest.raises(ValueError, match="bodies is 99; it must be within 0 and 8"):
        bench.publish(rows=free_bodies(*np.zeros((3, 99, 3))), objects__bodies=99)


def test_a_hundred_bodies_between_live_loop_and_main_are_never_torn():
    """Every body moves 1 m/s along x from 0: in one snapshot all of them must stand at the same place."""
    velocities = np.tile([1.0, 0.0, 0.0], (99, 1))
    bench = patient_bench(capacities={"objects": ROOM}, objects=new_object_work(ROOM), recipe="plain")
    bench.publish(rows=free_bodies(velocities, 0.0 * velocities, 0.0 * velocities), objects__bodies=99)
    bench.engine.start()
    seen: list[float] = []
    while bench.engine.ticks < 1000 or (len(set(seen)) <= 50 and bench.engine.ticks < 20_000):  # on a busy machine
        poses = bench.engine.snapshot().poses
        assert np.all(poses[:, 0] == poses[0, 0])
        seen.append(float(poses[0, 0]))
    bench.engine.stop()
    assert np.all(np.diff(seen) >= 0.0) and len(set(seen)) > 50


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="counts descriptors in /proc")
def test_shared_memory_goes_with_its_last_holder():
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(5):
        SessionMemory()
    gc.collect()
    assert len(os.listdir("/proc/self/fd")) <= before
