"""The page of keys in the centre of the picture."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.figures.palette import FAINT, INK

__all__ = ["Keys", "draw_keys"]

Keys = Sequence[tuple[str, str]]
"""Keys with their functions, in the order listed."""

_PANEL: Colour = (0.05, 0.06, 0.08, 0.97)
"""Hardly any text of the page behind it shows through."""
_LINE, _SIZE = 30.0, 17.0
_ROOM = 0.97
"""Maximum share of the canvas that the page covers."""


def draw_keys(hud: Hud, keys: Keys) -> None:
    """Draw the list of keys, centred."""
    left = max(hud.measure(key, _SIZE, bold=True) for key, _ in keys)
    right = max(hud.measure(what, _SIZE) for _, what in keys)
    width, height = left + right + 84.0, _LINE * len(keys) + 44.0
    fits = min(1.0, _ROOM * hud.width / width, _ROOM * hud.height / height)
    x, y = 0.5 * (hud.width - fits * width), 0.5 * (hud.height - fits * height)
    hud.box(x, y, fits * width, fits * height, _PANEL, radius=18.0)
    for number, (key, what) in enumerate(keys):
        line = y + fits * (height - 44.0 - _LINE * number)
        hud.text(x + fits * 30.0, line, key, fits * _SIZE, INK, bold=True)
        hud.text(x + fits * (54.0 + left), line, what, fits * _SIZE, FAINT)
