"""A recording of any length by the product's own writers, made stretch by stretch: its making needs little memory."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from mimics_app.contracts.clock import SECOND_NS, TICK_NS
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.contracts.system.run_environment import clock_pair, describe_environment
from mimics_app.recording.column_file import ColumnFile
from mimics_app.recording.event_log import encode_line
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.signal_rows import SignalRow, pack_signals
from mimics_app.recording.signals import SignalStream
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import EventStream, SampleStream
from mimics_app.recording.trial_table import TrialTable
from tests.support.synthetic_run import events_of_session, samples_of_session

START_NS = 5_000_000_000
"""Time of tick 0 on the clock of the run [ns]."""
STRETCH_S = 20
"""Length of what is repeated: two attempts [s]."""
_BLOCK = 50
_FRAMES = 60
_SIGNALS = {"ecg": 1000.0, "emg": 1000.0, "gsr": 1000.0, "resp": 1000.0, "speed": 60.0, "power": 60.0}
"""Signals of a simulated person and their rates [Hz]."""


def write_long_run(folder: Path, minutes: float) -> Path:
    """Fill an empty folder with a clean run: ticks, 60 frames a second, six body signals, two attempts a stretch."""
    state = StateHash()
    stream, columns = SampleStream(folder, state), ColumnFile(folder)
    log, signals = EventStream(folder, state), SignalStream(folder)
    trials = TrialTable(folder / "trials.csv")
    samples = samples_of_session(STRETCH_S)
    events = events_of_session(samples)
    count, made = round(minutes * 60 / STRETCH_S), 0
    noise = np.random.default_rng(5)
    for stretch in range(count):
        base = stretch * len(samples)
        samples["tick"] = base + np.arange(len(samples))
        samples["t"] = samples["tick"] / 1000
        samples["f_meas"] += noise.normal(0, 0.01, samples["f_meas"].shape)  # no stretch is as the one before
        for first in range(0, len(samples), _BLOCK):
            stream.append(samples[first : first + _BLOCK], base + first)
            columns.add(samples[first : first + _BLOCK])
        again = events.copy()
        again["tick"] += base
        again["t_ns"] = START_NS + again["tick"] * TICK_NS
        log.append_events(again)
        made += len(again)
        log.append_lines(
            list(map(_frame_line, range(stretch * STRETCH_S * _FRAMES, (stretch + 1) * STRETCH_S * _FRAMES)))
        )
        for second in range(stretch * STRETCH_S, (stretch + 1) * STRETCH_S):
            signals.append(pack_signals(_signal_rows(second, noise)))
        for attempt in (0, 1):
            number = 2 * stretch + attempt
            begin_ns = START_NS + number * STRETCH_S * SECOND_NS // 2
            row = {"trial": number, "label": "wavy", "outcome": "finished", "score": 81.25}
            trials.append({**row, "begin_ns": begin_ns, "end_ns": begin_ns + 9 * SECOND_NS})
    for file in (stream, columns, log, signals, trials):
        file.close()
    header = {"scene": {"name": "wavy_tunnel"}, "safety": {"late_stop_s": 0.05}, "settings": {"participant": "P01"}}
    session = {"format": "mimics run", "version": 1, **describe_environment(), "clock": clock_pair(), **header}
    (folder / "session.json").write_text(json.dumps(session))
    counts = {"rows": count * len(samples), "events": made, "trials": 2 * count, "parameters": 0}
    write_manifest(folder, Manifest("clean", state.hexdigest(), **counts, files=hash_files(folder)))
    return folder


def _frame_line(frame: int) -> bytes:
    tick = frame * 1000 // _FRAMES
    return encode_line("app", "frame", {"frame": frame, "tick": tick, "t_ns": START_NS + tick * TICK_NS})


def _signal_rows(second: int, noise: np.random.Generator) -> list[SignalRow]:
    """Return a second of each signal, frame by frame; times of frames are whole milliseconds."""
    rows = []
    for frame in range(second * _FRAMES, (second + 1) * _FRAMES):
        tick, end = frame * 1000 // _FRAMES, (frame + 1) * 1000 // _FRAMES
        t_ns = START_NS + tick * TICK_NS
        for name, rate in _SIGNALS.items():
            count = end - tick if rate == 1000.0 else 1
            rows.append(SignalRow(frame, SignalBlock(name, rate, t_ns, noise.normal(0, 1, count).round(4))))
    return rows
