"""Which columns a stream of samples was recorded with: by this version, an older or a newer one, of which device."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.contracts.loop_fields import MAX_CONTACTS, MAX_JOINTS, Extent
from mimics_app.recording.columns import HAPTICMASTER, ROW, column_names, column_units, present_columns

__all__ = ["SampleLayout", "current_layout", "layout_of", "samples_schema"]


_EVER = frozenset({"t", "tick", "state", "hip_world", "v_world", "f_user_world", "f_meas", "q", "dq"})
"""Fields of SAMPLE that every version has recorded."""

_ABSENT, _NOTHING = -1, -2
"""Places of what was not recorded, and of what the device does not have."""


@dataclass(frozen=True, slots=True)
class SampleLayout:
    """How the rows of a haptic.arrows become SAMPLE records.

    Attributes:
        schema: Arrow schema the stream was written with.
        width: float64 numbers in a recorded row, `t` included.
        places: Place of each column of a SAMPLE among the recorded ones, -1 where it is absent, -2 where the device has
            none, shape [ROW].
        absent: Names of the columns of this version that were not recorded, or in another unit; they read as NaN.
        extent: What of a sample the device has; the rest reads as 0.
    """

    schema: pa.Schema
    width: int
    places: NDArray[np.int64]
    absent: tuple[str, ...]
    extent: Extent = HAPTICMASTER

    @property
    def missing(self) -> tuple[str, ...]:
        """Absent columns without which nothing can be said of a run: those that every version has recorded."""
        return tuple(name for name in self.absent if name.partition("[")[0] in _EVER)

    @property
    def current(self) -> bool:
        """Whether it is just what this version records of this device."""
        wanted = _places(self.extent, dict(zip(column_names(self.extent), range(ROW), strict=False)))
        return self.width == len(column_names(self.extent)) and bool((self.places == wanted).all())

    def rows(self, t: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Samples as this version has them, shape [n, ROW], of `t` [n] and the other recorded columns [n, width-1]."""
        recorded = np.column_stack([t, values, np.zeros(len(t)), np.full(len(t), np.nan)])
        return recorded[:, self.places]


@cache
def samples_schema(extent: Extent = HAPTICMASTER) -> Any:
    """Schema of haptic.arrows: `t` [s] and `sample`, a list of the other columns of a tick that the device fills."""
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
    """The layout this version records of a device."""
    schema = samples_schema(extent)
    names = column_names(extent)
    return SampleLayout(schema, len(names), _places(extent, {name: i for i, name in enumerate(names)}), (), extent)


def layout_of(schema: pa.Schema | None) -> tuple[SampleLayout, str]:
    """The layout of a schema, and why it has none: the stream is then read as this version writes it.

    Args:
        schema: What `read_schema` found at the start of the stream.
    """
    try:
        return _parse(schema), ""
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError, pa.ArrowException) as error:
        return current_layout(), f"what its columns are cannot be read ({error})"


def _parse(schema: pa.Schema | None) -> SampleLayout:
    if schema is None:
        raise ValueError("no Arrow schema")
    kind = schema.field("sample").type
    if schema.names != ["t", "sample"] or schema.field("t").type != pa.float64() or kind.value_type != pa.float64():
        raise ValueError("other fields than t and sample")
    names, units = (json.loads(schema.metadata[key]) for key in (b"columns", b"units"))
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


def _places(extent: Extent, known: dict[str, int]) -> NDArray[np.int64]:
    """Place of each column of a SAMPLE, of those the device fills by name."""
    places = np.full(ROW, _NOTHING, np.int64)
    places[present_columns(extent)] = [known.get(name, _ABSENT) for name in column_names(extent)]
    return places


def _extent_of(text: bytes | None) -> Extent:
    """The device of a stream; recordings that name none are of a HapticMaster's kind.

    Raises:
        ValueError: It is none that could have been recorded.
    """
    if text is None:
        return HAPTICMASTER
    extent = msgspec.json.decode(text, type=Extent)  # its errors are ValueErrors
    if not (1 <= len(extent.joints) <= MAX_JOINTS and 1 <= extent.contacts <= MAX_CONTACTS):
        raise ValueError("a device of no or too many joints or points of contact")
    if set(extent.joints) - {"m", "rad"}:
        raise ValueError("joints in unknown units")
    return extent
