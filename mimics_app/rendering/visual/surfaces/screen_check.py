"""Check that a display server answers, before anything slow is imported for a window."""

from __future__ import annotations

import os

from mimics_app.contracts.errors import DeviceError

__all__ = ["check_screen"]


def check_screen() -> None:
    """Check that the display server of this process answers.

    Raises:
        DeviceError: It does not.
    """
    import glfw

    glfw.ERROR_REPORTING = "ignore"  # the error is reported by what is raised below
    if glfw.init():
        glfw.terminate()
        return
    named = [f"{name}={value}" for name in ("WAYLAND_DISPLAY", "DISPLAY") if (value := os.environ.get(name))]
    where = f"at {named[0]}" if named else "here"
    raise DeviceError(f"no screen answers {where}", "give the session one that does, or play without: --headless")
