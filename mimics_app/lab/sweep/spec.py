"""Sweep file: an experiment and values of its parameters, on a grid or as a seeded random sample."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from mimics_app.contracts.errors import MOST_SOUGHT, Issue, SceneError, nearest
from mimics_app.lab.sweep.quantity import Quantity, SweepExperiment
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.struct_file import read_struct_file

__all__ = ["MAX_POINTS", "Range", "Sample", "Scalar", "Sweep", "count_values", "load_sweep", "span_of"]

Scalar = float | int | str
_Count = Annotated[int, Meta(ge=1, le=100_000_000)]
_End = Annotated[float, Meta(ge=-1e18, le=1e18)]
_Values = Annotated[list[Scalar], Meta(max_length=100_000)]
_MAX_BYTES = 64 << 20
"""Largest size of a sweep file [bytes]: lists of values can be long."""

MAX_POINTS = 1_000_000_000
"""Largest number of points of a sweep."""


class Range(
    msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename={"low": "from", "high": "to"}
):
    """Values from one to another, both included."""

    low: Annotated[_End, Meta(description="First value")]
    high: Annotated[_End, Meta(description="Last value")]
    count: Annotated[int, Meta(ge=1, le=10_000_000, description="How many, on a grid; a sample draws in between")] = 1
    scale: Annotated[Literal["linear", "log"], Meta(description="Equal steps, or equal ratios")] = "linear"


_Given = Range | list[Scalar] | Scalar
"""Values of one parameter in a file."""


class Sample(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Random points instead of a grid."""

    points: Annotated[int, Meta(ge=1, le=100_000_000, description="How many")]
    seed: Annotated[int, Meta(ge=0, le=2**63 - 1, description="Of the draw; the same seed draws the same points")] = 0


class Sweep(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One sweep."""

    format: Literal["mimics-sweep"]
    version: Literal[1]
    experiment: Annotated[str, Meta(description="Name of the experiment; mimics sweep --list names them")]
    title: Annotated[str, Meta(description="For people")] = ""
    parameters: Annotated[
        dict[str, Range | _Values | Scalar],
        Meta(description="By name: one value, a list of values, or a range. Not named: the experiment's default"),
    ] = msgspec.field(default_factory=dict)
    sample: Annotated[Sample | None, Meta(description="Absent: every combination of the values")] = None
    chunk: Annotated[_Count | None, Meta(description="Points that are computed and kept together")] = None

    @property
    def canonical(self) -> str:
        """Text of the sweep that is equal for equal points, however the file was written."""
        plain = {name: value for name, value in msgspec.to_builtins(self).items() if name not in ("title", "chunk")}
        return json.dumps(plain, sort_keys=True, separators=(",", ":"))

    @property
    def digest(self) -> str:
        """SHA-256 of the canonical text, in hexadecimal."""
        return hashlib.sha256(self.canonical.encode()).hexdigest()


def load_sweep(path: Path, find: Callable[[str], SweepExperiment | None], known: tuple[str, ...]) -> Sweep:
    """Read a sweep file.

    Args:
        path: The file.
        find: The experiment of a name, or None.
        known: Names of all experiments, for hints.

    Raises:
        SceneError: With every fault, with file and JSON pointer: unknown keys, experiments and parameters, values
            outside their limits.
    """
    file = str(path)
    sweep = read_struct_file(path, Sweep, _MAX_BYTES)
    experiment = find(sweep.experiment)
    if experiment is None:
        what = f'there is no experiment "{sweep.experiment}"'
        raise SceneError(Issue(file, "/experiment", what, nearest(sweep.experiment, known)))
    issues = [Issue(file, *fault) for fault in islice(_faults(sweep, experiment), MOST_SOUGHT)]
    if issues:
        raise SceneError(issues)
    return _with_defaults(sweep, experiment)


def _with_defaults(sweep: Sweep, experiment: SweepExperiment) -> Sweep:
    """Return the sweep with all defaults filled in, so that a changed default makes another sweep."""
    said: dict[str, Any] = {
        name: quantity.default for name, quantity in experiment.parameters.items() if name not in sweep.parameters
    }
    return msgspec.structs.replace(sweep, parameters={**sweep.parameters, **said})


def _faults(sweep: Sweep, experiment: SweepExperiment) -> Iterator[tuple[str, str, str]]:
    for name, values in sweep.parameters.items():
        pointer = f"/parameters/{escape(name)}"
        quantity = experiment.quantity(name)
        if quantity is None:
            yield pointer, f'"{experiment.name}" has no parameter "{name}"', nearest(name, experiment.parameters)
        else:
            yield from _value_faults(values, quantity, pointer)
    points = math.prod(map(count_values, sweep.parameters.values()))
    if sweep.sample is None and points > MAX_POINTS:
        yield "/parameters", f"{points:.3g} points are more than {MAX_POINTS:g}", 'draw a "sample" of them'
    for name, quantity in experiment.parameters.items():
        if quantity.default is None and name not in sweep.parameters:
            yield "/parameters", f'"{experiment.name}" needs the parameter "{name}"', f'add "{name}"'


def _value_faults(values: _Given, quantity: Quantity, pointer: str) -> Iterator[tuple[str, str, str]]:
    if isinstance(values, Range):
        yield from _range_faults(values, quantity, pointer)
    if isinstance(values, list) and not values:
        yield pointer, "has no values", "write one at least"
    for place, value in _placed(values, pointer):
        if quantity.kind == "text":
            if not isinstance(value, str):
                yield place, f"{value!r} is not a text", ""
            elif quantity.choices and value not in quantity.choices:
                yield place, f'there is no "{value}"', nearest(value, quantity.choices)
        elif isinstance(value, str):
            yield place, f'"{value}" is not a number', ""
        elif quantity.kind == "int" and value != math.floor(value):
            yield place, f"{value:g} must be a whole number", ""
        elif not quantity.low <= value <= quantity.high:
            yield place, f"{value:g} is outside {quantity.low:g} to {quantity.high:g} {quantity.unit}".rstrip(), ""


def _range_faults(values: Range, quantity: Quantity, pointer: str) -> Iterator[tuple[str, str, str]]:
    if quantity.kind == "text":
        yield pointer, "is a text and has no range", "write a list of texts"
    if values.scale == "log" and min(values.low, values.high) <= 0.0:
        yield f"{pointer}/scale", "equal ratios need values above 0", 'write "linear"'
    if values.high < values.low:
        yield f"{pointer}/to", "is below from", "exchange the two"


def _placed(values: _Given, pointer: str) -> Iterator[tuple[str, Scalar]]:
    """Yield each value in the file with its pointer."""
    if isinstance(values, Range):
        yield f"{pointer}/from", values.low
        yield f"{pointer}/to", values.high
    elif isinstance(values, list):
        for i, value in enumerate(values):
            yield f"{pointer}/{i}", value
    else:
        yield pointer, values


def count_values(values: _Given) -> int:
    """Return the number of values of a parameter on a grid."""
    return values.count if isinstance(values, Range) else len(values) if isinstance(values, list) else 1


def span_of(sweep: Sweep) -> Mapping[str, list[Scalar]]:
    """Return the values of each parameter; of a range its ends."""
    return {name: [value for _, value in _placed(values, "")] for name, values in sweep.parameters.items()}
