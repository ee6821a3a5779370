"""Whether a window can be hoped for. Imports no graphics: commands ask before they do."""

from __future__ import annotations

import os

__all__ = ["has_display"]


def has_display() -> bool:
    """Whether this process has a display."""
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
