"""Stability experiments S1 to S16 in a sweep: disagreement of simulation and theory on finer grids."""

from __future__ import annotations

from pathlib import Path

from mimics_app.lab.stability.catalogue import load_experiment
from mimics_app.lab.sweep.quantity import Columns, Quantity, SweepExperiment

__all__ = ["stability_map"]

_FINEST = 64
"""Largest number of points along an axis: a map of two axes then takes minutes."""


def stability_map(name: str) -> SweepExperiment:
    """Return a stability experiment for sweeps, with a whole map for each point of the sweep.

    Args:
        name: One of `catalogue.NAMES`.
    """
    experiment = load_experiment(name)

    def run(values: Columns, folder: Path) -> Columns:
        outcomes = [experiment.run(points) for points in values["points"]]
        return {
            "rows": [len(outcome.rows) for outcome in outcomes],
            "disagreement": [outcome.disagreement for outcome in outcomes],
            "passed": [outcome.passed for outcome in outcomes],
        }

    return SweepExperiment(
        name=name,
        what=f"{experiment.title}: {experiment.claim}",
        parameters={"points": Quantity("int", "", 4, 2, _FINEST)},
        results={"rows": "int", "disagreement": "float", "passed": "bool"},
        chunk=1,
        run=run,
    )
