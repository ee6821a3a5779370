"""Search for the valid blocks of an Arrow stream that was cut off, overwritten or never closed.

The sidecar holds the offset of each block, so a damaged header costs that block only. Where the sidecar is missing or
wrong, the stream is read message by message; after a damaged one the next message is searched at the 8-byte boundaries
of the format.
"""

from __future__ import annotations

import mmap
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from mimics_app.contracts.system.regular_file import open_regular, read_regular
from mimics_app.recording.arrow_format import END_OF_STREAM, INDEX_ROW, Block, schema_bytes

__all__ = ["Damage", "FoundBlock", "last_block", "read_index", "read_schema", "scan_stream", "sorted_scan"]

_CONTINUATION = END_OF_STREAM[:4]
_ALIGNMENT = 8
_KEPT_BYTES = 1 << 24
"""Bytes of a file that was read that stay in memory."""

Span = tuple[int, int]


@dataclass(frozen=True, slots=True)
class FoundBlock:
    """A valid block and its bytes [offset, offset + length) in the stream."""

    offset: int
    length: int
    block: Block


@dataclass(frozen=True, slots=True)
class Damage:
    """Bytes of a stream that are not a valid block, and the reason."""

    offset: int
    length: int
    why: str

    def sentence(self, name: str) -> str:
        """Return the damage of a file in a sentence."""
        return f"{name}: {self.length} bytes at {self.offset} are not a valid block: {self.why}"


