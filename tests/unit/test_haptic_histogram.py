"""The lateness histogram: bins without gaps, known resolution, exact counts."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.haptic.histogram import LinkReport, count, edges_ns, percentile_us


def test_every_value_falls_between_the_edges_of_its_bin():
    edges = edges_ns(2048)
    assert np.all(np.diff(edges) > 0)
    rng = np.random.default_rng(1)
    for value in [0, 1, 63, 64, 127, 128, 129, *(int(10**e) for e in rng.uniform(0, 10.5, 500))]:
        bins = np.zeros(2048, np.int64)
        count(bins, value)
        (index,) = np.flatnonzero(bins)
        assert edges[index] <= value < edges[index + 1]


def test_resolution_is_one_sixtyfourth():
    edges = edges_ns(2048)[64:]
    assert np.max(np.diff(edges) / edges[:-1]) <= 1 / 64


def test_negative_and_huge_values_are_counted_at_the_ends():
    bins = np.zeros(128, np.int64)
    count(bins, -5)
    count(bins, 10**15)
    assert bins[0] == 1 and bins[-1] == 1


def test_percentiles_of_a_known_distribution():
    bins = np.zeros(2048, np.int64)
    for value in range(1, 100_001):
        count(bins, value * 10)
    for share in (0.01, 0.5, 0.99, 0.999, 1.0):
        assert percentile_us(bins, share) == pytest.approx(share * 1000.0, rel=1 / 64 + 1e-3)
    assert percentile_us(np.zeros(2048, np.int64), 0.5) == 0.0


def test_the_quality_of_a_link_is_that_of_its_ages():
    bins = np.zeros(2048, np.int64)
    assert LinkReport.of(bins, 0) is None
    for k in range(1000):
        count(bins, 12_000_000 if k == 500 else 900_000 if k % 50 == 0 else 400_000)
    link = LinkReport.of(bins, 25)
    assert link is not None and link.fresh_share == 0.975
    assert link.worst_gap_ms == pytest.approx(12.0, rel=1 / 64)
    assert link.jitter_us == pytest.approx(500.0, abs=900 / 64)
