"""The plots of a report: path of every attempt, traces over time, lateness, safety states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.messages.report_section import Marks, ReportSection, Traces, Word, frontal
from mimics_app.contracts.system.phrases import phrase
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.attempts import Attempt
from mimics_app.recording.columns import row_norms, whole
from mimics_app.recording.report_stability import stability_lines

__all__ = ["draw_lateness", "draw_path", "draw_states", "draw_traces"]


_MM = 1000.0
_AT_REST = 0.002
"""Extent of the path of a hand at rest [m]: sensor noise enlarged to the width of the page is no movement."""
_LEAST_LATENESS_US = 0.1  # left end of the axis of lateness [us]
_MISS_US = 1000.0  # lateness from which a tick is missed [us]
_AROUND_ROWS = 1000  # rows before and after the movement that are drawn, too


def draw_path(section: ReportSection, attempt: Attempt, facts: Mapping[str, Any], events: NDArray[Any]) -> Plot | None:
    """Plot the path of the hand in the frontal plane (world x, lateral, and y, vertical; equal axes).

    Without marks of the section, the beginnings of contacts are marked. None where the hand rested and nothing is
    behind its path.
    """
    behind = section.behind(attempt, facts)
    path = frontal(attempt)
    free = path[attempt.free] if attempt.free.any() else path
    if not behind and _rests(free):
        return None
    x = Axis.of(phrase("lateral [mm]"), *(_MM * points[:, 0] for points in (free, *(curve.points for curve in behind))))
    heights = (_MM * points[:, 1] for points in (free, *(curve.points for curve in behind)))
    y = Axis.of(phrase("vertical [mm]"), *heights, zero=section.from_floor)
    plot = Plot.equal(x, y, phrase("Path of the hand in the frontal plane, {attempt}", attempt=attempt.title))
    for curve in (*behind, *section.hand(attempt, facts)):
        plot.line(_MM * curve.points[:, 0], _MM * curve.points[:, 1], curve.style, curve.label)
    for word in section.words(attempt, facts):
        _write_beside(plot, word)
    marks = section.marks(attempt, facts) or [_contact_marks(section, attempt, events)]
    for mark in marks:
        if len(mark.points):
            plot.points(_MM * mark.points[:, 0], _MM * mark.points[:, 1], mark.style, mark.label, list(mark.hovers))
    return plot


def _rests(path: F8) -> bool:
    seen = path[np.isfinite(path).all(axis=1)]
    return not len(seen) or bool((np.ptp(seen, axis=0) < _AT_REST).all())


def _write_beside(plot: Plot, word: Word) -> None:
    gap = 0.008 * (plot.x.high - plot.x.low)
    outward = word.outward / max(float(np.hypot(*word.outward)), 1e-12)
    x, y = _MM * word.place + gap * outward
    anchor = "middle" if abs(outward[0]) < 0.3 else "end" if outward[0] < 0.0 else "start"
    plot.word(float(x), float(y) - 0.5 * gap, word.text, anchor)


def _contact_marks(section: ReportSection, attempt: Attempt, events: NDArray[Any]) -> Marks:
    mine = _contacts_of(attempt, events)
    hovers = [phrase("tick {tick:d}, {force:.1f} N", tick=int(e["tick"]), force=float(e["force"])) for e in mine]
    return Marks(mine["position_world"][:, :2].astype(np.float64), section.contact, hovers)


def _contacts_of(attempt: Attempt, events: NDArray[Any]) -> NDArray[Any]:
    ticks = attempt.samples["tick"]
    within = (events["tick"] >= ticks[0]) & (events["tick"] <= ticks[-1])
    return events[within & (events["kind"] == EventKind.CONTACT_BEGIN)]


def draw_traces(section: ReportSection, attempt: Attempt, facts: Mapping[str, Any]) -> list[Plot]:
    """Plot force, velocity, traces of the section, and stability over time; thinning preserves peaks."""
    samples = attempt.samples
    if len(samples) < 2:
        return []
    force = {
        "measured": (phrase("force of the person on the handle"), row_norms(samples["f_meas"])),
        "rendered": (phrase("virtual force on the person"), row_norms(samples["f_user_world"])),
    }
    speed = {"robot": (phrase("speed of the robot"), row_norms(samples["v_world"]))}
    touching = section.touching
    return [
        _trace_plot(attempt, phrase("force [N]"), force, touching),
        *_free_plots(attempt, section.traces(attempt, facts), touching),
        _trace_plot(attempt, phrase("velocity [m/s]"), speed, touching),
        *_free_plots(attempt, stability_lines(attempt), touching),
    ]


def _free_plots(attempt: Attempt, traces: Traces, touching: str) -> list[Plot]:
    return [_trace_plot(attempt, label, lines, touching, only_free=True) for label, lines in traces.items()]


def _trace_plot(
    attempt: Attempt, label: str, lines: Mapping[str, tuple[str, F8]], touching: str, *, only_free: bool = False
) -> Plot:
    """Plot traces around the time the person moved; `only_free` leaves out the time in which the robot was driven."""
    near = _near_free(attempt)
    t, free = attempt.samples["t"][near], attempt.free[near]
    parts = _runs(free) if only_free and free.any() else [slice(0, len(t))]
    drawn = [
        (kind, name if i == 0 else "", *envelope(t[part], values[near][part]))
        for kind, (name, values) in lines.items()
        for i, part in enumerate(parts)
    ]
    x = Axis.of(phrase("time [s]"), t, margin=0.0)
    y = Axis.of(label, *[values for *_, values in drawn], zero=True)
    plot = Plot(x, y, phrase("{what} over time, {attempt}", what=label, attempt=attempt.title), height=170.0)
    plot.spans(*_stretches(t, ~free), "driven", phrase("driven by the robot"))
    touch = free & ((attempt.samples["penetration"][near] > 0.0) | (attempt.samples["touching"][near] > 0.0))
    plot.spans(*_stretches(t, touch), "touch", touching)
    for kind, name, when, values in drawn:
        plot.line(when, values, kind, name)
    return plot


def _near_free(attempt: Attempt) -> slice:
    """Return the rows from a second before the person moves the robot to a second after; all without movement."""
    moves = np.flatnonzero(attempt.free)
    if len(moves) == 0:
        return slice(0, len(attempt.free))
    return slice(max(int(moves[0]) - _AROUND_ROWS, 0), int(moves[-1]) + _AROUND_ROWS)


def _runs(inside: NDArray[np.bool_]) -> list[slice]:
    edges = np.diff(np.concatenate([[0], inside.astype(np.int8), [0]]))
    pairs = zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True)
    return [slice(start, end) for start, end in pairs]


def _stretches(t: F8, inside: NDArray[np.bool_]) -> tuple[F8, F8]:
    """Return begin and end of each interval where `inside` holds."""
    runs = _runs(inside)
    return t[[run.start for run in runs]], t[[run.stop - 1 for run in runs]]


def draw_lateness(samples: NDArray[Any], marks: dict[str, float]) -> Plot | None:
    """Plot the histogram of the lateness on a logarithmic axis, with percentiles [us]; None on a virtual clock."""
    lateness = samples["lateness_ns"] * 1e-3
    lateness = lateness[np.isfinite(lateness)]
    if not (lateness > 0.0).any():
        return None
    low = _LEAST_LATENESS_US
    high = 10.0 ** np.ceil(np.log10(max(float(lateness.max()), 1.2 * _MISS_US)))
    edges = np.logspace(np.log10(low), np.log10(high), 10 * round(np.log10(high / low)) + 1)
    counts = np.histogram(np.clip(lateness, low, None), edges)[0].astype(np.float64)
    most = 10.0 ** np.ceil(np.log10(counts.max() + 1.0))
    x = Axis("lateness of a tick [µs]", low, high, log=True)
    plot = Plot(x, Axis("ticks", 0.5, most, log=True), "Histogram of lateness", height=260.0)
    plot.bars(edges, counts, "count", "ticks")
    for row, (name, value) in enumerate(marks.items()):
        plot.mark_x(float(np.clip(value, low, high)), f"{name} {value:.0f} µs", row)
    plot.mark_x(_MISS_US, "1 ms", len(marks))
    return plot


def draw_states(samples: NDArray[Any]) -> Plot:
    """Plot the states of the safety machine over the whole run."""
    t, state = samples["t"], whole(samples["state"])
    x = Axis.of(phrase("time [s]"), t, margin=0.0)
    plot = Plot(x, Axis("", 0.0, 1.0), phrase("Safety states over time"), height=110.0)
    for value in sorted(set(state.tolist())):
        name = _state_name(value)
        plot.spans(*_stretches_joined(t, state == value), f"state-{name.lower()}", name)
    return plot


def _stretches_joined(t: F8, inside: NDArray[np.bool_]) -> tuple[F8, F8]:
    """Return intervals as `_stretches`, each extended to the next tick, so that neighbours touch."""
    starts, ends = _stretches(t, inside)
    following = t[np.minimum(np.searchsorted(t, ends, side="right"), len(t) - 1)]
    return starts, following


def _state_name(value: int) -> str:
    try:
        return SafetyState(value).name
    except ValueError:
        return str(value)
