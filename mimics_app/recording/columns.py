"""Columns of the haptic stream: their names, units, and which of them a replay feeds in, compares, or leaves alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SAMPLE

__all__ = [
    "INPUT_FIELDS",
    "OUTPUT_FIELDS",
    "ROW",
    "TIMING_FIELDS",
    "column_names",
    "column_units",
    "field_columns",
    "rows_of",
    "samples_of",
    "whole",
]

_NAMES = SAMPLE.names or ()

INPUT_FIELDS = _NAMES[_NAMES.index("q") : _NAMES.index("hip_world")]
"""What came from outside at each tick; a replay feeds these in."""

TIMING_FIELDS = ("lateness_ns", "duration_ns")
"""How punctual the live loop was; no part of the state hash, and never compared."""

OUTPUT_FIELDS = _NAMES[_NAMES.index("hip_world") : _NAMES.index(TIMING_FIELDS[0])]
"""What the tick computed; a replay compares these bit for bit."""

ROW = SAMPLE.itemsize // 8
"""float64 numbers in a sample."""

_JOINTS = ("m", "rad", "m")
_UNITS: dict[str, str | tuple[str, ...]] = {
    "t": "s",
    "tick": "1",
    "q": _JOINTS,
    "dq": ("m/s", "rad/s", "m/s"),
    "f_meas": "N",
    "grasp": "N",
    "age": "s",
    "delay": "s",
    "period_s": "s",
    "hip_world": "m",
    "v_world": "m/s",
    "f_virt_world": "N",
    "f_user_world": "N",
    "f_shapes": "N",
    "f_effects": "N",
    "f_grip": "N",
    "depth": "m",
    "f_tunnel": "N",
    "s": "pieces",
    "distance": "m",
    "offset_n": "m",
    "offset_b": "m",
    "penetration": "m",
    "ball_radius": "m",
    "tunnel_radius": "m",
    "v_virtual": "m/s",
    "command": ("m/s", "rad/s", "m/s"),
    "f_command": "N",
    "stiffness_limit": "N/m",
    "energy": "J",
    "credit": "J",
    "passivity": "N",
    "tank": "J",
    "lateness_ns": "ns",
    "duration_ns": "ns",
}


def _width(name: str) -> int:
    return int(SAMPLE[name].itemsize // 8)


def column_names() -> list[str]:
    """One name per float64 column of a sample, in order: "t", "tick", "q[0]", ..."""
    names: list[str] = []
    for name in _NAMES:
        width = _width(name)
        names += [name] if width == 1 else [f"{name}[{i}]" for i in range(width)]
    return names


def column_units() -> list[str]:
    """One unit per column, "1" for numbers without dimension."""
    units: list[str] = []
    for name in _NAMES:
        unit = _UNITS.get(name, "1")
        units += [unit] * _width(name) if isinstance(unit, str) else list(unit)
    return units


def field_columns(fields: tuple[str, ...]) -> NDArray[np.int64]:
    """Indices of the float64 columns of these fields, ascending."""
    columns: list[int] = []
    for name in _NAMES:
        if name in fields:
            start = int(SAMPLE.fields[name][1]) // 8  # type: ignore[index]
            columns += range(start, start + _width(name))
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
