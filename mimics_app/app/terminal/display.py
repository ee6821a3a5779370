"""Check for a display server, without an import of graphics."""

from __future__ import annotations

import os

__all__ = ["has_display"]


def has_display() -> bool:
    """Whether this process has a display server (X11 or Wayland)."""
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
