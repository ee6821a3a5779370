"""The drawings of a report: Figure 48 of D2.1 for every attempt, traces over time, lateness, safety states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import EventKind, SafetyState
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.attempts import Attempt, TunnelShape
from mimics_app.recording.columns import whole
from mimics_app.recording.report_carry import carry_lines
from mimics_app.recording.report_stability import stability_lines

__all__ = ["draw_lateness", "draw_path", "draw_states", "draw_traces"]

Values = NDArray[np.float64]

_LEAST_LATENESS_US = 0.1
_MISS_US = 1000.0
_AROUND_ROWS = 1000


def draw_path(attempt: Attempt, events: NDArray[Any]) -> Plot:
    """Figure 48 of D2.1: path of the robot blue, bisector red, walls green, in the frontal plane, equal axes.

    The frontal plane is that of the world's x (lateral) and y (vertical).
    """
    path = 1000.0 * attempt.samples["hip_world"][:, :2]
    walls = [] if attempt.tunnel is None else [1000.0 * side for side in _walls(attempt.tunnel)]
    free = path[attempt.free] if attempt.free.any() else path
    x = Axis.of("lateral [mm]", free[:, 0], *[side[:, 0] for side in walls])
    y = Axis.of("vertical [mm]", free[:, 1], *[side[:, 1] for side in walls])
    plot = Plot.equal(x, y, f"Path of the robot in the frontal plane, {attempt.title}")
    if attempt.tunnel is not None:
        for i, side in enumerate(walls):
            plot.line(side[:, 0], side[:, 1], "wall", "" if i else "walls of the tunnel")
        bisector = 1000.0 * attempt.tunnel.bisector_world
        plot.line(bisector[:, 0], bisector[:, 1], "bisector", "bisector of the tunnel")
        _name_ends(plot, bisector[:, :2])
    moved = np.where(attempt.free[:, None], path, np.nan)
    plot.line(moved[:, 0], moved[:, 1], "robot", "path of the robot")
    _mark_contacts(plot, attempt, events)
    return plot


def _name_ends(plot: Plot, bisector: Values) -> None:
    """Write "start" and "goal" before the tunnel's mouths, where neither wall nor path runs."""
    gap = 0.008 * (plot.x.high - plot.x.low)
    for name, end, inner in (("start", 0, 1), ("goal", -1, -2)):
        outward = bisector[end] - bisector[inner]
        outward = outward / max(float(np.hypot(*outward)), 1e-12)
        x, y = bisector[end] + gap * outward
        anchor = "middle" if abs(outward[0]) < 0.3 else "end" if outward[0] < 0.0 else "start"
        plot.word(float(x), float(y) - 0.5 * gap, name, anchor)


def _walls(tunnel: TunnelShape) -> list[Values]:
    """Outline of a tube in the frontal plane: the bisector moved by its radius to both sides of its projection."""
    centre = tunnel.bisector_world[:, :2]
    along = np.gradient(centre, axis=0)
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)[:, None]
    side = np.column_stack([-along[:, 1], along[:, 0]]) / length * tunnel.radius[:, None]
    return [centre + side, centre - side]


def _mark_contacts(plot: Plot, attempt: Attempt, events: NDArray[Any]) -> None:
    mine = _contacts_of(attempt, events)
    if len(mine):
        where = 1000.0 * mine["position_world"].astype(np.float64)
        hovers = [f"tick {e['tick']}, {e['force']:.1f} N" for e in mine]
        what = "contact begins" if attempt.tunnel is None else "wall contact begins"
        plot.points(where[:, 0], where[:, 1], "contact", what, hovers)


def _contacts_of(attempt: Attempt, events: NDArray[Any]) -> NDArray[Any]:
    ticks = attempt.samples["tick"]
    within = (events["tick"] >= ticks[0]) & (events["tick"] <= ticks[-1])
    return events[within & (events["kind"] == EventKind.CONTACT_BEGIN)]


def draw_traces(attempt: Attempt, carry: Mapping[str, Any] | None = None) -> list[Plot]:
    """Force, velocity, distance and stability over time; peaks are kept however long the attempt is.

    Args:
        attempt: Whose.
        carry: What the scenario told of the carrying (`report_carry.carry_facts`); None: nothing was carried.
    """
    samples = attempt.samples
    if len(samples) < 2:
        return []
    force = {
        "measured": ("force of the person on the handle", _norm(samples["f_meas"])),
        "felt": ("virtual force on the person", _norm(samples["f_user_world"])),
    }
    own: list[Plot] = []
    if carry is not None:
        own = _carry_traces(attempt, carry)
    elif attempt.tunnel is not None:
        own = _tunnel_traces(attempt)
    return [
        _trace_plot(attempt, "force [N]", force),
        *own,
        _trace_plot(attempt, "velocity [m/s]", {"robot": ("speed of the robot", _norm(samples["v_world"]))}),
        *(_trace_plot(attempt, label, lines, only_free=True) for label, lines in stability_lines(attempt).items()),
    ]


