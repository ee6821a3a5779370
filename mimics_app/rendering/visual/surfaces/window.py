"""A desktop window with keyboard, mouse and gamepad, by GLFW."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.surfaces.surface import Place, Size, Surface
from mimics_app.rendering.visual.surfaces.window_copy import WindowCopy

if TYPE_CHECKING:
    import moderngl

    from mimics_app.contracts.ports.display_port import WindowPlace
    from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows

__all__ = ["WindowSurface", "on_the_desktop", "usual_size"]

_NO_DISPLAY = "give the session a screen; without one: --headless, or --backend egl"
_FIX_GL = "install it with: apt-get install libgl1 libgl1-mesa-dri, or run headless: --headless"
_ALIASES = {"kp_enter": "enter"}
_FIX_QUAD = "it takes a workstation's graphics card; else --display sbs, tb, interleaved or anaglyph"
_BACK_LEFT, _BACK_RIGHT, _BACK = 0x0402, 0x0403, 0x0405
_READ_FRAMEBUFFER, _DRAW_FRAMEBUFFER, _COLOUR_BUFFER_BIT, _NEAREST = 0x8CA8, 0x8CA9, 0x4000, 0x2600


_SMALLEST = (1280, 720)
"""Size at a content scale of 1 in which the launcher and the board of a task are read at arm's length [px]."""
_SHARE = 2.0 / 3.0
"""Share of the work area's width and height: 1280x720 on a monitor of 1920x1080, 2560x1440 on one of 3840x2160."""


def usual_size(glfw: ModuleType) -> Size:
    """Return a size of 16:9 that suits the primary monitor; text grows with the window, so it stays readable."""
    area = _work_area(glfw)
    width = max(_smallest_size(glfw)[0], _SHARE * min(area[0], area[1] * _SMALLEST[0] / _SMALLEST[1]))
    return round(width), round(width * _SMALLEST[1] / _SMALLEST[0])


def _smallest_size(glfw: ModuleType) -> Size:
    """Return the smallest size with readable text; it grows with the content scale where GLFW counts pixels."""
    monitor = glfw.get_primary_monitor()
    counts_pixels = glfw.get_platform() in (glfw.PLATFORM_X11, glfw.PLATFORM_WIN32)
    scale = max(1.0, glfw.get_monitor_content_scale(monitor)[0]) if monitor and counts_pixels else 1.0
    return round(_SMALLEST[0] * scale), round(_SMALLEST[1] * scale)


def on_the_desktop(glfw: ModuleType, size: Size) -> Size:
    """Limit a size to that of all monitors' work areas together [px]."""
    areas = [glfw.get_monitor_workarea(monitor) for monitor in glfw.get_monitors()]
    areas = [area for area in areas if area[2] > 0 and area[3] > 0]
    if not areas:
        return size
    width = max(x + w for x, _, w, _ in areas) - min(x for x, _, _, _ in areas)
    height = max(y + h for _, y, _, h in areas) - min(y for _, y, _, _ in areas)
    return min(size[0], width), min(size[1], height)


def _work_area(glfw: ModuleType) -> Size:
    """Return width and height of the primary monitor's work area; (0, 0) where it is unknown."""
    monitor = glfw.get_primary_monitor()
    return glfw.get_monitor_workarea(monitor)[2:] if monitor else (0, 0)


