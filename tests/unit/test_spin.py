"""Length of the haptic loop's spin before a release."""

import numpy as np
import pytest

from mimics_app.rendering.haptic.live_loop import _SHARE_LATE, _STEP_NS, follow_latency

LONGEST = 60_000


def spins(latencies, begin=LONGEST, longest=LONGEST):
    """The spin after each wake-up [ns]."""
    spin, after = begin, []
    for latency in latencies:
        spin = follow_latency(spin, int(latency), longest)
        after.append(spin)
    return np.array(after)


@pytest.mark.parametrize("median", [4_000.0, 25_000.0])
def test_all_but_a_share_of_the_wake_ups_come_within_the_spin(median):
    """The steps up and down balance where the share of late wake-ups is the wanted one, in any distribution."""
    latencies = median * np.random.default_rng(7).lognormal(0.0, 0.3, 20_000)
    after = spins(latencies)
    late = np.mean(latencies[10_001:] > after[10_000:-1])
    # Between two equal spins the steps cancel; at most 20 of them are left after 10,000.
    assert late == pytest.approx(_SHARE_LATE, abs=20 / 10_000)
    assert after[10_000:].mean() == pytest.approx(np.quantile(latencies, 1.0 - _SHARE_LATE), rel=0.1)


def test_a_stall_moves_the_spin_by_one_step():
    before, after = spins([20_000, 1_000_000_000], begin=30_000)
    assert 0 < after - before <= _STEP_NS


def test_the_spin_stays_within_its_limits():
    assert spins(np.full(1000, 200_000)).max() == LONGEST
    assert spins(np.zeros(5000)).min() == 0
    assert set(spins([5_000, 0, 50_000], begin=0, longest=0)) == {0}
