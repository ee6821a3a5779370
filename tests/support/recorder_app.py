"""Stands in for the app in the recorder's kill tests: a fake loop at 1 kHz, trial rows, frames, and a record of it all.

It shares a file of four int64 with the test: last tick pushed, trials handed over, recorder's pid, 1 when closed.
"""

from __future__ import annotations

import mmap
import os
import threading
import time
from pathlib import Path

import numpy as np

from mimics_app.contracts.loop.haptic import EVENT, SAMPLE, SCENE, EventKind
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, sample_dtype
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.columns import present_columns, row_length, rows_of
from mimics_app.recording.recorder import Recorder

TICK, TRIALS, PID, CLOSED = range(4)


def fake_samples(first_tick: int, count: int) -> np.ndarray:
    """Rows that are different in every column that is recorded, and show their tick."""
    samples = np.zeros(count, sample_dtype(LOOP_FIELDS, 1))
    ticks = np.arange(first_tick, first_tick + count, dtype=np.float64)
    rows = samples.view(np.float64).reshape(count, -1)
    present = present_columns()
    rows[:, present] = np.sin(ticks[:, None] * 1e-3 + present)
    samples["t"], samples["tick"], samples["sequence"] = ticks / 1000, ticks, 1
    return samples


def push_ticks(memory: SessionMemory, first_tick: int, count: int, *, events: bool = True) -> None:
    samples = np.zeros(count, SAMPLE)
    rows_of(samples)[:, : row_length(1)] = rows_of(fake_samples(first_tick, count))
    event = np.zeros(1, EVENT)
    for i in range(count):
        ring.push(memory.sample_words, memory.samples, samples[i : i + 1])
        if events and (first_tick + i) % 97 == 0:
            event["tick"], event["kind"], event["force"] = (
                first_tick + i,
                EventKind.CONTACT_BEGIN,
                0.1 * (first_tick + i),
            )
            ring.push(memory.recorder_event_words, memory.recorder_events, event)


def scene_block(sequence: int = 1, trial: int = 0) -> np.ndarray:
    block = np.zeros(1, SCENE)
    block["sequence"], block["trial"] = sequence, trial
    return block


def main(folder: Path, words_path: Path, seconds: float) -> None:
    """The body of the stand-in's process."""
    os.setsid()  # one group with its recorder, so that both can be killed at once
    with words_path.open("r+b") as file:
        words = np.ndarray(4, np.int64, buffer=mmap.mmap(file.fileno(), 32))
    memory = SessionMemory()
    recorder = Recorder(memory, folder, {"seed": 1})
    recorder.start()
    recorder.keep_standby()
    recorder.parameters(scene_block())
    words[PID] = recorder.pid
    done = threading.Event()

    def loop() -> None:
        start = time.monotonic()
        tick = 0
        while not done.is_set():
            due = int((time.monotonic() - start) * 1000)
            if due > tick:
                push_ticks(memory, tick, due - tick)
                tick = due
                words[TICK] = tick - 1
            time.sleep(0.001)

    thread = threading.Thread(target=loop)
    thread.start()
    frames = round(seconds * 60)
    for frame in range(frames):
        recorder.journal("frame", {"frame": frame, "tick": int(words[TICK]), "t_ns": frame})
        words[PID] = recorder.pid
        if frame % 12 == 11:
            recorder.trial({"trial": frame // 12, "score": frame * 0.1, "name": "a, b"})
            words[TRIALS] = frame // 12 + 1
        time.sleep(1 / 60)
    done.set()
    thread.join()
    recorder.close({"seed": 1})
    words[CLOSED] = 1
