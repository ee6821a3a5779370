"""Layout of a recorded stream of samples: columns by version and device, mapped to those of this version."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass
from functools import cache

import msgspec
import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, MAX_CONTACTS, MAX_JOINTS, MAX_NUMBERS, Extent
from mimics_app.recording.columns import (
    HAPTICMASTER,
    column_name,
    column_names,
    column_units,
    name_of,
    present_columns,
    row_length,
)

__all__ = ["SampleLayout", "current_layout", "layout_of", "samples_schema"]


_EVER = frozenset({"t", "tick", "state", "hip_world", "v_world", "f_user_world", "f_meas", "q", "dq"})
"""Fields of SAMPLE recorded by every version."""

_LATER = frozenset({"calm", "f_ordered"})
"""Outputs that recordings of the present inputs may lack: they were made before the detector of oscillation."""

_OTHERS = {
    "world": "hip_world",
    "v_world": "v_world",
    "f_meas": "f_meas",
    "f_virt_world": "f_virt_world",
    "f_user_world": "f_user_world",
    "depth": "depth",
    "margin": "margin",
    "share": "stiffness_share",
    "energy": "energy",
}
"""Fields of earlier versions, named "others_...", that held some numbers of all points of contact after the first."""

_ABSENT, _NOTHING = -1, -2
"""Indices of columns that were not recorded, and of those that the device does not have."""


@dataclass(frozen=True, slots=True)
class SampleLayout:
    """Mapping of the rows of a haptic.arrows to samples.

    Attributes:
        schema: Arrow schema of the stream.
        width: Number of float64 values in a recorded row, `t` included.
        places: Index of each column of a sample among the recorded ones, -1 where it is absent, -2 where the device has
            none, shape [numbers in a sample of the device].
        absent: Names of the columns of this version that were not recorded, or in another unit; read as NaN.
        extent: Extent of the device; columns beyond it are read as 0.
    """

    schema: pa.Schema
    width: int
    places: NDArray[np.int64]
    absent: tuple[str, ...]
    extent: Extent = HAPTICMASTER

    @property
    def missing(self) -> tuple[str, ...]:
        """Absent columns among those that every version has recorded."""
        return tuple(name for name in self.absent if name.partition("[")[0] in _EVER)

    @property
    def uncompared(self) -> tuple[str, ...]:
        """Names of the columns that a replay does not compare: absent ones, and those that the device does not have."""
        return (*self.absent, *(name_of(int(i)) for i in np.flatnonzero(self.places == _NOTHING)))

    @property
    def current(self) -> bool:
        """Whether it is the layout of this version for the device."""
        names = column_names(self.extent)
        wanted = _places(self.extent, {name: i for i, name in enumerate(names)})
        return self.width == len(names) and bool((self.places == wanted).all())

    @property
    def replayable(self) -> bool:
        """Whether a replay has all it needs: what is absent are outputs that came later, which are not compared."""
        return all(name.partition("[")[0] in _LATER for name in self.absent)

    def rows(self, t: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return samples of this version and the device, from `t` [n] and the other columns [n, width-1]."""
        recorded = np.column_stack([t, values, np.zeros(len(t)), np.full(len(t), np.nan)])
        return recorded[:, self.places]


@cache
def samples_schema(extent: Extent = HAPTICMASTER) -> pa.Schema:
    """Return the schema of haptic.arrows: `t` [s], and `sample`, a list of the other columns that the device fills."""
    names, units = column_names(extent)[1:], column_units(extent)[1:]
    metadata = {
        "format": "mimics haptic stream",
        "version": "1",
        "columns": json.dumps(names),
        "units": json.dumps(units),
        "column": "sample",
        "t": "s",
    }
    if extent != HAPTICMASTER:
        metadata["device"] = json.dumps(asdict(extent))
    item = pa.field("item", pa.float64(), nullable=False)
    fields = [
        pa.field("t", pa.float64(), nullable=False, metadata={"unit": "s"}),
        pa.field("sample", pa.list_(item, len(names)), nullable=False),
    ]
    return pa.schema(fields, metadata=metadata)


@cache
def current_layout(extent: Extent = HAPTICMASTER) -> SampleLayout:
    """Return the layout of this version for a device."""
    schema = samples_schema(extent)
    names = column_names(extent)
    return SampleLayout(schema, len(names), _places(extent, {name: i for i, name in enumerate(names)}), (), extent)


def layout_of(schema: pa.Schema | None) -> tuple[SampleLayout, str]:
    """Return the layout of a schema and "", or this version's layout and why the schema cannot be read.

    Args:
        schema: Result of `read_schema`.
    """
    try:
        return _parse(schema), ""
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError, pa.ArrowException) as error:
        return current_layout(), f"its description of the columns cannot be read ({error})"


def _parse(schema: pa.Schema | None) -> SampleLayout:
    if schema is None:
        raise ValueError("no Arrow schema")
    kind = schema.field("sample").type
    if schema.names != ["t", "sample"] or schema.field("t").type != pa.float64() or kind.value_type != pa.float64():
        raise ValueError("other fields than t and sample")
    names, units = (json.loads(schema.metadata[key]) for key in (b"columns", b"units"))
    names = [_present_name(name) for name in names]
    if not len(names) == len(units) == len(set(names)) == kind.list_size:
        raise ValueError("not a name and a unit for each column")
    extent = _extent_of(schema.metadata.get(b"device"))
    units_of = dict(zip(names, units, strict=True)) | {"t": "s"}
    place_of = {name: i + 1 for i, name in enumerate(names)} | {"t": 0}
    wanted = list(zip(column_names(extent), column_units(extent), strict=True))
    known = {name: place_of[name] for name, unit in wanted if units_of.get(name) == unit}
    absent = tuple(name for name, _ in wanted if name not in known)
    if "tick" in absent:
        raise ValueError("no column of ticks")
    return SampleLayout(schema, len(names) + 1, _places(extent, known), absent, extent)


def _present_name(name: str) -> str:
    """Return this version's name of a column; that of an earlier one for points after the first: "others_world[3]"."""
    found = re.fullmatch(r"others_(\w+)\[(\d)\]", name)
    if found is None or found[1] not in _OTHERS:
        return str(name)
    field = next(field for field in LOOP_FIELDS if field.name == _OTHERS[found[1]])
    point, i = divmod(int(found[2]), field.size)
    return column_name(field, i, 1 + point)


def _places(extent: Extent, known: dict[str, int]) -> NDArray[np.int64]:
    """Return the index of each column of a sample among the recorded ones."""
    places = np.full(row_length(extent.contacts), _NOTHING, np.int64)
    places[present_columns(extent)] = [known.get(name, _ABSENT) for name in column_names(extent)]
    return places


def _extent_of(text: bytes | None) -> Extent:
    """Return the extent of a stream's device; recordings without one have that of a HapticMaster.

    Raises:
        ValueError: The extent is out of range.
    """
    if text is None:
        return HAPTICMASTER
    extent = msgspec.json.decode(text, type=Extent)  # its errors are ValueErrors
    if not (1 <= len(extent.joints) <= MAX_JOINTS and 1 <= extent.contacts <= MAX_CONTACTS):
        raise ValueError("a device of no or too many joints or points of contact")
    if set(extent.joints) - {"m", "rad"}:
        raise ValueError("joints in unknown units")
    if len(extent.numbers) > MAX_NUMBERS:
        raise ValueError("too many columns of a controller")
    return extent
