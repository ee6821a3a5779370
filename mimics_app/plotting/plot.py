"""Plots as inline SVG: axes, lines, bands, bars and legends, coloured by the style sheet of their page.

A plot is markup to a template (`__html__`): every element is made in `marks`, which escapes text and attributes.
All words are shown in the present language.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from markupsafe import Markup

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.language import translated
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.marks import circle, element, joined, path, rect, word

__all__ = ["Plot", "envelope"]

_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 22.0, 10.0, 40.0
_GRID_PX = 0.25
_WIDTH, _MOST_HEIGHT = 860.0, 400.0
"""Width, and largest height of a plot with equal scales, whose height follows from its ranges [px]."""


def envelope(x: F8, y: F8, buckets: int = 900) -> tuple[F8, F8]:
    """Thin a trace for drawing, preserving peaks: the lowest and highest point of each bucket, in their order.

    Args:
        x: Ascending, shape [n].
        y: Shape [n]; values that are not finite are left out.
        buckets: Number of equal parts of the index range.

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
    """One plot. Elements are drawn in the order they are added; a template writes it as markup.

    Attributes:
        x, y: The axes.
        title: Description for people who cannot see it.
        width, height: Size of the whole drawing [px].
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
        """Return a plot with equal scales; the shorter range is widened."""
        inner = _WIDTH - _LEFT - _RIGHT
        span_x, span_y = x.high - x.low, y.high - y.low
        inner_height = min(max(span_y / span_x * inner, 150.0), _MOST_HEIGHT)
        scale = max(span_x / inner, span_y / inner_height)
        x, y = _widened(x, scale * inner), _widened(y, scale * inner_height)
        return cls(x, y, title, _WIDTH, inner_height + _TOP + _BOTTOM)

    @property
    def _inner(self) -> tuple[float, float]:
        return self.width - _LEFT - _RIGHT, self.height - _TOP - _BOTTOM

    def _pixels(self, x: F8, y: F8) -> tuple[F8, F8]:
        width, height = self._inner
        return _LEFT + self.x.share(x) * width, _TOP + (1.0 - self.y.share(y)) * height

    def line(self, x: F8, y: F8, kind: str, name: str = "") -> None:
        """Draw a line through points; `kind` is its class in the style sheet, `name` its entry in the legend."""
        d = self._path(np.asarray(x, np.float64), np.asarray(y, np.float64))
        if d:
            self._parts.append(path(f"line {kind}", d, translated(name)))
        self._name("line", kind, name)

    def _path(self, x: F8, y: F8) -> str:
        """Return a polyline without points on the same quarter of a pixel; NaN interrupts it."""
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

    def spans(self, starts: F8, ends: F8, kind: str, name: str = "") -> None:
        """Draw vertical bands between pairs of x values."""
        zeros = np.zeros(len(starts))
        left, right = self._pixels(starts, zeros)[0], self._pixels(ends, zeros)[0]
        height = self._inner[1]
        for a, b in zip(left.tolist(), right.tolist(), strict=True):
            width = max(b - a, 0.7)
            self._parts.append(rect(f"fill {kind}", (a, _TOP, width, height), translated(name)))
        self._name("fill", kind, name)

    def band(self, x: F8, low: F8, high: F8, kind: str, name: str = "") -> None:
        """Fill the area between two curves over the same x, shape [n]; all values are finite."""
        (forth, lower), (_, upper) = self._pixels(x, low), self._pixels(x, high)
        outline = [*zip(forth, lower, strict=True), *zip(forth[::-1], upper[::-1], strict=True)]
        d = "M" + "L".join(f"{px:.1f} {py:.1f}" for px, py in outline) + "Z"
        self._parts.append(path(f"fill {kind}", d, translated(name)))
        self._name("fill", kind, name)

    def bars(self, edges: F8, heights: F8, kind: str, name: str = "") -> None:
        """Draw a histogram: bar i from edges[i] to edges[i + 1]."""
        left, top = self._pixels(edges[:-1], heights)
        right = self._pixels(edges[1:], heights)[0]
        base = _TOP + self._inner[1]
        for i in np.flatnonzero(np.asarray(heights) > self.y.low):
            what = f"{edges[i]:.3g} – {edges[i + 1]:.3g}: {heights[i]:.6g}"
            corner = (left[i], top[i], max(right[i] - left[i] - 0.5, 0.7), max(base - top[i], 0.0))
            self._parts.append(rect(f"fill {kind}", corner, what))
        self._name("fill", kind, name)

    def points(self, x: F8, y: F8, kind: str, name: str = "", hovers: list[str] | None = None) -> None:
        """Draw small circles, each with its own hover text."""
        px, py = self._pixels(np.asarray(x, np.float64), np.asarray(y, np.float64))
        for i, (a, b) in enumerate(zip(px.tolist(), py.tolist(), strict=True)):
            self._parts.append(circle(f"point {kind}", a, b, 4.0, translated(hovers[i] if hovers else name)))
        self._name("point", kind, name)

    def word(self, x: float, y: float, text: str, anchor: str = "middle") -> None:
        """Draw text; `anchor` is "start", "middle" or "end"."""
        px, py = (float(p[0]) for p in self._pixels(np.array([x]), np.array([y])))
        self._parts.append(word(px, py, translated(text), "name", anchor))

    def mark_x(self, value: float, text: str, row: int = 0) -> None:
        """Draw a vertical line with text beside it; rows are one line of text apart."""
        px = float(self._pixels(np.array([value]), np.array([self.y.high]))[0][0])
        bottom = _TOP + self._inner[1]
        self._parts.append(path("line mark", f"M{px:.1f} {_TOP:g}V{bottom:g}"))
        self._parts.append(word(px + 4, _TOP + 12 + 14 * row, translated(text)))

    def _name(self, shape: str, kind: str, name: str) -> None:
        if name and (shape + " " + kind, name) not in self._legend:
            self._legend.append((shape + " " + kind, name))

    def __html__(self) -> Markup:
        """Return the drawing and its legend as one HTML figure, for templates."""
        size = f"0 0 {self.width:g} {self.height:g}"
        inside = joined([*self._grid(), *self._parts, *self._frame()])
        drawing = element("svg", inside, viewBox=size, role="img", aria_label=translated(self.title))
        return element("figure", joined([drawing, self._legend_html()]))

    def _grid(self) -> list[Markup]:
        width, height = self._inner
        parts: list[Markup] = []
        for value in self.x.ticks():
            px = _LEFT + float(self.x.share(np.array([value]))[0]) * width
            parts.append(path("grid", f"M{px:.1f} {_TOP:g}v{height:g}"))
            parts.append(word(px, _TOP + height + 16, translated(_number(value)), "tick", "middle"))
        rows = self.y.ticks() if self.y.label else []
        for value, text in zip(rows, self.y.words or map(_number, rows), strict=True):
            py = _TOP + (1.0 - float(self.y.share(np.array([value]))[0])) * height
            parts.append(path("grid", f"M{_LEFT:g} {py:.1f}h{width:g}"))
            parts.append(word(_LEFT - 6, py + 4, translated(text), "tick", "end"))
        return parts

    def _frame(self) -> list[Markup]:
        width, height = self._inner
        centre, middle = _LEFT + width / 2, _TOP + height / 2
        upwards = f"translate(14 {middle:g}) rotate(-90)"
        return [
            rect("frame", (_LEFT, _TOP, width, height)),
            word(centre, self.height - 6, translated(self.x.label), anchor="middle"),
            element("text", translated(self.y.label), text_anchor="middle", transform=upwards),
        ]

    def _legend_html(self) -> Markup:
        if not self._legend:
            return Markup()
        entries = [element("span", joined([_swatch(kind), translated(name)])) for kind, name in self._legend]
        return element("figcaption", joined(entries), class_="legend")


def _swatch(kind: str) -> Markup:
    shape = kind.split()[0]
    inside = {
        "line": path(kind, "M1 6h24"),
        "fill": rect(kind, (1.0, 1.0, 24.0, 10.0)),
        "point": circle(kind, 13.0, 6.0, 4.0),
    }[shape]
    return element("svg", inside, class_="swatch", viewBox="0 0 26 12", aria_hidden="true")


def _widened(axis: Axis, span: float) -> Axis:
    middle = (axis.low + axis.high) / 2
    return Axis(axis.label, middle - span / 2, middle + span / 2)


def _number(value: float) -> str:
    return f"{value:.6g}".replace("-", "−") if abs(value) > 1e-12 else "0"
