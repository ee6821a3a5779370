"""The experiments, one line each: a module `sNN_noun` holds one `EXPERIMENT` and is imported when asked for."""

from __future__ import annotations

from importlib import import_module

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.lab.experiment import Experiment

__all__ = ["NAMES", "load_experiment", "load_experiments"]

_MODULES = {
    "S1": "s01_integrators",
    "S2": "s02_free_mass",
    "S3": "s03_stiffest_wall",
    "S3R": "s03_wall_rate",
    "S7": "s07_joint_pd",
    "S9": "s09_admittance_forms",
    "S10": "s10_corner_slide",
    "S11": "s11_held_object",
    "S11B": "s11b_lugre_step",
    "S12": "s12_rotation_drift",
    "S12B": "s12b_free_top",
    "S13": "s13_mass_ratio",
    "S13B": "s13b_stack",
}
"""Modules of this folder by the name of their experiment, in the order of their numbers."""

NAMES = tuple(_MODULES)


def load_experiment(name: str) -> Experiment:
    """The experiment of a name like "S3" (any case).

    Raises:
        UsageError: There is none.
    """
    key = name.upper()
    if key not in _MODULES:
        raise UsageError(f'there is no experiment "{name}"', nearest(key, NAMES))
    module = import_module(f"{__package__}.{_MODULES[key]}")
    experiment: Experiment = module.EXPERIMENT
    return experiment


def load_experiments(names: tuple[str, ...] = ()) -> list[Experiment]:
    """The experiments of these names, or all of them."""
    return [load_experiment(name) for name in names or NAMES]
