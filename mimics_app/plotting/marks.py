"""SVG elements of a drawing: paths, circles, rectangles and text, each with its class in the style sheet."""

from __future__ import annotations

import re
from collections.abc import Sequence

from markupsafe import Markup, escape

__all__ = ["circle", "cross", "element", "joined", "path", "pixels", "rect", "word"]

_GREEK = {"us": "µs", "um": "µm", "mu": "μ"}
"""Drawn spelling of words that terminals, tables and JSON keys spell in ASCII."""

_ASCII = re.compile(rf"\b({'|'.join(_GREEK)})\b")


def element(tag: str, content: str = "", **attributes: object) -> Markup:
    """Return one element. Text and attribute values are escaped here only (`Markup` is not escaped again).

    `class_` becomes `class`, other underscores hyphens, as in `text_anchor`; attributes of None are left out.
    """
    named = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{escape(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    return Markup(f"<{tag}{named}>{escape(content)}</{tag}>")


def joined(parts: Sequence[str]) -> Markup:
    """Return the concatenated parts; plain text among them is escaped."""
    return Markup().join(parts)


def pixels(value: float) -> str:
    """Format a position or length [px] to a tenth."""
    return f"{value:.1f}"


def path(kind: str, d: str, hover: str = "") -> Markup:
    """Return a path with the commands `d`, with hover text."""
    return element("path", _title(hover), class_=kind, d=d)


def circle(kind: str, x: float, y: float, radius: float, hover: str = "") -> Markup:
    """Return a circle about a point [px], with hover text."""
    return element("circle", _title(hover), class_=kind, cx=pixels(x), cy=pixels(y), r=f"{radius:g}")


def cross(x: float, y: float, hover: str = "") -> Markup:
    """Return a diagonal cross about a point [px], with hover text."""
    return path("cross", f"M{x - 5:.1f} {y - 5:.1f}l10 10m0 -10l-10 10", hover)


def rect(kind: str, corner: tuple[float, float, float, float], hover: str = "") -> Markup:
    """Return a rectangle by its left, top, width and height [px], with hover text."""
    x, y, width, height = map(pixels, corner)
    return element("rect", _title(hover), class_=kind, x=x, y=y, width=width, height=height)


def word(x: float, y: float, text: str, kind: str | None = None, anchor: str | None = None) -> Markup:
    """Return text at a point [px]; `anchor` is "start", "middle" or "end"."""
    return element("text", _typeset(text), class_=kind, x=pixels(x), y=pixels(y), text_anchor=anchor)


def _title(text: str) -> Markup:
    return element("title", _typeset(text)) if text else Markup()


def _typeset(text: str) -> str:
    return _ASCII.sub(lambda found: _GREEK[found[0]], text)
