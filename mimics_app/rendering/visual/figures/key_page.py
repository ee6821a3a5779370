"""A page of keys over the middle of the picture."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, Colour, Hud
from mimics_app.rendering.visual.figures.palette import FAINT, INK

__all__ = ["Keys", "draw_keys"]

Keys = Sequence[tuple[str, str]]
"""Keys, and what each does, in the order they are listed."""

_PANEL: Colour = (0.05, 0.06, 0.08, 0.88)
_LINE, _SIZE = 30.0, 17.0


def draw_keys(hud: Hud, keys: Keys) -> None:
    """All keys, in the middle."""
    left = max(hud.measure(key, _SIZE, bold=True) for key, _ in keys)
    right = max(hud.measure(what, _SIZE) for _, what in keys)
    width, height = left + right + 84.0, _LINE * len(keys) + 44.0
    x, y = 0.5 * (hud.width - width), 0.5 * (CANVAS_HEIGHT - height)
    hud.box(x, y, width, height, _PANEL, radius=18.0)
    for number, (key, what) in enumerate(keys):
        line = y + height - 44.0 - _LINE * number
        hud.text(x + 30.0, line, key, _SIZE, INK, bold=True)
        hud.text(x + 54.0 + left, line, what, _SIZE, FAINT)
