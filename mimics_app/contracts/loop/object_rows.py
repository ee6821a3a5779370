"""Tables of haptic objects beside a SCENE record: capacities, copies, and serialisation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.loop.haptic_objects import BODY, EFFECT, MAX_POINTS, POINT, SHAPE, TUNNEL, WIRE
from mimics_app.contracts.loop.reference_rows import CURVE

__all__ = [
    "ROW_DTYPES",
    "ObjectCapacities",
    "Rows",
    "count_rows",
    "has_objects",
    "new_rows",
    "pack_rows",
    "slot_of",
    "unpack_rows",
]


_NEIGHBOURS = 24
"""Pairs per shape: in a stack of equal cubes each has 26 neighbours, so 13 pairs; the rest is for unequal sizes."""


class Rows(NamedTuple):
    """Parameters of the objects from the main thread; the dtypes are in `ROW_DTYPES`."""

    shapes: Records
    bodies: Records
    effects: Records
    points: Records
    wires: Records
    tunnels: Records
    curves: Records


ROW_DTYPES: dict[str, np.dtype[Any]] = dict(
    zip(Rows._fields, (SHAPE, BODY, EFFECT, POINT, WIRE, TUNNEL, CURVE), strict=True)
)
"""Dtype of each table."""


@dataclass(frozen=True, slots=True)
class ObjectCapacities:
    """Capacities of the tables and of the paths of effects, fixed when the session is built."""

    shapes: int = 32
    bodies: int = 8
    effects: int = 16
    points: int = MAX_POINTS
    wires: int = 32
    paths: int = 4
    tunnels: int = 1
    curves: int = 1

    @property
    def pairs(self) -> int:
        """Capacity of pairs of close shapes: all pairs, or _NEIGHBOURS per shape."""
        return max(1, min(self.shapes * (self.shapes - 1) // 2, _NEIGHBOURS * self.shapes))


def new_rows(capacities: ObjectCapacities, *slots: int) -> Rows:
    """Return empty tables, shape [capacity] each, or [*slots, capacity]."""
    return Rows(
        *(np.zeros((*slots, getattr(capacities, name)), dtype) for name, dtype in ROW_DTYPES.items()),
    )


def count_rows(counts: np.void) -> dict[str, int]:
    """Return the rows in use by table, from a record of OBJECT_COUNTS; older versions may lack a table."""
    known = counts.dtype.names or ()
    return {name: int(counts[name]) if name in known else 0 for name in Rows._fields}


def has_objects(counts: np.void) -> bool:
    """Whether a record of OBJECT_COUNTS counts shapes, bodies or effects; tunnels do not need the objects' code."""
    return any(int(counts[name]) > 0 for name in ("shapes", "bodies", "effects"))


def slot_of(tables: Rows, slot: int, source: Rows, counts: np.void) -> None:
    """Copy the rows in use of `source` into slot `slot` of tables of shape [slots, capacity]."""
    for name, count in count_rows(counts).items():
        getattr(tables, name)[slot, :count] = getattr(source, name)[:count]


def pack_rows(rows: Rows, counts: np.void) -> bytes:
    """Serialise the rows in use, table by table."""
    return b"".join(getattr(rows, name)[:count].tobytes() for name, count in count_rows(counts).items())


def unpack_rows(data: bytes | memoryview, counts: np.void, dtypes: Mapping[str, np.dtype[Any]] = ROW_DTYPES) -> Rows:
    """Deserialise rows packed by `pack_rows`, as tables without spare rows.

    Args:
        data: The bytes.
        counts: Record of OBJECT_COUNTS of the packed rows.
        dtypes: Dtypes of the version that packed them; a table unknown to it stays empty.

    Raises:
        ValueError: The number of bytes is wrong.
    """
    numbers = count_rows(counts)
    dtypes = {**ROW_DTYPES, **dtypes}
    expected = sum(count * dtypes[name].itemsize for name, count in numbers.items())
    if len(data) != expected or min(numbers.values()) < 0:
        raise ValueError(f"{len(data)} bytes of rows where {expected} belong")
    tables, start = [], 0
    for name, count in numbers.items():
        tables.append(np.frombuffer(data, dtypes[name], count, start).copy())
        start += count * dtypes[name].itemsize
    return Rows(*tables)
