"""Tables of the experiment for studies: a row for each tap with its visual and tactile times, and for each answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Any

from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.avatar_cord.tap_schedule import tap_of_number
from mimics_app.tasks.kinds.kind import ObservationTable

__all__ = ["ANSWERS", "TAPS"]

_Rows = Sequence[Mapping[str, Any]]

_MS = 1e-6
"""Milliseconds of a nanosecond."""
_ANSWER = ("trial", "condition", "item", "scale", "value", "seconds", "t_ns")
_HEADS = [
    phrase("condition"),
    phrase("Taps"),
    phrase("display after its time, mean [ms]"),
    phrase("error of the display, max [ms]"),
    phrase("error of the felt time, max [ms]"),
    phrase("felt after displayed, mean [ms]"),
]


def _taps(events: _Rows) -> list[dict[str, Any]]:
    rows: dict[tuple[int, int], dict[str, Any]] = {}
    for event in events:
        kind = event.get("kind")
        if kind == "tap_seen":
            key = event["trial"], event["tap"]
            seen = {f"seen_{name}": event[name] for name in ("scheduled_ns", "submitted_ns", "display_ns")}
            rows.setdefault(key, {}).update(condition=event["condition"], place=event["place"], **seen)
        elif kind == "tap_felt":
            key = event["trial"], event["tap"]
            scheduled = {"felt_scheduled_ns": event["scheduled_ns"], "offset_ms": event["offset_ms"]}
            rows.setdefault(key, {}).update(condition=event["condition"], felt_at=event["at"], **scheduled)
        elif kind == "tactile" and "number" in event:
            key = tap_of_number(event["number"])
            times = {"felt_commanded_ns": event["commanded_ns"], "felt_ns": event["felt_ns"]}
            rows.setdefault(key, {}).update(times)
    return [{"trial": trial, "tap": tap, **row} for (trial, tap), row in sorted(rows.items())]


def _answers(events: _Rows) -> list[dict[str, Any]]:
    return [{name: event.get(name) for name in _ANSWER} for event in events if event.get("kind") == "answer"]


def _summary_of_taps(rows: _Rows) -> tuple[list[str], list[list[str]]]:
    labels = dict.fromkeys(str(row.get("condition")) for row in rows)
    return _HEADS, [_tap_line(label, [row for row in rows if row.get("condition") == label]) for label in labels]


def _tap_line(label: str, rows: _Rows) -> list[str]:
    seen = [row["seen_display_ns"] - row["seen_scheduled_ns"] for row in rows if "seen_display_ns" in row]
    errors = [abs(row["felt_ns"] - row["felt_scheduled_ns"]) for row in rows if "felt_ns" in row]
    both = [row["felt_ns"] - row["seen_display_ns"] for row in rows if "felt_ns" in row and "seen_display_ns" in row]
    return [
        label,
        str(len(rows)),
        f"{fmean(seen) * _MS:.2f}" if seen else "",
        f"{max(map(abs, seen)) * _MS:.2f}" if seen else "",
        f"{max(errors) * _MS:.3f}" if errors else "",
        f"{fmean(both) * _MS:.1f}" if both else "",
    ]


def _summary_of_answers(_: _Rows) -> tuple[list[str], list[list[str]]]:
    """Return nothing: the means of the scales are measures of the trials."""
    return [], []


TAPS = ObservationTable(
    "taps",
    (
        "trial",
        "condition",
        "tap",
        "place",
        "felt_at",
        "seen_scheduled_ns",
        "seen_submitted_ns",
        "seen_display_ns",
        "felt_scheduled_ns",
        "felt_commanded_ns",
        "felt_ns",
        "offset_ms",
    ),
    _taps,
    _summary_of_taps,
)
ANSWERS = ObservationTable("answers", _ANSWER, _answers, _summary_of_answers)
