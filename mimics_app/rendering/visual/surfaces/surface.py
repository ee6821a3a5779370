"""Something to draw on: a GL context, a framebuffer with depth, and what the person did since the last frame."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.window_input import GamepadState, InputEvent

if TYPE_CHECKING:
    import moderngl

    from mimics_app.contracts.display_port import WindowPlace
    from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows

__all__ = ["ResetStatus", "Size", "Surface", "release_framebuffer"]

Size = tuple[int, int]


_NAMES = ("glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR", "glGetGraphicsResetStatusARB")
"""Of one function: OpenGL 4.5, KHR_robustness, ARB_robustness."""

_WORDS = {
    0x8253: "this program made the driver hang",
    0x8254: "another program made the driver hang",
    0x8255: "the driver was reset",
}


class ResetStatus:
    """Asks a context; a driver that cannot be asked is taken to be well."""

    def __init__(self, ctx: moderngl.Context) -> None:
        loader: Any = ctx.mglo._context  # what moderngl loads its own functions with
        address = next((found for name in _NAMES if (found := loader.load_opengl_function(name))), 0)
        self._ask = ctypes.CFUNCTYPE(ctypes.c_uint)(address) if address else None

    def __call__(self) -> str:
        """What happened to the context, in words; "" while it is well."""
        if self._ask is None:
            return ""
        status = self._ask()
        return _WORDS.get(status, f"the driver says 0x{status:x}") if status else ""


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
        gamepad: The first gamepad as of the last `poll`.
        both_eyes: Both eyes' pictures side by side, for a window that has a buffer for each; None elsewhere.
        reset_status: Says in words what made the driver lose the context; "" while it is well.
    """

    def __init__(self, backend: str, ctx: moderngl.Context, size: Size) -> None:
        self.backend = backend
        self.size = size
        self.framebuffer: moderngl.Framebuffer
        self._take(ctx)
        self.both_eyes: moderngl.Framebuffer | None = None
        self.keys: frozenset[str] = frozenset()
        self.buttons: frozenset[str] = frozenset()
        self.gamepad = GamepadState()

    @property
    def driver(self) -> str:
        """Version of OpenGL and the driver's name for itself, for people."""
        info = self.ctx.info
        return f"{info['GL_VERSION']}, {info['GL_RENDERER']}"

    def poll(self) -> list[InputEvent]:
        """Return what happened since the last call, oldest first, and refresh keys, buttons and gamepad."""
        return []

    def pointer(self) -> tuple[float, float] | None:
        """Where the pointer is, right and up in [-1, 1]; None before it first moved over the window."""
        return None

    def open_beside(self, places: Sequence[WindowPlace], size: Size) -> WallWindows | None:
        """Open further windows; None where there is no desktop.

        Args:
            places: Of the windows.
            size: Of one whose place says none [px].

        Raises:
            DeviceError: the display gives no further window.
        """
        return None

    def swap(self) -> None:
        """Show the picture drawn last."""

    @property
    def should_close(self) -> bool:
        """True once the person requested the window to close."""
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

    def renew(self) -> None:
        """Put a new context in the place of one that was lost, and with it a new framebuffer; nothing else is kept.

        Raises:
            DeviceError: the driver gives none any more.
        """
        raise DeviceError(f"a surface of {self.backend} cannot be made anew", "start again")

    def close(self) -> None:
        """Free the context. Nothing of the surface may be used afterwards."""
        self.ctx.release()

    def __enter__(self) -> Surface:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _take(self, ctx: moderngl.Context) -> None:
        """Draw in a context from here on."""
        self.ctx = ctx
        self.framebuffer = self._make_framebuffer(self.size)
        self.reset_status: Callable[[], str] = ResetStatus(ctx)

    def _make_framebuffer(self, size: Size) -> moderngl.Framebuffer:
        return self.ctx.framebuffer([self.ctx.renderbuffer(size, 4)], self.ctx.depth_renderbuffer(size))


def release_framebuffer(framebuffer: moderngl.Framebuffer) -> None:
    """Free a framebuffer with what is attached to it."""
    attachments = [*framebuffer.color_attachments, framebuffer.depth_attachment]
    framebuffer.release()
    for attachment in attachments:
        if attachment is not None:
            attachment.release()
