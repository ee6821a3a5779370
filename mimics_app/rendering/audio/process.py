"""The audio process seen from the main process: started, commanded and closed, never waited for within a frame.

Contacts and the poses of head and emitters do not pass through here: the child reads them from shared memory. Orders
are sent through a pipe whose writing end never blocks; a message is smaller than PIPE_BUF, so that the kernel accepts
it whole or not at all.
"""

from __future__ import annotations

import os
import pickle
import signal
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import MimicsError, nearest
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import AudioOrder, AudioReport, AudioStatus
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.system.child_main import main_hidden
from mimics_app.contracts.system.child_signals import signals_blocked
from mimics_app.contracts.system.pipe_watch import PipeWatch
from mimics_app.rendering.audio.settings import AudioSettings

if TYPE_CHECKING:
    from multiprocessing.context import SpawnProcess

__all__ = ["AudioProcess"]

_SILENT = AudioStatus(device="none", sink="null", hrtf=False, rate=0, latency_ms=0.0)

_STARTS = 2
"""Number of attempts: a start that fails for a transient reason (memory, a signal) is repeated once."""

_STILL_STARTING = "the session ended before its sound could start: nothing was played; picture and touch continued"
_LOST = "sound was lost; picture and touch continued"

_GONE_S = 0.01
"""Time-out for the exit code of a child that has closed its end of the pipe [s], shorter than a frame."""


