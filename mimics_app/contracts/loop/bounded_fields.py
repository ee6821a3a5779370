"""Records with integer fields that index or choose: each such field is declared with its largest value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

__all__ = ["Bounded", "choice_of", "largest_values", "record"]


class Bounded(NamedTuple):
    """Type of an integer field of 0 to `largest`."""

    largest: int
    format: str = "i4"


def choice_of(kind: type[IntEnum], format_: str = "i4") -> Bounded:
    """Return the type of a field that holds a member of an enumeration that counts from 0."""
    return Bounded(int(max(kind)), format_)


_LARGEST: dict[np.dtype[Any], Mapping[str, int]] = {}
"""Largest values of the bounded fields, by record type."""


def record(fields: Sequence[tuple[Any, ...]]) -> np.dtype[Any]:
    """Return an aligned record type.

    Args:
        fields: As numpy takes them, with `Bounded` as the type of a bounded field.
    """
    bounded = {name: type_.largest for name, type_, *_ in fields if isinstance(type_, Bounded)}
    plain = [(name, type_.format if name in bounded else type_, *shape) for name, type_, *shape in fields]
    dtype = np.dtype(plain, align=True)
    _LARGEST[dtype] = bounded
    return dtype


def largest_values(dtype: np.dtype[Any]) -> Mapping[str, int]:
    """Return the largest value of each bounded field of a record type."""
    return _LARGEST[dtype]
