"""Sweep experiment: stability of a sampled, delayed wall, simulated with the law and the integrator of the loop.

The simulation is imported with the first point, so that a list of experiments does not wait for it.
"""

from __future__ import annotations

from pathlib import Path

from mimics_app.lab.sweep.quantity import Columns, Quantity, SweepExperiment

__all__ = ["EXPERIMENT"]


def _run(values: Columns, folder: Path) -> Columns:
    from mimics_app.lab.stability.wall_loop import decide

    return {"stable": decide(*(values[name] for name in _ORDER))}


_MOST_DELAY = 64
"""Largest delay [ticks]."""

_ORDER = ("stiffness", "wall_damping", "mass", "device_damping", "period", "delay_ticks")

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