class WindowSurface(Surface):
    """A window, of which there is one at a time: the picture is drawn offscreen and copied to it by `swap`.

    Without a size it is as suits the monitor, or small for a scene whose frames pay for their pixels. F11 toggles full
    screen. With `stereo` it is quad-buffered, and `swap` fills both back buffers from the halves of `both_eyes`.

    Raises:
        DeviceError: no display, no OpenGL 4.3, or no quad buffers.
    """

    _events: list[InputEvent]
    _changed: list[tuple[int, int, int, int]] | None
    _noted_by: object

    def __init__(
        self,
        size: Size | None,
        title: str,
        *,
        vsync: bool = True,
        stereo: bool = False,
        scene: bool = True,
        visible: bool = True,
    ) -> None:
        import glfw

        self._read_library(glfw)
        self._title, self._vsync, self._stereo, self._scene = title, vsync, stereo, scene
        self._visible = visible
        self._pointer: tuple[float, float] | None = None
        self._resting: tuple[float, float] | None = None
        self._windowed: tuple[int, int, int, int] | None = None
        context = self._open(size)
        self._opened: Size = glfw.get_window_size(self._window)
        super().__init__("window", context, glfw.get_framebuffer_size(self._window))

    def _open(self, size: Size | None) -> moderngl.Context:
        """Open the window and create its context."""
        import moderngl

        glfw = self._glfw
        self._window = _open_window(glfw, size, self._title, stereo=self._stereo)
        glfw.make_context_current(self._window)
        glfw.swap_interval(1 if self._vsync else 0)
        self._bind_framebuffer, self._blit_framebuffer = _load_blit(glfw)
        self._draw_buffer = ctypes.CFUNCTYPE(None, ctypes.c_uint)(glfw.get_proc_address("glDrawBuffer"))
        self._listen()
        context = moderngl.create_context(require=430)
        if size is None:
            if self._scene and rasteriser_of(context).pays_for_pixels:
                glfw.set_window_size(self._window, *on_the_desktop(glfw, _smallest_size(glfw)))
        if self._visible:
            glfw.show_window(self._window)
        self._resting = self._on_screen(*glfw.get_cursor_pos(self._window))
        return context

    def renew(self) -> None:
        # A GLFW window keeps its context for life: another window is opened in its place, full screen or not.
        glfw = self._glfw
        whole, self._windowed = self._windowed is not None, None
        place, size = glfw.get_window_pos(self._window), glfw.get_window_size(self._window)
        self.close()
        self.keys = self.buttons = frozenset()
        context = self._open(size)
        glfw.set_window_pos(self._window, *place)
        self.size = glfw.get_framebuffer_size(self._window)
        self._take(context)
        if whole:
            self.toggle_fullscreen()

    def poll(self) -> list[InputEvent]:
        self._glfw.poll_events()
        self._read_gamepad()
        events, self._events = self._events, []
        if any(event.kind == "key" and event.name == "f11" and event.pressed and not event.repeat for event in events):
            self.toggle_fullscreen()
        return events

    @property
    def resized_to(self) -> Size | None:
        size = self._windowed[2:] if self._windowed else self._glfw.get_window_size(self._window)
        return None if size == self._opened else size

    @property
    def place(self) -> Place:
        glfw = self._glfw
        x, y = self._windowed[:2] if self._windowed else glfw.get_window_pos(self._window)
        return Place(x, y, *(self.resized_to or (0, 0)), whole=self._windowed is not None)

    def move_to(self, place: Place) -> None:
        glfw = self._glfw
        if self._windowed:
            self.toggle_fullscreen()
        glfw.set_window_pos(self._window, place.x, place.y)
        if place.width and place.height:
            glfw.set_window_size(self._window, place.width, place.height)
        if place.whole:
            self.toggle_fullscreen()

    def hide(self) -> None:
        self._visible = False
        self._glfw.hide_window(self._window)

    def show(self) -> None:
        glfw = self._glfw
        self._visible = True
        self._resting = self._on_screen(*glfw.get_cursor_pos(self._window))
        glfw.show_window(self._window)
        self.poll()
        self._changed = None

    def pointer(self) -> tuple[float, float] | None:
        return self._pointer

    def open_beside(self, places: Sequence[WindowPlace], size: Size) -> WallWindows | None:
        from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows

        return WallWindows(self._glfw, self._window, places, size)

    def note_changed(self, places: Sequence[tuple[int, int, int, int]] | None) -> None:
        before = self._changed
        self._changed = None if before is None or places is None else [*before, *places]
        self._noted_by = self.drawn_by

    def swap(self) -> None:
        self.present()
        self._glfw.swap_buffers(self._window)

    def present(self) -> None:
        """Copy the picture to the window's back buffer without swapping."""
        if self._stereo and self.both_eyes is not None:
            self._present_eyes(self.both_eyes)
            return
        self._copy.present(self.framebuffer, self._changed if self._noted_by is self.drawn_by else None)
        self._changed, self._noted_by = [], self

    def _present_eyes(self, source: moderngl.Framebuffer) -> None:
        """Copy the halves of a picture of both eyes to the left and the right back buffer."""
        self._bind_framebuffer(_READ_FRAMEBUFFER, source.glo)
        self._bind_framebuffer(_DRAW_FRAMEBUFFER, 0)
        half, height = source.size[0] // 2, source.size[1]
        for x, buffer in ((0, _BACK_LEFT), (half, _BACK_RIGHT)):
            self._draw_buffer(buffer)
            self._blit_framebuffer(x, 0, x + half, height, 0, 0, *self.size, _COLOUR_BUFFER_BIT, _NEAREST)
        self._draw_buffer(_BACK)
        self.framebuffer.use()

    @property
    def should_close(self) -> bool:
        return bool(self._glfw.window_should_close(self._window))

    def _take(self, ctx: moderngl.Context) -> None:
        super()._take(ctx)
        self._copy = rasteriser_of(ctx).member(WindowCopy)(ctx)
        self._changed, self._noted_by = [], self  # noted by nobody, which is not the same as nobody

    def toggle_fullscreen(self) -> None:
        """Switch between the window and full screen on the primary monitor."""
        glfw = self._glfw
        if self._windowed:
            x, y, width, height = self._windowed
            self._windowed = None
            glfw.set_window_monitor(self._window, None, x, y, width, height, 0)
            return
        monitor = glfw.get_primary_monitor()
        if not monitor:
            return
        self._windowed = (*glfw.get_window_pos(self._window), *glfw.get_window_size(self._window))
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(self._window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def close(self) -> None:
        super().close()
        self.both_eyes = None
        self._glfw.destroy_window(self._window)
        self._glfw.terminate()

    def _read_library(self, glfw: ModuleType) -> None:
        self._glfw = glfw
        self._key_names = _constant_names(glfw, "KEY_")
        self._pad_buttons = _constant_names(glfw, "GAMEPAD_BUTTON_")
        self._pad_axes = _constant_names(glfw, "GAMEPAD_AXIS_")
        self._events = []

    def _listen(self) -> None:
        glfw, window = self._glfw, self._window
        glfw.set_key_callback(window, self._on_key)
        glfw.set_char_callback(window, lambda _, code: self._events.append(InputEvent("text", chr(code), True)))
        glfw.set_mouse_button_callback(window, self._on_button)
        glfw.set_cursor_pos_callback(window, self._on_move)
        glfw.set_scroll_callback(window, lambda _, x, y: self._events.append(InputEvent("wheel", x=x, y=y)))
        glfw.set_framebuffer_size_callback(window, self._on_resize)
        glfw.set_window_close_callback(window, lambda _: self._events.append(InputEvent("close")))
        glfw.set_window_focus_callback(window, self._on_focus)

    def _on_key(self, _window: object, key: int, _scancode: int, action: int, _modifiers: int) -> None:
        name = self._key_names.get(key, "")
        name = _ALIASES.get(name, name)
        if not name:
            return
        pressed = action != self._glfw.RELEASE
        self.keys = self.keys | {name} if pressed else self.keys - {name}
        self._events.append(InputEvent("key", name, pressed, action == self._glfw.REPEAT))

    def _on_button(self, _window: object, button: int, action: int, _modifiers: int) -> None:
        name = ("left", "right", "middle")[button] if button < 3 else f"button_{button + 1}"
        pressed = action == self._glfw.PRESS
        self.buttons = self.buttons | {name} if pressed else self.buttons - {name}
        x, y = self._pointer or self._from_centre(*self._glfw.get_cursor_pos(self._window))
        self._events.append(InputEvent("button", name, pressed, x=x, y=y))

    def _on_move(self, _window: object, x: float, y: float) -> None:
        if self._resting is not None:  # a window that opens under a pointer gets its place, though nobody moved it
            if self._on_screen(x, y) == self._resting:
                return
            self._resting = None
        self._pointer = self._from_centre(x, y)
        self._events.append(InputEvent("move", x=self._pointer[0], y=self._pointer[1]))

    def _from_centre(self, x: float, y: float) -> tuple[float, float]:
        """Return a place in the window, right and up in [-1, 1]."""
        width, height = (max(side, 1) for side in self._glfw.get_window_size(self._window))
        return min(max(2.0 * x / width - 1.0, -1.0), 1.0), min(max(1.0 - 2.0 * y / height, -1.0), 1.0)

    def _on_screen(self, x: float, y: float) -> tuple[float, float]:
        """Return a place in the window on the desktop, which stays the same while the window moves [px]."""
        left, top = self._glfw.get_window_pos(self._window)
        return round(left + x), round(top + y)

    def _on_resize(self, _window: object, width: int, height: int) -> None:
        if min(width, height) < 1:
            return  # minimised: the picture keeps its size until the window is restored
        self.resize((width, height))
        self._events.append(InputEvent("resize", x=width, y=height))

    def _on_focus(self, _window: object, focused: int) -> None:
        # Without focus a window receives no release events: all held keys and buttons are released.
        if focused:
            return
        self._events += [InputEvent("key", name) for name in sorted(self.keys)]
        self._events += [InputEvent("button", name) for name in sorted(self.buttons)]
        self.keys = self.buttons = frozenset()

    def _read_gamepad(self) -> None:
        state = self._query_gamepad()
        for name in sorted(state.buttons ^ self.gamepad.buttons):
            self._events.append(InputEvent("pad", name, name in state.buttons))
        self.gamepad = state

    def _query_gamepad(self) -> GamepadState:
        glfw = self._glfw
        for joystick in range(glfw.JOYSTICK_1, glfw.JOYSTICK_LAST + 1):
            if not glfw.joystick_present(joystick) or not glfw.joystick_is_gamepad(joystick):
                continue
            raw = glfw.get_gamepad_state(joystick)
            if raw is None:
                continue
            axes = {name: _scale_axis(name, raw.axes[index]) for index, name in self._pad_axes.items()}
            held = frozenset(name for index, name in self._pad_buttons.items() if raw.buttons[index])
            return GamepadState(_text(glfw.get_gamepad_name(joystick)), axes, held)
        return GamepadState()


def _open_window(glfw: ModuleType, wanted: Size | None, title: str, *, stereo: bool = False) -> Any:
    # Errors are return values, raised as one DeviceError here, instead of warnings on stderr.
    glfw.ERROR_REPORTING = False  # type: ignore[attr-defined]  # the module's documented switch
    if not glfw.init():
        raise DeviceError("no screen answers", _NO_DISPLAY)
    glfw.default_window_hints()
    glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, 4)
    glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, 3)
    glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
    glfw.window_hint(glfw.OPENGL_FORWARD_COMPAT, True)
    glfw.window_hint(glfw.RESIZABLE, True)
    glfw.window_hint(glfw.SAMPLES, 0)
    glfw.window_hint(glfw.DEPTH_BITS, 0)
    glfw.window_hint(glfw.STENCIL_BITS, 0)
    glfw.window_hint(glfw.STEREO, stereo)
    glfw.window_hint(glfw.SRGB_CAPABLE, False)
    glfw.window_hint(glfw.CONTEXT_ROBUSTNESS, glfw.LOSE_CONTEXT_ON_RESET)
    glfw.window_hint(glfw.VISIBLE, False)
    for of_window in (glfw.X11_CLASS_NAME, glfw.X11_INSTANCE_NAME):
        glfw.window_hint_string(of_window, "mimics")  # by which a desktop finds the entry of the menu and its icon
    size = on_the_desktop(glfw, wanted or usual_size(glfw))
    window = glfw.create_window(*size, title, None, None)
    if not window:  # a driver that cannot report a reset may refuse the request
        glfw.window_hint(glfw.CONTEXT_ROBUSTNESS, glfw.NO_ROBUSTNESS)
        window = glfw.create_window(*size, title, None, None)
    if not window:
        glfw.terminate()
        if stereo:
            raise DeviceError("the display provides no window with a buffer for each eye", _FIX_QUAD)
        raise DeviceError("the display provides no window with OpenGL 4.3", _FIX_GL)
    glfw.window_hint(glfw.VISIBLE, True)  # hints stay: of the windows of further walls too
    return window


def _load_blit(glfw: ModuleType) -> tuple[Callable[..., None], Callable[..., None]]:
    bind = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint)
    blit = ctypes.CFUNCTYPE(None, *([ctypes.c_int] * 8), ctypes.c_uint, ctypes.c_uint)
    return bind(glfw.get_proc_address("glBindFramebuffer")), blit(glfw.get_proc_address("glBlitFramebuffer"))


def _constant_names(glfw: ModuleType, prefix: str) -> Mapping[int, str]:
    # Sorted so that of several names of a value (GAMEPAD_BUTTON_A, _CROSS, _LAST) the shortest wins.
    names = sorted((n for n in dir(glfw) if n.startswith(prefix)), key=lambda n: (-len(n), n))
    return {getattr(glfw, name): name.removeprefix(prefix).lower() for name in names if not name.endswith("_LAST")}


def _scale_axis(name: str, value: float) -> float:
    return 0.5 * (value + 1.0) if name.endswith("trigger") else float(value)


def _text(value: bytes | str | None) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else value or "gamepad"
