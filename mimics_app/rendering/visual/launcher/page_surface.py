"""A page that fills a surface: its canvas, drawing and pointer coordinates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, Hud
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.hud import HudPass, plane_of_views
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View

__all__ = ["Box", "PageSurface", "is_within"]

Box = tuple[float, float, float, float]
"""Left, lower edge, width and height [hud px]."""


class PageSurface:
    """Draws a canvas over a whole surface.

    Args:
        surface: Owned by the caller, which polls and swaps it.

    Attributes:
        hud: The canvas.
    """

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self.hud = Hud()
        self._pass = HudPass(surface.ctx, ShaderLibrary(surface.ctx))
        self.fit()

    def fit(self) -> None:
        """Set the canvas to the aspect ratio of the surface; its shorter side has `CANVAS_HEIGHT`."""
        width, height = self._surface.size
        scale = CANVAS_HEIGHT / min(width, height)
        self.hud.width, self.hud.height = scale * width, scale * height

    def draw(self, *, over: bool = False) -> None:
        """Draw the canvas into the surface's framebuffer, `over` what is there."""
        surface = self._surface
        surface.drawn_by = self
        surface.framebuffer.use()
        if not over:
            surface.framebuffer.clear(0.0, 0.0, 0.0, 1.0)
        view = View(np.eye(4), compute_tangents(0.7, surface.size), (0, 0, *surface.size))
        self._pass.draw(self.hud, view, replace(plane_of_views([view], 1.0), canvas_height=self.hud.height))

    def place(self, event: InputEvent) -> tuple[float, float]:
        """Return the position of a pointer event on the canvas [hud px]."""
        return 0.5 * (event.x + 1.0) * self.hud.width, 0.5 * (event.y + 1.0) * self.hud.height

    def release(self) -> None:
        """Free everything but the surface."""
        self._pass.release()


def is_within(place: tuple[float, float], box: Box) -> bool:
    """Whether a point of the canvas is in a box."""
    (x, y), (left, bottom, width, height) = place, box
    return left <= x <= left + width and bottom <= y <= bottom + height
