"""The experiments, one function each: a module `sNN_noun` holds one `EXPERIMENT` and is imported when asked for."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.lab.experiment import Experiment

__all__ = ["NAMES", "load_experiment", "load_experiments"]

_EXPERIMENTS: dict[str, Callable[[], Experiment]] = {}
"""By name, in the order of their numbers."""

NAMES = tuple(_EXPERIMENTS)


def load_experiment(name: str) -> Experiment:
    """The experiment of a name like "S3" (any case).

    Raises:
        UsageError: There is none.
    """
    key = name.upper()
    if key not in _EXPERIMENTS:
        raise UsageError(f'there is no experiment "{name}"', nearest(key, NAMES))
    return _EXPERIMENTS[key]()


def load_experiments(names: tuple[str, ...] = ()) -> list[Experiment]:
    """The experiments of these names, or all of them."""
    return [load_experiment(name) for name in names or NAMES]
