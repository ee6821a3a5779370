"""The page between the choice of a scene and its first picture: the present step, and an indeterminate progress bar."""

from __future__ import annotations

import math

from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.figures.palette import ACCENT, BACK, FAINT, INK, PANEL_LIT
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["WaitingPage"]

_BAR, _RUNNER = 420.0, 110.0
"""Widths of the bar and of the runner on it [hud px]; the duration is unknown, as it depends on the driver."""

_PERIOD_S = 1.6
_MARGIN = 24.0


class WaitingPage:
    """Drawn frame by frame; the caller swaps the surface.

    Args:
        surface: The window.
        title: Title of the scene.
    """

    def __init__(self, surface: Surface, title: str) -> None:
        self._canvas = PageSurface(surface)
        self._title = title
        self._frames = 0

    def draw(self, doing: str, *, leaves: bool = True) -> None:
        """Draw one frame with a description of the present step, and of Escape where it `leaves`."""
        self._canvas.fit()
        hud, centre = self._canvas.hud, 0.5 * self._canvas.hud.height
        x = 0.5 * (hud.width - _BAR)
        hud.clear()
        hud.box(0.0, 0.0, hud.width, hud.height, BACK)
        title, room = translated(self._title), hud.width - 2.0 * _MARGIN
        hud.fitted(0.5 * hud.width, centre + 44.0, title, (14.0, 30.0), room, INK, bold=True, align="centre")
        hud.box(x, centre, _BAR, 8.0, PANEL_LIT, radius=4.0)
        swing = 0.5 - 0.5 * math.cos(2.0 * math.pi * self._frames / (_PERIOD_S * FRAMES_PER_SECOND))
        hud.box(x + swing * (_BAR - _RUNNER), centre, _RUNNER, 8.0, ACCENT, radius=4.0)
        hud.text(0.5 * hud.width, centre - 36.0, translated(doing), 17.0, FAINT, align="centre")
        if leaves:
            hud.text(0.5 * hud.width, 40.0, translated(phrase("Esc: leave")), 14.0, FAINT, align="centre")
        self._canvas.draw()
        self._frames += 1

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()
