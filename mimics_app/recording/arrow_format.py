"""The two Arrow streams of a run folder: how a block becomes bytes, and how bytes become blocks again.

Both are plain Arrow IPC streams that any Arrow reader opens. What is ours stands in places the format provides: column
names and units in the schema's metadata, and in each block's custom metadata its number, the place of its first row
since the start of the session, and a CRC32 over the rows and both numbers. All numbers are printed with a fixed width,
so blocks of equally many rows take equally many bytes.
"""

from __future__ import annotations

import io
import json
import struct
import zlib
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SCENE
from mimics_app.contracts.object_rows import ROW_DTYPES, Rows, unpack_rows
from mimics_app.recording.columns import ROW, column_names, column_units, rows_of, samples_of

__all__ = [
    "BLOCK_ROWS",
    "END_OF_STREAM",
    "INDEX_ROW",
    "Block",
    "decode_parameters",
    "decode_samples",
    "encode_parameters",
    "encode_samples",
    "parameters_dtype",
    "parameters_schema",
    "samples_schema",
    "schema_bytes",
]

BLOCK_ROWS = 50
"""Rows of a full block: 50 ms."""

INDEX_ROW = np.dtype([("seq", "<i8"), ("offset", "<i8"), ("length", "<i8")])
"""One row of the sidecar: number of a block, where it starts in the stream, and its length [bytes]."""

END_OF_STREAM = b"\xff\xff\xff\xff\x00\x00\x00\x00"
"""What closes an Arrow stream."""

_VALUES = ROW - 1  # t has a column of its own
_NUMBERS = struct.Struct("<qq")


@dataclass(frozen=True, slots=True)
class Block:
    """One block of a stream: its number, the place of its first row since the session's start, and its records.

    With a SCENE record come the tables of objects it counts.
    """

    seq: int
    first: int
    records: NDArray[Any]
    rows: Rows | None = None


@cache
def samples_schema() -> Any:
    """Schema of haptic.arrows: `t` [s] and `sample`, a list of the other columns of a tick, `column_names()[1:]`."""
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
        pa.field("sample", pa.list_(item, _VALUES), nullable=False),
    ]
    return pa.schema(fields, metadata=metadata)


@cache
def parameters_schema() -> Any:
    """Schema of parameters.arrows: `sequence` and `block`, the bytes of a SCENE record and of the rows it counts."""
    metadata = {
        "format": "mimics parameter blocks",
        "version": "2",
        "dtype": json.dumps(np.lib.format.dtype_to_descr(SCENE)),
        "rows": json.dumps({name: np.lib.format.dtype_to_descr(dtype) for name, dtype in ROW_DTYPES.items()}),
    }
    fields = [
        pa.field("sequence", pa.int64(), nullable=False),
        pa.field("block", pa.binary(), nullable=False),
    ]
    return pa.schema(fields, metadata=metadata)


def schema_bytes(schema: Any) -> bytes:
    """What a stream of this schema begins with."""
    return bytes(schema.serialize())


def encode_samples(samples: NDArray[Any], seq: int, first: int) -> bytes:
    """SAMPLE records [n] as one block of haptic.arrows."""
    rows = rows_of(samples)
    t = np.ascontiguousarray(rows[:, 0])
    values = np.ascontiguousarray(rows[:, 1:])
    schema = samples_schema()
    item = pa.Array.from_buffers(pa.float64(), values.size, [None, pa.py_buffer(values)])
    columns = [
        pa.Array.from_buffers(pa.float64(), len(t), [None, pa.py_buffer(t)]),
        pa.Array.from_buffers(schema.field(1).type, len(t), [None], children=[item]),
    ]
    crc = _crc(seq, first, t, values)
    return _encode(pa.RecordBatch.from_arrays(columns, schema=schema), seq, first, crc)


