"""Plots as inline SVG: axes, lines, bands, bars and legends, coloured by the style sheet of the page they stand in.

A plot is markup to a template (`__html__`): every element is made by `_element`, which escapes text and attributes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

__all__ = ["Axis", "Plot", "envelope", "log_ticks", "nice_ticks"]

Values = NDArray[np.float64]

_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 22.0, 10.0, 40.0
_GRID_PX = 0.25
_WIDTH, _MOST_HEIGHT = 860.0, 620.0
"""Of a plot [px]; the height of one whose axes have the same scale follows from their ranges."""
_TICKS = 6
"""About so many lines of the grid along an axis."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Range and name of one axis; the name carries the unit, "" draws none. A logarithmic axis needs `low` > 0."""

    label: str
    low: float
    high: float
    log: bool = False

    @classmethod
    def of(cls, label: str, *data: Values, margin: float = 0.04, zero: bool = False) -> Axis:
        """An axis that holds all finite values, with a margin; `zero` makes it start at or below 0."""
        finite = np.concatenate([np.asarray(d, np.float64).ravel() for d in data]) if data else np.zeros(0)
        finite = finite[np.isfinite(finite)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
        if zero:
            low, high = min(low, 0.0), max(high, 0.0)
        if high - low <= 1e-12 * max(abs(low), abs(high), 1e-3):
            low, high = (low, low + 1.0) if zero else (low - 0.5, high + 0.5)
        pad = margin * (high - low)
        return cls(label, low if zero and low == 0.0 else low - pad, high + pad)

    def share(self, values: Values) -> Values:
        """Values as shares of the axis, 0 at `low` and 1 at `high`."""
        if self.log:
            low, high = math.log10(self.low), math.log10(self.high)
            return (np.log10(np.maximum(values, self.low)) - low) / (high - low)
        return (np.asarray(values, np.float64) - self.low) / (self.high - self.low)

    def ticks(self) -> list[float]:
        """Where lines of the grid stand."""
        return log_ticks(self.low, self.high) if self.log else nice_ticks(self.low, self.high)


def nice_ticks(low: float, high: float) -> list[float]:
    """Round numbers in [low, high], 1, 2 or 5 times a power of ten apart."""
    raw = (high - low) / _TICKS
    power = 10.0 ** math.floor(math.log10(raw))
    step = power * next((m for m in (1, 2, 5) if raw <= m * power * 1.0000001), 10)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [i * step for i in range(first, last + 1)]


def log_ticks(low: float, high: float) -> list[float]:
    """Powers of ten in [low, high]."""
    return [10.0**i for i in range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)]


