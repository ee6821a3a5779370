"""Columns of the haptic stream: those that a device fills, and their role in a replay."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, Extent, Replay

__all__ = [
    "INPUT_FIELDS",
    "OUTPUT_FIELDS",
    "ROW",
    "TIMING_FIELDS",
    "column_names",
    "column_units",
    "field_columns",
    "name_of",
    "present_columns",
    "row_norms",
    "rows_of",
    "samples_of",
    "whole",
]

HAPTICMASTER = Extent()
"""Extent of the recordings of every version: three joints and one point of contact."""

_RECORDED = tuple(field for field in LOOP_FIELDS if field.replay is not Replay.ABSENT)


def _names_of(replay: Replay) -> tuple[str, ...]:
    return tuple(field.name for field in _RECORDED if field.replay is replay)


INPUT_FIELDS = _names_of(Replay.INPUT)
"""Inputs of a tick, which a replay feeds in."""

TIMING_FIELDS = _names_of(Replay.TIMING)
"""Timing of the live loop, excluded from the state hash and from comparisons."""

OUTPUT_FIELDS = _names_of(Replay.OUTPUT)
"""Outputs of a tick, which a replay compares bit for bit."""

ROW = SAMPLE.itemsize // 8
"""float64 numbers in a sample."""


@cache
def _present(extent: Extent) -> tuple[tuple[int, str, str], ...]:
    """Return index in a sample, name and unit of every column that a device fills."""
    found: list[tuple[int, str, str]] = []
    start = 0
    for field in _RECORDED:
        for i, unit in enumerate(field.present(extent)):
            found.append((start + i, f"{field.name}[{i}]" if field.shape else field.name, unit))
        start += field.size
    return tuple(found)


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
    for field in _RECORDED:
        if place < field.size:
            return f"{field.name}[{place}]" if field.shape else field.name
        place -= field.size
    raise IndexError(place)


def field_columns(fields: tuple[str, ...]) -> NDArray[np.int64]:
    """Return the indices of the float64 columns of these fields, ascending."""
    columns: list[int] = []
    start = 0
    for field in _RECORDED:
        if field.name in fields:
            columns += range(start, start + field.size)
        start += field.size
    return np.array(columns, np.int64)


def rows_of(samples: NDArray[Any]) -> NDArray[np.float64]:
    """Return a view of SAMPLE records [n] as float64 rows [n, ROW]."""
    return np.ascontiguousarray(samples).view(np.float64).reshape(-1, ROW)


def samples_of(rows: NDArray[np.float64]) -> NDArray[Any]:
    """Return a view of float64 rows [n, ROW] as SAMPLE records [n]."""
    return np.ascontiguousarray(rows, np.float64).reshape(-1, ROW).view(SAMPLE).reshape(-1)


def row_norms(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the Euclidean norm of each row [n, k], shape [n]."""
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))


def whole(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return a column as int64, -1 where it holds no such number, as where an older version lacks it."""
    known = np.isfinite(values) & (np.abs(values) < 2.0**62)
    return np.where(known, values, -1.0).astype(np.int64)
