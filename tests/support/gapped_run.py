"""A recording with what exports must not lose: missing ticks, a stall, a signal with a gap, events and a trial."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.recording.event_log import encode_line
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.signal_rows import SignalRow, pack_signals
from mimics_app.recording.signals import SignalStream
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import EventStream, SampleStream
from mimics_app.recording.trial_table import TrialTable
from tests.support.synthetic_run import events_of_session, samples_of_session

TICKS, MISSING, STALL_TICK, DROPPED = 4000, range(700, 800), 1200, 60
"""Number of ticks, those that are missing, and the tick whose stall dropped others."""
RATE, SIGNAL_GAP_S = 250.0, (1.0, 1.6)
"""Rate of the signal [Hz], and begin and end of its gap since tick 0 [s]."""
START_NS = 5_000_000_000
"""Time of tick 0 on the clock of the run [ns]."""


def signal_values() -> np.ndarray:
    """Samples of the signal at 250 Hz for 4 s [mV], those of the gap included."""
    return np.sin(2 * np.pi * 1.2 * np.arange(1000) / RATE)


def write_gapped_run(folder: Path, participant: str = "") -> Path:
    """Fill an empty folder."""
    samples = samples_of_session(TICKS / 1000)
    samples["lateness_ns"][STALL_TICK] = DROPPED * 1e6 + 2e5
    state = StateHash()
    stream = SampleStream(folder, state)
    for first in range(0, TICKS, 50):
        if first not in MISSING:
            stream.append(samples[first : first + 50], first)
    log = EventStream(folder, state)
    events = events_of_session(samples)
    events["t_ns"] = START_NS + events["tick"] * 1_000_000
    log.append_events(events)
    gap = {"after_row": MISSING.start, "rows": len(MISSING), "reason": "the disk was full"}
    log.append_lines(
        [encode_line("recorder", "gap", gap), encode_line("app", "note", {"t_ns": START_NS, "text": "=cmd"})]
    )
    signals, values = SignalStream(folder), signal_values()
    for frame in range(20):
        part = slice(50 * frame, 50 * frame + 50)
        if not SIGNAL_GAP_S[0] <= part.start / RATE < SIGNAL_GAP_S[1]:
            t_ns = START_NS + round(part.start / RATE * 1e9)
            signals.append(pack_signals([SignalRow(frame, SignalBlock("ecg", RATE, t_ns, values[part]))]))
    trials = TrialTable(folder / "trials.csv")
    row = {"trial": 0, "label": "=HYPERLINK(1)", "outcome": "finished", "score": 81.25}
    trials.append({**row, "begin_ns": START_NS + 500_000_000, "end_ns": START_NS + 2_000_000_000})
    clock = {"utc": "2026-11-22T14:05:57.713398+00:00", "monotonic_ns": START_NS}
    header = {"clock": clock, "scene": {"name": "wavy_tunnel"}, "safety": {"late_stop_s": 0.05}}
    session = {"format": "mimics run", "version": 1, **header, "settings": {"participant": participant}}
    (folder / "session.json").write_text(json.dumps(session))
    for file in (stream, log, signals, trials):
        file.close()
    counts = {"rows": TICKS, "events": len(events), "trials": 1, "parameters": 0}
    write_manifest(folder, Manifest("clean", state.hexdigest(), **counts, files=hash_files(folder)))
    return folder
