"""Writers of the growing files of a run, each able to continue where a killed recorder stopped.

To continue, only the end of a file is read, so that it takes as long after an hour as after a second while the ring
fills. The hash of the earlier content is computed from the files when the run is sealed, see `hash_of_files`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.loop_fields import Extent
from mimics_app.contracts.loop.object_rows import unpack_rows
from mimics_app.contracts.system.regular_file import read_regular
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
from mimics_app.recording.arrow_scan import FoundBlock, last_block, read_index, scan_stream
from mimics_app.recording.column_layout import current_layout, samples_schema
from mimics_app.recording.columns import HAPTICMASTER
from mimics_app.recording.event_log import encode_event, events_of, find_lines, read_lines
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.state_hash import StateHash

__all__ = ["EventStream", "ParameterStream", "SampleStream", "hash_of_files"]


class SampleStream:
    """haptic.arrows and its sidecar.

    Attributes:
        next_row: Index after the last row written, counted from the session's start, lost rows included.
    """

    def __init__(
        self, folder: Path, state_hash: StateHash, extent: Extent = HAPTICMASTER, *, resume: bool = False
    ) -> None:
        self._hash = state_hash
        self._extent = extent
        self.next_row = 0
        self._seq = 0
        index: list[tuple[int, int, int]] = []
        end = None
        if resume:
            index, end = self._read_back(folder)
        self._file = AppendFile(folder / FILES["haptic"], resume_at=end)
        self._index = AppendFile(folder / FILES["index"], resume_at=0 if resume else None)
        if not end:
            self._file.append(schema_bytes(samples_schema(extent)))
        if index:
            self._index.append(np.array(index, INDEX_ROW).tobytes())

    def _read_back(self, folder: Path) -> tuple[list[tuple[int, int, int]], int]:
        """Return the rows of the sidecar up to the last valid block, and the end of that block."""
        known = read_index(folder / FILES["index"])
        layout = current_layout(self._extent)
        last = last_block(folder / FILES["haptic"], lambda data: decode_samples(data, layout), layout.schema, known)
        if last is None:
            return [], 0
        self._seq = last.block.seq + 1
        self.next_row = last.block.first + len(last.block.records)
        index = [row for row in known.tolist() if row[1] < last.offset]
        return [*index, (last.block.seq, last.offset, last.length)], last.offset + last.length

    def claim(self) -> None:
        """Lock the file until this process ends, to mark the run as being recorded."""
        self._file.claim()

    def append(self, samples: NDArray[Any], first: int) -> None:
        """Write SAMPLE records [n], of which the first is number `first` since the session's start.

        Raises:
            OSError: The disk is full or failed; the files end with the block before.
        """
        offset = self._file.length
        block = encode_samples(samples, self._seq, first, self._extent)
        self._file.append(block)
        try:
            self._index.append(np.array([(self._seq, offset, len(block))], INDEX_ROW).tobytes())
        except OSError:  # the recorder counts the block as lost, and its columns do not have it
            self._file.cut(offset)
            raise
        self._hash.add_samples(samples)
        self.next_row = first + len(samples)
        self._seq += 1

    def sync(self) -> None:
        """Flush both files to the medium."""
        self._file.sync()
        self._index.sync()

    def close(self) -> None:
        """Write the end mark and close the file."""
        self._file.append(END_OF_STREAM)
        self._file.close()
        self._index.close()


class ParameterStream:
    """parameters.arrows.

    Attributes:
        count: Number of blocks written.
    """

    def __init__(self, folder: Path, *, resume: bool = False) -> None:
        path = folder / FILES["parameters"]
        self.count = 0
        self._newest = -1
        end = 0 if resume else None
        if resume and (last := last_block(path, decode_parameters, parameters_schema())) is not None:
            self.count = last.block.seq + 1
            self._newest = int(last.block.records[0]["sequence"])
            end = last.offset + last.length
        self._file = AppendFile(path, resume_at=end)
        if not end:
            self._file.append(schema_bytes(parameters_schema()))

    def append(self, block: bytes) -> None:
        """Write the bytes of one SCENE record and of the rows it counts; one that was sent twice is written once.

        Raises:
            OSError: The disk is full or failed; the file ends with the block before.
            ValueError: The bytes are no SCENE record with its rows.
        """
        if len(block) < SCENE.itemsize:
            raise ValueError(f"a parameter block has at least {SCENE.itemsize} bytes, this one {len(block)}")
        record = np.frombuffer(block, SCENE, 1)[0]
        unpack_rows(block[SCENE.itemsize :], record["objects"])
        if record["sequence"] == self._newest:
            return
        self._file.append(encode_parameters(block, self.count))
        self.count, self._newest = self.count + 1, int(record["sequence"])

    def sync(self) -> None:
        """Flush the file to the medium."""
        self._file.sync()

    def close(self) -> None:
        """Write the end mark and close the file."""
        self._file.append(END_OF_STREAM)
        self._file.close()


class EventStream:
    """events.jsonl.

    Attributes:
        next_event: Number of the next EVENT record of the loop.
        earlier_gaps: Gaps noted by an earlier recorder.
        earlier_trips: Number of trips noted by it.
    """

    def __init__(self, folder: Path, state_hash: StateHash, *, resume: bool = False) -> None:
        path = folder / FILES["events"]
        self._hash = state_hash
        self.next_event = 0
        self.earlier_gaps: list[dict[str, Any]] = []
        self.earlier_trips = 0
        end = None
        if resume:
            data = read_regular(path) if path.exists() else b""
            end = data.rfind(b"\n") + 1
            self.earlier_gaps = [json.loads(line) for line in find_lines(data, "recorder", "gap")]
            self.next_event = len(find_lines(data, "loop"))
            self.earlier_trips = len(find_lines(data, "loop", "trip"))
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
        """Write encoded lines.

        Raises:
            OSError: The disk is full or failed; none of them was written.
        """
        if lines:
            self._file.append(b"\n".join(lines) + b"\n")

    def sync(self) -> None:
        """Flush the file to the medium."""
        self._file.sync()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def hash_of_files(folder: Path, trials: Iterable[Mapping[str, object]], extent: Extent = HAPTICMASTER) -> StateHash:
    """Return the state hash of the files of a run and of its trials; block by block, because a run can be long."""
    state, layout = StateHash(extent), current_layout(extent)
    path, index = folder / FILES["haptic"], read_index(folder / FILES["index"])
    for piece in scan_stream(path, lambda data: decode_samples(data, layout), layout.schema, index):
        if isinstance(piece, FoundBlock):
            state.add_samples(piece.block.records)
    state.add_events(events_of(read_lines(folder / FILES["events"])[0]))
    for row in trials:
        state.add_trial(row)
    return state