def envelope(x: Values, y: Values, buckets: int = 900) -> tuple[Values, Values]:
    """Thin a trace for drawing so that no peak is lost: of each bucket its lowest and highest point, in their order.

    Args:
        x: Ascending, shape [n].
        y: Shape [n]; values that are not finite are left out.
        buckets: Into how many equal parts of the index range the trace is cut.

    Returns:
        x and y of at most 2 * buckets points; the trace itself when it is no longer than that.
    """
    finite = np.isfinite(y)
    x, y = x[finite], y[finite]
    if len(y) <= 2 * buckets:
        return x, y
    size = -(-len(y) // buckets)
    starts = np.arange(0, len(y), size)
    padded = np.full(len(starts) * size, np.nan)
    padded[: len(y)] = y
    table = padded.reshape(len(starts), size)
    lowest, highest = np.nanargmin(table, axis=1) + starts, np.nanargmax(table, axis=1) + starts
    chosen = np.unique(np.concatenate([lowest, highest]))
    return x[chosen], y[chosen]


@dataclass
class Plot:
    """One drawing. Things are drawn in the order they are added; a template writes it as markup.

    Attributes:
        x, y: The axes.
        width, height: Of the whole drawing [px].
        title: What it shows, for people who cannot see it.
    """

    x: Axis
    y: Axis
    title: str
    width: float = _WIDTH
    height: float = 220.0
    _parts: list[Markup] = field(default_factory=list)
    _legend: list[tuple[str, str]] = field(default_factory=list)

    @classmethod
    def equal(cls, x: Axis, y: Axis, title: str) -> Plot:
        """A plot whose axes have the same scale; the shorter range is widened."""
        inner = _WIDTH - _LEFT - _RIGHT
        span_x, span_y = x.high - x.low, y.high - y.low
        inner_height = min(max(span_y / span_x * inner, 150.0), _MOST_HEIGHT)
        scale = max(span_x / inner, span_y / inner_height)
        x, y = _widened(x, scale * inner), _widened(y, scale * inner_height)
        return cls(x, y, title, _WIDTH, inner_height + _TOP + _BOTTOM)

    @property
    def _inner(self) -> tuple[float, float]:
        return self.width - _LEFT - _RIGHT, self.height - _TOP - _BOTTOM

    def _pixels(self, x: Values, y: Values) -> tuple[Values, Values]:
        width, height = self._inner
        return _LEFT + self.x.share(x) * width, _TOP + (1.0 - self.y.share(y)) * height

    def line(self, x: Values, y: Values, kind: str, name: str = "") -> None:
        """A line through points; `kind` is its class in the style sheet, `name` its entry in the legend."""
        path = self._path(np.asarray(x, np.float64), np.asarray(y, np.float64))
        if path:
            self._parts.append(_element("path", _hover(name), class_=f"line {kind}", d=path))
        self._name("line", kind, name)

    def _path(self, x: Values, y: Values) -> str:
        """Polyline without the points that fall on the same quarter of a pixel; not-a-number lifts the pen."""
        px, py = self._pixels(x, y)
        gx, gy = np.round(px / _GRID_PX), np.round(py / _GRID_PX)
        text: list[str] = []
        pen, last = "M", (math.nan, math.nan)
        for i, point in enumerate(zip(gx.tolist(), gy.tolist(), strict=True)):
            if point == last and i < len(gx) - 1:
                continue
            last = point
            if math.isnan(point[0] + point[1]):
                pen = "M"
                continue
            text.append(f"{pen}{point[0] * _GRID_PX:g} {point[1] * _GRID_PX:g}")
            pen = "L"
        return "".join(text)

    def spans(self, starts: Values, ends: Values, kind: str, name: str = "") -> None:
        """Vertical bands between two places of the x axis each."""
        zeros = np.zeros(len(starts))
        left, right = self._pixels(starts, zeros)[0], self._pixels(ends, zeros)[0]
        height = self._inner[1]
        for a, b in zip(left.tolist(), right.tolist(), strict=True):
            width = max(b - a, 0.7)
            self._parts.append(_rect(f"fill {kind}", (a, _TOP, width, height), _hover(name)))
        self._name("fill", kind, name)

    def bars(self, edges: Values, heights: Values, kind: str, name: str = "") -> None:
        """A histogram: bar i from edges[i] to edges[i + 1]."""
        left, top = self._pixels(edges[:-1], heights)
        right = self._pixels(edges[1:], heights)[0]
        base = _TOP + self._inner[1]
        for i in np.flatnonzero(np.asarray(heights) > self.y.low):
            what = f"{edges[i]:.3g} to {edges[i + 1]:.3g}: {heights[i]:.6g}"
            corner = (left[i], top[i], max(right[i] - left[i] - 0.5, 0.7), max(base - top[i], 0.0))
            self._parts.append(_rect(f"fill {kind}", corner, _hover(what)))
        self._name("fill", kind, name)

    def points(self, x: Values, y: Values, kind: str, name: str = "", hovers: list[str] | None = None) -> None:
        """Small circles, each with its own hover text."""
        px, py = self._pixels(np.asarray(x, np.float64), np.asarray(y, np.float64))
        for i, (a, b) in enumerate(zip(px.tolist(), py.tolist(), strict=True)):
            hover = _hover(hovers[i] if hovers else name)
            self._parts.append(_element("circle", hover, class_=f"point {kind}", cx=_px(a), cy=_px(b), r=4))
        self._name("point", kind, name)

    def word(self, x: float, y: float, text: str, anchor: str = "middle") -> None:
        """A word in the drawing; `anchor` is "start", "middle" or "end"."""
        px, py = (float(p[0]) for p in self._pixels(np.array([x]), np.array([y])))
        self._parts.append(_element("text", text, class_="name", text_anchor=anchor, x=_px(px), y=_px(py)))

    def mark_x(self, value: float, text: str, row: int = 0) -> None:
        """A vertical line with a word beside it; rows are one line of text apart."""
        px = float(self._pixels(np.array([value]), np.array([self.y.high]))[0][0])
        bottom = _TOP + self._inner[1]
        self._parts.append(_element("path", class_="line mark", d=f"M{px:.1f} {_TOP:g}V{bottom:g}"))
        self._parts.append(_element("text", text, x=_px(px + 4), y=f"{_TOP + 12 + 14 * row:g}"))

    def _name(self, shape: str, kind: str, name: str) -> None:
        if name and (shape + " " + kind, name) not in self._legend:
            self._legend.append((shape + " " + kind, name))

    def __html__(self) -> Markup:
        """The drawing and its legend as one HTML figure: what a template writes for a plot."""
        size = f"0 0 {self.width:g} {self.height:g}"
        inside = _joined([*self._grid(), *self._parts, *self._frame()])
        drawing = _element("svg", inside, viewBox=size, role="img", aria_label=self.title)
        return _element("figure", _joined([drawing, self._legend_html()]))

    def _grid(self) -> list[Markup]:
        width, height = self._inner
        parts: list[Markup] = []
        for value in self.x.ticks():
            px = _LEFT + float(self.x.share(np.array([value]))[0]) * width
            place = {"text_anchor": "middle", "x": _px(px), "y": f"{_TOP + height + 16:g}"}
            parts.append(_element("path", class_="grid", d=f"M{px:.1f} {_TOP:g}v{height:g}"))
            parts.append(_element("text", _number(value), class_="tick", **place))
        for value in self.y.ticks() if self.y.label else []:
            py = _TOP + (1.0 - float(self.y.share(np.array([value]))[0])) * height
            place = {"text_anchor": "end", "x": f"{_LEFT - 6:g}", "y": _px(py + 4)}
            parts.append(_element("path", class_="grid", d=f"M{_LEFT:g} {py:.1f}h{width:g}"))
            parts.append(_element("text", _number(value), class_="tick", **place))
        return parts

    def _frame(self) -> list[Markup]:
        width, height = self._inner
        centre, middle = _LEFT + width / 2, _TOP + height / 2
        upwards = f"translate(14 {middle:g}) rotate(-90)"
        return [
            _rect("frame", (_LEFT, _TOP, width, height)),
            _element("text", self.x.label, text_anchor="middle", x=f"{centre:g}", y=f"{self.height - 6:g}"),
            _element("text", self.y.label, text_anchor="middle", transform=upwards),
        ]

    def _legend_html(self) -> Markup:
        if not self._legend:
            return Markup()
        entries = [_element("span", _joined([_swatch(kind), name])) for kind, name in self._legend]
        return _element("figcaption", _joined(entries), class_="legend")


def _element(tag: str, content: str = "", **attributes: object) -> Markup:
    """One element: the one place where text and values of attributes are escaped (what is `Markup` already is not).

    `class_` is `class`, other low lines are hyphens, as in `text_anchor`.
    """
    named = [Markup(' {}="{}"').format(name.rstrip("_").replace("_", "-"), v) for name, v in attributes.items()]
    return Markup("<{0}{1}>{2}</{0}>").format(tag, _joined(named), content)


def _joined(parts: Sequence[str]) -> Markup:
    return Markup().join(parts)


def _px(value: float) -> str:
    return f"{value:.1f}"


def _rect(kind: str, corner: tuple[float, float, float, float], content: str = "") -> Markup:
    """A rectangle by its left, top, width and height [px]."""
    x, y, width, height = map(_px, corner)
    return _element("rect", content, class_=kind, x=x, y=y, width=width, height=height)


def _swatch(kind: str) -> Markup:
    shape = kind.split()[0]
    inside = {
        "line": _element("path", class_=kind, d="M1 6h24"),
        "fill": _rect(kind, (1.0, 1.0, 24.0, 10.0)),
        "point": _element("circle", class_=kind, cx=13, cy=6, r=4),
    }[shape]
    return _element("svg", inside, class_="swatch", viewBox="0 0 26 12", aria_hidden="true")


def _widened(axis: Axis, span: float) -> Axis:
    middle = (axis.low + axis.high) / 2
    return Axis(axis.label, middle - span / 2, middle + span / 2)


def _hover(text: str) -> Markup:
    return _element("title", text) if text else Markup()


def _number(value: float) -> str:
    return f"{value:.6g}".replace("-", "−") if abs(value) > 1e-12 else "0"
