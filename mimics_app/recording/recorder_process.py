"""The recorder process: every 20 ms it writes the content of the rings and of the channel to the run folder.

A record leaves its ring only after it is written: killing this process loses nothing, as long as the ring does not
overflow before the next one continues. Killing the application loses nothing either: the rings and the channel outlive
it and are emptied first. A standby process, which waits for the end of the recorder, keeps them when both are killed.
"""

from __future__ import annotations

import errno
import gc
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime
from multiprocessing import parent_process
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Literal

import numpy as np

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.loop.haptic import EVENT, SAMPLE
from mimics_app.contracts.shared_memory.ring_reader import RingReader
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.system.child_signals import ignore_signals
from mimics_app.contracts.system.run_environment import clock_pair
from mimics_app.recording.arrow_format import BLOCK_ROWS
from mimics_app.recording.byte_channel import CLOSE, LINE, PARAMETERS, SIGNALS, TRIAL, Inbox
from mimics_app.recording.column_file import ColumnFile
from mimics_app.recording.event_log import encode_line
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.recorder_status import PROBLEMS, Problem, RecorderStatus, StatusWord
from mimics_app.recording.run_folder import write_atomically
from mimics_app.recording.signals import SignalStream
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import EventStream, ParameterStream, SampleStream, hash_of_files
from mimics_app.recording.trial_table import TrialTable
from mimics_app.recording.trip_log import TripLog

__all__ = ["IGNORED", "RESERVE", "record"]

