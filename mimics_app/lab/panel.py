"""Panels of a drawing: axes, points, lines, labels placed without overlap, and hover text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from markupsafe import Markup

from mimics_app.plotting.axis import Axis, format_ticks
from mimics_app.plotting.drawing import swatch, text_width
from mimics_app.plotting.marks import circle, cross, element, joined, path, rect, word

__all__ = ["Label", "Panel"]

_LEFT, _RIGHT, _TOP, _BOTTOM = 78.0, 14.0, 8.0, 46.0
_LINE = 15.0
_DIRECTIONS = ((1, 0), (-1, 0), (0, -1), (0, 1), (0.8, -0.8), (-0.8, -0.8), (0.8, 0.8), (-0.8, 0.8))
_DISTANCES = (8.0, 14.0, 26.0, 40.0, 58.0, 80.0, 105.0)

Box = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""


@dataclass(frozen=True, slots=True)
class Label:
    """A label of a point in a panel, placed where it covers nothing.

    Attributes:
        x, y: The point, in values of the axes.
        text: Text of the label.
        kind: Classes of the text.
        clear: Radius drawn over around the point, beyond a small dot [px].
    """

    x: float
    y: float
    text: str
    kind: str = "name"
    clear: float = 0.0


@dataclass
class Panel:
    """One pair of axes. Lines and points are drawn in the order they are added, labels last.

    Attributes:
        left, top, width, height: Of the panel with its axes [px].
        x, y: The axes.
        title: Above the axes; "" for none.
    """

    left: float
    top: float
    width: float
    height: float
    x: Axis
    y: Axis
    title: str = ""
    _parts: list[Markup] = field(default_factory=list)
    _labels: list[Label] = field(default_factory=list)
    _entries: list[tuple[str, str, str]] = field(default_factory=list)
    _marks: list[tuple[float, float]] = field(default_factory=list)
    _paths: list[list[tuple[float, float]]] = field(default_factory=list)

    @property
    def _frame(self) -> Box:
        head = 20.0 if self.title else 0.0
        return (
            self.left + _LEFT,
            self.top + _TOP + head,
            self.left + self.width - _RIGHT,
            self.top + self.height - _BOTTOM,
        )

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return a point of the panel in pixels of the drawing."""
        left, top, right, bottom = self._frame
        return left + self.x.share_within(x) * (right - left), bottom - self.y.share_within(y) * (bottom - top)

    def line(self, points: Sequence[tuple[float, float]], kind: str, hover: str = "") -> None:
        """Draw a line through points; `kind`: its classes. Points that a logarithmic axis cannot show are left out."""
        shown = [point for point in points if self._can_show(point)]
        if len(shown) < 2:
            return
        pixels = [self.place(*point) for point in shown]
        self._paths.append(pixels)
        self._parts.append(path(kind, "M" + "L".join(f"{px:.1f} {py:.1f}" for px, py in pixels), hover))

    def dot(self, x: float, y: float, kind: str, hover: str = "", radius: float = 4.5) -> None:
        """Draw a small circle with hover text."""
        if not self._can_show((x, y)):
            return
        px, py = self.place(x, y)
        self._marks.append((px, py))
        self._parts.append(circle(kind, px, py, radius, hover))

    def cross(self, x: float, y: float, hover: str = "") -> None:
        """Draw the mark of a failure."""
        px, py = self.place(x, y)
        self._marks.append((px, py))
        self._parts.append(cross(px, py, hover))

    def label(self, label: Label) -> None:
        """Add a label."""
        self._labels.append(label)

    def entry(self, kind: str, text: str, words: str = "name") -> None:
        """Add a line to the legend in the upper left corner: classes of the line, text, classes of the text."""
        self._entries.append((kind, text, words))

    def _can_show(self, point: tuple[float, float]) -> bool:
        x, y = point
        if not (math.isfinite(x) and math.isfinite(y)):
            return False
        return (x > 0.0 or not self.x.log) and (y > 0.0 or not self.y.log)

    def svg(self) -> Markup:
        """Return the panel as part of the drawing."""
        return joined([*self._axes(), *self._parts, *self._words(), *self._list()])

    def _list(self) -> Iterable[Markup]:
        left, top = self._frame[0] + 10.0, self._frame[1] + 14.0
        for i, (kind, text, words) in enumerate(self._entries):
            yield swatch("line", kind, left, top + 16.0 * i)
            yield word(left + 32, top + 4 + 16.0 * i, text, words, "start")

    def _axes(self) -> Iterable[Markup]:
        left, top, right, bottom = self._frame
        yield rect("frame", (left, top, right - left, bottom - top))
        columns, rows = self.x.ticks(), self.y.ticks()
        places = [self.place(value, self.y.low)[0] for value in columns]
        yield from (path("grid", f"M{px:.1f} {top:g}V{bottom:g}") for px in places)
        for px, number in _apart(places, self.x.words or format_ticks(columns)):
            yield word(px, bottom + 17, number, "small", "middle")
        for value, number in zip(rows, format_ticks(rows), strict=True):
            py = self.place(self.x.low, value)[1]
            yield path("grid", f"M{left:g} {py:.1f}H{right:g}")
            yield word(left - 6, py + 4, number, "small", "end")
        yield word((left + right) / 2, bottom + 36, self.x.label, anchor="middle")
        turned = f"translate({self.left + 14:g} {(top + bottom) / 2:g}) rotate(-90)"
        yield element("text", self.y.label, text_anchor="middle", transform=turned)
        if self.title:
            yield word(left, top - 8, self.title, "name strong", "start")

    def _words(self) -> Iterable[Markup]:
        taken: list[Box] = []
        for label in sorted(self._labels, key=lambda label: self.place(label.x, label.y)[1]):
            px, py = self.place(label.x, label.y)
            box = min(_candidates(px, py, label), key=lambda box: self._badness(box, taken, px, py))
            taken.append(box)
            near = _nearest_in(box, (px, py))
            if math.dist(near, (px, py)) > 13.0 or self._doubt(box, px, py) > 0.4:
                yield path("lead", f"M{px:.1f} {py:.1f}L{near[0]:.1f} {near[1]:.1f}")
            x, anchor = _anchor(box, px)
            yield word(x, box[3] - 4, label.text, label.kind, anchor)

    def _badness(self, box: Box, taken: list[Box], px: float, py: float) -> float:
        """Return the cost of a label's box: area outside, overlap with labels, points and lines, distance."""
        left, top, right, bottom = self._frame
        outside = max(0.0, left - box[0], box[2] - right) + max(0.0, top - box[1], box[3] - bottom)
        points = sum(_inside(box, mark, 5.0) for mark in self._marks if mark != (px, py))
        crossings = sum(_inside(box, point, 1.0) for path in self._paths for point in _along(path))
        distance = math.dist(_nearest_in(box, (px, py)), (px, py))
        words = sum(_overlap(box, other) for other in taken)
        doubt = 90.0 * self._doubt(box, px, py)
        return 60.0 * outside + 20.0 * words + 400.0 * points + 6.0 * crossings + doubt + distance

    def _doubt(self, box: Box, px: float, py: float) -> float:
        """Return the ambiguity of a label: 0 if it is much nearer to its own point than to any other, up to 1."""
        own = 1.5 * math.dist(_nearest_in(box, (px, py)), (px, py)) + 4.0
        others = (math.dist(_nearest_in(box, mark), mark) for mark in self._marks if mark != (px, py))
        return max(0.0, 1.0 - min(others, default=math.inf) / own)


