"""Drawing that survives the loss of the OpenGL context."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TypeVar

from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["draw_or_recover"]

T = TypeVar("T")


def draw_or_recover(surface: Surface, draw: Callable[[], T], recover: Callable[[], None]) -> T:
    """Draw; where the driver has lost the context, report it, create a new one, and draw again.

    Args:
        surface: Surface of the context.
        draw: Draws a frame.
        recover: Creates context and renderer again.

    Raises:
        DeviceError: The context was lost and cannot be created again.
    """
    try:
        drawn = draw()
    except Exception:  # any call may fail after the loss of the context
        if not surface.reset_status():
            raise
    else:
        if not surface.reset_status():
            return drawn
    sys.stderr.write(f"mimics: the picture was lost ({surface.reset_status()}) and is created again\n")
    recover()
    return draw()
