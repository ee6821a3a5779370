"""Encoding and decoding of the blocks of a run folder's Arrow streams.

All are plain Arrow IPC streams that any Arrow reader opens. The schema's metadata holds names and units of the columns;
each block's custom metadata holds its number, the index of its first row since the start of the session, and a CRC32
over the rows and both numbers. Rows are compressed without loss. Streams of earlier versions are not compressed and are
read as well.
"""

from __future__ import annotations

import io
import json
import re
import struct
import zlib
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.contracts.loop.object_rows import ROW_DTYPES, Rows, unpack_rows
from mimics_app.recording.column_layout import SampleLayout, current_layout, samples_schema
from mimics_app.recording.columns import HAPTICMASTER, present_columns, rows_of, samples_of
from mimics_app.recording.older_blocks import rows_with_tunnel

__all__ = [
    "BLOCK_ROWS",
    "END_OF_STREAM",
    "INDEX_ROW",
    "Block",
    "compressed",
    "decode_batch",
    "decode_parameters",
    "decode_samples",
    "encode_batch",
    "encode_parameters",
    "encode_samples",
    "parameters_dtype",
    "parameters_schema",
    "rows_crc",
    "schema_bytes",
]

BLOCK_ROWS = 50
"""Rows of a full block: 50 ms."""

INDEX_ROW = np.dtype([("seq", "<i8"), ("offset", "<i8"), ("length", "<i8")])
"""Row of the sidecar: number of a block, its offset in the stream and its length [bytes]."""

END_OF_STREAM = b"\xff\xff\xff\xff\x00\x00\x00\x00"
"""End mark of an Arrow stream."""

_NUMBERS = struct.Struct("<qq")
_FIELD = re.compile(r"<[iuf][248]|\|[biu]1|\|V[0-9]{1,4}")
"""Types of the fields of a block: numbers with the low byte first, and the gaps between them."""
_BROKEN = (pa.ArrowException, StopIteration, OSError, EOFError)


@dataclass(frozen=True, slots=True)
class Block:
    """One block of a stream: its number, the index of its first row since the session's start, and its records.

    `rows` are the tables of objects that a SCENE record counts.
    """

    seq: int
    first: int
    records: NDArray[Any]
    rows: Rows | None = None


@cache
def parameters_schema() -> pa.Schema:
    """Return the schema of parameters.arrows: `sequence`, and `block`, the bytes of a SCENE record and its rows."""
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


def schema_bytes(schema: pa.Schema) -> bytes:
    """Return the schema message with which a stream begins."""
    return bytes(schema.serialize())


def encode_samples(samples: NDArray[Any], seq: int, first: int, extent: Extent = HAPTICMASTER) -> bytes:
    """Encode SAMPLE records [n] of a device as one block of haptic.arrows."""
    rows = rows_of(samples)[:, present_columns(extent)]
    t = np.ascontiguousarray(rows[:, 0])
    values = np.ascontiguousarray(rows[:, 1:])
    schema = samples_schema(extent)
    item = pa.Array.from_buffers(pa.float64(), values.size, [None, pa.py_buffer(values)])
    columns = [
        pa.Array.from_buffers(pa.float64(), len(t), [None, pa.py_buffer(t)]),
        pa.Array.from_buffers(schema.field(1).type, len(t), [None], children=[item]),
    ]
    crc = rows_crc(seq, first, t, values)
    return encode_batch(pa.RecordBatch.from_arrays(columns, schema=schema), seq, first, crc, compressed())


def decode_samples(data: bytes | memoryview, layout: SampleLayout | None = None) -> Block:
    """Decode one block of haptic.arrows.

    Args:
        data: The block.
        layout: Layout of the stream; None: that of this version.

    Raises:
        ValueError: The bytes are no such block, or their CRC32 is wrong.
    """
    layout = layout or current_layout()
    batch, seq, first, crc = decode_batch(data, layout.schema)
    t = batch.column(0).to_numpy(zero_copy_only=True)
    values = batch.column(1).values.to_numpy(zero_copy_only=True).reshape(len(t), layout.width - 1)
    if rows_crc(seq, first, t, np.ascontiguousarray(values)) != crc:
        raise ValueError("the checksum does not agree")
    samples = samples_of(layout.rows(t, values))
    if not (np.isfinite(samples["t"]).all() and np.isfinite(samples["tick"]).all()):
        raise ValueError("it has rows without a tick")
    return Block(seq, first, samples)


def encode_parameters(block: bytes, seq: int) -> bytes:
    """Encode the bytes of one SCENE record and its rows as one block of parameters.arrows."""
    record = np.frombuffer(block, SCENE, 1)
    batch = pa.RecordBatch.from_arrays(
        [pa.array([int(record["sequence"][0])], pa.int64()), pa.array([block], pa.binary())],
        schema=parameters_schema(),
    )
    crc = rows_crc(seq, seq, np.frombuffer(block, np.uint8))
    return encode_batch(batch, seq, seq, crc, compressed())


