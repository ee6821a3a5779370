"""A curve of a few values over sessions, as dots that a line connects, with its scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from mimics_app.contracts.system.language import translated
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, FAINT, INK, PANEL, QUIET
from mimics_app.rendering.visual.launcher.page_surface import Box

__all__ = ["Curve", "draw_curve"]

_TITLE, _LEAST_TITLE, _SMALL = 15.0, 11.0, 12.0
_DOT, _LINE, _STEP = 8.0, 3.0, 2.5
"""Diameters of a value and of the line, and distance of the line's dots [hud px]."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 52.0, 18.0, 34.0, 26.0
"""Margins of the plotted area within the box [hud px]."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve.

    Attributes:
        title: What it shows.
        unit: Unit of the values, "" for none.
        values: In order, at least one, all finite.
        places: What each value is of, such as the number of a session, as shown.
    """

    title: str
    unit: str
    values: Sequence[float]
    places: Sequence[str]


def draw_curve(hud: Hud, box: Box, curve: Curve) -> None:
    """Draw a curve into its box, with its last value beside its title."""
    x, y, width, height = box
    hud.box(*box, PANEL, radius=12.0)
    last = f"{figure(curve.values[-1])} {translated(curve.unit)}".rstrip()
    drawn = hud.text(x + width - 14.0, y + height - 23.0, last, _TITLE, INK, bold=True, align="right")
    room = width - 36.0 - drawn
    title = translated(curve.title)
    if hud.measure(title, _LEAST_TITLE) <= room:
        hud.fitted(x + 14.0, y + height - 23.0, title, (_LEAST_TITLE, _TITLE), room, FAINT)
    else:
        for number, line in enumerate(hud.wrap(title, _LEAST_TITLE, room, 2)):
            hud.text(x + 14.0, y + height - 17.0 - 13.0 * number, line, _LEAST_TITLE, FAINT)
    low, high = _ends(curve.values)
    left, right = x + _LEFT, x + width - _RIGHT
    bottom, top = y + _BOTTOM, y + height - _TOP - 8.0
    for value, at in ((low, bottom), (high, top)):
        hud.text(left - 10.0, at - 4.0, figure(value), _SMALL, FAINT, align="right")
    hud.box(left - 4.0, bottom - 2.0, right - left + 8.0, 1.0, FAINT)
    steps = max(len(curve.values) - 1, 1)
    places = [
        (left + (right - left) * number / steps, bottom + (top - bottom) * (value - low) / (high - low))
        for number, value in enumerate(curve.values)
    ]
    for (x0, y0), (x1, y1) in pairwise(places):
        _draw_line(hud, (x0, y0), (x1, y1))
    for px, py in places:
        hud.box(px - 0.5 * _DOT, py - 0.5 * _DOT, _DOT, _DOT, ACCENT, radius=0.5 * _DOT)
    begun, ended = (translated(curve.places[number]) for number in (0, -1))
    hud.text(left - 4.0, y + 9.0, begun, _SMALL, FAINT)
    if len(places) > 1:
        hud.text(right + 4.0, y + 9.0, ended, _SMALL, FAINT, align="right")


def figure(value: float) -> str:
    """Return a number in three digits, at most two of them decimals, and the decimal mark of the present language."""
    if abs(value) >= 100.0:
        return f"{value:.0f}"
    return translated(f"{round(value, 2) + 0.0:.3g}")


def _ends(values: Sequence[float]) -> tuple[float, float]:
    """Return the ends of the scale: a little beyond the values; zero where they are near it."""
    low, high = min(values), max(values)
    if 0.0 <= low <= 0.5 * high:
        return 0.0, high
    spare = 0.15 * (high - low) or 0.1 * abs(high) or 1.0
    return low - spare, high + spare


def _draw_line(hud: Hud, begin: tuple[float, float], end: tuple[float, float]) -> None:
    count = max(1, int(math.dist(begin, end) / _STEP))
    for number in range(1, count):
        share = number / count
        x, y = (a + share * (b - a) for a, b in zip(begin, end, strict=True))
        hud.box(x - 0.5 * _LINE, y - 0.5 * _LINE, _LINE, _LINE, QUIET, radius=0.5 * _LINE)
