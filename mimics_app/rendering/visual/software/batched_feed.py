"""Draws in batches: the threads that rasterise start at a flush, and work while further vertices are transformed."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import U4
from mimics_app.rendering.visual.drawing.draw_feed import DrawFeed
from mimics_app.rendering.visual.kernels.commands import MAX_TRIANGLES
from mimics_app.rendering.visual.surfaces.raw_gl import TRIANGLES, RawGL, function_address

if TYPE_CHECKING:
    import moderngl

__all__ = ["FEW_PIXELS_TRIANGLES", "BatchedFeed", "Fence"]

FEW_PIXELS_TRIANGLES = 2_000
"""Number of triangles after which a flush follows in a small picture, which one thread rasterises."""

_FLUSHES_APART = 16
"""Number of flushes after each of which the driver is waited for up to the one before: once 64 are pending, llvmpipe
never draws ahead again."""


_COMMANDS_COMPLETE, _FLUSH = 0x9117, 0x0001
_FOREVER = (1 << 64) - 1

_UINT, _SYNC = ctypes.c_uint, ctypes.c_void_p


class Fence:
    """A fence that is set again and again.

    Args:
        ctx: The context.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        create, delete, wait = (
            function_address(ctx, name) for name in ("glFenceSync", "glDeleteSync", "glClientWaitSync")
        )
        self._create = ctypes.CFUNCTYPE(_SYNC, _UINT, _UINT)(create)
        self._delete = ctypes.CFUNCTYPE(None, _SYNC)(delete)
        self._wait = ctypes.CFUNCTYPE(_UINT, _SYNC, _UINT, ctypes.c_uint64)(wait)
        self._sync: int | None = None

    def set(self) -> None:
        """Set it after the commands so far."""
        self.release()
        self._sync = self._create(_COMMANDS_COMPLETE, 0)

    def wait(self) -> None:
        """Wait until the driver has executed the commands before it; return at once where it was never set."""
        if self._sync is not None:
            self._wait(self._sync, _FLUSH, _FOREVER)

    def release(self) -> None:
        """Delete it."""
        if self._sync is not None:
            self._delete(self._sync)
            self._sync = None


class BatchedFeed(DrawFeed):
    """Flushes after some thousand triangles, within a run of commands too."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._raw, self._fence = RawGL(ctx), Fence(ctx)
        self._waiting, self._most_waiting, self._flushes = 0, MAX_TRIANGLES, 0

    def begin(self, *, few_pixels: bool) -> None:
        self._most_waiting = FEW_PIXELS_TRIANGLES if few_pixels else MAX_TRIANGLES
        self._waiting = 0

    def draw(
        self, array: moderngl.VertexArray, buffer: moderngl.Buffer, first: int, commands: U4, triangles: int
    ) -> None:
        if self._waiting + triangles < self._most_waiting or commands.shape[0] == 1:
            self._waiting += triangles
            array.render_indirect(buffer, TRIANGLES, commands.shape[0], first=first)
            if self._waiting >= self._most_waiting:
                self.flush()
            return
        for begun, count in self._split(commands):
            array.render_indirect(buffer, TRIANGLES, count, first=first + begun)
            if self._waiting >= self._most_waiting:
                self.flush()

    def flush(self) -> None:
        self._flushes = (self._flushes + 1) % _FLUSHES_APART
        self._raw.flush()
        self._waiting = 0
        if self._flushes == 0:
            self._fence.wait()
            self._fence.set()

    def _split(self, commands: U4) -> Iterator[tuple[int, int]]:
        """Yield first command and number of commands of each batch; counts the triangles since the last flush."""
        begun, counts = 0, commands[:, :2].astype(np.int64)
        for number, triangles in enumerate((counts[:, 0] // 3 * counts[:, 1]).tolist(), 1):
            self._waiting += triangles
            if self._waiting >= self._most_waiting or number == len(commands):
                yield begun, number - begun
                begun = number

    def release(self) -> None:
        self._fence.release()
