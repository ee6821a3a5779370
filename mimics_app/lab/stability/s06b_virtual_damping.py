"""S6B: the damping that an admittance loop needs around a stiff arm, where no virtual mass helps.

An arm of 2 kg and 3000 N/m, as a person who stiffens against the robot. Total damping, virtual and the arm's own,
against the delay, for virtual masses of 3, 10 and 60 kg: the heavier, the more it needs, up to the closed low-frequency
limit k_h (T + n T + 1/w_p). Virtual damping is the cure for co-contraction, mass is not.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of
from mimics_app.lab.stability.held_robot import Hold
from mimics_app.lab.stability.s06_virtual_mass import ARMS, damping_rule, least_damping

__all__ = ["EXPERIMENT"]

_MASSES = (3.0, 10.0, 60.0)
_DELAYS = (4, 20)
_ARM = ARMS["stiff, little damped"]


def _row(mass: float, delay: int) -> Row:
    loop = Hold(_ARM, delay=delay)
    simulated, exact = least_damping(loop, mass)
    return {
        "virtual_mass_kg": mass,
        "delay_ticks": delay,
        "simulated_ns_m": simulated,
        "exact_ns_m": exact,
        "rule_ns_m": damping_rule(loop),
        "arm_damping_ns_m": _ARM.damping,
    }


def _simulate_grid(points: int) -> Outcome:
    delays = sorted({round(float(n)) for n in np.linspace(*_DELAYS, max(2, points // 3))})
    rows = [_row(mass, n) for mass in _MASSES for n in delays]
    lost = any(row["simulated_ns_m"] is None or row["exact_ns_m"] is None for row in rows)
    found = [row for row in rows if row["simulated_ns_m"] is not None and row["exact_ns_m"] is not None]
    return Outcome(
        rows,
        *curves_of(found, "delay_ticks", "simulated_ns_m", "exact_ns_m"),
        rules={"k_h (T + n T + 1/w_p)": [(float(n), damping_rule(Hold(_ARM, delay=n))) for n in delays]},
        holds=not lost,
        note="An arm of 2 kg and 3000 N/m; virtual masses of 3, 10 and 60 kg (lowest to highest curve). The arm's own "
        "10 N s/m are not enough; the rest must be virtual damping, and a heavier mass needs more of it.",
    )


EXPERIMENT = Experiment(
    title="Admittance: damping that a stiff arm needs",
    claim="The total damping a stiff arm needs is where an eigenvalue reaches 1, below k_h (T + n T + 1/w_p).",
    x_label="delay of the command [ticks of 1 ms]",
    y_label="least total damping b_v + b_h [N s/m]",
    kind="boundary",
    simulate=_simulate_grid,
)
