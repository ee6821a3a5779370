"""Points of a sweep: each is computed from its number alone, so any chunk can be computed anywhere."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.lab.sweep.quantity import Kind, SweepExperiment
from mimics_app.lab.sweep.spec import Range, Scalar, Sweep, count_values

__all__ = ["count_points", "points_between"]


def count_points(sweep: Sweep) -> int:
    """Return the number of points of a sweep."""
    if sweep.sample is not None:
        return sweep.sample.points
    return math.prod(count_values(values) for values in sweep.parameters.values())


def points_between(sweep: Sweep, experiment: SweepExperiment, start: int, stop: int) -> dict[str, list[Scalar]]:
    """Return the parameter values of points start .. stop - 1, by name.

    Parameters are in the order of their names: on a grid the last one varies fastest, in a sample each value comes from
    the point's own stream of random numbers.
    """
    names = sorted(sweep.parameters)
    kinds = {name: experiment.kind(name) for name in names}
    if sweep.sample is not None:
        drawn = [_drawn(sweep, names, kinds, point, sweep.sample.seed) for point in range(start, stop)]
    else:
        drawn = [_on_grid(sweep, names, kinds, point) for point in range(start, stop)]
    return {name: [row[name] for row in drawn] for name in names}


def _on_grid(sweep: Sweep, names: list[str], kinds: dict[str, Kind], point: int) -> dict[str, Scalar]:
    row: dict[str, Scalar] = {}
    for name in reversed(names):
        values = sweep.parameters[name]
        count = count_values(values)
        point, place = divmod(point, count)
        share = place / (count - 1) if count > 1 else 0.0
        row[name] = _typed(_between(values, share) if isinstance(values, Range) else _item(values, place), kinds[name])
    return row


def _drawn(sweep: Sweep, names: list[str], kinds: dict[str, Kind], point: int, seed: int) -> dict[str, Scalar]:
    shares = np.random.Generator(np.random.Philox(key=np.array([seed, point], np.uint64))).random(len(names))
    row: dict[str, Scalar] = {}
    for name, share in zip(names, shares.tolist(), strict=True):
        values = sweep.parameters[name]
        if not isinstance(values, Range):
            value = _item(values, min(int(share * count_values(values)), count_values(values) - 1))
        elif kinds[name] == "int" and values.scale == "linear":
            value = values.low + math.floor(share * (values.high - values.low + 1.0))
        else:
            value = _between(values, share)
        row[name] = _typed(value, kinds[name])
    return row


def _item(values: list[Scalar] | Scalar, place: int) -> Scalar:
    return values[place] if isinstance(values, list) else values


def _between(values: Range, share: float) -> float:
    if share >= 1.0:
        return values.high
    if values.scale == "log":
        return values.low * (values.high / values.low) ** share
    return values.low + share * (values.high - values.low)


def _typed(value: Scalar, kind: Kind) -> Scalar:
    if kind == "text" or isinstance(value, str):
        return str(value)
    return round(value) if kind == "int" else float(value)