def _carry_traces(attempt: Attempt, carry: Mapping[str, Any]) -> list[Plot]:
    return [_trace_plot(attempt, label, lines, only_free=True) for label, lines in carry_lines(attempt, carry).items()]


def _tunnel_traces(attempt: Attempt) -> list[Plot]:
    samples = attempt.samples
    return [
        _trace_plot(
            attempt,
            "tunnel force [N]",
            {
                "tangent": ("along the tunnel (t)", samples["f_tunnel"][:, 0]),
                "normal": ("normal (n)", samples["f_tunnel"][:, 1]),
                "binormal": ("binormal (b)", samples["f_tunnel"][:, 2]),
            },
            only_free=True,
        ),
        _trace_plot(
            attempt,
            "from bisector [mm]",
            {
                "robot": ("distance of the ball from the bisector", 1000.0 * samples["distance"]),
                "wall": (
                    "where the ball meets the wall",
                    1000.0 * np.maximum(samples["tunnel_radius"] - samples["ball_radius"], 0.0),
                ),
            },
            only_free=True,
        ),
    ]


def _trace_plot(attempt: Attempt, label: str, lines: dict[str, tuple[str, Values]], *, only_free: bool = False) -> Plot:
    """Traces around the time the person moved; `only_free` leaves out what means nothing while the robot drives."""
    near = _near_free(attempt)
    t, free = attempt.samples["t"][near], attempt.free[near]
    parts = _runs(free) if only_free and free.any() else [slice(0, len(t))]
    drawn = [
        (kind, name if i == 0 else "", *envelope(t[part], values[near][part]))
        for kind, (name, values) in lines.items()
        for i, part in enumerate(parts)
    ]
    x = Axis.of("time [s]", t, margin=0.0)
    y = Axis.of(label, *[values for *_, values in drawn], zero=True)
    plot = Plot(x, y, f"{label} over time, {attempt.title}", height=170.0)
    plot.spans(*_stretches(t, ~free), "driven", "driven by the robot")
    touch = free & ((attempt.samples["penetration"][near] > 0.0) | (attempt.samples["touching"][near] > 0.0))
    plot.spans(*_stretches(t, touch), "touch", "ball in the wall" if attempt.tunnel is not None else "touching")
    for kind, name, when, values in drawn:
        plot.line(when, values, kind, name)
    return plot


def _near_free(attempt: Attempt) -> slice:
    """Rows from a second before the person moves the robot to a second after; all where that never happens."""
    moves = np.flatnonzero(attempt.free)
    if len(moves) == 0:
        return slice(0, len(attempt.free))
    return slice(max(int(moves[0]) - _AROUND_ROWS, 0), int(moves[-1]) + _AROUND_ROWS)


def _runs(inside: NDArray[np.bool_]) -> list[slice]:
    edges = np.diff(np.concatenate([[0], inside.astype(np.int8), [0]]))
    pairs = zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True)
    return [slice(start, end) for start, end in pairs]


def _norm(vectors: Values) -> Values:
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))


def _stretches(t: Values, inside: NDArray[np.bool_]) -> tuple[Values, Values]:
    """Begin and end of each stretch where `inside` holds."""
    runs = _runs(inside)
    return t[[run.start for run in runs]], t[[run.stop - 1 for run in runs]]


def draw_lateness(samples: NDArray[Any], marks: dict[str, float]) -> Plot | None:
    """Histogram of how late ticks began, on a logarithmic axis, with percentiles [us]; None on a virtual clock."""
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
    """States of the safety machine over the whole run."""
    t, state = samples["t"], whole(samples["state"])
    x = Axis.of("time [s]", t, margin=0.0)
    plot = Plot(x, Axis("", 0.0, 1.0), "Safety states over time", height=110.0)
    for value in sorted(set(state.tolist())):
        name = _state_name(value)
        plot.spans(*_stretches_joined(t, state == value), f"state-{name.lower()}", name)
    return plot


def _stretches_joined(t: Values, inside: NDArray[np.bool_]) -> tuple[Values, Values]:
    """Like `_stretches`, each drawn up to the tick after it, so that neighbours touch."""
    starts, ends = _stretches(t, inside)
    following = t[np.minimum(np.searchsorted(t, ends, side="right"), len(t) - 1)]
    return starts, following


def _state_name(value: int) -> str:
    try:
        return SafetyState(value).name
    except ValueError:
        return str(value)
