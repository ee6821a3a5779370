"""The main function of the audio process."""

from __future__ import annotations

import faulthandler
import gc
import os
import pickle
import signal
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from multiprocessing import connection, parent_process
from multiprocessing.connection import Connection

import numpy as np

from mimics_app.compiled.atomics import scratch
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE
from mimics_app.contracts.loop.haptic import EVENT
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import AudioOrder, AudioReport, AudioStatus, Mixer, frame_at
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.ring import wait_for_records
from mimics_app.contracts.shared_memory.session_memory import ControlWord, SessionMemory
from mimics_app.contracts.shared_memory.shared_words import DROPPED
from mimics_app.contracts.system.child_signals import ignore_signals
from mimics_app.contracts.system.pipe_watch import PipeWatch
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.director import SoundDirector
from mimics_app.rendering.audio.engine import fall_back, open_device, open_engine
from mimics_app.rendering.audio.settings import AudioSettings
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK
from mimics_app.rendering.audio.streamed_mixer import StreamedMixer
from mimics_app.rendering.audio.wav_file import unused_name

__all__ = ["FIFO_PRIORITY", "IGNORED", "WorkTimes", "ask_for_fifo", "run"]

IGNORED = ("SIGINT", "SIGHUP")
"""Signals of the process group that do not end the audio process: the application decides."""

_LIVE_WAIT_NS = 4_000_000
_STREAM_WAIT_NS = 500_000  # the queue of a stream is polled
_LIVE_STEP_NS = 1_000_000
_IDLE_WAIT_NS = 20_000_000
_CHECK_DEVICE_NS = 1_000_000_000
_TRY_DEVICE_NS = 3_000_000_000  # a failing attempt to open a device may delay the file by some milliseconds
_FADE_NS = 40_000_000
FIFO_PRIORITY = 10
"""SCHED_FIFO priority of the audio process, below the haptic loop's."""


def run(memory: SessionMemory, settings: AudioSettings, orders: Connection, results: Connection) -> None:
    """Play the session until the application sends stop, closes its end, or ends; then send the report."""
    ignore_signals(*IGNORED)
    os.environ.update(settings.environment)
    _tell_of_crashes()
    _die_with_parent()
    session = _LiveSession(memory, settings, orders, results, MonotonicClock())
    gc.freeze()  # a full collection over all loaded modules takes as long as four blocks
    session.send(session.engine.status)
    while not session.ended:
        session.step()
    session.send(session.finish())
    session.engine.close()


_BIN_NS = 10_000
_BINS = 2000
"""Number of bins, up to 20 ms; the last one also counts longer times."""


