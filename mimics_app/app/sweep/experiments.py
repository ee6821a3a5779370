"""What can be swept, by name; an experiment is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.lab.sweep.quantity import SweepExperiment

__all__ = ["NAMES", "find_experiment"]


def _wall_stability() -> SweepExperiment:
    from mimics_app.lab.sweep.wall_stability import EXPERIMENT

    return EXPERIMENT


def _patient() -> SweepExperiment:
    from mimics_app.app.sweep.patient import EXPERIMENT

    return EXPERIMENT


_EXPERIMENTS: dict[str, Callable[[], SweepExperiment]] = {"wall_stability": _wall_stability, "patient": _patient}

NAMES = tuple(_EXPERIMENTS)
"""Names of the experiments."""


def find_experiment(name: str) -> SweepExperiment | None:
    """The experiment of a name, or None."""
    return _EXPERIMENTS[name]() if name in _EXPERIMENTS else None
