"""Catalogue of the stability experiments; a module `sNN_noun` holds one `EXPERIMENT` and is imported on request."""

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
    "S4": "s04_quantised_wall",
    "S5": "s05_energy_leak",
    "S5B": "s05b_energy_dissipated",
    "S6": "s06_virtual_mass",
    "S6B": "s06_virtual_damping",
    "S7": "s07_joint_pd",
    "S8": "s08_printed_equations",
    "S9": "s09_admittance_forms",
    "S10": "s10_corner_slide",
    "S10B": "s10b_rounded_edge",
    "S11": "s11_held_object",
    "S11B": "s11b_lugre_step",
    "S12": "s12_rotation_drift",
    "S12B": "s12b_free_top",
    "S13": "s13_mass_ratio",
    "S13B": "s13b_stack",
    "S14": "s14_tunnel_frame",
    "S14B": "s14b_closest_point",
    "S15": "s15_late_ticks",
    "S15B": "s15b_dropped_ticks",
    "S16": "s16_contact_directions",
}
"""Module of this package by the name of its experiment, in the order of their numbers."""

NAMES = tuple(_MODULES)


def load_experiment(name: str) -> Experiment:
    """Return the experiment of a name such as "S3", in any case.

    Raises:
        UsageError: There is none.
    """
    key = name.upper()
    if key not in _MODULES:
        raise UsageError(f'there is no experiment "{name}"', nearest(key, NAMES))
    experiment: Experiment = import_module(f"{__package__}.{_MODULES[key]}").EXPERIMENT
    return experiment


def load_experiments(names: tuple[str, ...] = ()) -> list[Experiment]:
    """Return the experiments of these names, or all."""
    return [load_experiment(name) for name in names or NAMES]
