"""Copies of the shown frames for the operator's page: small, fifteen a second, and only while a page shows them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.shared_memory.newest_bytes import NewestWriter
from mimics_app.contracts.shared_memory.session_memory import PICTURE_SIZE
from mimics_app.rendering.visual.surfaces.frame_reader import FrameReader, ReadFrame
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["OperatorPicture"]

_EVERY = 4
"""Frames from one copy to the next."""


class OperatorPicture:
    """Copies frames of a surface into shared memory; the page's own process compresses them.

    A value is width and height as uint32, then the pixels, RGB, highest row first.

    Args:
        surface: The surface.
        slots: Where the copies go.
        wanted: Whether a page shows them.
    """

    def __init__(self, surface: Surface, slots: NewestWriter, wanted: Callable[[], bool]) -> None:
        self._surface, self._slots, self._wanted = surface, slots, wanted
        self._reader = FrameReader(surface, 1)  # read one copy later: a graphics card has finished it by then
        self._frames = 0

    def take(self, t_ns: int) -> None:
        """Copy the last frame, if it is the turn of one; `t_ns` is the time at which it is shown [ns]."""
        self._frames += 1
        if self._frames % _EVERY or not self._wanted():
            return
        for frame in self._reader.take(t_ns):
            self._write(frame)

    def forget(self) -> None:
        """Drop the copy that was not read yet, after a loss of the surface's context."""
        self._reader = FrameReader(self._surface, 1)

    def release(self) -> None:
        """Free the buffers."""
        self._reader.release()

    def _write(self, frame: ReadFrame) -> None:
        width, height = frame.size
        step = max(-(-width // PICTURE_SIZE[0]), -(-height // PICTURE_SIZE[1]))
        rows = np.frombuffer(frame.pixels, np.uint8).reshape(height, width, 3)
        small = np.ascontiguousarray(rows[::-step, ::step])
        self._slots.write(np.array([small.shape[1], small.shape[0]], "<u4").tobytes(), small.data.cast("B"))
