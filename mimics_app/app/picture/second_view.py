"""A small picture of another view for the operator's page, drawn a few times a second after the person's own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mimics_app.app.picture.around_hand import AROUND, around
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.shared_memory.newest_bytes import NewestWriter
from mimics_app.contracts.shared_memory.session_memory import SECOND_PICTURE_SIZE
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.frame_reader import FrameReader, ReadFrame
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["SecondView"]

_EVERY = 12
"""Frames from one picture to the next: 5 a second."""


class SecondView:
    """Draws a view of the session's world into shared memory, without shadows, board, and smoothed edges.

    Nothing is made before a view is wanted. A value is as that of `OperatorPicture`.

    Args:
        surface: Surface of the person's picture, whose context is used.
        person: Renderer of that picture.
        slots: Where the pictures go.
        wanted: Returns the name of the view to draw, one of the scene's or of `AROUND`; "": none.
        hand: Returns the position of the hand, world [m], float64 [3].
    """

    def __init__(
        self,
        surface: Surface,
        person: Renderer,
        slots: NewestWriter,
        wanted: Callable[[], str],
        hand: Callable[[], F8],
    ) -> None:
        self._surface, self._person, self._slots, self._wanted, self._hand = surface, person, slots, wanted, hand
        self._made: tuple[EyeBuffer, Renderer, FrameReader] | None = None
        self._frames = 0

    def take(self, t_ns: int) -> None:
        """Draw the wanted view, if it is its turn; `t_ns` is the time of the person's picture [ns]."""
        self._frames += 1
        view = self._wanted() if self._frames % _EVERY == 0 else ""
        if not view:
            return
        world = self._person.world
        camera = next((each for each in world.cameras if each.node.name == view), None)
        if camera is None and view not in AROUND:  # a reloaded scene has lost it
            return
        buffer, renderer, reader = self._made or self._make()
        renderer.world = world
        seen = desktop_views(camera or world.cameras[0], buffer.size)
        if camera is None:
            seen = [replace(each, world_from_eye=around(view, each.world_from_eye, self._hand())) for each in seen]
        renderer.draw(seen)
        for frame in reader.take(t_ns):
            self._write(frame)

    def forget(self) -> None:
        """Drop what was made, after a loss of the surface's context."""
        self._made = None

    def release(self) -> None:
        """Free everything that was made."""
        if self._made is not None:
            _, renderer, reader = self._made
            reader.release()
            renderer.release()
            self._made = None

    def _make(self) -> tuple[EyeBuffer, Renderer, FrameReader]:
        buffer = EyeBuffer(self._surface, SECOND_PICTURE_SIZE)
        plain = replace(
            self._person.settings, msaa=0, fxaa=False, shadow_size=0, bloom=0.0, ambient_occlusion=0.0, scale=1.0
        )
        self._made = buffer, Renderer(buffer, self._person.world, plain), FrameReader(buffer, 1)
        return self._made

    def _write(self, frame: ReadFrame) -> None:
        rows = np.frombuffer(frame.pixels, np.uint8).reshape(frame.size[1], frame.size[0], 3)
        self._slots.write(np.array(frame.size, "<u4").tobytes(), np.ascontiguousarray(rows[::-1]).data.cast("B"))