IGNORED = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals of the process group that do not end the recorder: only the application does."""

RESERVE = ".reserve"
"""A file that is deleted when the disk is full, to leave room for trials and the manifest."""

_RESERVE_BYTES = 512 * 1024
_RESUME_BYTES = 4 * 1024 * 1024
"""Free space at which recording resumes after a full disk [bytes]."""
_PASS_NS = 20_000_000
_BUSY_PASS_NS = 500_000
_BUSY_ROWS = 500
"""Period of the passes, and period after a pass with more than this number of rows [ns]."""
_SYNC_NS = 1_000_000_000
"""Period in which the files are flushed to the medium [ns]."""
_CLOCK_PAIR_NS = 10_000_000_000
_CLOCK_JUMP_S = 0.1
"""Period of the clock pairs [ns], and jump of the wall clock that is recorded at once [s]."""

_REPLACED, _RING, _DISK = "the recorder was replaced", "the ring was full", "the disk took no more"


def record(
    memory: SessionMemory,
    reader: Connection,
    status: RecorderStatus,
    folder: Path,
    restarts: int,
    before: Connection | None,
    life: Connection,
) -> None:
    """Record until the application closes the session or dies. Target of the spawned process.

    Args:
        memory: The session's shared memory; this process consumes the sample ring and the recorder's event ring.
        reader: The reading end of the app's `Outbox`.
        status: Status words read by the application.
        folder: The run folder, made by the application.
        restarts: Number of recorders of this run that died before; above 0: continue in the existing files.
        before: Ends when the recorder before this one is gone, and this one's turn has come; None: there was none.
        life: The other end of the same for the next one; held as long as this process lives.
    """
    ignore_signals(*IGNORED)
    if before is not None:
        before.poll(None)
        if status[StatusWord.SEALED]:
            return
    session = _Session(memory, Inbox(reader), status, folder, restarts)
    clock = MonotonicClock()
    status[StatusWord.READY] = restarts + 1
    while not session.over:
        busy = session.step(clock.now_ns())
        if not session.over:
            clock.sleep_until_ns(clock.now_ns() + (_BUSY_PASS_NS if busy else _PASS_NS))
    if session.finish():
        status[StatusWord.SEALED] = 1
    gc.freeze()  # no collection at the exit
    life.close()


@dataclass
class _Tally:
    """Losses so far."""

    gaps: list[dict[str, Any]] = field(default_factory=list)
    lost_rows: int = 0
    lost_in_this_gap: int = 0
    lost_lines: int = 0
    ring_dropped: int = 0
    event_dropped: int = 0


class _Session:
    """The files, rings and state of one recorder process."""

    def __init__(
        self, memory: SessionMemory, inbox: Inbox, status: RecorderStatus, folder: Path, restarts: int
    ) -> None:
        self._memory, self._inbox, self._status, self._folder = memory, inbox, status, folder
        self._restarts = restarts
        extent = memory.capacities.extent
        self._hash = StateHash(extent)
        resume = restarts > 0
        self._samples = SampleStream(folder, self._hash, extent, resume=resume)
        self._samples.claim()
        self._columns = ColumnFile(folder, extent, resume=resume)
        self._parameters = ParameterStream(folder, resume=resume)
        self._signals = SignalStream(folder, resume=resume)
        self._events = EventStream(folder, self._hash, resume=resume)
        self._trips = TripLog(folder, self._events.earlier_trips, extent)
        self._trials = TrialTable(folder / "trials.csv", resume=resume)
        self._tally = _Tally(gaps=self._events.earlier_gaps)
        self._tally.lost_rows = sum(gap["rows"] for gap in self._tally.gaps if gap["reason"] == _DISK)
        self._tally.ring_dropped = sum(gap["rows"] for gap in self._tally.gaps if gap["reason"] == _RING)
        self._waiting_trials: dict[int, dict[str, Any]] = {}
        self._sample_ring = RingReader(memory.sample_words, memory.samples)
        self._event_ring = RingReader(memory.recorder_event_words, memory.recorder_events)
        self._block = np.zeros(BLOCK_ROWS, SAMPLE)
        self._event_block = np.zeros(memory.capacities.events, EVENT)
        self._close_message: dict[str, Any] | None = None
        self._next_sync = self._next_pair = self._retry_at = 0
        self._offset_s: float | None = None
        self._now = 0
        self._alone = False
        self.over = False
        self._keep_reserve()
        if resume:
            self._align_with_rings()
        self._own_line("restart" if resume else "start", {"restarts": restarts, **clock_pair()})

    def _keep_reserve(self) -> None:
        path = self._folder / RESERVE
        try:
            write_atomically(path, b"\0" * _RESERVE_BYTES)
        except OSError:
            path.unlink(missing_ok=True)

    def _align_with_rings(self) -> None:
        """Release what the dead recorder had written but not released, and note the gap between it and now."""
        for reader, handled in (
            (self._sample_ring, self._samples.next_row),
            (self._event_ring, self._events.next_event),
        ):
            written = handled - reader.position
            if written > 0:
                reader.release(min(written, reader.waiting))
        lost = max(0, self._sample_ring.position - self._samples.next_row)
        self._gap(_REPLACED, lost)

    # one pass

    def step(self, now_ns: int) -> bool:
        """Write what is available; True when there was so much that the next pass is due soon."""
        self._now = now_ns
        if now_ns >= self._next_sync:  # the channel ends at once, unless another process inherited it
            parent = parent_process()
            self._alone = parent is not None and not parent.is_alive()
        self._take_messages()
        ending = self._alone or self._inbox.ended or self._close_message is not None
        backlog = self._sample_ring.waiting
        self._drain_events()
        self._drain_samples(everything=ending)
        self._note_overruns()
        self._housekeeping(now_ns)
        self._publish()
        self.over = ending
        return backlog > _BUSY_ROWS

    def _take_messages(self) -> None:
        lines: list[bytes] = []
        for kind, payload in self._inbox.messages():
            self._status[StatusWord.LINES] += 1
            if kind == LINE:
                lines.append(payload)
            else:
                self._write_lines(lines)
                lines = []
                self._take(kind, payload)
        self._write_lines(lines)

    def _take(self, kind: bytes, payload: bytes) -> None:
        if kind in (PARAMETERS, SIGNALS):
            stream = self._parameters if kind == PARAMETERS else self._signals
            with self._noting_trouble(lines=1):
                stream.append(payload)
        elif kind == TRIAL:
            message = json.loads(payload)
            self._waiting_trials[message["index"]] = message["row"]
            self._write_trials()
        elif kind == CLOSE:
            self._close_message = json.loads(payload)

    def _write_trials(self, *, all_of_them: bool = False) -> None:
        """Write trials in the order of their numbers: after a restart some arrive twice or out of order."""
        for index in sorted(self._waiting_trials):
            if index < len(self._trials.rows):
                del self._waiting_trials[index]
                continue
            if index > len(self._trials.rows) and not all_of_them:
                return
            try:
                self._trials.append(self._waiting_trials[index])
            except OSError as error:
                self._trouble(error)
                return
            self._hash.add_trial(self._waiting_trials.pop(index))
            self._status[StatusWord.TRIALS] = len(self._trials.rows)

    def _write_lines(self, lines: list[bytes]) -> None:
        with self._noting_trouble(lines=len(lines)):
            self._events.append_lines(lines)

    def _own_line(self, kind: str, data: dict[str, Any]) -> None:
        self._write_lines([encode_line("recorder", kind, data)])

    def _drain_events(self) -> None:
        count = self._event_ring.peek(self._event_block)
        if count == 0:
            return
        self._trips.note_events(self._event_block[:count])
        with self._noting_trouble(lines=count):
            self._events.append_events(self._event_block[:count])
        self._event_ring.release(count)

    def _drain_samples(self, *, everything: bool) -> None:
        for _ in range(2 * self._memory.capacities.samples // BLOCK_ROWS + 1):
            if self._sample_ring.waiting < BLOCK_ROWS and not everything:
                return
            first = self._sample_ring.position
            count = self._sample_ring.peek(self._block)
            if count == 0:
                return
            self._write_block(count, first)
            with self._noting_trouble():
                self._trips.note_samples(self._block[:count])
            self._sample_ring.release(count)

    def _write_block(self, count: int, first: int) -> None:
        if self._now < self._retry_at or (self._retry_at and not self._room_again()):
            self._lose_rows(count)
            return
        try:
            self._samples.append(self._block[:count], first)
        except OSError as error:
            self._trouble(error)
            self._lose_rows(count)
        else:
            self._columns.add(self._block[:count])

    # trouble

    def _room_again(self) -> bool:
        self._retry_at = self._now + _SYNC_NS
        if shutil.disk_usage(self._folder).free < _RESUME_BYTES:
            return False
        self._end_of_loss()
        self._retry_at = 0
        self._status[StatusWord.PROBLEM] = Problem.NONE
        return True

    @contextmanager
    def _noting_trouble(self, lines: int = 0) -> Iterator[None]:
        """Note an error of the disk, by which so many lines are lost, and continue."""
        try:
            yield
        except OSError as error:
            self._trouble(error, lines)

    def _trouble(self, error: OSError, lines: int = 0) -> None:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT)
        self._status[StatusWord.PROBLEM] = Problem.DISK_FULL if full else Problem.DISK_ERROR
        self._tally.lost_lines += lines
        if self._retry_at == 0:
            self._retry_at = self._now + _SYNC_NS
            (self._folder / RESERVE).unlink(missing_ok=True)
            self._own_line("problem", {"what": os.strerror(error.errno or 0), **clock_pair()})

    def _end_of_loss(self) -> None:
        if self._tally.lost_in_this_gap:
            self._gap(_DISK, self._tally.lost_in_this_gap)
            self._tally.lost_in_this_gap = 0

    def _lose_rows(self, count: int) -> None:
        self._tally.lost_rows += count
        self._tally.lost_in_this_gap += count
        self._status[StatusWord.LOST_ROWS] = self._tally.lost_rows

    def _gap(self, reason: str, rows: int) -> None:
        gap = {"reason": reason, "rows": int(rows), "after_row": self._samples.next_row}
        self._tally.gaps.append(gap)
        self._own_line("gap", gap)

    def _note_overruns(self) -> None:
        dropped = self._sample_ring.dropped
        self._tally.event_dropped = self._event_ring.dropped
        if dropped > self._tally.ring_dropped:
            self._status[StatusWord.PROBLEM] = self._status[StatusWord.PROBLEM] or Problem.RING_FULL
            rows, self._tally.ring_dropped = dropped - self._tally.ring_dropped, dropped
            self._gap(_RING, rows)

    # upkeep

    def _housekeeping(self, now_ns: int) -> None:
        if now_ns < self._next_sync:
            return
        self._next_sync = now_ns + _SYNC_NS
        self._write_trials()
        with self._noting_trouble():
            for stream in (self._samples, self._columns, self._parameters, self._signals, self._events):
                stream.sync()
        self._note_clock()

    def _note_clock(self) -> None:
        """Record a pair of clocks every 10 s, and at once when the wall clock was set."""
        pair = clock_pair()
        now_ns = pair["monotonic_ns"]
        offset = datetime.fromisoformat(pair["utc"]).timestamp() - now_ns * 1e-9
        jumped = self._offset_s is not None and abs(offset - self._offset_s) > _CLOCK_JUMP_S
        if jumped or now_ns >= self._next_pair:
            self._next_pair = now_ns + _CLOCK_PAIR_NS
            self._own_line("clock", pair | ({"jump_s": offset - (self._offset_s or 0.0)} if jumped else {}))
        self._offset_s = offset

    def _publish(self) -> None:
        self._status[StatusWord.ROWS] = self._samples.next_row
        self._status[StatusWord.EVENTS] = self._events.next_event
        self._status[StatusWord.PASSES] += 1

    # the end

    def finish(self) -> bool:
        """Write the rest, close the files in their formats, and seal them; return whether the manifest was written."""
        self._take_messages()
        status: Literal["clean", "interrupted"] = "interrupted" if self._close_message is None else "clean"
        self._end_of_loss()
        with self._noting_trouble():
            self._trips.finish()
        self._own_line("end", {"status": status, **clock_pair()})
        (self._folder / RESERVE).unlink(missing_ok=True)
        self._write_trials(all_of_them=True)
        for stream in (self._samples, self._columns, self._parameters, self._signals, self._events, self._trials):
            with self._noting_trouble():
                stream.close()
        return self._seal(status)

    def _seal(self, status: Literal["clean", "interrupted"]) -> bool:
        said = self._close_message or {}
        extent = self._memory.capacities.extent
        state = hash_of_files(self._folder, self._trials.rows, extent) if self._restarts else self._hash
        manifest = Manifest(
            status=status,
            state_hash=state.hexdigest(),
            rows=state.rows,
            events=self._events.next_event,
            trials=len(self._trials.rows),
            parameters=self._parameters.count,
            dropped={
                "samples": self._tally.ring_dropped + self._tally.lost_rows,
                "events": self._tally.event_dropped,
                "lines": self._tally.lost_lines + int(said.get("dropped", 0)),
                "channel_bytes": self._inbox.skipped_bytes,
            },
            restarts=self._restarts,
            gaps=self._tally.gaps,
            problem=PROBLEMS[Problem(self._status[StatusWord.PROBLEM])],
            summary=said.get("summary", {}),
            clock=clock_pair(),
            files=hash_files(self._folder),
        )
        try:
            write_manifest(self._folder, manifest)
        except OSError as error:
            self._trouble(error)
            return False
        return True
