"""The figures over the picture: progress and time above, contacts and force below, one line of words in the middle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, Colour, Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, FAINT, INK

__all__ = ["draw_board"]

_PANEL: Colour = (0.06, 0.08, 0.11, 0.62)
_CALM: Colour = (0.36, 0.78, 0.47, 1.0)
_WARN: Colour = (0.96, 0.62, 0.16, 1.0)
_ALARM: Colour = (0.90, 0.22, 0.20, 1.0)

_MARGIN = 22.0
_HEIGHT = 62.0
_STOPPED = "stopped"

_RIGHT: Colour = (0.36, 0.78, 0.47, 0.34)
_GRASP_ROOM = 1.4
"""The bar of the grip goes up to this many times what is right at most."""

_MOST_SHOWN = 9.99
_NARROW = 0.25
"""Below this margin a wall is near its limit: the rule itself may be off by as much."""
_SOFTENED = 0.995
"""A larger share of the authored stiffness is shown as all of it."""
_LEAK = 1e-4
"""Energy [J] a contact may give before it is shown as a fault: less cannot be felt."""


def draw_board(hud: Hud, figures: Mapping[str, object], show: Sequence[str], force_full: float) -> None:
    """Lay the task's figures over the picture.

    Args:
        hud: What to draw on; cleared first.
        figures: `TaskOrders.hud`: title, message, state, trial, progress, time, time_limit, contacts, force, score;
            margin [-] with energy [J] of the haptic loop's stability monitor, and stiffness_share 0-1 of its cap; where
            something is carried also grasp, grasp_least and grasp_most [N], placed and drops.
        show: Names of the figures wanted, in the order of the scene.
        force_full: Force that fills the bar [N].
    """
    hud.clear()
    x = _MARGIN
    for name in show:
        width = _WIDTHS.get(name, 150.0)
        y = CANVAS_HEIGHT - _MARGIN - _HEIGHT
        hud.box(x, y, width, _HEIGHT, _PANEL, radius=12.0)
        _draw_figure(hud, name, figures, (x + 16.0, y + 12.0, width - 32.0), force_full)
        x += width + 12.0
    _draw_message(hud, str(figures.get("message", "")), alarm=figures.get("state") == _STOPPED)


_WIDTHS = {
    "progress": 290.0,
    "force": 290.0,
    "time": 150.0,
    "contacts": 150.0,
    "score": 130.0,
    "state": 170.0,
    "margin": 220.0,
    "grasp": 250.0,
    "placed": 130.0,
    "drops": 120.0,
}


def _draw_figure(
    hud: Hud, name: str, figures: Mapping[str, object], place: tuple[float, float, float], force_full: float
) -> None:
    x, y, width = place
    label, text = _LABELS.get(name, name.capitalize()), _text(name, figures)
    hud.text(x, y + 27.0, label, 15.0, FAINT)
    if name in _DRAWN:
        _DRAWN[name](hud, figures, place)
        return
    if name not in ("progress", "force"):
        hud.text(x, y, text, 25.0, INK, bold=True, width=width)
        return
    hud.text(x + width, y + 27.0, text, 17.0, INK, bold=True, align="right")
    share = _number(figures, name) / (force_full if name == "force" else 1.0)
    hud.bar((x, y + 4.0, width, 11.0), share, ACCENT if name == "progress" else _force_colour(share))


_LABELS = {
    "progress": "Tunnel",
    "time": "Time",
    "contacts": "Wall contacts",
    "force": "Force on the hand",
    "margin": "Stability",
    "grasp": "Grip",
    "placed": "Placed",
}


def _text(name: str, figures: Mapping[str, object]) -> str:
    value = _number(figures, name)
    if name == "progress":
        return f"{100.0 * value:.0f} %"
    if name == "time":
        return f"{value:.1f} s"
    if name == "force":
        return f"{value:.1f} N"
    if name in ("contacts", "score", "placed", "drops"):
        return f"{value:.0f}"
    return str(figures.get(name, ""))


def _draw_margin(hud: Hud, figures: Mapping[str, object], place: tuple[float, float, float]) -> None:
    """How much stiffer the wall might be before it may swing up, and the energy of the newest contact.

    Where the wall is softened to stay stable, the share of its stiffness that is left stands instead.
    """
    x, y, width = place
    margin, energy = _number(figures, "margin"), _number(figures, "energy")
    text = f"{100.0 * min(margin, _MOST_SHOWN):+.0f} %" if margin < _MOST_SHOWN else f"> {100.0 * _MOST_SHOWN:.0f} %"
    colour = _margin_colour(margin)
    share = figures.get("stiffness_share")
    if isinstance(share, float) and share < _SOFTENED:
        text, colour = f"soft {100.0 * share:.0f} %", _WARN
    hud.text(x, y, text, 25.0, colour, bold=True, width=0.62 * width)
    hud.text(x + width, y + 4.0, f"{1e3 * energy:.1f} mJ", 17.0, _ALARM if energy < -_LEAK else FAINT, align="right")


def _draw_grasp(hud: Hud, figures: Mapping[str, object], place: tuple[float, float, float]) -> None:
    """The grasp force on a bar that shows between which two forces it is right."""
    x, y, width = place
    grasp, least, most = (_number(figures, name) for name in ("grasp", "grasp_least", "grasp_most"))
    full = _GRASP_ROOM * most if most > 0.0 else 1.0
    right = least <= grasp <= most
    hud.text(x + width, y + 27.0, f"{grasp:.1f} N", 17.0, INK, bold=True, align="right")
    left, wide = x + width * least / full, width * (most - least) / full
    hud.box(left, y - 1.0, wide, 21.0, _RIGHT, radius=4.0)
    hud.bar((x, y + 4.0, width, 11.0), grasp / full, _CALM if right else ACCENT if grasp < least else _WARN)


def _margin_colour(margin: float) -> Colour:
    if margin < 0.0:
        return _ALARM
    return _WARN if margin < _NARROW else _CALM


def _number(figures: Mapping[str, object], name: str) -> float:
    value = figures.get(name)
    return float(value) if isinstance(value, int | float) else 0.0


def _force_colour(share: float) -> Colour:
    if share < 0.4:
        return _CALM
    return _WARN if share < 0.8 else _ALARM


def _draw_message(hud: Hud, message: str, *, alarm: bool) -> None:
    if not message:
        return
    size = 30.0
    width = min(hud.measure(message, size, bold=True) + 64.0, hud.width - 2.0 * _MARGIN)
    x, y = 0.5 * (hud.width - width), 46.0
    hud.box(x, y, width, 64.0, (0.55, 0.08, 0.08, 0.86) if alarm else _PANEL, radius=18.0)
    hud.text(0.5 * hud.width, y + 21.0, message, size, INK, bold=True, align="centre", width=width - 32.0)


_DRAWN = {"margin": _draw_margin, "grasp": _draw_grasp}
"""Figures that are more than a number or a bar."""
