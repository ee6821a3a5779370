"""The growing files of a run as the recorder writes them, each able to go on where a killed recorder stopped."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SCENE, EventKind
from mimics_app.contracts.object_rows import unpack_rows
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.arrow_format import (
    END_OF_STREAM,
    INDEX_ROW,
    decode_parameters,
    decode_samples,
    encode_parameters,
    encode_samples,
    parameters_schema,
    schema_bytes,
)
from mimics_app.recording.arrow_scan import Found, read_index, scan_stream
from mimics_app.recording.event_log import encode_event, events_of, read_lines, whole_length
from mimics_app.recording.layout import samples_schema
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.state_hash import StateHash

__all__ = ["EventStream", "ParameterStream", "SampleStream"]


class SampleStream:
    """haptic.arrows and its sidecar.

    Attributes:
        next_row: Place after the last row written, counted from the session's start; rows that were lost count too.
    """

    def __init__(self, folder: Path, state_hash: StateHash, *, resume: bool = False) -> None:
        self._hash = state_hash
        self.next_row = 0
        self._seq = 0
        index: list[tuple[int, int, int]] = []
        end = None
        if resume:
            index, end = self._read_back(folder)
        self._file = AppendFile(folder / FILES["haptic"], resume_at=end)
        self._index = AppendFile(folder / FILES["index"], resume_at=0 if resume else None)
        if not end:
            self._file.append(schema_bytes(samples_schema()))
        if index:
            self._index.append(np.array(index, INDEX_ROW).tobytes())

    def _read_back(self, folder: Path) -> tuple[list[tuple[int, int, int]], int]:
        path = folder / FILES["haptic"]
        index: list[tuple[int, int, int]] = []
        end = 0
        for piece in scan_stream(path, decode_samples, samples_schema(), read_index(folder / FILES["index"])):
            if isinstance(piece, Found):
                self._hash.add_samples(piece.block.records)
                self._seq = piece.block.seq + 1
                self.next_row = piece.block.first + len(piece.block.records)
                end = piece.offset + piece.length
                index.append((piece.block.seq, piece.offset, piece.length))
        return index, end

    def append(self, samples: NDArray[Any], first: int) -> None:
        """Write SAMPLE records [n], of which the first is number `first` since the session's start.

        Raises:
            OSError: The disk is full or failed; the files end with the block before.
        """
        offset = self._file.length
        block = encode_samples(samples, self._seq, first)
        self._file.append(block)
        self._hash.add_samples(samples)
        self.next_row = first + len(samples)
        row = np.array([(self._seq, offset, len(block))], INDEX_ROW)
        self._seq += 1
        self._index.append(row.tobytes())

    def sync(self) -> None:
        """Bring both files onto the medium."""
        self._file.sync()
        self._index.sync()

    def close(self) -> None:
        """End the stream as Arrow wants it."""
        self._file.append(END_OF_STREAM)
        self._file.close()
        self._index.close()


class ParameterStream:
    """parameters.arrows.

    Attributes:
        count: Blocks written.
    """

    def __init__(self, folder: Path, *, resume: bool = False) -> None:
        path = folder / FILES["parameters"]
        self.count = 0
        end = 0 if resume else None
        if resume:
            for piece in scan_stream(path, decode_parameters, parameters_schema()):
                if isinstance(piece, Found):
                    self.count = piece.block.seq + 1
                    end = piece.offset + piece.length
        self._file = AppendFile(path, resume_at=end)
        if not end:
            self._file.append(schema_bytes(parameters_schema()))

    def append(self, block: bytes) -> None:
        """Write the bytes of one SCENE record and of the rows it counts.

        Raises:
            OSError: The disk is full or failed; the file ends with the block before.
            ValueError: The bytes are no SCENE record with its rows.
        """
        if len(block) < SCENE.itemsize:
            raise ValueError(f"a parameter block has at least {SCENE.itemsize} bytes, this one {len(block)}")
        unpack_rows(block[SCENE.itemsize :], np.frombuffer(block, SCENE, 1)[0]["objects"])
        self._file.append(encode_parameters(block, self.count))
        self.count += 1

    def sync(self) -> None:
        """Bring the file onto the medium."""
        self._file.sync()

    def close(self) -> None:
        """End the stream as Arrow wants it."""
        self._file.append(END_OF_STREAM)
        self._file.close()


class EventStream:
    """events.jsonl.

    Attributes:
        next_event: Number of the next EVENT record of the loop.
        earlier_gaps: Gaps that a recorder before this one wrote down.
        earlier_trips: Trips that it wrote down.
    """

    def __init__(self, folder: Path, state_hash: StateHash, *, resume: bool = False) -> None:
        path = folder / FILES["events"]
        self._hash = state_hash
        self.next_event = 0
        self.earlier_gaps: list[dict[str, Any]] = []
        self.earlier_trips = 0
        end = None
        if resume:
            end = whole_length(path) if path.exists() else 0
            lines = read_lines(path)[0] if path.exists() else []
            self.earlier_gaps = [line for line in lines if line["source"] == "recorder" and line["kind"] == "gap"]
            events = events_of(lines)
            self._hash.add_events(events)
            self.next_event = len(events)
            self.earlier_trips = int((events["kind"] == EventKind.TRIP).sum())
        self._file = AppendFile(path, resume_at=end)

    def append_events(self, events: NDArray[Any]) -> None:
        """Write EVENT records [n].

        Raises:
            OSError: The disk is full or failed; none of them was written.
        """
        lines = [encode_event(event, self.next_event + i) for i, event in enumerate(events)]
        self.append_lines(lines)
        self._hash.add_events(events)
        self.next_event += len(events)

    def append_lines(self, lines: list[bytes]) -> None:
        """Write lines that are encoded already.

        Raises:
            OSError: The disk is full or failed; none of them was written.
        """
        if lines:
            self._file.append(b"\n".join(lines) + b"\n")

    def sync(self) -> None:
        """Bring the file onto the medium."""
        self._file.sync()

    def close(self) -> None:
        """Let the file go."""
        self._file.close()