class AudioProcess:
    """Sound of a live session, mixed in a spawned process, which no Python work of the main process can delay.

    Start it before the haptic thread and before the main process changes its niceness, which a child inherits.

    Attributes:
        starts: Number of processes started: two where the first one ended before it was ready.
    """

    def __init__(self, memory: SessionMemory, settings: AudioSettings) -> None:
        self.starts = 0
        self._memory = memory
        self._settings = settings
        self._process: SpawnProcess | None = None
        self._orders: Connection | None = None
        self._results: Connection | None = None
        self._watch: PipeWatch | None = None
        self._status: AudioStatus | None = None
        self._report: AudioReport | None = None
        self._orders_dropped = 0
        self._given_up = False
        self._hung_up = False

    def start(self) -> None:
        """Spawn the process and return at once; a session without sound spawns none."""
        if self._settings.sink == "null":
            self._status = _SILENT
            return
        self._spawn()

    def _spawn(self) -> None:
        import multiprocessing

        from mimics_app.rendering.audio.worker import IGNORED, run

        self.starts += 1
        self._hung_up = False
        spawn = multiprocessing.get_context("spawn")
        orders_child, self._orders = spawn.Pipe(duplex=False)
        self._results, results_child = spawn.Pipe(duplex=False)
        self._watch = PipeWatch(self._results)
        self._process = spawn.Process(
            target=run,
            args=(self._memory, self._settings, orders_child, results_child),
            name="mimics-audio",
            daemon=True,
        )
        with signals_blocked(*IGNORED), main_hidden():
            self._process.start()
        # With our copies of the child's ends open, a read would wait for a child that has ended.
        orders_child.close()
        results_child.close()
        if hasattr(os, "set_blocking"):
            os.set_blocking(self._orders.fileno(), False)

    @property
    def ready(self) -> AudioStatus | None:
        """Status of the present output (a fallback once a device was lost), None while starting; never waits."""
        if self._report is None:
            self._take_status(timeout_s=0.0)
        return self._status

    def wait_ready(self, timeout_s: float | None = None) -> AudioStatus:
        """Wait until the output is open; after the time-out of the settings the session continues without sound."""
        if self._status is None:
            self._take_status(self._settings.start_timeout_s if timeout_s is None else timeout_s)
        if self._status is None:
            self._give_up("the audio process did not start in time: sound is dropped; picture and touch run on")
        assert self._status is not None
        return self._status

    @property
    def alive(self) -> bool:
        """True while the process runs."""
        return self._process is not None and self._process.is_alive()

    @property
    def pid(self) -> int | None:
        """Process id of the child, None where there is none."""
        return None if self._process is None else self._process.pid

    def play(self, event: SoundEvent) -> None:
        """Start a sound of the task; never waits, and counts orders that the process did not accept.

        Raises:
            MimicsError: The settings know no sound of that name.
        """
        if event.sound not in self._settings.sounds:
            raise MimicsError(f'no sound "{event.sound}"', nearest(event.sound, self._settings.sounds))
        if not self._send(event):
            self._orders_dropped += 1

    def master(self, gain: float) -> None:
        """Set the linear gain of everything; never waits."""
        self._send(float(gain))

    def advance(self, now_ns: int) -> None:
        """Do nothing: the process has a clock of its own."""

    def stop(self) -> AudioReport:
        """End the sound, receive the report and end the process, by force where it does not answer."""
        if self._report is None:
            self._report = self._close()
        return self._report

    def _close(self) -> AudioReport:
        if self._process is None:
            return AudioReport(self._status or _SILENT)
        self._send(None)
        if self._orders is not None:
            self._orders.close()
            self._orders = None
        report = self._take_report()
        if not report.crashed:
            self._process.join(1.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        if self._results is not None:
            self._results.close()
        return report

    def _take_report(self) -> AudioReport:
        message = self._receive(self._settings.stop_timeout_s)
        while isinstance(message, AudioStatus):
            self._status = message
            message = self._receive(self._settings.stop_timeout_s)
        if isinstance(message, AudioReport):
            self._status = message.status
            return replace(message, orders_dropped=self._orders_dropped)
        starting = not self._given_up and self._status is None and not self._hung_up and self.alive
        if not self._given_up:
            self._give_up(_STILL_STARTING if starting else f"the audio process ended early{self._cause()}: {_LOST}")
        file = self._settings.file
        written = str(file) if file is not None and file.exists() else ""
        return AudioReport(
            self._status or _SILENT, orders_dropped=self._orders_dropped, file=written, crashed=not starting
        )

    def _take_status(self, timeout_s: float) -> None:
        message = self._receive(timeout_s)
        if isinstance(message, AudioStatus):
            self._status = message
        elif self._given_up or self._process is None or not (self._hung_up or not self._process.is_alive()):
            return
        elif self._status is None and self.starts < _STARTS:
            self._start_again()
            self._take_status(timeout_s)
        else:
            self._give_up(f"the audio process has ended{self._cause()}: sound is dropped; picture and touch run on")

    def _start_again(self) -> None:
        """Clean up after a child that ended before it was ready, and spawn another."""
        for end in (self._orders, self._results):
            if end is not None:
                end.close()
        if self._process is not None:
            self._process.kill()
            self._process.join()
        self._spawn()

    def _receive(self, timeout_s: float) -> object:
        """Return the next message of the child, None at the time-out or when the child has ended."""
        if self._results is None or self._watch is None:
            return None
        try:
            arrived = self._watch.ready() or (timeout_s > 0.0 and self._results.poll(timeout_s))
            return self._results.recv() if arrived else None
        except (EOFError, OSError):
            self._hung_up = True  # it closed its end of the pipe: it has ended or is ending
            return None

    def _send(self, order: AudioOrder) -> bool:
        """Send an order without waiting; return whether the pipe took it."""
        if self._orders is None:
            return False
        try:
            self._orders.send_bytes(pickle.dumps(order))
        except (BlockingIOError, BrokenPipeError):
            return False
        return True

    def _cause(self) -> str:
        """Return the signal or exit code of a child that has ended, in brackets, as far as it is known."""
        if self._process is None:
            return ""
        self._process.join(_GONE_S)
        code = self._process.exitcode
        if code is None:
            return ""
        return f" ({signal.Signals(-code).name})" if code < 0 else f" (exit code {code})"

    def _give_up(self, notice: str) -> None:
        self._given_up = True
        self._status = replace(_SILENT, notice=notice)
