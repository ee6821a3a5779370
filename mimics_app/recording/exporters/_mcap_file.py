"""A file of MCAP, a chunk of one topic's messages at a time.

The records are those of the library `mcap`. Its own writer takes messages one by one, 4 us each: an hour of ticks and
of four signals at 1 kHz, 18 million messages, would take more than a minute. Here numpy lays out those of a chunk.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping, Sequence
from typing import BinaryIO

import lz4.frame
import numpy as np
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.writer import MCAP0_MAGIC

from mimics_app.contracts.arrays import I8, Records

__all__ = ["McapFile"]

_CHUNK_BYTES = 1 << 20
"""Size of a chunk, which a reader decompresses as a whole."""
_PREFIX = [("opcode", "u1"), ("length", "<u8")]
"""What stands before every record."""
_HEAD = [("channel", "<u2"), ("sequence", "<u4"), ("log_ns", "<i8"), ("publish_ns", "<i8")]
"""What stands before the data of a message."""


class McapFile:
    """One file under way, indexed by chunks and messages.

    Args:
        file: Where it is written.
        library: Name of the program that writes it.
    """

    def __init__(self, file: BinaryIO, library: str) -> None:
        self._file = file
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunks: list[ChunkIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts: dict[int, int] = {}
        file.write(MCAP0_MAGIC)
        self._record(Header("", library))

    def schema(self, name: str, encoding: str, data: bytes) -> int:
        """Write a schema; return its number."""
        self._schemas.append(Schema(len(self._schemas) + 1, data, encoding, name))
        self._record(self._schemas[-1])
        return len(self._schemas)

    def channel(self, topic: str, encoding: str, schema: int, metadata: Mapping[str, str]) -> int:
        """Write a channel of messages of a schema; return its number."""
        self._channels.append(Channel(len(self._channels) + 1, topic, encoding, dict(metadata), schema))
        self._record(self._channels[-1])
        return len(self._channels)

    def put_rows(self, channel: int, log_ns: I8, rows: Records) -> None:
        """Write messages of one length: times [ns], shape [n], and a structured array of their data, shape [n]."""
        messages = np.zeros(len(rows), np.dtype([*_PREFIX, *_HEAD, ("data", rows.dtype)]))
        messages["opcode"], messages["length"] = Opcode.MESSAGE, np.dtype(_HEAD).itemsize + rows.dtype.itemsize
        messages["channel"], messages["data"] = channel, rows
        messages["log_ns"] = messages["publish_ns"] = log_ns
        step = max(1, _CHUNK_BYTES // messages.itemsize)
        for begin in range(0, len(rows), step):
            part = messages[begin : begin + step]
            self._chunk(channel, part["log_ns"], np.arange(len(part)) * messages.itemsize, part.tobytes())

    def put_texts(self, channel: int, texts: Iterable[tuple[int, bytes]]) -> None:
        """Write messages of any length, each with its time [ns]."""
        built = RecordBuilder()
        begins: list[tuple[int, int]] = []
        for t_ns, text in texts:
            begins.append((t_ns, built.count))
            Message(channel, t_ns, text, t_ns, 0).write(built)
            if built.count > _CHUNK_BYTES:
                self._chunk_texts(channel, begins, built.end())
                begins.clear()
        if begins:
            self._chunk_texts(channel, begins, built.end())

    def _chunk_texts(self, channel: int, begins: Sequence[tuple[int, int]], data: bytes) -> None:
        log_ns, offsets = np.array(begins, np.int64).T
        self._chunk(channel, log_ns, offsets, data)

    def metadata(self, name: str, content: Mapping[str, str]) -> None:
        """Write texts by name."""
        begin, length = self._record(Metadata(name, dict(content)))
        self._metadata.append(MetadataIndex(begin, length, name))

    def finish(self) -> None:
        """Write the end of the data and the summary; the file stays open."""
        self._record(DataEnd(0))
        begin = self._file.tell()
        built = RecordBuilder()
        for each in (*self._schemas, *self._channels, self._statistics(), *self._chunks, *self._metadata):
            each.write(built)
        summary = built.end()
        Footer(begin, 0, 0).write(built)
        footer = built.end()
        Footer(begin, 0, zlib.crc32(footer[:-4], zlib.crc32(summary))).write(built)
        self._file.write(summary + built.end() + MCAP0_MAGIC)

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            message_end_time=max((each.message_end_time for each in self._chunks), default=0),
            message_start_time=min((each.message_start_time for each in self._chunks), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )

    def _record(self, record: McapRecord) -> tuple[int, int]:
        """Write a record; return its place and its length [bytes]."""
        built = RecordBuilder()
        record.write(built)
        begin, content = self._file.tell(), built.end()
        self._file.write(content)
        return begin, len(content)

    def _chunk(self, channel: int, log_ns: I8, offsets: I8, data: bytes) -> None:
        """Write messages of a channel as a chunk, and the index of their times [ns] and places in it."""
        first, last = int(log_ns.min()), int(log_ns.max())
        packed = lz4.frame.compress(data)
        begin, length = self._record(Chunk("lz4", packed, last, first, zlib.crc32(data), len(data)))
        built = RecordBuilder()
        built.start_record(Opcode.MESSAGE_INDEX)
        entries = np.stack([log_ns, offsets], axis=1).astype("<u8")
        built.write2(channel)
        built.write4(entries.nbytes)
        built.write(entries.tobytes())
        built.finish_record()
        index, place = built.end(), self._file.tell()
        self._file.write(index)
        self._chunks.append(
            ChunkIndex(length, begin, "lz4", len(packed), last, len(index), {channel: place}, first, len(data))
        )
        self._counts[channel] = self._counts.get(channel, 0) + len(log_ns)
