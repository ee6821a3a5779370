"""S18: the stiffest stable wall at the foot of the gait orthosis against the rate of its control, and D2.1's 500 Hz.

"For haptic rendering typical sampling times are in the range of 500-1000 Hz. Below 500 Hz, the rendering can become
unstable, thus producing vibrations." The foot of a person who presses with 60 N, under impedance control with the
stiffness of the wall, and under combined control with that of its position control. Drives without dry friction, which
hides a vibration as long as it is small.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE
from mimics_app.lab.stability.leg_loop import LegBench

__all__ = ["EXPERIMENT", "compare", "holds_default"]

_SLOWEST, _FASTEST = 150.0, 4000.0  # [Hz]
_WALL, _BANDWIDTH = 8000.0, 40.0
"""Defaults of both controls: stiffness of a wall [N/m], and bandwidth of the position control [rad/s]."""

_PASSES, _FAILS = (500, 1000), 250
"""Rates at which both defaults must be stable, and at which the wall of impedance control must not [Hz]."""


def compare(kind: int, rate: int) -> Row:
    """Return a row: stiffest stable wall under a control at a rate [Hz], simulated and exact [N/m]."""
    bench = LegBench.at(rate)
    limits = bench.simulated_limit(kind), bench.exact_limit(kind)
    simulated, exact = (bench.stiffness(kind, limit) for limit in limits)
    return {
        "control": CONTROLS[kind],
        "rate_hz": rate,
        "simulated_n_m": simulated,
        "exact_n_m": exact,
        "difference": abs(simulated / exact - 1.0),
    }


def holds_default(kind: int, rate: int) -> bool:
    """Whether a foot on the default wall of a control comes to rest at a rate [Hz], by simulation."""
    return LegBench.at(rate).is_stable(kind, _WALL if kind == IMPEDANCE else _BANDWIDTH)


def _simulate_grid(points: int) -> Outcome:
    rates = [round(rate) for rate in np.geomspace(_SLOWEST, _FASTEST, points)]
    rows = [compare(kind, rate) for kind in (IMPEDANCE, COMBINED) for rate in rates]
    simulated, exact = curves_of(rows, "rate_hz", "simulated_n_m", "exact_n_m")
    least = float(np.interp(_WALL, [row["exact_n_m"] for row in rows[:points]], rates))
    passes = all(holds_default(kind, rate) for kind in (IMPEDANCE, COMBINED) for rate in _PASSES)
    ends = float(rates[0]), float(rates[-1])
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={
            "default wall of impedance control": [(end, _WALL) for end in ends],
            "500 Hz (D2.1 4.3.1)": [(500.0, min(y for _, y in exact)), (500.0, max(y for _, y in exact))],
        },
        holds=passes and not holds_default(IMPEDANCE, _FAILS),
        note="Impedance control is the lower curve, which rises about with the square root of the rate, and combined "
        f"control the upper one. The default wall of {_WALL:g} N/m is stable from {least:.0f} Hz on.",
    )


EXPERIMENT = Experiment(
    title="A foot on a wall against the rate of the orthosis' control",
    claim="The default wall of 8 kN/m shakes at 250 Hz, and both controls hold theirs at 500 and 1000 Hz.",
    x_label="rate of the control [Hz]",
    y_label="stiffest stable wall at the foot [N/m]",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
    log_y=True,
)
