"""Experiments of `mimics sweep` by name; each is imported when it is requested."""

from __future__ import annotations

from pathlib import Path

from mimics_app.lab.stability import catalogue
from mimics_app.lab.stability.catalogue import describe_experiment, load_experiment
from mimics_app.lab.sweep.quantity import Columns, Quantity, SweepExperiment

__all__ = ["NAMES", "find_experiment"]

NAMES = ("wall_stability", "patient", *catalogue.NAMES)
"""Names of the experiments: walls, patients, and the stability experiments S1 to S18."""


_FINEST = 64
"""Largest number of points along an axis: a map of two axes then takes minutes."""


def find_experiment(name: str) -> SweepExperiment | None:
    """Return the experiment of a name; None where there is none."""
    if name == "wall_stability":
        from mimics_app.lab.sweep.wall_stability import EXPERIMENT

        return EXPERIMENT
    if name == "patient":
        from mimics_app.app.sweep import patient

        return patient.EXPERIMENT
    if name in catalogue.NAMES:
        return _stability_map(name)
    return None


def _stability_map(name: str) -> SweepExperiment:
    """Return a stability experiment for sweeps, with a whole map for each point of the sweep.

    Args:
        name: One of `catalogue.NAMES`.
    """

    def run(values: Columns, folder: Path) -> Columns:
        experiment = load_experiment(name)
        outcomes = [experiment.run(points) for points in values["points"]]
        return {
            "rows": [len(outcome.rows) for outcome in outcomes],
            "disagreement": [outcome.disagreement for outcome in outcomes],
            "passed": [outcome.passed for outcome in outcomes],
        }

    return SweepExperiment(
        name=name,
        what=describe_experiment(name),
        parameters={"points": Quantity("int", "", 4, 2, _FINEST)},
        results={"rows": "int", "disagreement": "float", "passed": "bool"},
        chunk=1,
        run=run,
    )
