"""signals.arrows: raw body signals as each frame received them, one row per block; only where there are any.

A plain Arrow stream of the columns `frame`, `t_ns`, `name`, `rate` [Hz] and `values`, with the blocks of a frame in
their order, so that a replay passes them to the signal processing in the same way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.arrow_format import (
    END_OF_STREAM,
    Block,
    compressed,
    decode_batch,
    encode_batch,
    rows_crc,
    schema_bytes,
)
from mimics_app.recording.arrow_scan import FoundBlock, last_block, read_schema, scan_stream
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.signal_rows import SignalRow, unpack_signals

__all__ = ["SampledSignal", "SignalStream", "decode_signals", "read_signals", "sampled_signals", "signals_schema"]

_ROUNDED_NS = 1.0
"""Difference of two time stamps that rounding makes [ns]."""

_LONGEST = 8192
"""Samples after which a block is not joined to the one before."""

_Sent = Sequence[tuple[int, int, str, float, bytes]]


@cache
def signals_schema() -> pa.Schema:
    """Return the schema of signals.arrows."""
    fields = [
        pa.field("frame", pa.int64(), nullable=False),
        pa.field("t_ns", pa.int64(), nullable=False, metadata={"unit": "ns"}),
        pa.field("name", pa.string(), nullable=False),
        pa.field("rate", pa.float64(), nullable=False, metadata={"unit": "Hz"}),
        pa.field("values", pa.list_(pa.field("item", pa.float64(), nullable=False)), nullable=False),
    ]
    return pa.schema(fields, metadata={"format": "mimics signals", "version": "1"})


def _encode_signals(rows: _Sent, seq: int, first: int) -> bytes:
    """Encode rows of `unpack_signals` as one block; `first` is the number of the first row."""
    values = [np.frombuffer(row[4], np.float64) for row in rows]
    offsets = np.concatenate(([0], np.cumsum([len(v) for v in values]))).astype(np.int32)
    flat = np.concatenate(values) if values else np.empty(0)
    schema = signals_schema()
    columns = [pa.array([row[i] for row in rows], schema.field(i).type) for i in range(4)]
    columns.append(pa.ListArray.from_arrays(pa.array(offsets), pa.array(flat), type=schema.field(4).type))
    batch = pa.RecordBatch.from_arrays(columns, schema=schema)
    return encode_batch(batch, seq, first, rows_crc(seq, first, _heads(rows), offsets, flat), compressed())


def decode_signals(data: bytes | memoryview) -> Block:
    """Decode one block; its records are `SignalRow`s, an object array of shape [n].

    Raises:
        ValueError: The bytes are no such block, or their CRC32 is wrong.
    """
    batch, seq, first, crc = decode_batch(data, signals_schema())
    frames, times, names, rates = (batch.column(i).to_pylist() for i in range(4))
    values = batch.column(4)
    offsets = values.offsets.to_numpy()
    flat = values.values.to_numpy(zero_copy_only=True)
    rows = np.empty(len(frames), object)
    sent = []
    for i, head in enumerate(zip(frames, times, names, rates, strict=True)):
        piece = flat[offsets[i] : offsets[i + 1]]
        rows[i] = SignalRow(head[0], SignalBlock(head[2], head[3], head[1], piece))
        sent.append((*head, b""))
    if rows_crc(seq, first, _heads(sent), offsets, np.ascontiguousarray(flat)) != crc:
        raise ValueError("the checksum does not agree")
    return Block(seq, first, rows)


def _heads(rows: _Sent) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return all of the rows but the samples as bytes, for the checksum."""
    return np.frombuffer(msgspec.msgpack.encode([row[:4] for row in rows]), np.uint8)


class SignalStream:
    """Writer of the file, which is created with its first rows.

    Attributes:
        count: Number of rows written.
    """

    def __init__(self, folder: Path, *, resume: bool = False) -> None:
        self._path = folder / FILES["signals"]
        self._file: AppendFile | None = None
        self.count = self._seq = 0
        if resume and (last := last_block(self._path, decode_signals, signals_schema())) is not None:
            self._seq = last.block.seq + 1
            self.count = last.block.first + len(last.block.records)
            self._file = AppendFile(self._path, resume_at=last.offset + last.length)

    def append(self, payload: bytes) -> None:
        """Write rows encoded by `pack_signals`.

        Raises:
            OSError: The disk is full or failed; the file ends with the previous block.
            ValueError: The bytes are not of `pack_signals`.
        """
        rows = unpack_signals(payload)
        if self._file is None:
            self._path.unlink(missing_ok=True)  # of a recorder that died before its first whole block
            self._file = AppendFile(self._path)
            self._file.append(schema_bytes(signals_schema()))
        self._file.append(_encode_signals(rows, self._seq, self.count))
        self._seq += 1
        self.count += len(rows)

    def sync(self) -> None:
        """Flush the file to the medium."""
        if self._file is not None:
            self._file.sync()

    def close(self) -> None:
        """Write the end mark and close the file."""
        if self._file is not None:
            self._file.append(END_OF_STREAM)
            self._file.close()


def read_signals(folder: Path) -> tuple[list[SignalRow], list[str]]:
    """Return the valid rows in order, and the losses, one sentence each; both empty without signals."""
    path = folder / FILES["signals"]
    if not path.exists():
        return [], []
    rows: list[SignalRow] = []
    faults: list[str] = []
    for piece in scan_stream(path, decode_signals, read_schema(path) or signals_schema()):
        if isinstance(piece, FoundBlock):
            if piece.block.first != len(rows):
                faults.append(
                    f"{path.name}: {piece.block.first - len(rows)} rows are missing before {piece.block.first}"
                )
            rows += list(piece.block.records)
        else:
            faults.append(piece.sentence(path.name))
    return rows, faults


class SampledSignal:
    """Samples of one signal in a temporary file, so that hours of them need no memory.

    Attributes:
        spans: Time of the first sample [ns], rate [Hz] and number of samples of each block.
    """

    def __init__(self) -> None:
        self.spans: list[tuple[int, float, int]] = []
        self._file = TemporaryFile()

    def add(self, block: SignalBlock) -> None:
        """Append a block; one that continues the block before it to the nanosecond is joined to it."""
        self._file.write(np.ascontiguousarray(block.values, np.float64).tobytes())
        if self.spans:
            t_ns, rate, count = self.spans[-1]
            end_ns = t_ns + count * SECOND_NS / rate
            if rate == block.rate and count < _LONGEST and abs(block.t_ns - end_ns) <= _ROUNDED_NS:
                self.spans[-1] = (t_ns, rate, count + len(block.values))
                return
        self.spans.append((block.t_ns, block.rate, len(block.values)))

    def blocks(self) -> Iterator[tuple[int, float, F8]]:
        """Yield time of the first sample [ns], rate [Hz] and samples of each block."""
        offset = 0
        for t_ns, rate, count in self.spans:
            self._file.seek(offset)
            data = self._file.read(count * 8)
            offset += len(data)
            yield t_ns, rate, np.frombuffer(data, np.float64)


def sampled_signals(folder: Path) -> dict[str, SampledSignal]:
    """Return the valid samples of each signal; {} without signals."""
    path = folder / FILES["signals"]
    found: dict[str, SampledSignal] = {}
    if not path.exists():
        return found
    for part in scan_stream(path, decode_signals, read_schema(path) or signals_schema()):
        for row in part.block.records if isinstance(part, FoundBlock) else ():
            if row.block.name not in found:
                found[row.block.name] = SampledSignal()
            found[row.block.name].add(row.block)
    return found
