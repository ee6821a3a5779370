"""Functions of the keys in a session's window, by input device."""

from __future__ import annotations

from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.device_names import POINTER
from mimics_app.rendering.visual.figures.key_page import Keys

__all__ = ["session_keys"]

_AT_MOUSE = (
    ("Mouse, arrows, left stick", "move the hand"),
    ("Wheel, left button, trigger", "close and open the hand"),
    ("Shift", "slower"),
)
_AT_ROBOT = (("Handle of the robot", "move the hand"),)
_SIMULATED = (("Nothing to hold", "a simulated patient moves the hand"),)
_ALWAYS = (
    ("Space, gamepad B", "stop the force at once"),
    ("R", "allow force again after a stop"),
    ("P, gamepad Start", "pause and go on"),
    ("H", "this page"),
    ("F5", "force and stability figures, for the operator"),
    ("F1 to F4, F6", "times, wireframe, bounds, lights, shadows"),
    ("F11, F12, Esc", "full screen;  keep a picture;  end the session"),
)


def session_keys(plugin: DevicePlugin) -> Keys:
    """Return the keys of a session with a device, and their functions."""
    if plugin.name == POINTER:
        return (*_AT_MOUSE, *_ALWAYS)
    return (*(_AT_ROBOT if plugin.real_time else _SIMULATED), *_ALWAYS)
