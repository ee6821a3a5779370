"""Additional windows: each shows a rectangle of a texture of the first window's context."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import Rect, Size, WindowPlace

__all__ = ["WallWindows"]

_READ, _DRAW, _COLOUR, _TEXTURE_2D = 0x8CA8, 0x8CA9, 0x8CE0, 0x0DE1
_COLOUR_BUFFER_BIT, _LINEAR = 0x4000, 0x2601

_UINT, _INT = ctypes.c_uint, ctypes.c_int
_ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "glGenFramebuffers": (_INT, ctypes.POINTER(_UINT)),
    "glDeleteFramebuffers": (_INT, ctypes.POINTER(_UINT)),
    "glBindFramebuffer": (_UINT, _UINT),
    "glFramebufferTexture2D": (_UINT, _UINT, _UINT, _UINT, _INT),
    "glBlitFramebuffer": (*([_INT] * 8), _UINT, _UINT),
}


@dataclass(slots=True, eq=False)
class _Window:
    """One window with a framebuffer for the shared texture: contexts do not share framebuffers."""

    handle: Any
    framebuffer: ctypes.c_uint
    texture: int = 0


class WallWindows:
    """Windows that share the objects of the first window's context.

    A window without a position fills a monitor other than the first.

    Args:
        glfw: The initialised library.
        main: The first window, whose context is current before and after every call.
        places: Titles, positions and sizes of the windows.
        size: Size of a window whose place has none [px].

    Attributes:
        missing: Titles of the windows for which no monitor is left.

    Raises:
        DeviceError: a window cannot be opened.
    """

    def __init__(self, glfw: ModuleType, main: Any, places: Sequence[WindowPlace], size: Size) -> None:
        self._glfw, self._main = glfw, main
        self._windows: dict[str, _Window] = {}
        self.missing: list[str] = []
        self._calls = {
            name: ctypes.CFUNCTYPE(None, *arguments)(glfw.get_proc_address(name))
            for name, arguments in _ARGUMENTS.items()
        }
        monitors = list(glfw.get_monitors())[1:]
        try:
            for place in places:
                if place.at is None and not monitors:
                    self.missing.append(place.title)
                    continue
                monitor = monitors.pop(0) if place.at is None else None
                self._windows[place.title] = self._open(place, monitor, place.size or size)
        except DeviceError:
            self.close()
            raise
        finally:
            glfw.make_context_current(main)

    def show(self, texture: int, rectangles: Sequence[tuple[str, Rect]]) -> None:
        """Show rectangles of a texture [px, from the lower left] in the windows of these titles."""
        glfw = self._glfw
        for title, (x, y, width, height) in rectangles:
            window = self._windows.get(title)
            if window is None:
                continue
            glfw.make_context_current(window.handle)
            self._attach(window, texture)
            across, down = glfw.get_framebuffer_size(window.handle)
            whole = (0, 0, across, down)
            self._calls["glBlitFramebuffer"](x, y, x + width, y + height, *whole, _COLOUR_BUFFER_BIT, _LINEAR)
            glfw.swap_buffers(window.handle)
        glfw.make_context_current(self._main)

    @property
    def should_close(self) -> bool:
        """Whether one of the windows was closed."""
        return any(self._glfw.window_should_close(window.handle) for window in self._windows.values())

    def close(self) -> None:
        """Close all windows."""
        for window in self._windows.values():
            self._glfw.make_context_current(window.handle)
            self._calls["glDeleteFramebuffers"](1, ctypes.byref(window.framebuffer))
            self._glfw.destroy_window(window.handle)
        self._windows.clear()
        self._glfw.make_context_current(self._main)

    def _open(self, place: WindowPlace, monitor: Any, size: Size) -> _Window:
        """Open a window; the first one's hints for the context still hold, as sharing requires."""
        glfw = self._glfw
        for hint in (glfw.DECORATED, glfw.AUTO_ICONIFY, glfw.FOCUSED, glfw.FOCUS_ON_SHOW):
            glfw.window_hint(hint, False)
        if monitor is not None:
            mode = glfw.get_video_mode(monitor)
            size = (mode.size.width, mode.size.height)
        handle = glfw.create_window(*size, place.title, monitor, self._main)
        if not handle:
            raise DeviceError(f'the display provides no window for "{place.title}"', "remove its place from the file")
        if place.at is not None:
            glfw.set_window_pos(handle, *place.at)
        glfw.make_context_current(handle)
        glfw.swap_interval(0)  # the first window's swap waits for the display
        framebuffer = _UINT()
        self._calls["glGenFramebuffers"](1, ctypes.byref(framebuffer))
        return _Window(handle, framebuffer)

    def _attach(self, window: _Window, texture: int) -> None:
        """Bind a texture for reading and the window itself for drawing."""
        bind = self._calls["glBindFramebuffer"]
        bind(_READ, window.framebuffer)
        if window.texture != texture:
            self._calls["glFramebufferTexture2D"](_READ, _COLOUR, _TEXTURE_2D, texture, 0)
            window.texture = texture
        bind(_DRAW, 0)
