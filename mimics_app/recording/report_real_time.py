"""Real time in the report: lateness of the ticks and the control cycles that ended late."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.plotting.plot import Plot
from mimics_app.recording.report_figures import draw_lateness
from mimics_app.recording.report_tables import Table
from mimics_app.recording.report_values import thousands
from mimics_app.recording.run import Run

__all__ = ["Punctuality", "RealTime", "late_card", "punctuality", "real_time_of"]

_WARM_UP_TICKS = 1000
"""Ticks that are left out: in the first second caches are cold and the other processes start."""
_MARKS = {"p50": 50.0, "p99": 99.0, "p99.9": 99.9, "max": 100.0}


@dataclass(frozen=True, slots=True)
class Punctuality:
    """Lateness of the ticks from the recorded rows after the first second [us].

    Attributes:
        marks: Percentiles and maximum of the lateness [us], by their captions: "p50", "p99", "p99.9", "max".
        missed: Number of ticks that ended more than 1 ms after their release.
        ticks: Number of ticks evaluated.
    """

    marks: dict[str, float]
    missed: int
    ticks: int


def punctuality(samples: NDArray[Any]) -> Punctuality | None:
    """Return the punctuality of a live run; None without any lateness, as on a virtual clock."""
    late = samples[_WARM_UP_TICKS:] if len(samples) > 2 * _WARM_UP_TICKS else samples
    lateness = late["lateness_ns"]
    if len(late) == 0 or not (lateness > 0.0).any():
        return None
    marks = {name: float(np.percentile(lateness, share)) * 1e-3 for name, share in _MARKS.items()}
    return Punctuality(marks, int((lateness + late["duration_ns"] > 1e6).sum()), len(late))


@dataclass(frozen=True, slots=True)
class RealTime:
    """Punctuality of the ticks; both None on a virtual clock, where no tick can be late."""

    plot: Plot | None
    table: Table | None


def real_time_of(run: Run) -> RealTime:
    """Return the section of a run that recorded ticks."""
    result = punctuality(run.haptic)
    if result is None:
        return RealTime(None, None)
    scheduler = run.lines_of("app", "scheduler")
    after = _counted_after(result, run)
    recipe = run.summary.get("recipe") or (scheduler[-1].get("recipe") if scheduler else None)
    rows = [
        ("scheduling recipe", recipe),
        *((f"lateness {name} [µs]", number) for name, number in result.marks.items()),
        (f"late control cycles{after} (ended more than 1 ms after their release)", result.missed),
        ("share of late control cycles", result.missed / result.ticks),
        (f"control cycles{after}", result.ticks),
        *_link_rows(run),
    ]
    return RealTime(draw_lateness(run.haptic[_WARM_UP_TICKS:], result.marks), Table(["", "value"], rows))


def _link_rows(run: Run) -> list[tuple[str, float]]:
    """Return the quality of the link to the device; [] without a device, and of a run that was never closed."""
    link = run.summary.get("link")
    if not isinstance(link, dict):
        return []
    captions = {
        "fresh_share": "share of control cycles with new data of the device",
        "worst_gap_ms": "longest gap between data of the device [ms]",
        "jitter_us": "jitter of the device's data (99th percentile of their age less the median) [µs]",
    }
    return [(caption, float(link[name])) for name, caption in captions.items() if name in link]


def late_card(run: Run) -> dict[str, str]:
    """Return the number of late control cycles by its caption; {} on a virtual clock."""
    real_time = punctuality(run.haptic)
    if real_time is None:
        return {}
    of = f"{thousands(real_time.ticks)}{_counted_after(real_time, run)}"
    return {f"late control cycles of {of}": thousands(real_time.missed)}


def _counted_after(result: Punctuality, run: Run) -> str:
    """Return the remark that the first second was left out; "" for runs of up to two seconds."""
    return " after the first second" if result.ticks < len(run.haptic) else ""
