"""A page over the picture: title, words, an image and keys, in the centre."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mimics_app.contracts.system.language import translated
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, FAINT, INK

__all__ = ["KeyPage", "Keys", "draw_keys", "draw_page"]

Keys = Sequence[tuple[str, str]]
"""Keys with their functions, in the order listed."""

_PANEL: Colour = (0.05, 0.06, 0.08, 0.97)
"""Hardly any text of the page behind it shows through."""
_LINE, _SIZE = 30.0, 17.0
_TITLE, _WORDS, _WORDS_LINE = 30.0, 20.0, 27.0
_MOST_LINES = 10
_PICTURE = (416.0, 234.0)
"""Width and height of the image [hud px]."""
_EDGE, _GAP = 30.0, 24.0
_ROOM = 0.97
"""Maximum share of the canvas that the page covers."""


@dataclass(frozen=True, slots=True)
class KeyPage:
    """Content of a page.

    Attributes:
        keys: Keys.
        title: Heading, "" for none.
        words: What is to be done, "" for nothing.
        foot: Line at the bottom, "" for none.
        picture: File of an image beside the words, None for none; it is layer 0 of the canvas's images.
    """

    keys: Keys
    title: str = ""
    words: str = ""
    foot: str = ""
    picture: Path | None = None


def draw_keys(hud: Hud, keys: Keys) -> None:
    """Draw the list of keys alone, centred."""
    draw_page(hud, KeyPage(keys))


def draw_page(hud: Hud, page: KeyPage) -> None:
    """Draw a page, centred, smaller where it does not fit."""
    keys = [(translated(key), translated(what)) for key, what in page.keys]
    left = max(hud.measure(key, _SIZE, bold=True) for key, _ in keys)
    right = max(hud.measure(what, _SIZE) for _, what in keys)
    pictured = page.picture is not None and hud.images is not None
    inside = max(left + right + 24.0, _PICTURE[0] + _GAP + 360.0 if pictured else 0.0, 560.0 if page.words else 0.0)
    beside = inside - (_PICTURE[0] + _GAP if pictured else 0.0)
    lines = hud.wrap(translated(page.words), _WORDS, beside, _MOST_LINES)
    text = (_TITLE + 18.0 if page.title else 0.0) + _WORDS_LINE * len(lines)
    head = max(text, _PICTURE[1] if pictured else 0.0)
    head += 20.0 if head else 0.0
    width, height = inside + 2.0 * _EDGE, head + _LINE * len(page.keys) + 44.0 + (40.0 if page.foot else 0.0)
    fits = min(1.0, _ROOM * hud.width / width, _ROOM * hud.height / height)
    x, y = 0.5 * (hud.width - fits * width), 0.5 * (hud.height - fits * height)
    hud.box(x, y, fits * width, fits * height, _PANEL, radius=18.0)
    x, top = x + fits * _EDGE, y + fits * height
    if pictured:
        _, high = _PICTURE
        hud.image((x + fits * (beside + _GAP), top - fits * (24.0 + high), fits * _PICTURE[0], fits * high), 0)
    at = top - fits * (24.0 + 0.8 * _TITLE)
    if page.title:
        sizes = fits * 0.5 * _TITLE, fits * _TITLE
        hud.fitted(x, at, translated(page.title), sizes, fits * beside, INK, bold=True)
        at -= fits * (_TITLE + 18.0)
    for number, line in enumerate(lines):
        hud.text(x, at - fits * _WORDS_LINE * number, line, fits * _WORDS, INK)
    for number, (key, what) in enumerate(keys):
        line_y = top - fits * (head + 44.0 + _LINE * number)
        hud.text(x, line_y, key, fits * _SIZE, INK, bold=True)
        hud.text(x + fits * (24.0 + left), line_y, what, fits * _SIZE, FAINT)
    if page.foot:
        hud.text(x, y + fits * 24.0, translated(page.foot), fits * 20.0, ACCENT, bold=True)
