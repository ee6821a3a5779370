"""The application's side of the recorder: sends messages, supervises the process, never waits for a disk."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.util import Finalize
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import TICKS_PER_SECOND, Clock, MonotonicClock
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.loop.object_rows import Rows, pack_rows
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.system.child_main import main_hidden
from mimics_app.contracts.system.child_signals import signals_blocked
from mimics_app.contracts.system.run_environment import boot_id, clock_pair, describe_environment
from mimics_app.recording.byte_channel import CLOSE, LINE, PARAMETERS, SIGNALS, TRIAL, Outbox
from mimics_app.recording.event_log import encode_line, to_json
from mimics_app.recording.manifest import Manifest, read_manifest
from mimics_app.recording.recorder_process import IGNORED, record
from mimics_app.recording.recorder_status import PROBLEMS, Problem, RecorderStatus, StatusWord
from mimics_app.recording.run_folder import FILES, write_atomically
from mimics_app.recording.signal_rows import SignalRow, pack_signals

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess

__all__ = ["Recorder"]

_START_S = 60.0
"""Time-out of the start [s]."""
_MOST_RESTARTS = 5
"""Largest number of restarts."""
_ROOM_STEP_NS = 200_000
"""Polling period while waiting for room in the rings [ns]."""
_STALLED_NS = 30_000_000_000
"""Time-out of waiting for room in the rings [ns]."""
_EVENT_ROOM = 256
"""Free events in the ring that count as room."""
_BACKLOG = 8 << 20
"""Queued bytes up to which there is room."""
_WAKE_NS = 2_000_000_000
_HUNG_NS = 7_000_000_000
"""Time without a pass after which the recorder is woken, and after which it is replaced; the ring holds 16 s [ns]."""
_LONGEST_STEP_NS = 100_000_000
"""Longest time between two checks that counts as time without a pass [ns]."""


def _ignore(kind: str, data: Mapping[str, object]) -> None:
    """Do nothing."""


class Recorder:
    """Records one session into its run folder.

    Args:
        memory: The session's shared memory.
        folder: An empty run folder, see `create_run_folder`.
        header: Description of the session: seed, scene name and hash, resolved scene, command line, profile,
            method plan, device ... plain values; versions, machine and clocks are added here.

    Attributes:
        folder: The run folder.
        restarts: Number of times the process died and was replaced.
        listener: Called with kind and values of each line of the journal, and with "trial" and the row of each trial.
    """

    def __init__(self, memory: SessionMemory, folder: Path, header: Mapping[str, object]) -> None:
        self.folder = folder
        self._memory = memory
        self._header = dict(header)
        self._outbox = Outbox()
        self._status = RecorderStatus()
        self._process: SpawnProcess | None = None
        self._standby: SpawnProcess | None = None
        self._keeps_standby = False
        self._life: Connection | None = None
        self._clock: Clock = MonotonicClock()
        self.restarts = 0
        self.listener: Callable[[str, Mapping[str, object]], None] = _ignore
        self._passes = 0
        self._looked_ns = self._still_ns = 0
        self._trials: list[bytes] = []
        self._last_parameters = b""
        self._closed = self._given_up = False
        # At an exit without `close` the channel must end before the process is joined, or both would wait forever.
        self._finalize = Finalize(self, self._outbox.close, exitpriority=100)

    def start(self, *, wait: bool = True) -> None:
        """Write session.json and spawn the process.

        Args:
            wait: Return when its files are open; else call `wait_until_ready` later.

        Raises:
            PartialDataError: The process does not start.
        """
        clock = clock_pair() | {"boot": boot_id()}
        session = {"format": "mimics run", "version": 1, **describe_environment(), "clock": clock}
        write_atomically(
            self.folder / FILES["session"], msgspec.json.format(to_json({**session, **self._header}), indent=1)
        )
        self._process = self._spawn(0)
        if wait:
            self.wait_until_ready()

    def wait_until_ready(self) -> None:
        """Return when the recorder's files are open; earlier messages are kept.

        Raises:
            PartialDataError: The process does not start.
        """
        deadline = self._clock.now_ns() + int(_START_S * 1e9)
        while not self.ready:
            if self._clock.now_ns() > deadline or not self.alive:
                self._give_up_start()
            self._clock.sleep_until_ns(self._clock.now_ns() + 1_000_000)

    def _give_up_start(self) -> NoReturn:
        ended = self._process.exitcode if self._process else None
        self.kill()
        if ended is None:
            why = f"it was not ready within {_START_S:.0f} s"
        else:
            why = "see the message above" if ended >= 0 else f"it was ended by {signal.Signals(-ended).name}"
        raise PartialDataError(f"the recorder of {self.folder} does not start", why)

    def keep_standby(self) -> None:
        """Keep a second process started that takes over when the first one dies, even if the application is gone too.

        For a live session: until a replacement were started, nobody but the application would hold the rings.
        """
        self._keeps_standby = True
        self.supervise()

    def _spawn(self, number: int) -> SpawnProcess:
        """Start a process; its target's module imports no compiler, which would double the start-up time.

        It records when the one before it is gone, which it sees by the end of a pipe that only that one can write.
        """
        context = get_context("spawn")
        before, (self._life, held) = self._life, context.Pipe(duplex=False)
        arguments = (self._memory, self._outbox.reader, self._status, self.folder, number, before, held)
        process = context.Process(target=record, args=arguments, name="mimics recorder")
        with signals_blocked(*IGNORED), main_hidden():
            process.start()
        held.close()
        if before is not None:
            before.close()
        return process

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process is not None and self._process.is_alive()

    @property
    def pid(self) -> int | None:
        """Process id of the recorder, None before `start`."""
        return self._process.pid if self._process else None

    @property
    def problem(self) -> str:
        """Message on what keeps it from recording, "" for none."""
        if self._given_up:
            return PROBLEMS[Problem.NOT_RUNNING]
        return PROBLEMS[Problem(self._status[StatusWord.PROBLEM])]

    @property
    def ready(self) -> bool:
        """Whether the present process has its files open."""
        return self._status[StatusWord.READY] > self.restarts

    @property
    def holds_s(self) -> float:
        """Capacity of the sample ring [s]."""
        return len(self._memory.samples) / TICKS_PER_SECOND

    @property
    def dropped(self) -> int:
        """Number of messages dropped because the queue was full."""
        return self._outbox.dropped

    def supervise(self) -> None:
        """Replace the process when it died or hangs, and flush the queue; called by every `journal`, once a frame.

        Raises:
            PartialDataError: The first process did not start.
        """
        self._check_passes(replace=True)
        if not (self._closed or self._given_up or self._process is None or self.alive):
            if self.restarts == 0 and not self.ready:
                self._give_up_start()
            self._given_up = self.restarts == _MOST_RESTARTS
            if not self._given_up:
                self.restarts += 1
                self._process, self._standby = self._standby or self._spawn(self.restarts), None
                self._send_again()
        elif self._keeps_standby and self._standby is None and self.ready and self.restarts < _MOST_RESTARTS:
            self._standby = self._spawn(self.restarts + 1)
        self._outbox.flush()

    def _check_passes(self, *, replace: bool) -> None:
        """Wake a recorder that makes no passes (SIGSTOP); one that does not wake is killed to be replaced.

        Of the time between two calls at most a few frames count, so that a recorder is not taken as hung when the
        application was stopped too or the machine was asleep.
        """
        now_ns, passes = self._clock.now_ns(), int(self._status[StatusWord.PASSES])
        step_ns, self._looked_ns = min(now_ns - self._looked_ns, _LONGEST_STEP_NS), now_ns
        if passes != self._passes or not self.ready or self._process is None:
            self._passes, self._still_ns = passes, 0
            return
        before_ns, self._still_ns = self._still_ns, self._still_ns + step_ns
        if before_ns < _WAKE_NS <= self._still_ns and hasattr(signal, "SIGCONT"):
            with suppress(OSError):
                os.kill(self._process.pid or 0, signal.SIGCONT)
        elif replace and before_ns < _HUNG_NS <= self._still_ns:
            self._process.kill()

    def _send_again(self) -> None:
        """Send what the dead process may have read but not written; the new one skips what the files hold."""
        for payload in self._trials[self._status[StatusWord.TRIALS] :]:
            self._outbox.send(TRIAL, payload)
        if self._last_parameters:
            self._outbox.send(PARAMETERS, self._last_parameters)

    def journal(self, kind: str, data: Mapping[str, object] | bytes) -> None:
        """Append a line to events.jsonl; never waits.

        The kinds that the report reads, all with plain values; others are kept as they are:

            frame       frame (number), tick (of the snapshot it saw), t_ns; where there were any, events (number since
                        the frame before), pressed (keys), action (chosen for the task); where there are haptic bodies
                        also bodies: position [m] and quaternion xyzw of each, world
            sound       sound (name), tick (of the contact event; -1 for others), t_ns, sample (index in the mix),
                        latency_ms (from the event to that sample)
            scheduler   recipe of the live loop
            audio       device, sink, hrtf ...
            quality     settings of a live picture as it was opened
            action      values of an adaptation
            features    t_ns, values, quality: each new frame of features
            person      each new estimate of the person's state; means and variances
            result      of a trial, as the learning system received it
            choice      of the learning system: values, at_trial, propensity, reward

        Args:
            kind: Kind of event, in lower case; "parameters" with bytes stores SCENE record and rows, as `parameters`.
            data: Its values.
        """
        if isinstance(data, bytes):
            if kind != "parameters":
                raise ValueError(f'bytes are stored as "parameters" only, not as "{kind}"')
            self._store_parameters(data)
        else:
            self._outbox.send(LINE, encode_line("app", kind, data))
            self.listener(kind, data)
        self.supervise()

    def parameters(self, block: NDArray[Any], rows: Rows | None = None) -> None:
        """Store a SCENE record [shape (1,) or ()] and its rows as published; a replay needs every one of them."""
        record = np.ascontiguousarray(block).reshape(1)
        packed = b"" if rows is None else pack_rows(rows, record[0]["objects"])
        self._store_parameters(record.tobytes() + packed)
        self.supervise()

    def _store_parameters(self, block: bytes) -> None:
        self._last_parameters = block
        self._outbox.send(PARAMETERS, block)

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Store blocks of body signals; never waits."""
        self._outbox.send(SIGNALS, pack_signals(rows))

    def trial(self, row: Mapping[str, object]) -> None:
        """Store the result of a finished trial, one plain value per column; it is on the medium within 50 ms."""
        payload = to_json({"index": len(self._trials), "row": row})
        self._trials.append(payload)
        self._outbox.send(TRIAL, payload)
        self.listener("trial", row)
        self.supervise()

    def wait_for_room(self, ticks: int) -> None:
        """Return when the rings have room for `ticks` more samples; for the virtual clock, which outruns any disk.

        Raises:
            ValueError: The rings are too small.
            PartialDataError: There was no room for 30 s.
        """
        samples = self._memory.samples
        if ticks > len(samples) // 2:
            raise ValueError(f"{ticks} ticks at once; the ring takes {len(samples) // 2}")
        deadline = self._clock.now_ns() + _STALLED_NS
        while (
            ring.room(self._memory.sample_words, samples) < ticks
            or ring.room(self._memory.recorder_event_words, self._memory.recorder_events) < _EVENT_ROOM
            or self._outbox.waiting_bytes > _BACKLOG
        ):
            self.supervise()
            if self._clock.now_ns() > deadline or self._given_up:
                raise PartialDataError(f"the recorder of {self.folder} is stuck", "is its disk alive?")
            self._clock.sleep_until_ns(self._clock.now_ns() + _ROOM_STEP_NS)

    def close(self, summary: Mapping[str, object] | None = None, timeout_s: float = 60.0) -> Manifest:
        """End the recording after the loop ended; returns when every file is sealed.

        Args:
            summary: Summary of the session: the object of `mimics run --json`, lateness, recipe ...
            timeout_s: Time-out for the disk [s].

        Raises:
            PartialDataError: The recorder could not close the files; `mimics record recover` can.
        """
        self.supervise()
        self._outbox.send(CLOSE, to_json({"summary": summary or {}, "dropped": self._outbox.dropped}))
        deadline = self._clock.now_ns() + int(timeout_s * 1e9)
        while self.alive and not self._status[StatusWord.SEALED] and self._clock.now_ns() < deadline:
            self._check_passes(replace=False)  # sealing a long run is one long pass
            self._outbox.flush()
            self._clock.sleep_until_ns(self._clock.now_ns() + 1_000_000)
        hung = self.alive and not self._status[StatusWord.SEALED]
        manifest = None if hung else read_manifest(self.folder)[0]
        self.kill()
        if manifest is None:
            raise PartialDataError(f"{self.folder} was not closed", f"try: mimics record recover {self.folder}")
        return manifest

    def abandon(self, timeout_s: float = 10.0) -> None:
        """End without an orderly close, after an error: all that was sent is written, the run is "interrupted".

        Args:
            timeout_s: Time-out for the disk [s].
        """
        self._closed = True
        self._finalize()
        deadline = self._clock.now_ns() + int(timeout_s * 1e9)
        for process in (self._process, self._standby):  # the second writes the rest where the first did not
            if process is not None and not self._status[StatusWord.SEALED]:
                process.join(max(0.0, 1e-9 * (deadline - self._clock.now_ns())))
        self.kill()

    def kill(self) -> None:
        """Close the channel and kill the process; what was written remains."""
        self._closed = True
        self._finalize()
        for process in (self._standby, self._process):  # in this order: the first would take over from the second
            if process is not None:
                process.kill()
                process.join()
