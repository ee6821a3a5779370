"""How draws are handed to the driver."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import U4
from mimics_app.rendering.visual.surfaces.raw_gl import TRIANGLES

if TYPE_CHECKING:
    import moderngl

__all__ = ["DrawFeed"]


class DrawFeed:
    """Draws of a frame, each in one call; a graphics card begins them when it likes.

    Args:
        ctx: Context of the draws.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        """Keep nothing."""

    def begin(self, *, few_pixels: bool) -> None:
        """Begin a frame, of a picture of few pixels or of many."""

    def draw(
        self, array: moderngl.VertexArray, buffer: moderngl.Buffer, first: int, commands: U4, triangles: int
    ) -> None:
        """Draw successive commands.

        Args:
            array: The vertex array.
            buffer: Buffer of commands.
            first: Number of the first of them in the buffer.
            commands: The commands, uint32 [n, `COMMAND_WORDS`].
            triangles: Triangles of all of them.
        """
        array.render_indirect(buffer, TRIANGLES, commands.shape[0], first=first)

    def flush(self) -> None:
        """Let the driver start what was drawn so far, while the caller prepares the next draws."""

    def release(self) -> None:
        """Free what the feed owns."""