def decode_samples(data: bytes | memoryview) -> Block:
    """Read one block of haptic.arrows back.

    Raises:
        ValueError: It is no such block, or its CRC32 says that it was damaged.
    """
    batch, seq, first, crc = _decode(data, samples_schema())
    t = batch.column(0).to_numpy(zero_copy_only=True)
    values = batch.column(1).flatten().to_numpy(zero_copy_only=True).reshape(len(t), _VALUES)
    if _crc(seq, first, t, np.ascontiguousarray(values)) != crc:
        raise ValueError("the checksum does not agree")
    rows = np.empty((len(t), ROW))
    rows[:, 0] = t
    rows[:, 1:] = values
    return Block(seq, first, samples_of(rows))


def encode_parameters(block: bytes, seq: int) -> bytes:
    """The bytes of one SCENE record and its rows as one block of parameters.arrows; compressed: most is empty."""
    record = np.frombuffer(block, SCENE, 1)
    batch = pa.RecordBatch.from_arrays(
        [pa.array([int(record["sequence"][0])], pa.int64()), pa.array([block], pa.binary())],
        schema=parameters_schema(),
    )
    crc = _crc(seq, seq, np.frombuffer(block, np.uint8))
    return _encode(batch, seq, seq, crc, pa.ipc.IpcWriteOptions(compression="zstd"))


def decode_parameters(data: bytes | memoryview, schema: Any | None = None) -> Block:
    """Read one block of parameters.arrows back, with the dtypes it was written with: record of shape [1], rows.

    Raises:
        ValueError: It is no such block, or its CRC32 says that it was damaged.
    """
    schema = schema or parameters_schema()
    batch, seq, first, crc = _decode(data, schema)
    content = batch.column(1)[0].as_py()
    if _crc(seq, first, np.frombuffer(content, np.uint8)) != crc:
        raise ValueError("the checksum does not agree")
    dtype = parameters_dtype(schema)
    record = np.frombuffer(content, dtype, 1)
    if "objects" not in (dtype.names or ()):
        return Block(seq, first, record)
    return Block(seq, first, record, unpack_rows(content[dtype.itemsize :], record[0]["objects"], _row_dtypes(schema)))


def parameters_dtype(schema: Any) -> np.dtype[Any]:
    """Dtype of the SCENE records in a stream, which may be of an older version of the application."""
    description = json.loads(schema.metadata[b"dtype"])
    return np.lib.format.descr_to_dtype(_tuples(description))


def _row_dtypes(schema: Any) -> dict[str, np.dtype[Any]]:
    descriptions = json.loads(schema.metadata[b"rows"])
    return {name: np.lib.format.descr_to_dtype(_tuples(each)) for name, each in descriptions.items()}


def _tuples(description: Any) -> Any:
    """JSON has lists where a dtype description has tuples."""
    if isinstance(description, str):
        return description
    return [(name, _tuples(kind), *(tuple(shape) for shape in rest)) for name, kind, *rest in description]


def _crc(seq: int, first: int, *arrays: NDArray[Any]) -> int:
    crc = zlib.crc32(_NUMBERS.pack(seq, first))
    for array in arrays:
        crc = zlib.crc32(array.data, crc)
    return crc


def _encode(batch: Any, seq: int, first: int, crc: int, options: Any | None = None) -> bytes:
    sink = io.BytesIO()
    writer = pa.ipc.new_stream(sink, batch.schema, options=options)
    metadata = {"seq": f"{seq:016d}", "first": f"{first:016d}", "crc": f"{crc:08x}"}
    writer.write_batch(batch, custom_metadata=metadata)
    return sink.getvalue()[len(schema_bytes(batch.schema)) :]  # without the end mark, for the writer is not closed


def _decode(data: bytes | memoryview, schema: Any) -> tuple[Any, int, int, int]:
    try:
        message = pa.ipc.open_stream(schema_bytes(schema) + bytes(data)).read_next_batch_with_custom_metadata()
        metadata = message.custom_metadata
        message.batch.validate(full=True)
        return message.batch, int(metadata[b"seq"]), int(metadata[b"first"]), int(metadata[b"crc"], 16)
    except (pa.ArrowException, StopIteration, OSError, KeyError, TypeError, ValueError, EOFError) as error:
        raise ValueError(f"no whole block: {error}") from error