def read_index(path: Path) -> NDArray[Any]:
    """Return the plausible rows of a sidecar: ascending, without overlap, shape [n]; empty without the file."""
    try:
        data = read_regular(path)
    except OSError:
        return np.empty(0, INDEX_ROW)
    rows = np.frombuffer(data, INDEX_ROW, len(data) // INDEX_ROW.itemsize)
    kept: list[int] = []
    end = 0
    for i, (_, offset, length) in enumerate(rows.tolist()):
        if offset >= end and length > 0 and offset % _ALIGNMENT == 0:
            kept.append(i)
            end = offset + length
    return rows[kept]


def read_schema(path: Path) -> pa.Schema | None:
    """Return the schema of a stream, None where its start is damaged."""
    try:
        with open_regular(path) as stream:
            return pa.ipc.open_stream(stream).schema
    except (pa.ArrowException, OSError, EOFError, ValueError):
        return None


def scan_stream(
    path: Path,
    decode: Callable[[memoryview], Block],
    schema: pa.Schema,
    index: NDArray[Any] | None = None,
    begin: int = 0,
) -> Iterator[FoundBlock | Damage]:
    """Yield the valid blocks and the damaged parts in the order of the file; nothing without the file.

    Args:
        path: An Arrow stream, possibly incomplete.
        decode: `decode_samples`, `decode_parameters` or `decode_signals`.
        schema: Schema it was written with.
        index: Rows of the sidecar, if any.
        begin: Offset of a block from which on it is read [bytes]; 0: from the first one.
    """
    with _opened(path, schema, index, begin) as (view, spans):
        kept = 0
        for span in spans:
            yield from _read_span(view, span, decode)
            if span[1] - kept > _KEPT_BYTES:
                kept = _release_pages(view, kept, span[1])


def _release_pages(view: memoryview, start: int, end: int) -> int:
    """Release the memory of bytes that were read, so that a long file does not stay in it; return where they end."""
    whole = end - end % mmap.PAGESIZE
    if isinstance(view.obj, mmap.mmap) and hasattr(view.obj, "madvise"):
        view.obj.madvise(mmap.MADV_DONTNEED, start, whole - start)
    return whole


def sorted_scan(
    path: Path, decode: Callable[[memoryview], Block], schema: pa.Schema, index: NDArray[Any] | None = None
) -> tuple[list[FoundBlock], list[Damage]]:
    """Return the valid blocks and the damaged parts of a stream, see `scan_stream`."""
    pieces = list(scan_stream(path, decode, schema, index))
    return [each for each in pieces if isinstance(each, FoundBlock)], [
        each for each in pieces if isinstance(each, Damage)
    ]


def last_block(
    path: Path, decode: Callable[[memoryview], Block], schema: pa.Schema, index: NDArray[Any] | None = None
) -> FoundBlock | None:
    """Return the last valid block of a stream, see `scan_stream`; None where it has none. None before it is decoded."""
    with _opened(path, schema, index) as (view, spans):
        for span in reversed(list(spans)):
            for piece in _read_span(view, span, decode):
                if isinstance(piece, FoundBlock):
                    return piece
    return None


@contextmanager
def _opened(
    path: Path, schema: pa.Schema, index: NDArray[Any] | None, begin: int = 0
) -> Iterator[tuple[memoryview, Iterator[Span]]]:
    """Open a stream: its bytes and the spans of its possible blocks; both empty without the file."""
    try:
        file = open_regular(path)
    except OSError:
        yield memoryview(b""), iter(())
        return
    with file:
        if file.seek(0, os.SEEK_END) == 0:
            yield memoryview(b""), iter(())
            return
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data, memoryview(data) as view:
            yield view, _spans(data, begin or _schema_length(data) or len(schema_bytes(schema)), index)


def _read_span(view: memoryview, span: Span, decode: Callable[[memoryview], Block]) -> Iterator[FoundBlock | Damage]:
    start, end = span
    if bytes(view[start:end]) == END_OF_STREAM:
        return
    part = view[start:end]
    try:
        yield FoundBlock(start, end - start, decode(part))
    except ValueError as error:
        yield Damage(start, end - start, str(error))
    finally:
        part.release()


def _schema_length(data: mmap.mmap) -> int:
    """Return the length of the schema message [bytes], 0 where the stream does not begin with one."""
    length = _message_length(data, 0, len(data))
    try:
        return length if length and pa.ipc.read_message(pa.py_buffer(data[:length])).type == "schema" else 0
    except (pa.ArrowException, OSError, EOFError):
        return 0


def _spans(data: mmap.mmap, start: int, index: NDArray[Any] | None) -> Iterator[Span]:
    """Yield the spans of possible blocks in order, covering everything after the schema."""
    position = start
    for _, offset, length in [] if index is None else index.tolist():
        if offset < position or offset + length > len(data):
            continue
        yield from _walk(data, position, offset)
        yield offset, offset + length
        position = offset + length
    yield from _walk(data, position, len(data))


def _walk(data: mmap.mmap, start: int, end: int) -> Iterator[Span]:
    """Yield the spans of messages between two offsets by their headers; bytes between messages form one span."""
    position = broken = start
    while position < end:
        length = _message_length(data, position, end)
        if length == 0:
            position = _next_message(data, position + 1, end)
            continue
        if broken < position:
            yield broken, position
        yield position, position + length
        position = broken = position + length
    if broken < end:
        yield broken, end


def _next_message(data: mmap.mmap, start: int, end: int) -> int:
    while (place := data.find(_CONTINUATION, start, end)) >= 0:
        if place % _ALIGNMENT == 0:
            return place
        start = place + 1
    return end


def _message_length(data: mmap.mmap, position: int, end: int) -> int:
    """Return the length of the message at `position` [bytes], 0 where there is no complete one before `end`."""
    head = data[position : position + 8]
    if head[:4] != _CONTINUATION or len(head) < 8:
        return 0
    metadata = int.from_bytes(head[4:], "little")
    if metadata == 0:
        return len(END_OF_STREAM)
    if metadata > end - position - 8:
        return 0
    try:
        message = pa.ipc.read_message(pa.py_buffer(data[position : min(end, position + (1 << 20))]))
    except (pa.ArrowException, OSError, EOFError):
        return 0
    return int(8 + metadata + message.body.size)
