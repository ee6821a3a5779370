"""Columns of the haptic stream: those that a device fills, and their role in a replay."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.loop_fields import (
    LOOP_FIELDS,
    MAX_CONTACTS,
    Extent,
    LoopField,
    Per,
    Replay,
    sample_dtype,
)

__all__ = [
    "OUTPUT_FIELDS",
    "TIMING_FIELDS",
    "RecordedField",
    "column_name",
    "column_names",
    "column_units",
    "field_columns",
    "name_of",
    "present_columns",
    "recorded_fields",
    "row_length",
    "row_norms",
    "rows_of",
    "samples_of",
    "whole",
]

HAPTICMASTER = Extent()
"""Extent of the recordings of every version: three joints and one point of contact."""

_RECORDED = tuple(field for field in LOOP_FIELDS if field.replay is not Replay.ABSENT)
_OF_EACH_POINT = tuple(field for field in _RECORDED if field.per is Per.POINT)


def _names_of(replay: Replay) -> tuple[str, ...]:
    return tuple(field.name for field in _RECORDED if field.replay is replay)


TIMING_FIELDS = _names_of(Replay.TIMING)
"""Timing of the live loop, excluded from the state hash and from comparisons."""

OUTPUT_FIELDS = _names_of(Replay.OUTPUT)
"""Outputs of a tick, which a replay compares bit for bit."""

_DTYPES = {dtype.itemsize // 8: dtype for dtype in (sample_dtype(LOOP_FIELDS, 1 + c) for c in range(MAX_CONTACTS))}
"""Dtype of the samples of a device by the float64 numbers in one, from one point of contact up."""


def row_length(contacts: int) -> int:
    """Return the number of float64 numbers in a sample of a device with so many points of contact."""
    return list(_DTYPES)[contacts - 1]


@dataclass(frozen=True, slots=True)
class RecordedField:
    """A field of a device's samples: one or more columns.

    Attributes:
        name: As in the recording: "hip_world", of the second point of contact "point_1_hip_world".
        field: Name in the samples.
        point: Number of the point of contact; 0 also where the field is one of the device.
        units: Unit of each component that the device fills.
        vector: Whether its components are numbered, even where there is one.
    """

    name: str
    field: str
    point: int
    units: tuple[str, ...]
    vector: bool


def recorded_fields(extent: Extent) -> tuple[RecordedField, ...]:
    """Return the fields that a device fills, in the order of the recording."""
    fields = []
    for _, field, point in _places(extent.contacts):
        units = field.present(extent)
        if field.per is Per.CONTROLLER:
            fields += [RecordedField(name, field.name, point, (unit,), vector=False) for name, unit in extent.numbers]
        elif units:
            fields.append(RecordedField(_field_name(field, point), field.name, point, units, bool(field.shape)))
    return tuple(fields)


def _field_name(field: LoopField, point: int) -> str:
    return f"point_{point}_{field.name}" if point else field.name


def column_name(field: LoopField, i: int, point: int = 0) -> str:
    """Return the name of a column: component i of a field, of a point of contact."""
    name = _field_name(field, point)
    return f"{name}[{i}]" if field.shape else name


def _places(contacts: int) -> list[tuple[int, LoopField, int]]:
    """Return first index in a sample, field, and point of contact, in the order of the recording."""
    rows = [(field, 0) for field in _RECORDED]
    rows += [(field, point) for point in range(1, contacts) for field in _OF_EACH_POINT]
    starts = np.concatenate([[0], np.cumsum([field.size for field, _ in rows])]).tolist()
    return [(start, *row) for start, row in zip(starts, rows, strict=False)]


@cache
def _present(extent: Extent) -> tuple[tuple[int, str, str], ...]:
    """Return index in a sample, name and unit of every column that a device fills."""
    return tuple(
        (start + i, extent.numbers[i][0] if field.per is Per.CONTROLLER else column_name(field, i, point), unit)
        for start, field, point in _places(extent.contacts)
        for i, unit in enumerate(field.present(extent))
    )


def present_columns(extent: Extent = HAPTICMASTER) -> NDArray[np.int64]:
    """Return the indices in a sample of the float64 columns that a device fills, ascending: those recorded."""
    return np.array([place for place, _, _ in _present(extent)], np.int64)


def column_names(extent: Extent = HAPTICMASTER) -> list[str]:
    """Return the names of the recorded columns in order: "t", "tick", "q[0]", ..."""
    return [name for _, name, _ in _present(extent)]


def column_units(extent: Extent = HAPTICMASTER) -> list[str]:
    """Return the units of the recorded columns, "1" for dimensionless numbers."""
    return [unit for _, _, unit in _present(extent)]


def name_of(place: int) -> str:
    """Return the name of a column by its index in a sample, whether a device fills it or not."""
    for start, field, point in _places(MAX_CONTACTS):
        if start <= place < start + field.size:
            return column_name(field, place - start, point)
    raise IndexError(place)


def field_columns(fields: tuple[str, ...]) -> NDArray[np.int64]:
    """Return the indices of the float64 columns of these fields, ascending, of every point of contact."""
    columns: list[int] = []
    for start, field, _ in _places(MAX_CONTACTS):
        if field.name in fields:
            columns += range(start, start + field.size)
    return np.array(columns, np.int64)


def rows_of(samples: NDArray[Any]) -> NDArray[np.float64]:
    """Return a view of samples [n] as float64 rows [n, numbers in one]."""
    return np.ascontiguousarray(samples).view(np.float64).reshape(-1, samples.dtype.itemsize // 8)


def samples_of(rows: NDArray[np.float64]) -> NDArray[Any]:
    """Return a view of float64 rows [n, `row_length` of the device] as its samples [n]."""
    return np.ascontiguousarray(rows, np.float64).view(_DTYPES[rows.shape[1]]).reshape(-1)


def row_norms(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the Euclidean norm of each row [n, k], shape [n]."""
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))


def whole(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return a column as int64, -1 where it holds no such number, as where an older version lacks it."""
    known = np.isfinite(values) & (np.abs(values) < 2.0**62)
    return np.where(known, values, -1.0).astype(np.int64)
