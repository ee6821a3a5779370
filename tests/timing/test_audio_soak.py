"""The soak of the audio process: that it counts what it mixed, and beside what load; figures belong to the bench."""

from __future__ import annotations

import pytest

from mimics_app.app.bench.audio_soak import measure_soak
from mimics_app.contracts.resources import root
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK
from mimics_app.rendering.audio.worker import WorkTimes


def test_work_times_are_percentiles_of_what_was_counted():
    times = WorkTimes()
    assert times.percentiles_us() == {}
    for took in (*([205_000] * 98), 950_000, 60_000_000):
        times.count(took)
    assert times.percentiles_us() == {"p50": 210.0, "p99": 960.0, "max": 60_000.0, "count": 100}


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
    assert reported["late_turns"] >= 0 and reported["voices"] == 64
