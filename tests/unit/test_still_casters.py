"""Casters drawn over the kept depths of others: the kernel against sets."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.visual.software.kernels.shadow_prisms import find_moving


def _by_sets(casters: np.ndarray, kept: np.ndarray, moved_at: np.ndarray, kept_in: int, last: int) -> list[int] | None:
    if not set(kept.tolist()) <= set(casters.tolist()) or (moved_at[kept] > kept_in).any():
        return None
    over = [item for item in casters.tolist() if item not in set(kept.tolist())]
    return over if all(moved_at[item] > last for item in over) else None


def test_moving_casters_are_those_that_are_not_kept_and_moved_lately():
    rng, held = np.random.default_rng(3), 0
    for _ in range(2000):
        count = int(rng.integers(1, 12))
        moved_at = rng.choice([0, 5, 30], count, p=[0.5, 0.1, 0.4])
        casters = np.flatnonzero(rng.random(count) < 0.8).astype(np.int32)
        among = casters if rng.random() < 0.9 else np.arange(count, dtype=np.int32)
        kept = among[moved_at[among] <= rng.choice([0, 5])].astype(np.int32)
        wanted = _by_sets(casters, kept, moved_at, 4, 10)
        marks, moving = np.full(count, 7, np.uint8), np.empty(len(casters), np.int32)
        found = find_moving(casters, kept, moved_at, 4, 10, marks, moving)
        assert found == (-1 if wanted is None else len(wanted))
        assert wanted is None or moving[:found].tolist() == wanted
        held += wanted is not None
    assert 300 < held < 1700
