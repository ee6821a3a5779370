"""Drawings of the laboratory: panels with axes, points, lines, labels that keep off each other, and hover text.

A drawing is one SVG file that stands alone: its style sheet is inside, light and dark, and nothing is fetched.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise

from mimics_app.lab.scale import Scale, format_ticks

__all__ = ["STYLE", "Label", "Panel", "document", "legend", "text_width"]

SERIES = 8
"""Colours for series; further ones begin again."""

STYLE = """
.lab { --paper: #ffffff; --ink: #1a2230; --soft: #566173; --rule: #dfe4ec; --bad: #b3261e; --front: #1559c9;
  --s0: #1559c9; --s1: #c2410c; --s2: #1f7a3b; --s3: #7c3aed; --s4: #a16207; --s5: #be185d; --s6: #0e7490;
  --s7: #4b5563; }
@media (prefers-color-scheme: dark) { .lab { --paper: #151a22; --ink: #e7ebf2; --soft: #a3aec0; --rule: #303947;
  --bad: #ff8a80; --front: #74a9ff; --s0: #74a9ff; --s1: #ff9d5c; --s2: #56d37b; --s3: #c19bff; --s4: #e5bf4d;
  --s5: #ff8ab8; --s6: #4fd0e6; --s7: #a8b3c4; } }
.lab .paper { fill: var(--paper); } .lab text { fill: var(--soft); font: 12px system-ui, "DejaVu Sans", sans-serif; }
.lab text.head { fill: var(--ink); font-size: 17px; font-weight: 650; } .lab text.name { fill: var(--ink); }
.lab text.strong { font-weight: 700; } .lab text.small { font-size: 11px; } .lab text.bad { fill: var(--bad); }
.lab .grid { stroke: var(--rule); fill: none; } .lab .frame { stroke: var(--soft); fill: none; }
.lab .lead { stroke: var(--soft); stroke-width: 0.8; fill: none; opacity: 0.7; }
.lab .line { fill: none; stroke: var(--c, var(--ink)); stroke-width: 2; stroke-linejoin: round; }
.lab .front { stroke: var(--front); stroke-width: 2.2; fill: none; stroke-dasharray: 1 0; opacity: 0.55; }
.lab .dashed { stroke-dasharray: 7 5; stroke-width: 1.7; } .lab .dotted { stroke-dasharray: 2 4; stroke-width: 1.7; }
.lab .dot { fill: var(--c, var(--front)); stroke: var(--paper); stroke-width: 1; }
.lab .open { fill: var(--paper); stroke: var(--c, var(--soft)); stroke-width: 2; }
.lab .yardstick { stroke-dasharray: 2.2 2.2; }
.lab .ring { fill: none; stroke: var(--ink); stroke-width: 1.8; } .lab .cross { stroke: var(--bad); stroke-width: 2.4; }
.lab .s0 { --c: var(--s0); } .lab .s1 { --c: var(--s1); } .lab .s2 { --c: var(--s2); } .lab .s3 { --c: var(--s3); }
.lab .s4 { --c: var(--s4); } .lab .s5 { --c: var(--s5); } .lab .s6 { --c: var(--s6); } .lab .s7 { --c: var(--s7); }
"""

_LEFT, _RIGHT, _TOP, _BOTTOM = 78.0, 14.0, 8.0, 46.0
_LETTER = 6.75
_LINE = 15.0
_DIRECTIONS = ((1, 0), (-1, 0), (0, -1), (0, 1), (0.8, -0.8), (-0.8, -0.8), (0.8, 0.8), (-0.8, 0.8))
_DISTANCES = (8.0, 14.0, 26.0, 40.0, 58.0, 80.0, 105.0)

Box = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""


def text_width(text: str, bold: bool = False) -> float:
    """About how wide a text of 12 px is drawn [px]."""
    return _LETTER * (1.09 if bold else 1.0) * len(text)


@dataclass(frozen=True, slots=True)
class Label:
    """A word that belongs to a place of a panel and is put where it covers nothing.

    Attributes:
        x, y: The place, in the panel's values.
        text: The word.
        kind: Classes of the text.
        clear: How much of the place is drawn over all around [px], beyond a small dot.
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
    x: Scale
    y: Scale
    title: str = ""
    _parts: list[str] = field(default_factory=list)
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
        """A point of the panel in pixels of the drawing."""
        left, top, right, bottom = self._frame
        return left + self.x.share(x) * (right - left), bottom - self.y.share(y) * (bottom - top)

    def line(self, points: Sequence[tuple[float, float]], kind: str, hover: str = "") -> None:
        """A line through points; `kind`: its classes. Points a logarithmic axis cannot show are left out."""
        shown = [point for point in points if self._can_show(point)]
        if len(shown) < 2:
            return
        pixels = [self.place(*point) for point in shown]
        self._paths.append(pixels)
        path = "M" + "L".join(f"{px:.1f} {py:.1f}" for px, py in pixels)
        self._parts.append(f'<path class="{kind}" d="{path}">{_title(hover)}</path>')

    def dot(self, x: float, y: float, kind: str, hover: str = "", radius: float = 4.5) -> None:
        """A small circle with hover text."""
        if not self._can_show((x, y)):
            return
        px, py = self.place(x, y)
        self._marks.append((px, py))
        self._parts.append(
            f'<circle class="{kind}" cx="{px:.1f}" cy="{py:.1f}" r="{radius:g}">{_title(hover)}</circle>'
        )

    def cross(self, x: float, y: float, hover: str = "") -> None:
        """A mark for what fails."""
        px, py = self.place(x, y)
        self._marks.append((px, py))
        path = f"M{px - 5:.1f} {py - 5:.1f}l10 10m0 -10l-10 10"
        self._parts.append(f'<path class="cross" d="{path}">{_title(hover)}</path>')

    def label(self, label: Label) -> None:
        """A word to be put near its place."""
        self._labels.append(label)

    def entry(self, kind: str, text: str, words: str = "name") -> None:
        """A line of the list in the panel's upper left corner: the classes of what is drawn, and of the words."""
        self._entries.append((kind, text, words))

    def _can_show(self, point: tuple[float, float]) -> bool:
        x, y = point
        if not (math.isfinite(x) and math.isfinite(y)):
            return False
        return (x > 0.0 or not self.x.log) and (y > 0.0 or not self.y.log)

    def svg(self) -> str:
        """The panel's part of the drawing."""
        return self._axes() + "".join(self._parts) + self._words() + self._list()

    def _list(self) -> str:
        left, top = self._frame[0] + 10.0, self._frame[1] + 14.0
        return "".join(
            _swatch("line", kind, left, top + 16.0 * i) + _word(left + 32, top + 4 + 16.0 * i, text, words, "start")
            for i, (kind, text, words) in enumerate(self._entries)
        )

    def _axes(self) -> str:
        left, top, right, bottom = self._frame
        text = [f'<rect class="frame" x="{left:g}" y="{top:g}" width="{right - left:g}" height="{bottom - top:g}"/>']
        columns, rows = self.x.ticks(), self.y.ticks()
        for value, number in zip(columns, format_ticks(columns), strict=True):
            px = self.place(value, self.y.low)[0]
            text.append(f'<path class="grid" d="M{px:.1f} {top:g}V{bottom:g}"/>')
            text.append(_word(px, bottom + 17, number, "small", "middle"))
        for value, number in zip(rows, format_ticks(rows), strict=True):
            py = self.place(self.x.low, value)[1]
            text.append(f'<path class="grid" d="M{left:g} {py:.1f}H{right:g}"/>')
            text.append(_word(left - 6, py + 4, number, "small", "end"))
        text.append(_word((left + right) / 2, bottom + 36, self.x.label, "", "middle"))
        turned = f'transform="translate({self.left + 14:g} {(top + bottom) / 2:g}) rotate(-90)"'
        text.append(f'<text text-anchor="middle" {turned}>{escape(self.y.label)}</text>')
        if self.title:
            text.append(_word(left, top - 8, self.title, "name strong", "start"))
        return "".join(text)

    def _words(self) -> str:
        taken: list[Box] = []
        text: list[str] = []
        for label in sorted(self._labels, key=lambda label: self.place(label.x, label.y)[1]):
            px, py = self.place(label.x, label.y)
            box = min(_candidates(px, py, label), key=lambda box: self._badness(box, taken, px, py))
            taken.append(box)
            near = _nearest_in(box, (px, py))
            if math.dist(near, (px, py)) > 13.0 or self._doubt(box, px, py) > 0.4:
                text.append(f'<path class="lead" d="M{px:.1f} {py:.1f}L{near[0]:.1f} {near[1]:.1f}"/>')
            x, anchor = _anchor(box, px)
            text.append(_word(x, box[3] - 4, label.text, label.kind, anchor))
        return "".join(text)

    def _badness(self, box: Box, taken: list[Box], px: float, py: float) -> float:
        """How much a place for a word covers: outside, other words, points, lines; and how far off it is."""
        left, top, right, bottom = self._frame
        outside = max(0.0, left - box[0], box[2] - right) + max(0.0, top - box[1], box[3] - bottom)
        points = sum(_inside(box, mark, 5.0) for mark in self._marks if mark != (px, py))
        crossings = sum(_inside(box, point, 1.0) for path in self._paths for point in _along(path))
        distance = math.dist(_nearest_in(box, (px, py)), (px, py))
        words = sum(_overlap(box, other) for other in taken)
        doubt = 90.0 * self._doubt(box, px, py)
        return 60.0 * outside + 20.0 * words + 400.0 * points + 6.0 * crossings + doubt + distance

    def _doubt(self, box: Box, px: float, py: float) -> float:
        """0 for a word that stands much nearer to its own point than to any other, rising to 1."""
        own = 1.5 * math.dist(_nearest_in(box, (px, py)), (px, py)) + 4.0
        others = (math.dist(_nearest_in(box, mark), mark) for mark in self._marks if mark != (px, py))
        return max(0.0, 1.0 - min(others, default=math.inf) / own)


def _candidates(px: float, py: float, label: Label) -> Iterable[Box]:
    width = text_width(label.text, "strong" in label.kind)
    for distance in (label.clear + near for near in _DISTANCES):
        for along, down in _DIRECTIONS:
            x = px + along * distance - width * (0.0 if along > 0 else 1.0 if along < 0 else 0.5)
            y = py + down * distance - _LINE * (0.0 if down > 0 else 1.0 if down < 0 else 0.5)
            yield x, y, x + width, y + _LINE


def _anchor(box: Box, px: float) -> tuple[float, str]:
    """Where a word is held [px] and how: on the side of its place, which a wider letter then cannot cover."""
    if box[2] <= px:
        return box[2], "end"
    return (box[0], "start") if box[0] >= px else ((box[0] + box[2]) / 2, "middle")


def _nearest_in(box: Box, point: tuple[float, float]) -> tuple[float, float]:
    """The point of a box nearest to another one."""
    return min(max(point[0], box[0]), box[2]), min(max(point[1], box[1]), box[3])


def _inside(box: Box, point: tuple[float, float], room: float) -> bool:
    return box[0] - room < point[0] < box[2] + room and box[1] - room < point[1] < box[3] + room


def _overlap(a: Box, b: Box) -> float:
    """Common area of two boxes [px^2], with a little room between them."""
    width = min(a[2], b[2]) - max(a[0], b[0]) + 4.0
    height = min(a[3], b[3]) - max(a[1], b[1])
    return max(width, 0.0) * max(height, 0.0)


def _along(path: list[tuple[float, float]]) -> Iterable[tuple[float, float]]:
    """Points about 8 px apart on a line."""
    for (ax, ay), (bx, by) in pairwise(path):
        steps = max(1, round(math.hypot(bx - ax, by - ay) / 8.0))
        for i in range(steps):
            yield ax + (bx - ax) * i / steps, ay + (by - ay) * i / steps


def _word(x: float, y: float, text: str, kind: str, anchor: str) -> str:
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _title(hover: str) -> str:
    return f"<title>{escape(hover)}</title>" if hover else ""


def legend(left: float, top: float, entries: Sequence[tuple[str, str, str]]) -> str:
    """A row of what lines and points mean: (shape "line" | "dot" | "ring" | "cross", classes, words)."""
    text: list[str] = []
    for shape, kind, words in entries:
        text.append(_swatch(shape, kind, left, top))
        text.append(_word(left + 32, top + 4, words, "small", "start"))
        left += 32 + text_width(words) * 0.92 + 22
    return "".join(text)


def _swatch(shape: str, kind: str, left: float, top: float) -> str:
    if shape == "line":
        return f'<path class="{kind}" d="M{left:g} {top:g}h26"/>'
    if shape == "cross":
        return f'<path class="cross" d="M{left + 8:g} {top - 5:g}l10 10m0 -10l-10 10"/>'
    ring = f'<circle class="ring" cx="{left + 13:g}" cy="{top:g}" r="8"/>' if shape == "ring" else ""
    return f'{ring}<circle class="{kind}" cx="{left + 13:g}" cy="{top:g}" r="4.5"/>'


def document(width: float, height: float, title: str, parts: Sequence[str], foot: Sequence[str] = ()) -> str:
    """A whole SVG file.

    Args:
        width: [px].
        height: [px].
        title: Above the drawing, and for people who cannot see it.
        parts: What is drawn.
        foot: Small lines below the drawing; the last one says how it was made.
    """
    kinds = ["small"] * (len(foot) - 1) + ["small made"]
    lines = "".join(
        _word(14, height - 10 - 15 * (len(foot) - 1 - i), line, kinds[i], "start") for i, line in enumerate(foot)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="lab" viewBox="0 0 {width:g} {height:g}" '
        f'width="{width:g}" height="{height:g}" role="img" aria-label="{escape(title, quote=True)}">\n'
        f"<style>{STYLE}</style>\n"
        f'<rect class="paper" width="{width:g}" height="{height:g}"/>'
        f"{_word(14, 26, title, 'head', 'start')}{''.join(parts)}{lines}\n</svg>\n"
    )