class WorkTimes:
    """A histogram with bins of 10 us."""

    def __init__(self) -> None:
        self._counts = np.zeros(_BINS, np.int64)
        self._longest_ns = 0

    def count(self, took_ns: int) -> None:
        """Count the working time of one block [ns]."""
        self._counts[min(took_ns // _BIN_NS, _BINS - 1)] += 1
        self._longest_ns = max(self._longest_ns, took_ns)

    def percentiles_us(self) -> Mapping[str, float]:
        """Return p50 and p99 (upper ends of their bins), max [us] and `count`; empty without counts."""
        total = int(self._counts.sum())
        if total == 0:
            return {}
        ranks = np.searchsorted(np.cumsum(self._counts), [np.ceil(0.50 * total), np.ceil(0.99 * total)])
        p50, p99 = ((ranks + 1) * _BIN_NS * 1e-3).tolist()
        return {"p50": p50, "p99": p99, "max": self._longest_ns * 1e-3, "count": total}


class _LiveSession:
    """Main loop of the audio process: wait, read orders, read contacts, mix the blocks that are due."""

    def __init__(
        self, memory: SessionMemory, settings: AudioSettings, orders: Connection, results: Connection, clock: Clock
    ) -> None:
        self.ended = False
        self._memory = memory
        self._settings = settings
        self._orders, self._watch = orders, PipeWatch(orders)
        self._results = results
        self._clock = clock
        self._timespec = scratch()
        self._blocks = 0
        self._late_blocks = 0
        self._times = WorkTimes()
        self._gain = 1.0
        self._earlier = AudioReport(_nothing())
        self._lost: SoundBank | None = None  # sounds of a lost device
        _warm_up(memory, clock)
        self.engine = open_engine(settings, clock, _take_precedence if settings.realtime else None)
        self._director = self._direct()
        self._opened_ns = clock.now_ns()
        self._check_ns = self._opened_ns + _CHECK_DEVICE_NS
        self._listen()
        self._advance_file()

    def step(self) -> None:
        """Run one iteration: one block of a file, or one poll of the rings for a live device."""
        self._wait()
        begun, before = self._clock.now_ns(), self._mixed
        try:
            self._read_orders()
            self._listen()
            self._advance_file()
            if self._mixed != before:
                self._times.count(self._clock.now_ns() - begun)
            self._check_device()
        except DeviceError as error:
            self._replace_output(error.what)
        self.ended = self.ended or bool(self._memory.control[ControlWord.CLOSED])

    def finish(self) -> AudioReport:
        """Let the sounds of a file decay, or fade a device out, and return the report."""
        mixer = self.engine.mixer
        if self._director is not None:
            self._director.decay()
        if mixer is not None and self.engine.live:
            mixer.master(0.0)
            self._fade_out(mixer)
        elif mixer is not None:
            with suppress(DeviceError):  # a file that cannot be written any further keeps what it has
                self.engine.decay(self._settings.block)
        if self._director is not None:
            self._director.close()
        return self.report()

    def _fade_out(self, mixer: Mixer) -> None:
        """Play on for the time of a fade."""
        end = self._clock.now_ns() + _FADE_NS
        with suppress(DeviceError):
            while self._clock.now_ns() < end:
                mixer.render(LIVE_BLOCK)
                self._clock.sleep_until_ns(self._clock.now_ns() + _STREAM_WAIT_NS)

    def send(self, message: object) -> None:
        """Send a message to the application; a closed pipe ends the session."""
        try:
            self._results.send(message)
        except OSError:
            self.ended = True

    def report(self) -> AudioReport:
        """Return the report, including the time before a lost device."""
        director, mixer, writer = self._director, self.engine.mixer, self.engine.writer
        now = AudioReport(
            self.engine.status,
            rows=tuple(director.rows) if director else (),
            merged=director.merged if director else 0,
            stale=director.stale if director else 0,
            dropped=int(self._memory.audio_event_words[DROPPED]),
            refused=mixer.refused if mixer else 0,
            blocks=self._blocks,
            late_blocks=self._late_blocks,
            underruns=mixer.queue.underruns if isinstance(mixer, StreamedMixer) else 0,
            queue=mixer.report_queue() if isinstance(mixer, StreamedMixer) else {},
            block_us=self._times.percentiles_us(),
            clipped=writer.clipped if writer else 0,
            file=str(writer.path) if writer else "",
            origin_ns=mixer.timing.origin_ns if mixer else 0,
        )
        before = self._earlier
        return replace(
            now,
            rows=(*before.rows, *now.rows),
            file=now.file or before.file,
            merged=before.merged + now.merged,
            stale=before.stale + now.stale,
            refused=before.refused + now.refused,
            underruns=before.underruns + now.underruns,
            clipped=before.clipped + now.clipped,
        )

    def _listen(self) -> None:
        if self._director is not None:
            self._director.take_contacts()
            self._director.listen()
            if problem := self._director.take_problem():
                self.engine.status = replace(self.engine.status, notice=problem)
                self.send(self.engine.status)
        else:
            words = self._memory.audio_event_words
            ring.release(words, ring.waiting(words))
            words = self._memory.audio_force_words
            ring.release(words, ring.waiting(words))

    def _direct(self) -> SoundDirector | None:
        engine = self.engine
        if engine.mixer is None or engine.bank is None:
            return None
        return SoundDirector(self._memory, engine.mixer, engine.bank, self._settings, self._clock)

    def _wait(self) -> None:
        now = self._clock.now_ns()
        mixer = self.engine.mixer
        if mixer is None:
            self._clock.sleep_until_ns(now + _IDLE_WAIT_NS)
            return
        if self.engine.live:
            driving = self._director is not None and self._director.driving
            openal_ns = _LIVE_STEP_NS if driving else _LIVE_WAIT_NS
            allowed = _STREAM_WAIT_NS if isinstance(mixer, StreamedMixer) else openal_ns
            due = now + allowed
            wait_for_records(self._memory.audio_event_words, self._timespec, due, min(allowed, _LIVE_STEP_NS))
        else:
            due = self._block_due_ns(now)
            self._clock.sleep_until_ns(due)
            allowed = self._block_ns()
        self._blocks += 1
        if self._clock.now_ns() - due > allowed:
            self._late_blocks += 1

    @property
    def _mixed(self) -> int:
        """Frames mixed so far on the open output."""
        return 0 if self.engine.mixer is None else self.engine.mixer.position

    def _block_ns(self) -> int:
        return self._settings.block * 1_000_000_000 // self._settings.rate

    def _block_due_ns(self, now: int) -> int:
        """Return the next block boundary in session time [ns]."""
        origin = self.engine.mixer.timing.origin_ns if self.engine.mixer is not None else 0
        return origin + ((now - origin) // self._block_ns() + 1) * self._block_ns()

    def _advance_file(self) -> None:
        """Render a file two blocks ahead of the clock, or fill the queue of a live device."""
        mixer = self.engine.mixer
        if mixer is None:
            return
        if self.engine.live:
            mixer.render(LIVE_BLOCK)
            return
        block = self._settings.block
        elapsed = frame_at(self._clock.now_ns(), mixer.timing.origin_ns, mixer.rate) // block
        self.engine.render_to((elapsed + 2) * block, block)

    def _read_orders(self) -> None:
        while not self.ended and self._watch.ready():
            try:
                order: AudioOrder = pickle.loads(self._orders.recv_bytes())
            except (EOFError, OSError):
                self.ended = True
                return
            self._obey(order)

    def _obey(self, order: AudioOrder) -> None:
        if order is None:
            self.ended = True
        elif isinstance(order, SoundEvent):
            if self._director is not None:
                self._director.play_order(order)
        else:
            self._gain = order
            if self.engine.mixer is not None:
                self.engine.mixer.master(order)

    def _check_device(self) -> None:
        """Once a second, replace an unplugged device by the next output of the fallback chain, until it is back."""
        now = self._clock.now_ns()
        if now < self._check_ns:
            return
        self._check_ns = now + _CHECK_DEVICE_NS
        if self._lost is not None:
            self._check_ns = now + _TRY_DEVICE_NS
            self._try_device(self._lost)
        elif self.engine.live and self.engine.mixer is not None and not self.engine.mixer.connected():
            self._replace_output("the audio device is gone")

    def _try_device(self, bank: SoundBank) -> None:
        """Return to the device if it can be opened again."""
        try:
            engine = open_device(self._settings, bank, self._clock)
        except DeviceError:
            return
        self._earlier = self.report()
        self.engine.close()
        self._lost, self.engine = None, engine
        self._settings = replace(self._settings, file=unused_name(self._settings.file))
        self._resume()

    def _replace_output(self, why: str) -> None:
        """Close the failed output and continue with the file, or without sound if the file failed."""
        failed = self.engine
        self._earlier = self.report()
        failed.close()
        if failed.bank is not None:
            self._lost = failed.bank if failed.live else None
            settings = self._settings if failed.live else replace(self._settings, sink="device", file=None)
            self.engine = fall_back(settings, failed.bank, self._clock, why)
        self._resume()

    def _resume(self) -> None:
        """Continue on a new output with the same master gain, and report its status."""
        if self.engine.mixer is not None:
            self.engine.mixer.master(self._gain)
        if self._director is not None:
            self._director.close()
        self._director = self._direct()
        self.send(self.engine.status)


def _nothing() -> AudioStatus:
    return AudioStatus("none", "null", hrtf=False, rate=0, latency_ms=0.0)


def _die_with_parent() -> None:
    """Exit when the application ends, also when it is killed. PDEATHSIG would fire with the spawning thread."""
    parent = parent_process()
    if parent is None:
        return

    def wait() -> None:
        connection.wait([parent.sentinel])
        os._exit(0)

    threading.Thread(target=wait, name="parent", daemon=True).start()


def _tell_of_crashes() -> None:
    """Have a crash in a library print its stack to stderr, also while that is redirected."""
    if sys.stderr is not None:
        faulthandler.enable(os.fdopen(os.dup(2), "w"))


def _warm_up(memory: SessionMemory, clock: Clock) -> None:
    """Compile or load the functions of the main loop, on copies of the data, before real-time priority is set."""
    wait_for_records(memory.audio_event_words, scratch(), clock.now_ns(), _LIVE_STEP_NS)
    ring.drain(memory.audio_event_words.copy(), memory.audio_events.copy(), np.zeros(1, EVENT))
    ring.drain(memory.audio_force_words.copy(), memory.audio_forces.copy(), np.zeros(1, CONTACT_FORCE))
    for words in (memory.sound_scene_words, memory.audio_words):
        triple_buffer.acquire(words.copy())


def _take_precedence() -> None:
    """Set real-time priority where the system allows it; threads started later inherit it.

    Under a limit of uninterrupted real-time work (RLIMIT_RTTIME, set with the haptic loop and inherited) the kernel
    kills a process that exceeds it. SIGXCPU comes first, and its handler returns the process to normal priority.
    """
    ask_for_fifo()
    if hasattr(signal, "SIGXCPU"):
        signal.signal(signal.SIGXCPU, lambda *_: os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0)))


def ask_for_fifo(pid: int = 0, priority: int = FIFO_PRIORITY) -> None:
    """Set SCHED_FIFO for a process (0: this one) where the system allows it; threads it starts inherit it."""
    if not hasattr(os, "sched_setscheduler"):
        return
    try:
        os.sched_setscheduler(pid, os.SCHED_FIFO, os.sched_param(priority))
    except OSError:
        return
