"""The report of a run: one HTML file that needs nothing but itself, also of a run that was cut off."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import EventKind
from mimics_app.contracts.trial_counts import count_trials
from mimics_app.recording.attempts import Attempt, find_attempts
from mimics_app.recording.report_carry import carry_cards, carry_facts, draw_carry
from mimics_app.recording.report_figures import draw_lateness, draw_path, draw_states, draw_traces
from mimics_app.recording.report_governor import governor_text
from mimics_app.recording.report_stability import smallest_margin, stability_text
from mimics_app.recording.report_style import STYLE
from mimics_app.recording.report_tables import (
    contact_rows,
    contact_table,
    event_table,
    key_table,
    plan_tables,
    score_table,
    table,
    value,
)
from mimics_app.recording.report_trips import trips_text
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES, write_atomically

__all__ = ["Punctuality", "punctuality", "write_report"]

_OPEN_ATTEMPTS = 3
_WARM_UP_TICKS = 1000
_OWN_KEYS = ("format", "version", "versions", "machine", "clock", "plan")
_TUNNEL_COLOURS = "The path of the robot's top is blue, the bisector of the tunnel red, its walls green."
_CARRY_COLOURS = "The path of the empty hand is blue, that of the hand with the thing in it orange, the mark green."
_HAND_COLOURS = "The path of the robot's top is blue."
_COUNTED = "Figures are over trials that reached their goal or their time; practice is left out where there is other."


@dataclass(frozen=True, slots=True)
class Punctuality:
    """How late ticks began, computed from the recorded rows after the first second [us].

    Attributes:
        p50, p99, p99_9, max: Of the lateness.
        missed: Ticks that ended more than 1 ms after their release.
        ticks: Ticks it was computed of.
    """

    p50: float
    p99: float
    p99_9: float
    max: float
    missed: int
    ticks: int

    def marks(self) -> dict[str, float]:
        """The percentiles by the name people give them."""
        return {"p50": self.p50, "p99": self.p99, "p99.9": self.p99_9, "max": self.max}


def punctuality(samples: NDArray[Any]) -> Punctuality | None:
    """Percentiles and misses of a live run; None where nothing was late at all: a virtual clock."""
    late = samples[_WARM_UP_TICKS:] if len(samples) > 2 * _WARM_UP_TICKS else samples
    lateness = late["lateness_ns"]
    if len(late) == 0 or not (lateness > 0.0).any():
        return None
    p50, p99, p99_9 = (float(v) * 1e-3 for v in np.percentile(lateness, [50.0, 99.0, 99.9]))
    missed = int((lateness + late["duration_ns"] > 1e6).sum())
    return Punctuality(p50, p99, p99_9, float(lateness.max()) * 1e-3, missed, len(late))


def write_report(folder: Path) -> Path:
    """Write report.html into a run folder and return where it is.

    Raises:
        UsageError: It is no run folder.
        PartialDataError: It was written by a version with other columns.
        OSError: The folder cannot be written.
    """
    run = Run.open(folder)
    page = _page(run)
    path = folder / FILES["report"]
    write_atomically(path, page.encode())
    return path


def _page(run: Run) -> str:
    attempts = find_attempts(run)
    title = f"Report of {_scene_name(run)}"
    body = "".join(
        [
            _head(run, title),
            _cards(run, attempts),
            _problems(run),
            _movement(run, attempts),
            _section("Scores", score_table(run.trials) if run.trials else _soft("No trial was finished.")),
            _section("Contacts: touch, picture and sound", contact_table(contact_rows(run))),
            _safety(run),
            _real_time(run),
            _section("Picture", governor_text(run)),
            _settings(run),
            _record(run),
        ]
    )
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head>'
        f"<body><main>{body}</main></body></html>\n"
    )


def _scene_name(run: Run) -> str:
    scene = run.session.get("scene", "a run")
    return str(scene.get("name", "a run") if isinstance(scene, Mapping) else scene).replace("_", " ")


def _section(title: str, content: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{content}</section>" if content else ""


def _soft(text: str) -> str:
    return f'<p class="soft">{escape(text)}</p>'


def _head(run: Run, title: str) -> str:
    tone = {"clean": "good", "open": "bad"}.get(run.status, "warn")
    started = str(run.session.get("clock", {}).get("utc", ""))[:19].replace("T", " ")
    words = [f"{started} UTC" if started else "", f"{_seconds(run):.1f} s", f"seed {run.session.get('seed', '–')}"]
    known = {**_mapping(run.session.get("settings")), **run.session}
    words += [str(known[key]) for key in ("patient", "device", "profile") if known.get(key)]
    line = " · ".join(escape(word) for word in words if word)
    return f'<h1>{escape(title)}<span class="badge {tone}">{run.status}</span></h1><p class="soft">{line}</p>'


def _mapping(item: Any) -> Mapping[str, Any]:
    return item if isinstance(item, Mapping) else {}


def _seconds(run: Run) -> float:
    return float(run.haptic["t"][-1]) if len(run.haptic) else 0.0


def _cards(run: Run, attempts: list[Attempt]) -> str:
    summary = run.manifest.summary if run.manifest else {}
    task = _mapping(summary.get("task"))
    free = [attempt.samples[attempt.free] for attempt in attempts]
    felt = [_largest(rows["f_user_world"]) for rows in free]
    real_time = punctuality(run.haptic)
    carried, tunnel = carry_facts(run) is not None, _has_tunnel(attempts)
    cards = {
        **_trial_cards(run),
        "score": _one(task.get("score")),
        "time": _one(task.get("time_s"), "s"),
        **({name: _card(*figure) for name, figure in carry_cards(task).items()} if carried else {}),
        "off the straight way" if carried else "path error": _one(_scaled(task.get("path_error_m"), 1000.0), "mm"),
        "wall contacts" if tunnel and not carried else "contacts": value(task.get("contacts")),
        "largest force felt": _one(max(felt, default=0.0) or None, "N"),
        "smallest stability margin": _one(_scaled(smallest_margin(run.haptic), 100.0), "%"),
        "ticks missed": _missed(real_time),
        "trips": value(int((run.events["kind"] == EventKind.TRIP).sum())),
    }
    items = "".join(f"<div><b>{text}</b><span>{name}</span></div>" for name, text in cards.items() if text != "–")
    note = _soft(_COUNTED) if task else ""
    return f'<div class="cards">{items}</div>{note}'


def _missed(real_time: Punctuality | None) -> str:
    return "–" if real_time is None else f"{real_time.missed} of {real_time.ticks:,}".replace(",", "\u2009")


def _trial_cards(run: Run) -> dict[str, str]:
    """How many trials were finished, those alone of which some ended."""
    counts = count_trials(run.trials)
    ended = {
        "trials finished": (counts.completed, counts.trials),
        "practice finished": (counts.practice_completed, counts.practice_trials),
    }
    return {name: f"{completed} of {trials}" for name, (completed, trials) in ended.items() if trials}


def _has_tunnel(attempts: list[Attempt]) -> bool:
    return any(attempt.tunnel is not None for attempt in attempts)


def _card(number: Any, unit: str) -> str:
    return _one(number, unit) if unit else value(number)


def _largest(vectors: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)).max()) if len(vectors) else 0.0


def _scaled(number: Any, factor: float) -> float | None:
    return factor * number if isinstance(number, (int, float)) else None


def _one(number: Any, unit: str = "") -> str:
    return f"{number:.1f} {unit}".strip() if isinstance(number, (int, float)) else "–"


def _problems(run: Run) -> str:
    found = run.problems()
    if run.manifest and run.manifest.problem:
        found.append(run.manifest.problem)
    if not found:
        return ""
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in found)
    return f'<div class="note"><b>This recording is not whole.</b><ul>{items}</ul></div>'


def _movement(run: Run, attempts: list[Attempt]) -> str:
    if not attempts:
        return _section("Movement", _soft("No tick was recorded."))
    carry = carry_facts(run)
    title, colours = "Movement of the hand", _HAND_COLOURS
    if carry is not None:
        title, colours = "Carrying", _CARRY_COLOURS
    elif _has_tunnel(attempts):
        title, colours = "Movement through the tunnel", _TUNNEL_COLOURS
    text = _soft(f"Frontal plane seen by the person: lateral to the right, vertical up. {colours}")
    for i, attempt in enumerate(attempts):
        traces = "".join(draw_traces(attempt, carry))
        path = draw_path(attempt, run.events) if carry is None else draw_carry(attempt, carry)
        content = f"{path}<h3>Force and velocity</h3>{traces}"
        opened = " open" if i < _OPEN_ATTEMPTS else ""
        text += f"<details{opened}><summary>{escape(attempt.title)}</summary>{content}</details>"
    return _section(title, text)


def _safety(run: Run) -> str:
    if len(run.haptic) == 0:
        return ""
    trips = int((run.events["kind"] == EventKind.TRIP).sum())
    words = f"{trips} trip{'' if trips == 1 else 's'}." if trips else "No trip."
    text = f"{_soft(words)}{draw_states(run.haptic)}{event_table(run.events)}{trips_text(run)}{stability_text(run)}"
    return _section("Safety", text)


def _real_time(run: Run) -> str:
    if len(run.haptic) == 0:
        return ""
    result = punctuality(run.haptic)
    if result is None:
        return _section("Real time", _soft("The run went on a virtual clock: no tick can be late."))
    summary = run.manifest.summary if run.manifest else {}
    scheduler = run.lines_of("app", "scheduler")
    recipe = summary.get("recipe") or (scheduler[-1].get("recipe") if scheduler else None)
    rows = [
        ("scheduling recipe", recipe),
        *((f"lateness {name} [µs]", number) for name, number in result.marks().items()),
        ("ticks that ended more than 1 ms late", result.missed),
        ("share of all ticks", result.missed / result.ticks),
        ("ticks after the first second", result.ticks),
    ]
    text = draw_lateness(run.haptic[_WARM_UP_TICKS:], result.marks()) + table(["", "value"], rows)
    return _section("Real time", text)


def _settings(run: Run) -> str:
    own = {key: item for key, item in run.session.items() if key not in _OWN_KEYS}
    document = _mapping(own.get("scene")).get("document")
    if document is not None:
        own["scene"] = {key: item for key, item in own["scene"].items() if key != "document"}
    text = key_table(own) if own else ""
    if document is not None:
        listing = escape(json.dumps(document, indent=1, ensure_ascii=False))
        text += f"<details><summary>The whole scene</summary><pre>{listing}</pre></details>"
    plan = run.session.get("plan")
    if isinstance(plan, Mapping) and (methods := plan_tables(plan)):
        text += f"<h3>Methods</h3>{methods}"
    for title, kind in (("Sound", "audio"), ("Picture as it was opened", "quality")):
        for line in run.lines_of("app", kind)[-1:]:
            told = {key: item for key, item in line.items() if key not in ("source", "kind")}
            text += f"<h3>{title}</h3>{key_table(told)}"
    actions = run.lines_of("app", "action")
    if actions:
        text += f"<h3>Adaptations</h3>{_lines_table(actions)}"
    return _section("Settings", text)


def _lines_table(lines: list[dict[str, Any]]) -> str:
    names = [n for n in dict.fromkeys(n for line in lines for n in line) if n not in ("source", "kind")]
    return table(names, [[line.get(name) for name in names] for line in lines])


def _record(run: Run) -> str:
    made: dict[str, Any] = {key: run.session[key] for key in ("machine", "versions") if key in run.session}
    text = key_table(made) if made else ""
    if run.manifest:
        rows = [(name, sealed["bytes"], sealed["sha256"]) for name, sealed in run.manifest.files.items()]
        text += "<h3>Files</h3>" + table(["file", "bytes", "SHA-256"], rows, "keys")
        text += f"<p>State hash <code>{escape(run.manifest.state_hash)}</code></p>"
    text += _soft(
        "Research software: an independent hardware stop and limits in the device are required; "
        "the software stop is no safety function."
    )
    return _section("Environment and record", text)
