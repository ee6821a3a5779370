"""Chart of a group of methods: cost against error with the Pareto front, and cost against the size of the work."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from markupsafe import Markup

from mimics_app.lab.figure import Figure
from mimics_app.lab.measure import Measured, MeasuredGroup
from mimics_app.lab.measured_on import measured_on
from mimics_app.lab.panel import Label, Panel
from mimics_app.plotting.axis import Axis, format_number
from mimics_app.plotting.drawing import SERIES, document, legend, wrapped
from mimics_app.plotting.marks import word

__all__ = ["draw_chart", "pareto_front"]

_WIDTH = 1000.0
_PANELS = 370.0
_HEAD = 66.0
_FOOT = 14.0
_FOOT_LINE = 15.0
_CROWDED = 480.0
_BESIDE = 9
"""Largest number of methods with the growth beside, not below."""
_NAMED = 20
"""Largest number of methods whose points carry their names; beyond, they carry numbers, with a list beside."""
_KEY = 340.0
"""Width of that list [px]."""

_LIST_LINE = 16.0
_RING = 9.0
"""Radius of the ring around the point of the default [px]."""

_LEAST_ERROR = 1e-17
"""Smaller errors, 0 among them, are drawn at the lower end of their axis."""


def draw_chart(measured: MeasuredGroup) -> Figure:
    """Return the figure of a measured group."""
    rows = measured.rows
    chosen_from = [row for row in rows if row.method.runnable]
    front = [chosen_from[i].method.name for i in pareto_front([(row.cost_us, row.error) for row in chosen_from])]
    machine = str(measured_on())
    name = measured.group.name
    command = f'mimics lab chart "{name}"'
    return Figure(
        kind="chart",
        name=name,
        command=command,
        machine=machine,
        rows=[_row(row) for row in rows],
        front=front,
        default=measured.default,
        svg=_draw(measured, front, f"{command}   on   {machine}"),
        more={
            "what": measured.group.what,
            "unit": measured.group.unit,
            "work": measured.group.work,
            "reference_ns": measured.reference_us * 1e3,
            "growth": [_growth(row) for row in rows if row.growth],
            "methods": [
                {"method": r.method.name, "source": r.method.source, "valid_range": r.method.valid_range} for r in rows
            ],
            "skipped": measured.skipped,
            "few": measured.group.few,
            "why_default": measured.group.why_default,
        },
    )


def _row(row: Measured) -> dict[str, object]:
    return {
        "method": row.method.name,
        "x": row.ratio,
        "cost_ns": row.cost_us * 1e3,
        "spread_ns": [cost * 1e3 for cost in row.spread_us] if row.spread_us[1] else None,
        "error": row.error if math.isfinite(row.error) else None,
        "valid": math.isfinite(row.error),
    }


def _growth(row: Measured) -> dict[str, object]:
    assert row.growth is not None
    return {
        "method": row.method.name,
        "sizes": list(row.growth.sizes),
        "cost_ns": [cost * 1e3 for cost in row.growth.cost_us],
        "exponent": row.growth.exponent,
    }


def _draw(measured: MeasuredGroup, front: list[str], foot: str) -> str:
    grows = any(row.growth for row in measured.rows)
    crowded = len(measured.rows) > _BESIDE
    high = _CROWDED if crowded else _PANELS
    numbered = len(measured.rows) > _NAMED
    wide = 0.56 * _WIDTH if grows and not crowded else _WIDTH - 20.0 - _KEY * numbered
    panels = [_error_panel(measured, front, wide, high, numbered=numbered)]
    if grows and crowded:
        panels.append(_growth_panel(measured, 6.0, _HEAD + high + 6.0, _WIDTH - 20.0))
        high += 6.0 + _PANELS
    elif grows:
        panels.append(_growth_panel(measured, 0.56 * _WIDTH + 6.0, _HEAD, 0.44 * _WIDTH - 20.0))
    parts = [legend(20.0, 48.0, _entries(measured)), *(panel.svg() for panel in panels)]
    parts += _key(measured, wide + 14.0, _HEAD + 20.0) if numbered else []
    title = f"{measured.group.name}: cost against error"
    words = [*wrapped("; ".join(filter(None, (measured.group.what, measured.group.few)))), foot]
    return document(_WIDTH, _HEAD + high + _FOOT + _FOOT_LINE * len(words), title, parts, words)


def _key(measured: MeasuredGroup, left: float, top: float) -> list[Markup]:
    """Return the list of the methods with the numbers of their points."""
    lines = [(top + _LIST_LINE * i, str(i + 1), name) for i, name in enumerate(_names(measured))]
    numbers = [word(left + 16.0, y, number, "name strong", "end") for y, number, _ in lines]
    return numbers + [word(left + 24.0, y, name, "name", "start") for y, _, name in lines]


def _names(measured: MeasuredGroup) -> list[str]:
    """Return the names of the methods, with a remark where one fails or, unlike others, has no error."""
    differ = any(row.error for row in measured.rows)
    remarks = {row.method.name: " (error 0)" if differ and row.error < _LEAST_ERROR else "" for row in measured.rows}
    failed = {row.method.name: " (fails)" for row in measured.rows if row.error == math.inf}
    return [name + remark for name, remark in (remarks | failed).items()]


def _entries(measured: MeasuredGroup) -> list[tuple[str, str, str]]:
    """Return the entries of the legend."""
    entries = [
        ("dot", "dot", "on the Pareto front"),
        ("dot", "open", "dominated: another is cheaper and as accurate"),
        ("ring", "dot", "default"),
    ]
    if any(not row.method.runnable for row in measured.rows):
        entries.append(("dot", "open yardstick", "yardstick, not part of the product"))
    if any(not math.isfinite(row.error) for row in measured.rows):
        entries.append(("cross", "cross", "fails"))
    return entries


@dataclass(frozen=True, slots=True)
class _Unit:
    """A unit of costs, and its length [ns]."""

    name: str
    ns: float

    def of(self, cost_us: float) -> float:
        """Return a cost in this unit."""
        return cost_us * 1e3 / self.ns

    def text(self, cost_us: float) -> str:
        """Return a cost with its unit."""
        return f"{format_number(self.of(cost_us))} {self.name}"

    @property
    def label(self) -> str:
        """Label of an axis."""
        return f"cost [{self.name} per call]"


def _unit_for(costs_us: Sequence[float]) -> _Unit:
    """Return the largest unit in which the median of the costs is at least 1."""
    middle_ns = 1e3 * median(costs_us)
    return next((unit for unit in (_Unit("ms", 1e6), _Unit("µs", 1e3)) if middle_ns >= unit.ns), _Unit("ns", 1.0))


def _error_scale(measured: MeasuredGroup) -> Axis:
    unit = measured.group.unit
    errors = [row.error for row in measured.rows]
    if not any(errors):
        return Axis(f"error [{unit}]: 0 for all", -1.0, 1.0, at=(0.0,))
    positive = [max(error, _LEAST_ERROR) for error in errors if 0.0 < error < math.inf]
    scale = Axis.around(f"error [{unit}]", positive, log=True)
    low = scale.low / 10.0 if any(error < _LEAST_ERROR for error in errors) else scale.low
    high = scale.high * 10.0 if any(error == math.inf for error in errors) else scale.high
    return Axis(scale.label, low, high, True)


def _error_panel(measured: MeasuredGroup, front: list[str], width: float, height: float, *, numbered: bool) -> Panel:
    unit = _unit_for([row.cost_us for row in measured.rows])
    costs = [cost for row in measured.rows for cost in (row.cost_us, row.spread_us[1]) if cost > 0.0]
    x = Axis.around(unit.label, [unit.of(cost) for cost in costs], log=True)
    panel = Panel(6.0, _HEAD, width, height, x, _error_scale(measured))
    if panel.y.log:
        of_front = [row for row in measured.rows if row.method.name in front]
        drawn = sorted((unit.of(row.cost_us), max(row.error, panel.y.low)) for row in of_front)
        panel.line(_steps(drawn, panel), "front", "Pareto front: no method is both cheaper and as accurate")
    labels = [str(i + 1) if numbered else name for i, name in enumerate(_names(measured))]
    marked = [(row.method.name in front, row, label) for row, label in zip(measured.rows, labels, strict=True)]
    for on_front, row, label in sorted(marked, key=lambda mark: mark[0]):  # the front is drawn last, on top
        _mark(panel, row, unit, label, on_front=on_front)
    return panel


def _steps(points: list[tuple[float, float]], panel: Panel) -> list[tuple[float, float]]:
    """Return the front as a staircase: what is above and right of it is dominated."""
    if not points:
        return []
    steps = [(points[0][0], panel.y.high)]
    for before, after in pairwise(points):
        steps += [before, (after[0], before[1])]
    return [*steps, points[-1], (panel.x.high, points[-1][1])]


def _mark(panel: Panel, row: Measured, unit: _Unit, label: str, *, on_front: bool) -> None:
    name, cost, method = row.method.name, unit.of(row.cost_us), row.method
    error_text = "fails" if row.error == math.inf else f"{format_number(row.error)} {method.unit}"
    hover = (
        f"{name}\ncost {unit.text(row.cost_us)}, {format_number(row.ratio)} x the reference loop\nerror {error_text}\n"
        f"{method.source}\nvalid: {method.valid_range}"
    )
    if row.error == math.inf:
        panel.cross(cost, panel.y.high, hover)
        panel.label(Label(cost, panel.y.high, label, "bad"))
        return
    error = max(row.error, panel.y.low)
    least, most = (unit.of(each) for each in row.spread_us)
    panel.line(
        [(least, error), (most, error)], "spread", f"{name}: {least:.3g} to {most:.3g} {unit.name} over the rounds"
    )
    if method.default:
        panel.dot(cost, error, "ring", hover, _RING)
    panel.dot(cost, error, "dot" if on_front else "open" if method.runnable else "open yardstick", hover)
    kind, clear = ("name strong", _RING - 4.0) if method.default else ("name", 0.0)
    panel.label(Label(cost, error, label, kind, clear))


def _growth_panel(measured: MeasuredGroup, left: float, top: float, width: float) -> Panel:
    growing = [(row.method, row.growth) for row in measured.rows if row.growth]
    growing.sort(key=lambda pair: -pair[1].cost_us[-1])
    sizes = [float(size) for _, growth in growing for size in growth.sizes]
    unit = _unit_for([cost for _, growth in growing for cost in growth.cost_us])
    y = Axis.around(unit.label, [unit.of(cost) for _, growth in growing for cost in growth.cost_us], log=True)
    room = min(_LIST_LINE * (len(growing) + 0.5) / (_PANELS - 60.0), 0.6)
    y = Axis(y.label, y.low, y.low * (y.high / y.low) ** (1.0 / (1.0 - room)), True)
    panel = Panel(left, top, width, _PANELS, Axis.around(measured.group.work, sizes, log=True), y)
    for i, (method, growth) in enumerate(growing):
        colour = f"s{i % SERIES}"
        grows = f"{method.name}: cost ∼ n^{format_number(round(growth.exponent, 2))}"
        costs = list(zip(growth.sizes, growth.cost_us, strict=True))
        panel.line([(float(n), unit.of(cost)) for n, cost in costs], f"line {colour}", grows)
        for n, cost in costs:
            panel.dot(n, unit.of(cost), f"dot {colour}", f"{method.name}, n = {n:g}: {unit.text(cost)}", 3.5)
        panel.entry(f"line {colour}", grows, "name strong" if method.default else "name")
    return panel


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Return the indices of the (cost, error) points that no other dominates, cheapest first.

    Points that are not finite are never among them; of equal points the first one is.
    """
    finite = [i for i, point in enumerate(points) if all(math.isfinite(value) for value in point)]
    front: list[int] = []
    lowest = math.inf
    for i in sorted(finite, key=lambda i: (points[i], i)):
        if points[i][1] < lowest:
            front.append(i)
            lowest = points[i][1]
    return front
