"""Sweep experiment: stability of a sampled, delayed wall, simulated with the law and the integrator of the loop.

See `stability.wall_loop`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.stability.growth import LENGTHEN, QUARTERS, decay_sign
from mimics_app.lab.stability.wall_loop import press_wall
from mimics_app.lab.sweep.quantity import Columns, Quantity, SweepExperiment

__all__ = ["EXPERIMENT"]


_MOST_DELAY = 64
"""Largest delay [ticks]."""

_SHORTEST, _LONGEST = 2_000, 128_000
"""Lengths of the first and of the last run [ticks]."""


@kernel
def _decide(k: Vec, B: Vec, m: Vec, b: Vec, dt: Vec, delay: NDArray[np.int64], stable: NDArray[np.uint8]) -> None:
    """Whether the motion of each point dies away, as `growth.dies_away`."""
    line = np.zeros(_MOST_DELAY + 1)
    peaks = np.zeros(QUARTERS)
    for i in range(k.shape[0]):
        ticks, sign = _SHORTEST, 0
        while sign == 0:
            press_wall(k[i], B[i], m[i], b[i], dt[i], delay[i], ticks, line, peaks)
            sign = decay_sign(peaks, ticks >= _LONGEST)
            ticks *= LENGTHEN
        stable[i] = 1 if sign > 0 else 0


def _run(values: Columns, folder: Path) -> Columns:
    k, B, m, b, dt = (np.array(values[name], np.float64) for name in _ORDER)
    delay = np.array(values["delay_ticks"], np.int64)
    stable = np.zeros(len(delay), np.uint8)
    _decide(k, B, m, b, dt, delay, stable)
    return {"stable": stable.astype(bool).tolist()}


_ORDER = ("stiffness", "wall_damping", "mass", "device_damping", "period")

EXPERIMENT = SweepExperiment(
    name="wall_stability",
    what="whether a wall is stable: law and integrator of the loop, sampled and delayed",
    parameters={
        "stiffness": Quantity("float", "N/m", 1000.0, 0.0, 1e9),
        "wall_damping": Quantity("float", "N s/m", 0.0, 0.0, 1e6),
        "mass": Quantity("float", "kg", 3.0, 1e-6, 1e6),
        "device_damping": Quantity("float", "N s/m", 5.0, 0.0, 1e6),
        "period": Quantity("float", "s", 1e-3, 1e-6, 1.0),
        "delay_ticks": Quantity("int", "ticks", 0, 0, _MOST_DELAY),
    },
    results={"stable": "bool"},
    chunk=1000,
    run=_run,
)
