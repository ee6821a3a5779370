"""The end of a frame: the filters of the world's picture, and what lies over it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from mimics_app.contracts.clock import Clock
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.hud import HudPass
from mimics_app.rendering.visual.stages.kept_board import KeptBoard
from mimics_app.rendering.visual.stages.picture_stage import PictureStage
from mimics_app.rendering.visual.stages.shadow_stage import ShadowStage
from mimics_app.rendering.visual.surfaces.fence import Fence
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.targets import PictureTarget
from mimics_app.rendering.visual.view import View
from mimics_app.world.world import World

if TYPE_CHECKING:
    from mimics_app.rendering.visual.overlay.overlay import Overlay

__all__ = ["FinishStage", "Show", "SubmittedFrame"]

Show = Callable[[int, int], None]
"""Shows the picture that the surface has now, given the times from which on, and until which, the driver was waited for
to draw it [ns]."""


@dataclass(frozen=True, eq=False)
class SubmittedFrame:
    """A frame whose world is submitted to the driver.

    Attributes:
        views: Its views.
        parts: Parts in which it was redrawn; None: all of it.
        world: Its world.
        hud: The heads-up display.
        overlay: The developer's overlay; None where it shows nothing.
        hud_depth: Distance of the display [m].
    """

    views: Sequence[View]
    parts: Sequence[ChangedPart] | None
    world: World
    hud: Hud
    overlay: Overlay | None
    hud_depth: float


@dataclass(frozen=True, eq=False)
class _LeftFrame:
    """A frame that is finished later.

    Attributes:
        frame: The frame.
        framebuffer: Framebuffer of the surface that it was drawn for.
        show: Shows it once it is finished.
    """

    frame: SubmittedFrame
    framebuffer: object
    show: Show


class FinishStage:
    """Finishes frames: at once, or, where a software driver still draws them, when the next one is prepared.

    Args:
        surface: The surface.
        shaders: Shaders of the display's pass.
        picture: Target of the world's picture.
        pictures: Insets over it.
        shadows: Shadow maps, which the developer's overlay shows.
        clock: Clock of the waits.
    """

    def __init__(
        self,
        surface: Surface,
        shaders: ShaderLibrary,
        picture: PictureTarget,
        pictures: PictureStage,
        shadows: ShadowStage,
        clock: Clock,
    ) -> None:
        self._surface, self._picture, self._pictures, self._shadows = surface, picture, pictures, shadows
        self._hud_pass = HudPass(surface.ctx, shaders)
        self._kept_board = KeptBoard(surface, self._hud_pass)
        self._fence, self._clock = Fence(surface.ctx), clock
        self._left: _LeftFrame | None = None

    def leave(self, frame: SubmittedFrame, show: Show) -> None:
        """Leave a frame to `take_left`; `show` shows it once it is finished."""
        self._left = _LeftFrame(frame, self._surface.framebuffer, show)
        self._fence.set()

    def drawn(self, timeout_ns: int) -> bool:
        """Return whether the driver has drawn the frame that was left, after waiting for some time at most [ns].

        True where none was left.
        """
        return self._left is None or self._fence.reached(timeout_ns)

    def take_left(self) -> tuple[SubmittedFrame, Callable[[], None]] | None:
        """Wait for the frame that was left; return it, to be finished now, and what shows it then; None without one.

        It is dropped if the surface has another framebuffer now.
        """
        left, self._left = self._left, None
        if left is None or left.framebuffer is not self._surface.framebuffer:
            return None
        begun_ns = self._clock.now_ns()
        self._fence.wait()
        return left.frame, partial(left.show, begun_ns, self._clock.now_ns())

    def finish(self, frame: SubmittedFrame) -> int:
        """Filter and show the world's picture; draw insets and heads-up display over it at full resolution.

        Returns:
            Draw calls made.
        """
        picture, within = self._picture, self._picture.takes_board
        draws = self._draw_hud(frame) if within else 0
        filtered, written = picture.finish([view.rectangle for view in frame.views], frame.parts)
        alone = not (within or frame.world.insets or frame.overlay is not None)
        over = (frame.hud, frame.views[0], frame.hud_depth)
        if (drawn := self._kept_board.draw(picture.finished, written if alone else None, *over)) is None:
            picture.show(picture.finished)
            self._surface.note_changed(None)
            drawn = 0 if within else self._draw_hud(frame)
        return draws + filtered + drawn

    def release(self) -> None:
        """Drop a frame that was left, and free everything."""
        self._left = None
        self._fence.release()
        self._hud_pass.release()

    def _draw_hud(self, frame: SubmittedFrame) -> int:
        depth, overlay, huds = frame.hud_depth, frame.overlay, [frame.hud]
        draws = self._pictures.draw_insets(frame.world, frame.views, depth)
        if overlay is not None:
            draws += overlay.draw_atlas(self._surface.framebuffer, self._shadows)
            overlay.lay_out(frame.hud.width, frame.hud.height)
            huds.append(overlay.hud)
        return draws + self._hud_pass.draw_over(huds, frame.views, depth)
