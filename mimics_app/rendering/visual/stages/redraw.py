"""What of a picture is drawn again from frame to frame."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.drawing.draw_list import DrawList
from mimics_app.rendering.visual.drawing.frame_buffers import FrameBuffers
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.stages.picture_stage import PictureStage
from mimics_app.rendering.visual.stages.world_stage import FrameScene, ViewDraws
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["Inside", "Redraw"]

Inside = Callable[[FrameScene, View, Hashable], ViewDraws]
"""Queues what is visible in a mirror, screen or inset, given the view and its key."""


class Redraw:
    """On a graphics card all of it is drawn again: to find out what changed costs more.

    Args:
        listed: The draw list.
        frame: Buffers of the frame.
        pictures: Mirrors, screens and insets.
        sparse: True where frames are far apart in time.

    Attributes:
        keeps: Whether the picture of this frame is kept for the next one.
        only_sprites: Whether the last one is kept, and nothing but sprites has changed since.
    """

    def __init__(self, listed: DrawList, frame: FrameBuffers, pictures: PictureStage, *, sparse: bool) -> None:
        self.keeps = self.only_sprites = False

    def forget(self) -> None:
        """Discard the last frame."""

    def find(
        self, scene: FrameScene, views: Sequence[View], place: Rect, shaders: int, hud: Hud
    ) -> list[ChangedPart] | None:
        """Return the parts in which a frame differs from the last one; None: redraw all of it.

        Args:
            scene: World, light and settings of the frame.
            views: Its views; none where something is drawn that is not compared.
            place: Rectangle of the first one in the target [px].
            shaders: Number of programs replaced by reloads so far.
            hud: The heads-up display.
        """
        return None

    def queue(
        self, scene: FrameScene, view: View, place: Rect, parts: Sequence[ChangedPart], samples: int, inside: Inside
    ) -> list[ViewDraws]:
        """Queue what is visible in parts of the only view, and in what changed of the pictures within it.

        Args:
            scene: World, light and settings of the frame.
            view: The view.
            place: Its rectangle in the target [px].
            parts: The parts that `find` returned; at least one.
            samples: Samples per pixel.
            inside: Queues what is visible in a picture within the view.
        """
        return []
