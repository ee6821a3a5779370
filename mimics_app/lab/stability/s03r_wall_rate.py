"""S3R: the stiffest stable wall against the rate of the loop, 60 to 4000 Hz, and the 500 Hz of D2.1 4.3.1.

"Below 500 Hz, the rendering can become unstable." The stiffest wall is 2 b / T for a device of damping b: at 500 Hz
5000 N/m with 5 N s/m, 2000 N/m with 2 N s/m. At the 60 Hz of a picture loop 5 N s/m allow 603 N/m, hence the wall is
rendered in the haptic loop.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Points, curves_of, points_of
from mimics_app.lab.stability.s03_stiffest_wall import compare
from mimics_app.lab.stability.wall_loop import Wall

__all__ = ["EXPERIMENT"]

_DAMPINGS = (2.0, 5.0, 15.0)
_LOWEST_RATE = 60.0
_HIGHEST_RATE = 4000.0


def _simulate_grid(points: int) -> Outcome:
    rates = [float(rate) for rate in np.geomspace(_LOWEST_RATE, _HIGHEST_RATE, points)]
    rows = [compare("rate", Wall(device_damping=b, rate=rate)) for b in _DAMPINGS for rate in rates]
    simulated, exact = curves_of(rows, "rate_hz", "simulated_n_m", "exact_n_m")
    rules: dict[str, Points] = {
        f"2 b/T, b = {b:g} N s/m": points_of(
            (row for row in rows if row["device_damping_ns_m"] == b), "rate_hz", "rule_n_m"
        )
        for b in _DAMPINGS
    }
    rules["500 Hz (D2.1 4.3.1)"] = [(500.0, min(y for _, y in exact)), (500.0, max(y for _, y in exact))]
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules=rules,
        note="A device of 3 kg with 2, 5 and 15 N s/m of its own (lowest to highest curve). The 500 Hz of D2.1 are no "
        "limit of their own: the stiffest wall grows with rate times damping, 5000 N/m at 500 Hz and 5 N s/m.",
    )


EXPERIMENT = Experiment(
    title="Stiffest stable wall from 60 to 4000 Hz",
    claim="The stiffest stable wall is 2 b / T: proportional to the rate, with nothing special at 500 Hz.",
    x_label="rate of the wall [Hz]",
    y_label="stiffest stable wall [N/m]",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
    log_y=True,
)
