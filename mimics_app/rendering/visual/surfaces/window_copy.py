"""Copy of a picture to a window."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.raw_gl import RawGL

if TYPE_CHECKING:
    import moderngl

    from mimics_app.contracts.ports.display_port import Rect

__all__ = ["WindowCopy"]


class WindowCopy:
    """Copies a picture to the back buffer of a window, which has no depth.

    Args:
        ctx: Context of the window.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._gl = RawGL(ctx)

    def present(self, picture: moderngl.Framebuffer, changed: Sequence[Rect] | None) -> None:
        """Copy a picture, and use its framebuffer.

        Args:
            picture: Framebuffer of the picture, of the window's size, with a texture.
            changed: All rectangles that differ from the last one [px]; None: the whole picture.
        """
        whole = (0, 0, *picture.size)
        self._gl.blit(picture.glo, 0, [(whole, whole)])
        picture.use()
