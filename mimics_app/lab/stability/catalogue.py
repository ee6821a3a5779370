"""Catalogue of the stability experiments: the modules `sNN_noun` here.

Each holds one `EXPERIMENT`, named by the beginning of its file (`s03r_wall_rate`: S3R), and is imported on request.
"""

from __future__ import annotations

import re
from importlib import import_module
from pkgutil import iter_modules

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.lab import stability
from mimics_app.lab.experiment import Experiment

__all__ = ["NAMES", "load_experiment", "load_experiments"]

_MODULES = {
    f"S{int(found[1])}{found[2].upper()}": found[0]
    for module in iter_modules(stability.__path__)
    if (found := re.match(r"s(\d\d)([a-z]?)_\w+", module.name))
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
    experiment: Experiment = import_module(f"{stability.__name__}.{_MODULES[key]}").EXPERIMENT
    return experiment


def load_experiments(names: tuple[str, ...] = ()) -> list[Experiment]:
    """Return the experiments of these names, or all."""
    return [load_experiment(name) for name in names or NAMES]
