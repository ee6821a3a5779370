"""A setting as a row of a page: its caption, its value, and arrows where it has choices."""

from __future__ import annotations

from mimics_app.contracts.system.language import translated
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, FAINT, INK, PANEL, PANEL_LIT
from mimics_app.rendering.visual.launcher.page_surface import Box
from mimics_app.rendering.visual.launcher.setting import Setting

__all__ = ["draw_setting"]

_ARROWS = 64.0
"""Width of a row that its arrows take [hud px]."""
_CAPTION, _VALUE = (11.5, 14.0), (15.0, 17.0)
"""Sizes of caption and value, in a low row and in a high one [hud px]."""
_HIGH, _LEAST_CAPTION, _LEAST_VALUE = 44.0, 8.5, 11.0
"""Height from which a row is high, and least sizes [hud px]."""


def draw_setting(hud: Hud, box: Box, setting: Setting, value: str, *, focused: bool, refused: bool = False) -> None:
    """Draw a setting into its box; a value that is refused, or a field that is empty, is faint."""
    x, y, width, height = box
    hud.box(*box, PANEL_LIT if focused else PANEL, radius=12.0)
    high = int(height >= _HIGH)
    caption, largest = translated(setting.label), _CAPTION[high]
    room = width - (_ARROWS if setting.choices and high else 16.0)
    size = min(largest, max(_LEAST_CAPTION, largest * room / max(hud.measure(caption, largest), 1.0)))
    hud.text(
        x + 0.5 * width,
        y + height - largest - (1.5 + 2.5 * high),
        caption,
        size,
        FAINT,
        align="centre",
        width=width - 8.0,
    )
    words, room = setting.words(value) + ("|" if setting.typed and focused else ""), width - _ARROWS
    largest = _VALUE[high]
    size = min(largest, max(_LEAST_VALUE, largest * room / max(hud.measure(words, largest, bold=True), 1.0)))
    if setting.typed:  # of a long text the end is seen, where it is typed
        while len(words) > 1 and hud.measure(words, size, bold=True) > room:
            words = "…" + words.removeprefix("…")[1:]
    colour = INK if (value or not setting.typed) and not refused else FAINT
    hud.text(x + 0.5 * width, y + 0.19 * height, words, size, colour, bold=True, align="centre", width=room)
    if setting.choices:
        arrow = ACCENT if focused else FAINT
        hud.text(x + 20.0, y + 0.5 * height - 7.0, "◀", 16.0, arrow, align="centre")
        hud.text(x + width - 20.0, y + 0.5 * height - 7.0, "▶", 16.0, arrow, align="centre")
    if focused:
        hud.box(*box, ACCENT, radius=12.0, border=2.5)