def _apart(places: Sequence[float], numbers: Sequence[str]) -> Iterable[tuple[float, str]]:
    """Yield the numbers of an axis that do not touch each other; powers of ten come first."""
    taken: list[tuple[float, float]] = []
    for px, number in sorted(zip(places, numbers, strict=True), key=lambda each: each[1].strip("0.") != "1"):
        half = 0.5 * text_width(number) + 3.0
        if all(px + half <= left or right <= px - half for left, right in taken):
            taken.append((px - half, px + half))
            yield px, number


def _candidates(px: float, py: float, label: Label) -> Iterable[Box]:
    width = text_width(label.text, "strong" in label.kind)
    for distance in (label.clear + near for near in _DISTANCES):
        for along, down in _DIRECTIONS:
            x = px + along * distance - width * (0.0 if along > 0 else 1.0 if along < 0 else 0.5)
            y = py + down * distance - _LINE * (0.0 if down > 0 else 1.0 if down < 0 else 0.5)
            yield x, y, x + width, y + _LINE


def _anchor(box: Box, px: float) -> tuple[float, str]:
    """Return position [px] and anchor of a label: on the side of its point, which wider letters then do not cover."""
    if box[2] <= px:
        return box[2], "end"
    return (box[0], "start") if box[0] >= px else ((box[0] + box[2]) / 2, "middle")


def _nearest_in(box: Box, point: tuple[float, float]) -> tuple[float, float]:
    """Return the point of a box nearest to a point."""
    return min(max(point[0], box[0]), box[2]), min(max(point[1], box[1]), box[3])


def _inside(box: Box, point: tuple[float, float], room: float) -> bool:
    return box[0] - room < point[0] < box[2] + room and box[1] - room < point[1] < box[3] + room


def _overlap(a: Box, b: Box) -> float:
    """Return the common area of two boxes [px^2], with a small margin."""
    width = min(a[2], b[2]) - max(a[0], b[0]) + 4.0
    height = min(a[3], b[3]) - max(a[1], b[1])
    return max(width, 0.0) * max(height, 0.0)


def _along(path: list[tuple[float, float]]) -> Iterable[tuple[float, float]]:
    """Yield points about 8 px apart on a line."""
    for (ax, ay), (bx, by) in pairwise(path):
        steps = max(1, round(math.hypot(bx - ax, by - ay) / 8.0))
        for i in range(steps):
            yield ax + (bx - ax) * i / steps, ay + (by - ay) * i / steps
