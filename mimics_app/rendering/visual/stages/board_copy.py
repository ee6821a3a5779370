"""The heads-up display over a finished picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.passes.hud import HudPass
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    import moderngl

__all__ = ["BoardCopy"]


class BoardCopy:
    """Updates a surface that shows the last frame; with a graphics card it is copied and drawn as a whole.

    Args:
        surface: The surface.
        hud_pass: Draws the display.
    """

    def __init__(self, surface: Surface, hud_pass: HudPass) -> None:
        """Keep nothing."""

    def draw(
        self,
        finished: moderngl.Framebuffer | None,
        parts: Sequence[ChangedPart] | None,
        hud: Hud,
        view: View,
        depth: float,
        enlarged: float,
    ) -> int | None:
        """Copy what changed of a picture to the surface, and draw the display over that and where it changed itself.

        Args:
            finished: The picture without the display; None where that is the surface's already.
            parts: Parts of it that changed since the last frame; None: all of it, or it is not for this class to draw.
            hud: The display.
            view: The only view of the picture.
            depth: Distance of the display [m].
            enlarged: Factor on its size.

        Returns:
            Draw calls made; None where all of it has to be copied and drawn.
        """
        return None
