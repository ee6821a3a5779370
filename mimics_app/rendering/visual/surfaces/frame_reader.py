"""Asynchronous read-back of pictures, a frame or two later, without stalling the frame."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.surface import Size, Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["FrameReader", "ReadFrame"]


@dataclass(frozen=True, slots=True)
class ReadFrame:
    """One picture: display time [ns], size [px], and display values, RGB rows from the bottom up."""

    t_ns: int
    size: Size
    pixels: bytes


class FrameReader:
    """Copies each picture into a pixel buffer, and reads the buffer some frames later.

    Args:
        surface: Surface to read.
        behind: Frames between drawing and reading; 0 reads at once.

    Attributes:
        behind: Frames between drawing and reading.
    """

    def __init__(self, surface: Surface, behind: int = 2) -> None:
        self._surface = surface
        self.behind = behind
        self._free: list[moderngl.Buffer] = []
        self._waiting: deque[tuple[int, Size, moderngl.Buffer]] = deque()

    def take(self, t_ns: int) -> list[ReadFrame]:
        """Copy the picture drawn last, with its display time [ns]; return those that are due, usually an older one."""
        size = self._surface.size
        self._waiting.append((t_ns, size, self._copy(size)))
        return self._read(self.behind)

    def flush(self) -> list[ReadFrame]:
        """Read and return all pictures not read yet."""
        return self._read(0)

    def release(self) -> None:
        """Free the buffers; pictures not read yet are lost."""
        for buffer in (*self._free, *(each[2] for each in self._waiting)):
            buffer.release()
        self._free.clear()
        self._waiting.clear()

    def _copy(self, size: Size) -> moderngl.Buffer:
        wanted = 3 * size[0] * size[1]
        while self._free and self._free[-1].size != wanted:
            self._free.pop().release()  # of a size that the surface no longer has
        buffer = self._free.pop() if self._free else self._surface.ctx.buffer(reserve=wanted)
        self._surface.framebuffer.read_into(buffer, components=3, alignment=1)
        return buffer

    def _read(self, left: int) -> list[ReadFrame]:
        ready = []
        while len(self._waiting) > left:
            t_ns, size, buffer = self._waiting.popleft()
            ready.append(ReadFrame(t_ns, size, buffer.read()))
            self._free.append(buffer)
        return ready
