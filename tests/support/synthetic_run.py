"""A run folder as a session leaves it, without a session: two attempts through a wavy tunnel, the last cut short."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from mimics_app.contracts.loop.controller_slots import Lead, Slot
from mimics_app.contracts.loop.haptic import EVENT, SAMPLE, SCENE, EventKind, SafetyState, TripCause
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows, pack_rows
from mimics_app.contracts.system.run_environment import clock_pair, describe_environment
from mimics_app.recording.column_file import ColumnFile
from mimics_app.recording.event_log import encode_line
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import EventStream, ParameterStream, SampleStream
from mimics_app.recording.trial_table import TrialTable

PIECES, LENGTH, RADIUS = 8, 0.36, 0.032


def bisector(x: np.ndarray) -> np.ndarray:
    """Vertical place [m] of the wavy bisector at lateral place x [m]."""
    return 0.06 * np.sin(2 * np.pi * x / 0.24)


def packed(block: np.ndarray, rows: Rows) -> bytes:
    """Both as they are recorded."""
    return block.tobytes() + pack_rows(rows, block[0]["objects"])


def scene_block(sequence: int, trial: int, controller: int) -> tuple[np.ndarray, Rows]:
    """A SCENE record, shape [1], and the rows beside it.

    The tunnel follows `bisector` by cubic Hermite pieces, with a radius that narrows.
    """
    block = np.zeros(1, SCENE)
    block["sequence"], block["trial"], block["controller"] = sequence, trial, controller
    block[0]["leads"][[Slot.START, Slot.PERSON]] = Lead.TARGET, Lead.PERSON
    block[0]["objects"]["tunnels"] = 1
    rows = new_rows(ObjectCapacities())
    tunnel = rows.tunnels[0]
    tunnel["pieces"], tunnel["radius_scale"] = PIECES, 1.0
    knots = np.linspace(-LENGTH / 2, LENGTH / 2, PIECES + 1)
    step = knots[1] - knots[0]
    y, slope = bisector(knots), 0.06 * 2 * np.pi / 0.24 * np.cos(2 * np.pi * knots / 0.24) * step
    for i in range(PIECES):
        rise = y[i + 1] - y[i]
        tunnel["centre"][i, 0, :2] = knots[i], step
        curve = 3 * rise - 2 * slope[i] - slope[i + 1], slope[i] + slope[i + 1] - 2 * rise
        tunnel["centre"][i, 1] = y[i], slope[i], *curve
        tunnel["radius"][i, :2] = RADIUS - 0.0012 * i, -0.0012
    return block, rows


def samples_of_session(seconds: float, seed: int = 3, live: bool = True) -> np.ndarray:
    """Rows of two attempts of equal length, each driven to the start for its first 1.5 s."""
    count = round(seconds * 1000)
    chance = np.random.default_rng(seed)
    samples = np.zeros(count, SAMPLE)
    tick = np.arange(count)
    half = count // 2
    share = np.clip((tick % half - 1500) / (half - 2200), 0.0, 1.0)
    smooth = share**3 * (10 - 15 * share + 6 * share**2)
    x = -LENGTH / 2 + LENGTH * smooth
    driven = tick % half < 1500
    wander = 0.021 * np.sin(2 * np.pi * 1.3 * tick / 1000 + seed) + 0.002 * np.sin(2 * np.pi * 8 * tick / 1000)
    samples["t"], samples["tick"] = tick / 1000, tick
    samples["sequence"] = 1 + 2 * (tick // half).clip(0, 1) + ~driven
    start = np.array([-0.05, 0.1])
    blend = np.clip((tick % half) / 1500, 0, 1)
    samples["hip_world"][:, 0] = np.where(driven, start[0] + blend * (-LENGTH / 2 - start[0]), x)
    inside = bisector(x) + np.where(share > 0, wander, 0.0)
    samples["hip_world"][:, 1] = np.where(driven, start[1] + blend * (bisector(-LENGTH / 2) - start[1]), inside)
    for part in (slice(0, half), slice(half, count)):
        samples["v_world"][part] = np.gradient(samples["hip_world"][part], 1e-3, axis=0)
    samples["v_world"][np.abs(samples["v_world"]) > 2.0] = 0.0  # where the driven part is joined
    samples["distance"] = np.where(driven, 0, np.abs(wander))
    samples["tunnel_radius"], samples["ball_radius"] = RADIUS - 0.0012 * (x + LENGTH / 2) / LENGTH * PIECES, 0.012
    depth = np.maximum(samples["distance"] + samples["ball_radius"] - samples["tunnel_radius"], 0)
    samples["penetration"] = np.where(share > 0, depth, 0)
    samples["f_user_world"][:, 1] = -np.sign(wander) * 1200 * samples["penetration"]
    samples["f_virt_world"] = samples["f_user_world"]
    samples["f_tunnel"][:, 1] = samples["f_user_world"][:, 1]
    samples["f_tunnel"][:, 0] = -np.where(driven, 0, 4 * np.abs(samples["v_world"][:, 0]))
    samples["f_meas"] = 3 * samples["v_world"] + chance.normal(0, 0.25, (count, 3)) * ~driven[:, None]
    samples["progress"], samples["state"], samples["ramp"] = smooth, SafetyState.ACTIVE, 1.0
    samples["state"][tick < 300] = SafetyState.HOMED
    samples["state"][(tick >= 300) & (tick < 500)] = SafetyState.READY
    samples["state"][count - 400 :], samples["cause"][count - 400 :] = SafetyState.E_STOP, TripCause.STOP_KEY
    samples["period_s"], samples["stiffness_limit"] = 1e-3, 3200.0
    samples["margin"] = 3200.0 / np.where(tick < half, 2000.0, 2400.0) - 1.0
    samples["energy"] = 0.5e-3 * np.cumsum(samples["penetration"] > 0) / 1000
    if live:
        samples["lateness_ns"] = chance.lognormal(np.log(14e3), 0.5, count)
        samples["lateness_ns"][chance.integers(min(1000, count // 2), count, 7)] = chance.uniform(0.3e6, 3e6, 7)
        samples["duration_ns"] = chance.normal(5e3, 300, count)
    return samples


def events_of_session(samples: np.ndarray) -> np.ndarray:
    touches = np.flatnonzero(np.diff((samples["penetration"] > 0).astype(int)) == 1) + 1
    events = np.zeros(len(touches) + 2, EVENT)
    for event, i in zip(events, touches, strict=False):
        event["tick"], event["kind"], event["body_b"] = i, EventKind.CONTACT_BEGIN, -1
        event["t_ns"] = i * 1_000_000
        event["position_world"], event["speed"] = samples["hip_world"][i], np.abs(samples["v_world"][i, 1])
        event["force"] = np.abs(samples["f_user_world"][i, 1])
    events[-2:]["tick"] = len(samples) - 400
    events[-2]["kind"], events[-2]["force"] = EventKind.TRIP, TripCause.STOP_KEY
    events[-1]["kind"], events[-1]["force"] = EventKind.STATE, SafetyState.E_STOP
    return events


def write_synthetic_run(folder: Path, seconds: float = 24.0, *, live: bool = True, closed: bool = True) -> Path:
    """Fill an empty folder; with `closed` the manifest is written too."""
    samples = samples_of_session(seconds, live=live)
    state = StateHash()
    stream, columns = SampleStream(folder, state), ColumnFile(folder)
    for first in range(0, len(samples), 50):
        stream.append(samples[first : first + 50], first)
        columns.add(samples[first : first + 50])
    parameters = ParameterStream(folder)
    for sequence in range(1, 5):
        controller = Slot.PERSON if sequence % 2 == 0 else Slot.START
        parameters.append(packed(*scene_block(sequence, (sequence + 1) // 2, controller)))
    log = EventStream(folder, state)
    events = events_of_session(samples)
    log.append_events(events)
    frames = [{"frame": k, "tick": round(k * 1000 / 60), "t_ns": 0} for k in range(round(seconds * 60))]
    log.append_lines([encode_line("app", "frame", frame) for frame in frames])
    contacts = events[events["kind"] == EventKind.CONTACT_BEGIN]
    for event in contacts:
        t_ns = int(event["t_ns"])
        sound = {"sound": "tap", "tick": int(event["tick"]), "t_ns": t_ns, "sample": t_ns * 48 // 10**6 + 480}
        log.append_lines([encode_line("app", "sound", sound | {"latency_ms": 10.0})])
    status = {"device": "loopback", "sink": "file", "hrtf": True, "rate": 48000, "latency_ms": 10.0}
    log.append_lines([encode_line("app", "audio", status), encode_line("app", "scheduler", {"recipe": "fifo"})])
    trials = TrialTable(folder / "trials.csv")
    for trial, outcome in enumerate(("finished", "aborted")[: 2 if closed else 1]):
        row = {
            "trial": trial, "attempt": 1, "block": "main", "label": "wavy <1>", "practice": trial == 0,
            "outcome": outcome, "cause": "", "begin_ns": 0, "end_ns": 1, "time_s": 10.25 + trial,
            "path_error_rms_m": 0.0081, "contacts": len(contacts) // 2, "smoothness": -4.2, "score": 81.25 - 30 * trial,
        }  # fmt: skip
        trials.append(row)
        state.add_trial(row)
    header = {
        "scene": {"name": "wavy_tunnel", "hash": "ab" * 32, "document": {"format": "mimics", "x-note": "</pre><b>"}},
        "names": {"shapes": ["table"]}, "safety": {"late_stop_s": 0.05},
        "seed": 7, "patient": "moderate", "profile": "demo", "device": "simulated_hapticmaster",
        "command": ["mimics", "run", "scenes/wavy_tunnel.json"], "path": [[0.1, 0.2]] * 200,
        "settings": {"safety": {"force_limit": 40.0, "ramp_time": 1.0}, "tunnel": {"stiffness": 1200.0}},
        "plan": {
            "profile": "demo",
            "parts": [
                {"part": "tunnel", "group": "tunnel projection", "method": "newton", "cost_us": 0.31,
                 "error": 2.1e-12, "unit": "m", "tolerance": 1e-6},
            ],
            "left_out": [{"part": "skinning", "why": "no skin in the scene", "saved_us": 85.0}],
        },
    }  # fmt: skip
    session = {"format": "mimics run", "version": 1, **describe_environment(), "clock": clock_pair(), **header}
    (folder / "session.json").write_text(json.dumps(session))
    for file in (stream, columns, parameters, log, trials) if closed else ():
        file.close()
    if closed:
        summary = {
            "recipe": "fifo",
            "task": {"completed": 1, "trials": 2, "score": 66.2, "time_s": 10.75, "path_error_m": 0.0081},
        }
        counts = {"rows": len(samples), "events": len(events), "trials": 2, "parameters": 4}
        sealed = Manifest("clean", state.hexdigest(), **counts, summary=summary, files=hash_files(folder))
        write_manifest(folder, sealed)
    return folder
