"""Texts over the viewer's picture: caption, hint, message, reason for an empty tile, and the page of keys."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.figures.palette import FAINT, INK

__all__ = ["KEYS", "draw_caption", "draw_hint", "draw_message", "draw_reason"]

KEYS: tuple[tuple[str, str], ...] = (
    ("Drag", "orbit; on the selected object or an arrow: move it"),
    ("Shift + drag, middle", "pan"),
    ("Right drag", "look around"),
    ("Wheel", "nearer, farther"),
    ("W A S D, E Q", "fly; Shift: faster"),
    ("F", "fit the selected object, or all, into the picture"),
    ("Home", "first view"),
    ("Click", "select the object under the pointer"),
    ("X  Y  Z", "move along one axis; again: freely"),
    ("Tab", "of a scene: edit it; next panel"),
    ("Ins  Del  Ctrl + D", "add, delete, duplicate an entity"),
    ("Ctrl + Z   Ctrl + Y", "undo, do again"),
    ("Ctrl + S   Ctrl + Shift + S", "save;  save as"),
    ("F8   F9", "next fault;  play the scene as it is now"),
    ("N   P   Space", "next clip, previous clip;  pause it"),
    ("G   L", "floor;  studio light or the model's own"),
    ("F1 - F6", "frame graph, wireframe, bounds, lights, forces, shadow atlas"),
    ("F11   F12", "full screen;  picture to a PNG file"),
    ("H   Esc", "this page;  leave"),
)
"""Keys and their functions, in the order of the page."""

_PANEL: Colour = (0.05, 0.06, 0.08, 0.66)
_WARN: Colour = (0.98, 0.76, 0.40, 1.0)

_ALARM: Colour = (0.98, 0.50, 0.44, 1.0)

_MARGIN, _PAD = 18.0, 16.0
_LINE = 21.0
_MOST_NOTES = 3
_MOST_ISSUES, _REASON_LINES = 4, 5


def draw_caption(hud: Hud, title: str, lines: Sequence[str], notes: Sequence[str] = (), *, scale: float = 1.0) -> None:
    """Draw a caption in the lower left corner.

    Args:
        hud: Display to draw on.
        title: Title of the model or scene.
        lines: Facts about it.
        notes: Notes on it; of many the first ones.
        scale: Factor on the font size.
    """
    shown_notes = list(notes[:_MOST_NOTES])
    if len(notes) > _MOST_NOTES:
        shown_notes[-1] = f"{shown_notes[-1]}, and {len(notes) - _MOST_NOTES} more"
    small, large, step = 15.0 * scale, 22.0 * scale, _LINE * scale
    widest = hud.width - 2.0 * (_MARGIN + _PAD)
    wanted = [hud.measure(title, large, bold=True), *(hud.measure(line, small) for line in (*lines, *shown_notes))]
    width, height = min(max(wanted), widest) + 2.0 * _PAD, 2.0 * _PAD + large + step * (len(lines) + len(shown_notes))
    hud.box(_MARGIN, _MARGIN, width, height, _PANEL, radius=12.0)
    x, y = _MARGIN + _PAD, _MARGIN + height - _PAD - 0.8 * large
    hud.text(x, y, title, large, INK, bold=True, width=widest)
    for number, line in enumerate((*lines, *shown_notes)):
        ink = FAINT if number < len(lines) else _WARN
        hud.text(x, y - step * (number + 1), line, small, ink, width=widest)


def draw_hint(hud: Hud, hint: str) -> None:
    """Draw a hint in the upper left corner."""
    wide = hud.measure(hint, 15.0) + 24.0
    x, top = _MARGIN, hud.height - _MARGIN - 30.0
    hud.box(x, top, wide, 30.0, _PANEL, radius=10.0)
    hud.text(x + 12.0, top + 10.0, hint, 15.0, FAINT)


def draw_reason(hud: Hud, title: str, verdict: str, issues: Sequence[Issue], scale: float) -> None:
    """Draw the reason for the lack of a picture, over the whole canvas."""
    small, large = 15.0 * scale, 22.0 * scale
    width = hud.width - 2.0 * (_MARGIN + _PAD)
    x, y = _MARGIN + _PAD, hud.height - _MARGIN - _PAD - large
    hud.text(x, y, title, large, INK, bold=True, width=width)
    hud.text(x, y - 1.6 * large, verdict, small, _ALARM, bold=True)
    y -= 1.8 * large
    for issue in issues[:_MOST_ISSUES]:
        place = f"{issue.pointer}: " if issue.pointer else ""
        for line in hud.wrap(f"{place}{issue.what}", small, width, _REASON_LINES):
            y -= 1.35 * small
            hud.text(x, y, line, small, FAINT)
        y -= 0.5 * small
    if len(issues) > _MOST_ISSUES:
        hud.text(x, y - 1.35 * small, f"and {len(issues) - _MOST_ISSUES} more", small, FAINT)


def draw_message(hud: Hud, text: str, *, alarm: bool = False) -> None:
    """Draw a message below the centre; "" draws nothing."""
    if not text:
        return
    width = min(hud.measure(text, 19.0) + 48.0, hud.width - 2.0 * _MARGIN)
    x = 0.5 * (hud.width - width)
    hud.box(x, 132.0, width, 46.0, (0.50, 0.09, 0.08, 0.90) if alarm else _PANEL, radius=14.0)
    hud.text(0.5 * hud.width, 148.0, text, 19.0, INK, align="centre", width=width - 32.0)
