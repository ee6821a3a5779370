"""Columns of numbers as Arrow arrays, without a copy and without pandas, which `pyarrow.array` would import."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from mimics_app.contracts.arrays import F8

__all__ = ["arrow_numbers", "batch_of"]


def arrow_numbers(values: F8) -> pa.Array:
    """Return float64 values of shape [n] as an Arrow array."""
    kept = np.ascontiguousarray(values, np.float64)
    return pa.Array.from_buffers(pa.float64(), len(kept), [None, pa.py_buffer(kept)])


def batch_of(columns: list[F8], schema: pa.Schema) -> pa.RecordBatch:
    """Return columns of shape [n] each as a record batch of a schema."""
    return pa.RecordBatch.from_arrays([arrow_numbers(each) for each in columns], schema=schema)
