"""Attached displays and gamepads, queried from GLFW without opening a window."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

from mimics_app.contracts.errors import DeviceError

__all__ = ["DisplayInfo", "list_attached"]


@dataclass(frozen=True, slots=True)
class DisplayInfo:
    """One display.

    Attributes:
        name: Name given by the display server.
        size_px: Width and height of its current mode [px].
        size_m: Width and height of the panel [m]; (0, 0) where unknown.
        refresh_hz: Refresh rate [Hz].
        primary: True for the display on which windows open.
    """

    name: str
    size_px: tuple[int, int]
    size_m: tuple[float, float]
    refresh_hz: int
    primary: bool


def list_attached() -> tuple[list[DisplayInfo], list[str]]:
    """Return the displays, the primary one first, and the names of the gamepads.

    Raises:
        DeviceError: there is no display server.
    """
    glfw = _load()
    if not glfw.init():
        raise DeviceError("no display", "give the session a display")
    try:
        displays = [_describe(glfw, monitor, number == 0) for number, monitor in enumerate(glfw.get_monitors())]
        pads = [
            glfw.get_gamepad_name(joystick)
            for joystick in range(glfw.JOYSTICK_1, glfw.JOYSTICK_LAST + 1)
            if glfw.joystick_present(joystick) and glfw.joystick_is_gamepad(joystick)
        ]
    finally:
        glfw.terminate()
    return displays, [_text(pad) for pad in pads]


def _load() -> Any:
    import glfw

    glfw.ERROR_REPORTING = False  # type: ignore[assignment]  # errors come back as return values
    return glfw


def _describe(glfw: ModuleType, monitor: Any, primary: bool) -> DisplayInfo:
    mode = glfw.get_video_mode(monitor)
    width_mm, height_mm = glfw.get_monitor_physical_size(monitor)
    return DisplayInfo(
        name=_text(glfw.get_monitor_name(monitor)),
        size_px=(mode.size.width, mode.size.height),
        size_m=(width_mm * 1e-3, height_mm * 1e-3),
        refresh_hz=mode.refresh_rate,
        primary=primary,
    )


def _text(value: bytes | str) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else value
