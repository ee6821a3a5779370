"""Drawing that outlives the loss of a context."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TypeVar

from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["draw_or_recover"]

T = TypeVar("T")


def draw_or_recover(surface: Surface, draw: Callable[[], T], recover: Callable[[], None]) -> T:
    """Draw; where the driver lost the context, report it, create a new one, and draw again.

    Args:
        surface: Whose context.
        draw: Draws a frame.
        recover: Makes context and renderer anew.

    Raises:
        DeviceError: the context was lost, and there is no other.
    """
    try:
        drawn = draw()
    except Exception:  # in a context that is gone anything may fail
        if not surface.reset_status():
            raise
    else:
        if not surface.reset_status():
            return drawn
    sys.stderr.write(f"mimics: the picture was lost ({surface.reset_status()}) and is made anew\n")
    recover()
    return draw()
