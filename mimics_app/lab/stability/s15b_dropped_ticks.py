"""S15B: dropped ticks: a wall whose loop drops a share p of its ticks at random.

A period then lasts n ticks with probability p^(n-1) (1 - p), and its mean weighted by length is T (1 + p)/(1 - p), not
the mean period T/(1 - p): with 30 % dropped the wall needs 1.86 times the damping, by the mean period 1.43 times.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Points
from mimics_app.lab.stability.replayed_wall import (
    PERIOD,
    STIFFNESS,
    Stroke,
    Wakes,
    exact_needed,
    needed_damping,
    wakes_without,
    weighted_period,
)

__all__ = ["EXPERIMENT", "dropping", "expected_needed"]

_STROKE = Stroke(count=60)
_SEED = 15


def dropping(share: float, seed: int = _SEED) -> Wakes:
    """Return the ticks of a loop that drops each with probability `share`."""
    draws = np.random.default_rng(seed).random(round(_STROKE.seconds / PERIOD) + 1)
    return wakes_without(draws < share, _STROKE.seconds)


def expected_needed(share: float) -> float:
    """Return the mean required damping, K T (1 + p) / (2 (1 - p)) [N s/m]."""
    return 0.5 * STIFFNESS * PERIOD * (1.0 + share) / (1.0 - share)


def _simulate_grid(points: int) -> Outcome:
    shares = [float(share) for share in np.linspace(0.0, 0.6, max(points, 2))]
    wakes = {share: dropping(share) for share in shares}
    simulated: Points = [(100.0 * p, needed_damping(wakes[p], False, _STROKE)) for p in shares]
    exact: Points = [(100.0 * p, exact_needed(wakes[p], False, _STROKE)) for p in shares]
    expected: Points = [(100.0 * p, expected_needed(p)) for p in shares]
    rows = [
        {
            "dropped_percent": 100.0 * p,
            "weighted_period_ms": 1e3 * weighted_period(wakes[p]),
            "needed_N_s_m": simulated[i][1],
            "exact_N_s_m": exact[i][1],
            "expected_N_s_m": expected[i][1],
            "mean_period_N_s_m": 0.5 * STIFFNESS * PERIOD / (1.0 - p),
        }
        for i, p in enumerate(shares)
    ]
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={
            "K T (1 + p)/(2 (1 - p)), expected": expected,
            "K T / (2 (1 - p)), mean period": [(100.0 * p, rows[i]["mean_period_N_s_m"]) for i, p in enumerate(shares)],
        },
        note=(
            f"With {100.0 * shares[-1]:.0f} % of the ticks dropped the wall of 2 kN/m needs {simulated[-1][1]:.2f} "
            f"N s/m; the mean period promises {rows[-1]['mean_period_N_s_m']:.2f}."
        ),
    )


EXPERIMENT = Experiment(
    title="Dropped ticks: the damping a wall needs",
    claim=(
        "A wall generates energy exactly below the damping that the sum of its held forces gives; for ticks dropped "
        "at random that is K T (1 + p)/(2 (1 - p)) on average."
    ),
    x_label="ticks dropped at random [%]",
    y_label="damping that takes as much as the hold gives [N s/m]",
    kind="boundary",
    simulate=_simulate_grid,
)
