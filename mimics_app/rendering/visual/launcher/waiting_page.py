"""The page between the choice of a scene and its first picture: what is being done, and a bar that moves."""

from __future__ import annotations

import math

from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT
from mimics_app.rendering.visual.figures.palette import ACCENT, BACK, FAINT, INK, PANEL_LIT
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["WaitingPage"]

_BAR, _RUNNER = 420.0, 110.0
"""Width of the bar, and of what runs to and fro on it [hud px]: nobody knows how long a driver takes."""

_PERIOD_S = 1.6


class WaitingPage:
    """Drawn frame by frame; the caller swaps the surface.

    Args:
        surface: The window.
        title: Of the scene that comes.
    """

    def __init__(self, surface: Surface, title: str) -> None:
        self._canvas = PageSurface(surface)
        self._title = title
        self._frames = 0

    def draw(self, doing: str) -> None:
        """One frame, with what is being done."""
        self._canvas.fit()
        hud, middle = self._canvas.hud, 0.5 * CANVAS_HEIGHT
        x = 0.5 * (hud.width - _BAR)
        hud.clear()
        hud.box(0.0, 0.0, hud.width, CANVAS_HEIGHT, BACK)
        hud.text(0.5 * hud.width, middle + 44.0, self._title, 30.0, INK, bold=True, align="centre")
        hud.box(x, middle, _BAR, 8.0, PANEL_LIT, radius=4.0)
        swing = 0.5 - 0.5 * math.cos(2.0 * math.pi * self._frames / (_PERIOD_S * FRAMES_PER_SECOND))
        hud.box(x + swing * (_BAR - _RUNNER), middle, _RUNNER, 8.0, ACCENT, radius=4.0)
        hud.text(0.5 * hud.width, middle - 36.0, doing, 17.0, FAINT, align="centre")
        hud.text(0.5 * hud.width, 40.0, "Esc: leave", 14.0, FAINT, align="centre")
        self._canvas.draw()
        self._frames += 1
