"""What lies behind the sprites that change."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl

__all__ = ["Backdrop"]


class Backdrop:
    """A graphics card draws it with everything else, in every frame.

    Args:
        ctx: Context of the pictures.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        """Keep nothing."""

    def begin(self, *, same: bool) -> bool:
        """Begin a frame; return whether its sprites are to be split into those of the backdrop and the others.

        Args:
            same: Whether nothing but sprites has changed since the last frame.
        """
        return False

    def use(self, sprites: bytes) -> bool:
        """Use it in this frame, with some sprites that belong to it; return whether it is kept from another one."""
        return False

    def draw(self, target: moderngl.Framebuffer, draw: Callable[[], int]) -> int:
        """Bring it into a target; return the draw calls. Changes the framebuffer in use.

        Args:
            target: The target.
            draw: Draws it, and returns the draw calls.
        """
        return draw()

    def release(self) -> None:
        """Free what is kept."""
