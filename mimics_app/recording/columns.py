"""Columns of the haptic stream: which a device fills, and which a replay feeds in, compares, or leaves alone."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SAMPLE
from mimics_app.contracts.loop_fields import LOOP_FIELDS, Extent, Replay

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
    "rows_of",
    "samples_of",
    "whole",
]

HAPTICMASTER = Extent()
"""What every version has recorded: three joints and one hand."""

_RECORDED = tuple(field for field in LOOP_FIELDS if field.replay is not Replay.ABSENT)


def _names_of(replay: Replay) -> tuple[str, ...]:
    return tuple(field.name for field in _RECORDED if field.replay is replay)


INPUT_FIELDS = _names_of(Replay.INPUT)
"""What came from outside at each tick; a replay feeds these in."""

TIMING_FIELDS = _names_of(Replay.TIMING)
"""How punctual the live loop was; no part of the state hash, and never compared."""

OUTPUT_FIELDS = _names_of(Replay.OUTPUT)
"""What the tick computed; a replay compares these bit for bit."""

ROW = SAMPLE.itemsize // 8
"""float64 numbers in a sample."""


@cache
def _present(extent: Extent) -> tuple[tuple[int, str, str], ...]:
    """Place in a sample, name and unit of every column that a device fills."""
    found: list[tuple[int, str, str]] = []
    start = 0
    for field in _RECORDED:
        for i, unit in enumerate(field.present(extent)):
            found.append((start + i, f"{field.name}[{i}]" if field.shape else field.name, unit))
        start += field.size
    return tuple(found)


def present_columns(extent: Extent = HAPTICMASTER) -> NDArray[np.int64]:
    """Places in a sample of the float64 columns that a device fills, ascending: those that are recorded."""
    return np.array([place for place, _, _ in _present(extent)], np.int64)


def column_names(extent: Extent = HAPTICMASTER) -> list[str]:
    """One name per recorded column, in order: "t", "tick", "q[0]", ..."""
    return [name for _, name, _ in _present(extent)]


def column_units(extent: Extent = HAPTICMASTER) -> list[str]:
    """One unit per recorded column, "1" for numbers without dimension."""
    return [unit for _, _, unit in _present(extent)]


def name_of(place: int) -> str:
    """Name of a column by its place in a sample, whether a device fills it or not."""
    for field in _RECORDED:
        if place < field.size:
            return f"{field.name}[{place}]" if field.shape else field.name
        place -= field.size
    raise IndexError(place)


def field_columns(fields: tuple[str, ...]) -> NDArray[np.int64]:
    """Indices of the float64 columns of these fields, ascending."""
    columns: list[int] = []
    start = 0
    for field in _RECORDED:
        if field.name in fields:
            columns += range(start, start + field.size)
        start += field.size
    return np.array(columns, np.int64)


def rows_of(samples: NDArray[Any]) -> NDArray[np.float64]:
    """View of SAMPLE records [n] as float64 rows [n, ROW], without a copy."""
    return np.ascontiguousarray(samples).view(np.float64).reshape(-1, ROW)


def samples_of(rows: NDArray[np.float64]) -> NDArray[Any]:
    """View of float64 rows [n, ROW] as SAMPLE records [n], without a copy."""
    return np.ascontiguousarray(rows, np.float64).reshape(-1, ROW).view(SAMPLE).reshape(-1)


def whole(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Whole numbers of a column, -1 where it holds none a 64-bit number can be: an older version lacks some."""
    known = np.isfinite(values) & (np.abs(values) < 2.0**62)
    return np.where(known, values, -1.0).astype(np.int64)
