"""S5: energy that a sampled spring generates in a tap, and the part that the passivity observer registers.

A hand enters a wall at speed v, turns at depth d and leaves as fast. Each force is held for a tick, too small on the
way in and too large on the way out: the wall generates K T v d (Gillespie & Cutkosky 1996), exactly, over all phases
of the ticks, K T v d - K (v T)^2 / 3 for v T <= d: the share of the edges. The same as a damping of -K T / 2. Summing
T f v instead of held force times displacement sees nothing of it.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of, points_of
from mimics_app.lab.haptic.taps import observed_leak

__all__ = ["EXPERIMENT", "closed_leak"]

_STIFFNESS = 2000.0
_RATE = 1000.0
_DEPTHS = (1e-3, 3e-3, 10e-3)


def closed_leak(speed: float, depth: float, stiffness: float = _STIFFNESS, rate: float = _RATE) -> float:
    """Return the same energy in closed form, for a tap of at least one tick: K T v d - K (v T)^2 / 3 [J]."""
    step = speed / rate
    return stiffness * step * depth - stiffness * step**2 / 3.0


def _row(speed: float, depth: float) -> Row:
    observed, naive = observed_leak(speed, depth)
    exact = closed_leak(speed, depth)
    return {
        "speed_m_s": speed,
        "depth_m": depth,
        "observed_j": observed,
        "exact_j": exact,
        "ktvd_j": _STIFFNESS * speed * depth / _RATE,
        "sum_of_t_f_v_j": naive,
        "damping_that_pays_ns_m": exact / (2.0 * speed * depth),
        "difference": abs(observed / exact - 1.0),
    }


def _simulate_grid(points: int) -> Outcome:
    speeds = [float(speed) for speed in np.geomspace(0.02, 0.5, points)]
    rows = [_row(speed, depth) for depth in _DEPTHS for speed in speeds]
    rules = {
        f"K T v d, {1e3 * depth:g} mm": points_of(
            (row for row in rows if row["depth_m"] == depth), "speed_m_s", "ktvd_j"
        )
        for depth in _DEPTHS
    }
    blind = max(abs(row["sum_of_t_f_v_j"]) / row["exact_j"] for row in rows)
    return Outcome(
        rows,
        *curves_of(rows, "speed_m_s", "observed_j", "exact_j"),
        rules=rules,
        note=f"2000 N/m at 1 kHz, taps of 1, 3 and 10 mm (lowest to highest curve). The passivity observer counts held "
        f"force times displacement and sees all of it; summing T f v sees {100.0 * blind:.1g} % at most.",
    )


EXPERIMENT = Experiment(
    title="Energy leak of a sampled spring",
    claim="A tap draws K T v d - K (v T)^2 / 3 from a sampled spring, and the passivity observer counts all of it.",
    x_label="speed of the tap [m/s]",
    y_label="energy given to the hand per tap [J]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=1e-3,
    log_x=True,
    log_y=True,
)
