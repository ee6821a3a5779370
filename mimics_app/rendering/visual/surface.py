"""Something to draw on: a GL context, a framebuffer with depth, and what the person did since the last frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.window_input import GamepadState, InputEvent

if TYPE_CHECKING:
    import moderngl

__all__ = ["Size", "Surface", "release_framebuffer"]

Size = tuple[int, int]


class Surface:
    """A drawable of one backend; this class itself is the offscreen one, whose person never does anything.

    Pictures are always drawn into `framebuffer` (8-bit RGBA in display code values, 24-bit depth), on every backend,
    so that a window shows exactly what an offscreen picture holds; `swap` brings it to the glass where there is one.

    Attributes:
        backend: "window", "egl" or "osmesa".
        ctx: The GL 4.3 core context; current on the thread that made it.
        framebuffer: Where the picture is drawn; replaced when the size changes.
        size: Width and height [px].
        keys: Names of the keys held.
        buttons: Names of the mouse buttons held.
        wheel: Wheel steps away from the person between the last two calls of `poll`.
        gamepad: The first gamepad as of the last `poll`.
    """

    def __init__(self, backend: str, ctx: moderngl.Context, size: Size) -> None:
        self.backend = backend
        self.ctx = ctx
        self.size = size
        self.framebuffer = self._make_framebuffer(size)
        self.keys: frozenset[str] = frozenset()
        self.buttons: frozenset[str] = frozenset()
        self.wheel = 0.0
        self.gamepad = GamepadState()

    def poll(self) -> list[InputEvent]:
        """Return what happened since the last call, oldest first, and refresh keys, buttons, wheel and gamepad."""
        return []

    def pointer(self) -> tuple[float, float] | None:
        """Where the pointer is, right and up in [-1, 1]; None before it first moved over the window."""
        return None

    def swap(self) -> None:
        """Show the picture drawn last."""

    @property
    def should_close(self) -> bool:
        """True once the person asked for the window to close."""
        return False

    def resize(self, size: Size) -> None:
        """Give the framebuffer a new size [px]; its picture is undefined until the next draw."""
        if size == self.size:
            return
        old = self.framebuffer
        self.framebuffer = self._make_framebuffer(size)
        self.framebuffer.use()  # moderngl goes back to the one in use after making another, and that is to be freed
        self.size = size
        release_framebuffer(old)

    def close(self) -> None:
        """Free the context. Nothing of the surface may be used afterwards."""
        self.ctx.release()

    def __enter__(self) -> Surface:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _make_framebuffer(self, size: Size) -> moderngl.Framebuffer:
        return self.ctx.framebuffer([self.ctx.renderbuffer(size, 4)], self.ctx.depth_renderbuffer(size))


def release_framebuffer(framebuffer: moderngl.Framebuffer) -> None:
    """Free a framebuffer with what is attached to it."""
    attachments = [*framebuffer.color_attachments, framebuffer.depth_attachment]
    framebuffer.release()
    for attachment in attachments:
        if attachment is not None:
            attachment.release()
