"""haptic_columns.arrows: the rows of haptic.arrows column by column, so that one column of an hour is read at once.

A plain Arrow stream with a float64 field for each column, in batches of 8 s; rows are compressed without loss. A batch
ends with a block of haptic.arrows, and its custom metadata holds the number of blocks so far and a CRC32 of each
column. It is written beside haptic.arrows, which has every row within 50 ms: what a batch does not hold yet, or not any
more, is read from there.
"""

from __future__ import annotations

import json
import mmap
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.arrow_format import BLOCK_ROWS, END_OF_STREAM, compressed, schema_bytes
from mimics_app.recording.columns import HAPTICMASTER, column_names, column_units, present_columns, rows_of
from mimics_app.recording.run_folder import FILES

__all__ = ["BATCH_ROWS", "Batch", "ColumnFile", "columns_schema", "end_of_columns", "read_columns"]

BATCH_ROWS = 160 * BLOCK_ROWS
"""Largest number of rows of a batch."""

_BROKEN = (pa.ArrowException, StopIteration, OSError, EOFError, IndexError, KeyError, TypeError, ValueError)


@dataclass(frozen=True, slots=True)
class Batch:
    """Some columns of a batch.

    Attributes:
        values: Each column, shape [n].
        blocks: Number of blocks of haptic.arrows whose rows are in this batch and those before.
        end: Its end in the file [bytes].
    """

    values: list[NDArray[np.float64]]
    blocks: int
    end: int


@cache
def columns_schema(extent: Extent = HAPTICMASTER) -> pa.Schema:
    """Return the schema: a float64 field for each column that a device fills, with its unit."""
    pairs = zip(column_names(extent), column_units(extent), strict=True)
    fields = [pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit}) for name, unit in pairs]
    return pa.schema(fields, metadata={"format": "mimics haptic columns", "version": "1"})


class ColumnFile:
    """Writer of the file.

    A disk that takes no more ends it for good: its rows are in haptic.arrows.

    Args:
        folder: The run folder.
        extent: Extent of the device.
        resume: Whether a recorder that died has written it: it keeps what it has, and gets no more.
    """

    def __init__(self, folder: Path, extent: Extent = HAPTICMASTER, *, resume: bool = False) -> None:
        self._schema, self._chosen = columns_schema(extent), present_columns(extent)
        self._rows = np.empty((len(self._chosen), BATCH_ROWS))
        self._count = self._blocks = 0
        self._file: AppendFile | None = None
        if not resume:
            self._file = AppendFile(folder / FILES["columns"])
            self._append(schema_bytes(self._schema))

    def add(self, samples: NDArray[Any]) -> None:
        """Take the rows of the next block of haptic.arrows: SAMPLE records, shape [n]."""
        if self._file is None:
            return
        if self._count + len(samples) > BATCH_ROWS:
            self._write()
        self._rows[:, self._count : self._count + len(samples)] = rows_of(samples)[:, self._chosen].T
        self._count, self._blocks = self._count + len(samples), self._blocks + 1

    def sync(self) -> None:
        """Flush the file to the medium."""
        with self._until_trouble():
            if self._file is not None:
                self._file.sync()

    def close(self) -> None:
        """Write the last rows and the end mark, and close the file."""
        if self._count:
            self._write()
        self._append(END_OF_STREAM)
        file, self._file = self._file, None
        if file is not None:
            with suppress(OSError):
                file.close()

    def _write(self) -> None:
        columns = [row[: self._count] for row in self._rows]
        arrays = [pa.Array.from_buffers(pa.float64(), self._count, [None, pa.py_buffer(each)]) for each in columns]
        sums = [zlib.crc32(each.data) for each in columns]
        sink = pa.BufferOutputStream()
        with pa.ipc.new_stream(sink, self._schema, options=compressed()) as writer:
            batch = pa.RecordBatch.from_arrays(arrays, schema=self._schema)
            writer.write_batch(batch, custom_metadata={"blocks": str(self._blocks), "crc": json.dumps(sums)})
        stream = memoryview(sink.getvalue())
        self._append(stream[len(schema_bytes(self._schema)) : -len(END_OF_STREAM)])
        self._count = 0

    def _append(self, data: bytes | memoryview) -> None:
        with self._until_trouble():
            if self._file is not None:
                self._file.append(data)

    @contextmanager
    def _until_trouble(self) -> Iterator[None]:
        """End the file where the disk takes no more."""
        try:
            yield
        except OSError:
            file, self._file = self._file, None
            if file is not None:
                with suppress(OSError):
                    file.close()


def read_columns(folder: Path, extent: Extent, chosen: Sequence[int]) -> Iterator[Batch]:
    """Yield columns of each batch up to the first that is cut off or damaged; none of a file of another layout.

    Args:
        folder: The run folder.
        extent: Extent of the device.
        chosen: Indices of the columns, ascending; those of others are not decompressed.
    """
    options = pa.ipc.IpcReadOptions(included_fields=list(chosen), use_threads=False)
    try:
        with open_regular(folder / FILES["columns"]) as file:
            source = pa.BufferReader(pa.py_buffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)))
        stream = pa.ipc.open_stream(source, options=options)
        if not stream.schema.equals(_part_of(extent, chosen), check_metadata=True):
            return
        while True:
            message = stream.read_next_batch_with_custom_metadata()
            message.batch.validate(full=True)
            values = [column.to_numpy(zero_copy_only=True) for column in message.batch.columns]
            sums = json.loads(message.custom_metadata[b"crc"])
            if [zlib.crc32(each) for each in values] != [sums[i] for i in chosen]:
                return
            yield Batch(values, int(message.custom_metadata[b"blocks"]), source.tell())
    except _BROKEN:
        return


def _part_of(extent: Extent, chosen: Sequence[int]) -> pa.Schema:
    schema = columns_schema(extent)
    return pa.schema([schema.field(i) for i in chosen], metadata=schema.metadata)


def end_of_columns(folder: Path, extent: Extent) -> int:
    """Return the end of the last valid batch in the file [bytes], 0 without one."""
    end = 0
    for batch in read_columns(folder, extent, range(len(column_names(extent)))):
        end = batch.end
    return end
