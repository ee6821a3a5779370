"""The soak of the audio process: that it counts what it mixed, and beside what load; figures belong to the bench."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.app.bench.audio_soak import measure_soak
from mimics_app.app.bench.stall_witness import explain_gaps
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK
from mimics_app.rendering.audio.worker import WorkTimes


def test_work_times_are_percentiles_of_what_was_counted():
    times = WorkTimes()
    assert times.percentiles_us() == {}
    for took in (*([205_000] * 98), 950_000, 60_000_000):
        times.count(took)
    assert times.percentiles_us() == {"p50": 210.0, "p99": 960.0, "max": 60_000.0, "count": 100}


def test_a_gap_is_explained_by_a_stall_shortly_before_it():
    """Gaps at the end of a stall of 5 ms, of a queue too long for it, long after it, and after a stall too short."""
    stalls = np.array([[900_000_000, 901_500_000], [100_000_000, 105_000_000]])
    held = explain_gaps(stalls, [(106e6, 6.0), (107e6, 15.5), (500e6, 6.0), (902e6, 6.0)], 1.0)
    assert held["before_gap_ms"] == pytest.approx([5.0, 5.0, 0.0, 1.5])
    assert (held["unexplained"], held["count"], held["longest_ms"], held["total_ms"]) == pytest.approx((3, 2, 5.0, 6.5))
    assert held["chance"] == pytest.approx(0.035)
    quiet = explain_gaps(np.zeros((0, 2), np.int64), [(1e6, 6.0)], 1.0)
    assert (quiet["unexplained"], quiet["chance"], quiet["longest_ms"]) == (1, 0.0, 0.0)


def test_stalls_of_two_cores_at_once_count_once():
    """Three of 4 ms that overlap or follow each other: 9 ms in all."""
    stalls = np.array([[102_000_000, 106_000_000], [100_000_000, 104_000_000], [110_000_000, 114_000_000]])
    (stalled,) = explain_gaps(stalls, [(113e6, 13.0)], 1.0)["before_gap_ms"]
    assert stalled == pytest.approx(9.0)


@pytest.mark.slow
@pytest.mark.parametrize("load", [False, True])
def test_a_soak_counts_every_block(load):
    """Where the device was late one turn may mix two."""
    reported = measure_soak(root() / "scenes" / "wavy_tunnel.json", 6.0, load=load)
    assert reported["block_us"]["count"] >= 0.4 * 6.0 * 48_000 / LIVE_BLOCK
    assert 0.0 < reported["block_us"]["p50"] <= reported["block_us"]["p99"] <= reported["block_us"]["max"]
    assert bool(reported["loop"]) == load
    if load:  # the figure beside which gaps are read
        assert set(reported["loop"]["lateness_us"]) == {"p50", "p99", "p99_9", "max"}
    assert reported["missed"] >= 0 and reported["queue"]["ms"] <= reported["queue"]["longest_ms"] <= 20.0
    if "stalls" in reported:  # not where real-time priority is refused
        assert len(reported["stalls"]["before_gap_ms"]) == reported["missed"]
    assert reported["late_turns"] >= 0 and reported["voices"] == 64
