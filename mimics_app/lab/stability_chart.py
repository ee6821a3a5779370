"""Chart of a stability experiment: simulated points, the exact boundary, and simplified rules beside it."""

from __future__ import annotations

from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.experiment import Experiment, Outcome, Points, Row
from mimics_app.lab.figure import Figure
from mimics_app.lab.panel import Panel
from mimics_app.plotting.axis import Axis, format_number
from mimics_app.plotting.drawing import SERIES, document, legend, text_width, wrapped

__all__ = ["draw_outcome"]

_WIDTH = 1000.0
_PANEL = 400.0
_HEAD = 56.0
_LINE = 22.0
_RULES = ("dashed", "dotted")


def draw_outcome(experiment: Experiment, outcome: Outcome, points: int) -> Figure:
    """Return the figure of an outcome on a grid of `points` points along each axis."""
    machine = str(describe_machine())
    command = f"mimics lab stability {experiment.name} --points {points}"
    return Figure(
        kind="stability",
        name=experiment.name,
        command=command,
        machine=machine,
        rows=_rows(outcome),
        boundary={
            "simulated": outcome.simulated,
            "exact": outcome.exact,
            "rule": outcome.rules,
            "disagreement": outcome.disagreement,
        },
        svg=_draw(experiment, outcome, f"{command}   on   {machine}"),
        more={
            "title": experiment.title,
            "claim": experiment.claim,
            "decided_by": experiment.kind,
            "x_label": experiment.x_label,
            "y_label": experiment.y_label,
            "tolerance": experiment.tolerance,
            "passed": outcome.passed,
            "note": outcome.note,
            "table": outcome.rows,
        },
    )


def _rows(outcome: Outcome) -> list[Row]:
    """Return a row for each point; its error is the relative difference from the exact point at the same x."""
    exact = {x: y for x, y in outcome.exact} if len({x for x, _ in outcome.exact}) == len(outcome.exact) else {}
    rows = []
    for method, points in (("simulated", outcome.simulated), ("exact", outcome.exact), *outcome.rules.items()):
        for x, y in points:
            known = exact.get(x)
            error = abs(y - known) / abs(known) if known else None
            rows.append({"method": method, "x": x, "y": y, "cost_ns": None, "error": error, "valid": True})
    return rows


def _draw(experiment: Experiment, outcome: Outcome, foot: str) -> str:
    series = [outcome.simulated, outcome.exact, *outcome.rules.values()]
    x = Axis.around(experiment.x_label, [p[0] for s in series for p in s], log=experiment.log_x)
    y = Axis.around(experiment.y_label, [p[1] for s in series for p in s], log=experiment.log_y)
    entries = _entries(experiment, outcome)
    legends = _legend_rows(entries)
    top = _HEAD + _LINE * (len(legends) - 1)
    panel = Panel(6.0, top, _WIDTH - 20.0, _PANEL, x, y)
    for i, (name, points) in enumerate(outcome.rules.items()):
        for part in _runs(points):
            panel.line(part, _rule_kind(i), name)
    for part in _runs(outcome.exact):
        panel.line(part, "line s0", "exact")
    for x_, y_ in outcome.simulated:
        hover = f"simulated: {format_number(x_)}, {format_number(y_)}"
        panel.dot(x_, y_, "open s1", hover, 4.0)
    words = [*wrapped(outcome.note), _verdict(experiment, outcome), foot]
    height = top + _PANEL + 15.0 * len(words) + 12.0
    parts = [*(legend(20.0, 46.0 + _LINE * i, row) for i, row in enumerate(legends)), panel.svg()]
    return document(_WIDTH, height, f"{experiment.name}: {experiment.title}", parts, words)


def _rule_kind(i: int) -> str:
    return f"line s{(i + 2) % SERIES} {_RULES[i // SERIES % 2]}"


def _verdict(experiment: Experiment, outcome: Outcome) -> str:
    found = "within" if outcome.passed else "OUTSIDE"
    if experiment.kind == "boundary":
        said = f"simulation against exact boundary: {100.0 * outcome.disagreement:.3g} % apart at most"
        return f"{said}, {found} the {100.0 * experiment.tolerance:.3g} % allowed"
    error, allowed = format_number(outcome.disagreement), format_number(experiment.tolerance)
    return f"error of the invariant: {error}, {found} the {allowed} allowed"


def _entries(experiment: Experiment, outcome: Outcome) -> list[tuple[str, str, str]]:
    exact = "exact: eigenvalues or closed form"
    entries = [("dot", "open s1", "simulated with the loop's functions")] if outcome.simulated else []
    entries += [("line", "line s0", exact)] if outcome.exact else []
    return entries + [("line", _rule_kind(i), name) for i, name in enumerate(outcome.rules)]


def _legend_rows(entries: list[tuple[str, str, str]]) -> list[list[tuple[str, str, str]]]:
    """Return the legend in rows that fit the drawing."""
    rows: list[list[tuple[str, str, str]]] = [[]]
    used = 0.0
    for entry in entries:
        width = 54.0 + 0.92 * text_width(entry[2])
        if rows[-1] and used + width > _WIDTH - 40.0:
            rows.append([])
            used = 0.0
        rows[-1].append(entry)
        used += width
    return rows


def _runs(points: Points) -> list[Points]:
    """Return a list of points as curves, which follow one another or alternate at every x."""
    runs: list[Points] = []
    for point in points:
        if not runs or point[0] < runs[-1][-1][0]:
            runs.append([])
        runs[-1].append(point)
    return [curve for run in runs for curve in _unravelled(run)]


def _unravelled(run: Points) -> list[Points]:
    """Return points of ascending x as curves where there are equally many at every x, else as one curve."""
    by_x: dict[float, Points] = {}
    for point in run:
        by_x.setdefault(point[0], []).append(point)
    counts = {len(group) for group in by_x.values()}
    if len(by_x) < 2 or len(counts) > 1:
        return [run]
    return [list(curve) for curve in zip(*by_x.values(), strict=True)]