def decode_parameters(data: bytes | memoryview, schema: pa.Schema | None = None) -> Block:
    """Decode one block of parameters.arrows with the dtypes of its version: record of shape [1], rows.

    Raises:
        ValueError: The bytes are no such block, or their CRC32 is wrong.
    """
    schema = schema or parameters_schema()
    batch, seq, first, crc = decode_batch(data, schema)
    try:
        content = batch.column(1)[0].as_py()
        if rows_crc(seq, first, np.frombuffer(content, np.uint8)) != crc:
            raise ValueError("the checksum does not agree")
        dtype = parameters_dtype(schema)
        record = np.frombuffer(content, dtype, 1)
        if "objects" not in (dtype.names or ()):
            return Block(seq, first, record, rows_with_tunnel(record, None))
        rows = unpack_rows(content[dtype.itemsize :], record[0]["objects"], _row_dtypes(schema.metadata[b"rows"]))
    except (KeyError, IndexError, TypeError, AttributeError, OverflowError, RecursionError, struct.error) as error:
        raise ValueError("its content is not a parameter block") from error
    return Block(seq, first, record, rows_with_tunnel(record, rows))


def parameters_dtype(schema: pa.Schema) -> np.dtype[Any]:
    """Return the dtype of the SCENE records of a stream, which may be of an older version.

    Raises:
        ValueError: The schema does not describe one.
    """
    try:
        dtype = _dtype_of(schema.metadata[b"dtype"])
    except (KeyError, TypeError, SyntaxError, RecursionError, OverflowError) as error:
        raise ValueError(f"no description of parameter blocks: {error!r}") from error
    if dtype.hasobject or "sequence" not in (dtype.names or ()):
        raise ValueError("no description of parameter blocks: no sequence, or objects of Python")
    return dtype


@lru_cache(maxsize=8)
def _dtype_of(description: bytes) -> np.dtype[Any]:
    """Return the dtype of a JSON description, cached: all blocks of a stream have the same."""
    return np.lib.format.descr_to_dtype(_tuples(json.loads(description)))


@lru_cache(maxsize=8)
def _row_dtypes(descriptions: bytes) -> dict[str, np.dtype[Any]]:
    return {name: np.lib.format.descr_to_dtype(_tuples(each)) for name, each in json.loads(descriptions).items()}


def _tuples(description: str | list[Any]) -> Any:
    """Return a dtype description with the tuples that JSON holds as lists.

    Raises:
        ValueError: A field is of a type that no version writes, as where its description is damaged.
    """
    if isinstance(description, str):
        if not _FIELD.fullmatch(description):
            raise ValueError(f"no description of parameter blocks: a field of type {description!r}")
        return description
    return [(name, _tuples(kind), *(tuple(shape) for shape in rest)) for name, kind, *rest in description]


@cache
def compressed() -> pa.ipc.IpcWriteOptions:
    """Return the write options: Zstandard at level 1, a tenth of a millisecond per block."""
    return pa.ipc.IpcWriteOptions(compression=pa.Codec("zstd", 1))


def rows_crc(seq: int, first: int, *arrays: NDArray[Any]) -> int:
    """Return the CRC32 over both numbers of a block and its arrays."""
    crc = zlib.crc32(_NUMBERS.pack(seq, first))
    for array in arrays:
        crc = zlib.crc32(array.data, crc)
    return crc


def encode_batch(
    batch: pa.RecordBatch, seq: int, first: int, crc: int, options: pa.ipc.IpcWriteOptions | None = None
) -> bytes:
    """Encode a record batch as one block of a stream, with its numbers and its checksum."""
    sink = io.BytesIO()
    writer = pa.ipc.new_stream(sink, batch.schema, options=options)
    metadata = {"seq": f"{seq:016d}", "first": f"{first:016d}", "crc": f"{crc:08x}"}
    writer.write_batch(batch, custom_metadata=metadata)
    return sink.getvalue()[len(schema_bytes(batch.schema)) :]  # without the end mark, for the writer is not closed


def decode_batch(data: bytes | memoryview, schema: pa.Schema) -> tuple[pa.RecordBatch, int, int, int]:
    """Return a block's record batch, its number, that of its first row, and its checksum, which is not verified.

    Raises:
        ValueError: The bytes are no block.
    """
    try:
        message = pa.ipc.open_stream(schema_bytes(schema) + bytes(data)).read_next_batch_with_custom_metadata()
        metadata = message.custom_metadata
        message.batch.validate(full=True)
        seq, first = int(metadata[b"seq"]), int(metadata[b"first"])
        _NUMBERS.pack(seq, first)  # they are 64 bits long
        return message.batch, seq, first, int(metadata[b"crc"], 16)
    except (*_BROKEN, KeyError, TypeError, ValueError, struct.error) as error:
        raise ValueError("it is cut off or overwritten") from error
