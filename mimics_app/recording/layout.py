"""Which columns a stream of samples was recorded with: by this version, an older or a newer one."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.recording.columns import ROW, column_names, column_units

__all__ = ["SampleLayout", "current_layout", "layout_of", "samples_schema"]


_EVER = frozenset({"t", "tick", "state", "hip_world", "v_world", "f_user_world", "f_meas", "q", "dq"})
"""Fields of SAMPLE that every version has recorded."""


@dataclass(frozen=True, slots=True)
class SampleLayout:
    """How the rows of a haptic.arrows become SAMPLE records.

    Attributes:
        schema: Arrow schema the stream was written with.
        width: float64 numbers in a recorded row, `t` included.
        places: Place of each column of a SAMPLE among the recorded ones, -1 where it is absent, shape [ROW].
        absent: Names of the columns of this version that were not recorded, or in another unit; they read as NaN.
    """

    schema: Any
    width: int
    places: NDArray[np.int64]
    absent: tuple[str, ...]

    @property
    def missing(self) -> tuple[str, ...]:
        """Absent columns without which nothing can be said of a run: those that every version has recorded."""
        return tuple(name for name in self.absent if name.partition("[")[0] in _EVER)

    @property
    def current(self) -> bool:
        """Whether it is just what this version records."""
        return self.width == ROW and bool((self.places == np.arange(ROW)).all())

    def rows(self, t: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rows as this version records them, shape [n, ROW], of `t` [n] and the other recorded columns [n, width-1]."""
        recorded = np.column_stack([t, values, np.full(len(t), np.nan)])
        return recorded[:, self.places]  # -1 is the last: not a number


@cache
def samples_schema() -> Any:
    """Schema of haptic.arrows: `t` [s] and `sample`, a list of the other columns of a tick."""
    metadata = {
        "format": "mimics haptic stream",
        "version": "1",
        "columns": json.dumps(column_names()[1:]),
        "units": json.dumps(column_units()[1:]),
        "column": "sample",
        "t": "s",
    }
    item = pa.field("item", pa.float64(), nullable=False)
    fields = [
        pa.field("t", pa.float64(), nullable=False, metadata={"unit": "s"}),
        pa.field("sample", pa.list_(item, ROW - 1), nullable=False),
    ]
    return pa.schema(fields, metadata=metadata)


@cache
def current_layout() -> SampleLayout:
    """The layout this version records."""
    return SampleLayout(samples_schema(), ROW, np.arange(ROW), ())


def layout_of(schema: Any | None) -> tuple[SampleLayout, str]:
    """The layout a schema tells of, and why it tells of none: the stream is then read as this version writes it.

    Args:
        schema: What `read_schema` found at the start of the stream.
    """
    try:
        return _parse(schema), ""
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError, pa.ArrowException) as error:
        return current_layout(), f"what its columns are cannot be read ({error})"


def _parse(schema: Any | None) -> SampleLayout:
    if schema is None:
        raise ValueError("no Arrow schema")
    kind = schema.field("sample").type
    if schema.names != ["t", "sample"] or schema.field("t").type != pa.float64() or kind.value_type != pa.float64():
        raise ValueError("other fields than t and sample")
    names, units = (json.loads(schema.metadata[key]) for key in (b"columns", b"units"))
    if not len(names) == len(units) == len(set(names)) == kind.list_size:
        raise ValueError("not a name and a unit for each column")
    units_of = dict(zip(names, units, strict=True)) | {"t": "s"}
    place_of = {name: i + 1 for i, name in enumerate(names)} | {"t": 0}
    wanted = list(zip(column_names(), column_units(), strict=True))
    places = [place_of[name] if units_of.get(name) == unit else -1 for name, unit in wanted]
    absent = tuple(name for (name, _), place in zip(wanted, places, strict=True) if place < 0)
    if "tick" in absent:
        raise ValueError("no column of ticks")
    return SampleLayout(schema, len(names) + 1, np.array(places, np.int64), absent)
