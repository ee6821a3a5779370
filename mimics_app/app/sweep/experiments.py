"""Experiments of `mimics sweep` by name; each is imported when it is requested."""

from __future__ import annotations

from mimics_app.lab.stability import catalogue
from mimics_app.lab.sweep.quantity import SweepExperiment

__all__ = ["NAMES", "find_experiment"]

NAMES = ("wall_stability", "patient", *catalogue.NAMES)
"""Names of the experiments: walls, patients, and the stability experiments S1 to S16."""


def find_experiment(name: str) -> SweepExperiment | None:
    """Return the experiment of a name; None where there is none."""
    if name == "wall_stability":
        from mimics_app.lab.sweep.wall_stability import EXPERIMENT

        return EXPERIMENT
    if name == "patient":
        from mimics_app.app.sweep import patient

        return patient.EXPERIMENT
    if name in catalogue.NAMES:
        from mimics_app.lab.sweep.stability_map import stability_map

        return stability_map(name)
    return None
