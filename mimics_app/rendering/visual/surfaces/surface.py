"""Surfaces to draw on: a GL context, a framebuffer with depth, and the input events of its window."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.rendering.visual.surfaces.picture_texture import make_picture_texture
from mimics_app.rendering.visual.surfaces.raw_gl import function_address

if TYPE_CHECKING:
    import moderngl

    from mimics_app.contracts.ports.display_port import WindowPlace
    from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows

__all__ = ["Place", "ResetStatus", "Size", "Surface", "release_framebuffer"]

Size = tuple[int, int]


class Place(NamedTuple):
    """Place of a window on the desktop.

    Attributes:
        x, y: Upper left corner of its content [px].
        width, height: Size that a person gave it, full screen aside [px]; 0 for none.
        whole: Whether it fills the screen.
    """

    x: int
    y: int
    width: int = 0
    height: int = 0
    whole: bool = False

    @classmethod
    def of(cls, numbers: Sequence[int]) -> Place:
        """Return the place whose five fields are given as numbers."""
        x, y, width, height, whole = numbers
        return cls(x, y, width, height, bool(whole))


_NAMES = ("glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR", "glGetGraphicsResetStatusARB")
"""Names of one function: OpenGL 4.5, KHR_robustness, ARB_robustness."""

_WORDS = {
    0x8253: "this program made the driver hang",
    0x8254: "another program made the driver hang",
    0x8255: "the driver was reset",
}


class ResetStatus:
    """Reset status of a context; always "" for a driver that cannot report it."""

    def __init__(self, ctx: moderngl.Context) -> None:
        address = next((found for name in _NAMES if (found := function_address(ctx, name))), 0)
        self._ask = ctypes.CFUNCTYPE(ctypes.c_uint)(address) if address else None

    def __call__(self) -> str:
        """Return what happened to the context, in words; "" while it works."""
        if self._ask is None:
            return ""
        status = self._ask()
        return _WORDS.get(status, f"the driver says 0x{status:x}") if status else ""


class Surface:
    """A drawable of one backend; this class itself is the offscreen one, without input.

    On every backend pictures are drawn into `framebuffer` (8-bit RGBA display values, 24-bit depth), so that a window
    shows exactly the pixels of an offscreen picture; `swap` shows it in a window.

    Attributes:
        backend: "window", "egl" or "osmesa".
        ctx: The GL 4.3 core context; current on the thread that created it.
        framebuffer: Framebuffer of the picture; replaced when the size changes.
        size: Width and height [px].
        keys: Names of the keys held.
        buttons: Names of the mouse buttons held.
        gamepad: The first gamepad as of the last `poll`.
        drawn_by: Who drew the picture and updates it in parts, unless another has drawn since; else None.
        both_eyes: Both eyes' pictures side by side, for a quad-buffered window; None elsewhere.
        reset_status: Returns why the context was lost, in words; "" while it works.
    """

    def __init__(self, backend: str, ctx: moderngl.Context, size: Size) -> None:
        self.backend = backend
        self.size = size
        self.framebuffer: moderngl.Framebuffer
        self._take(ctx)
        self.drawn_by: object = None
        self.both_eyes: moderngl.Framebuffer | None = None
        self.keys: frozenset[str] = frozenset()
        self.buttons: frozenset[str] = frozenset()
        self.gamepad = GamepadState()

    @property
    def driver(self) -> str:
        """Version of OpenGL and name of the renderer, for people."""
        info = self.ctx.info
        return f"{info['GL_VERSION']}, {info['GL_RENDERER']}"

    def poll(self) -> list[InputEvent]:
        """Return the events since the last call, oldest first, and update keys, buttons and gamepad."""
        return []

    @property
    def resized_to(self) -> Size | None:
        """Size that a person gave the window, full screen aside; None without one."""
        return None

    @property
    def place(self) -> Place | None:
        """Place of the window on the desktop; None without one."""
        return None

    def move_to(self, place: Place) -> None:
        """Move the window to the place of another; its size changes only where a person gave the other one a size."""

    def hide(self) -> None:
        """Take the window off the desktop; it continues to exist."""

    def show(self) -> None:
        """Put a hidden window back on the desktop; what happened to it before is forgotten."""

    def pointer(self) -> tuple[float, float] | None:
        """Return the pointer's position, right and up in [-1, 1]; None before it first moved over the window."""
        return None

    def open_beside(self, places: Sequence[WindowPlace], size: Size) -> WallWindows | None:
        """Open further windows; return None without a desktop.

        Args:
            places: Titles, positions and sizes of the windows.
            size: Size of a window whose place has none [px].

        Raises:
            DeviceError: a window cannot be opened.
        """
        return None

    def note_changed(self, places: Sequence[tuple[int, int, int, int]] | None) -> None:
        """Note what `drawn_by` drew since the last swap, if it is called for all of it.

        Args:
            places: Rectangles of the picture [px]; None: it may be all of it.
        """

    def swap(self) -> None:
        """Show the picture drawn last."""

    @property
    def should_close(self) -> bool:
        """True once the window was asked to close."""
        return False

    def resize(self, size: Size) -> None:
        """Change the size of the framebuffer [px]; its picture is undefined until the next draw."""
        if size == self.size:
            return
        old = self.framebuffer
        self.framebuffer = self._make_framebuffer(size)
        self.framebuffer.use()  # moderngl rebinds the one in use, which is freed below
        self.size = size
        release_framebuffer(old)

    def renew(self) -> None:
        """Replace a lost context by a new one with a new framebuffer; all GPU objects are lost.

        Raises:
            DeviceError: no context can be created any more.
        """
        raise DeviceError(f"a surface of {self.backend} cannot be created again", "restart the application")

    def close(self) -> None:
        """Free the context; the surface must not be used afterwards."""
        self.ctx.release()

    def __enter__(self) -> Surface:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _take(self, ctx: moderngl.Context) -> None:
        """Use a context, and create the framebuffer in it."""
        self.ctx = ctx
        self.framebuffer = self._make_framebuffer(self.size)
        self.reset_status: Callable[[], str] = ResetStatus(ctx)

    def _make_framebuffer(self, size: Size) -> moderngl.Framebuffer:
        return self.ctx.framebuffer([make_picture_texture(self.ctx, size)], self.ctx.depth_renderbuffer(size))


def release_framebuffer(framebuffer: moderngl.Framebuffer) -> None:
    """Free a framebuffer with its attachments."""
    attachments = [*framebuffer.color_attachments, framebuffer.depth_attachment]
    framebuffer.release()
    for attachment in attachments:
        if attachment is not None:
            attachment.release()
