"""A self-contained drawing: one SVG file with its style sheet, light and dark."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from mimics_app.plotting.marks import circle, cross, element, joined, path, word

__all__ = ["SERIES", "STYLE", "document", "legend", "swatch", "text_width", "wrapped"]

SERIES = 8
"""Number of colours for series, repeated beyond."""

STYLE = "\n" + Path(__file__).with_suffix(".css").read_text(encoding="utf-8")

_NARROW, _WIDE = " ijlrtfI.,:;'|()[]-", "mwMW%"
_LETTER = 7.5
"""Width of a letter of 12 px that is neither narrow nor wide [px], in DejaVu Sans, the widest font of the style."""


def text_width(text: str, bold: bool = False) -> float:
    """Return the approximate width of a text of 12 px [px]."""
    letters = sum(0.55 if letter in _NARROW else 1.4 if letter in _WIDE else 1.0 for letter in text)
    return _LETTER * (1.12 if bold else 1.0) * letters


def wrapped(text: str, letters: int = 150) -> list[str]:
    """Return a text in lines of at most so many letters, unless a word is longer: 150 small ones fill 1000 px."""
    return textwrap.wrap(text, letters, break_long_words=False, break_on_hyphens=False)


def legend(left: float, top: float, entries: Sequence[tuple[str, str, str]]) -> Markup:
    """Return a legend in a row, of entries (shape "line" | "dot" | "ring" | "cross", classes, text)."""
    parts: list[Markup] = []
    for shape, kind, words in entries:
        parts.append(swatch(shape, kind, left, top))
        parts.append(word(left + 32, top + 4, words, "small", "start"))
        left += 32 + text_width(words) * 0.92 + 22
    return joined(parts)


def swatch(shape: str, kind: str, left: float, top: float) -> Markup:
    """Return a sample of a line or a mark at the left end and the centre line of an entry [px]."""
    if shape == "line":
        return path(kind, f"M{left:g} {top:g}h26")
    if shape == "cross":
        return cross(left + 13.0, top)
    ring = circle("ring", left + 13.0, top, 8.0) if shape == "ring" else Markup()
    return ring + circle(kind, left + 13.0, top, 4.5)


def document(width: float, height: float, title: str, parts: Sequence[Markup], foot: Sequence[str] = ()) -> Markup:
    """Return a whole SVG file.

    Args:
        width: Width of the drawing [px].
        height: Height of the drawing [px].
        title: Title above the drawing, and its description for people who cannot see it.
        parts: Elements of the drawing.
        foot: Small lines below the drawing; the last one is the command that reproduces it, and the machine.
    """
    kinds = ["small"] * (len(foot) - 1) + ["small made"]
    lines = [word(14, height - 10 - 15 * (len(foot) - 1 - i), line, kinds[i], "start") for i, line in enumerate(foot)]
    inside = [
        Markup("\n"),
        element("style", Markup(STYLE)),
        Markup("\n"),
        element("rect", class_="paper", width=f"{width:g}", height=f"{height:g}"),
        word(14, 26, title, "head", "start"),
        *parts,
        *lines,
        Markup("\n"),
    ]
    size = {"viewBox": f"0 0 {width:g} {height:g}", "width": f"{width:g}", "height": f"{height:g}"}
    drawing = element(
        "svg",
        joined(inside),
        xmlns="http://www.w3.org/2000/svg",
        class_="lab",
        **size,
        role="img",
        aria_label=title,
    )
    return drawing + Markup("\n")
