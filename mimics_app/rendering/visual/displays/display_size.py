"""How large the picture of a display may be, all walls and both eyes together."""

from __future__ import annotations

import math

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import Size

__all__ = ["MOST_PIXELS", "check_drawn_size", "too_many_pixels"]

MOST_PIXELS = 1 << 26
"""Pixels of all walls or of both eyes together: eight walls of 3840 x 2160; drawing takes some 50 bytes for each."""


def too_many_pixels(pixels: int) -> list[str]:
    """Return what is wrong with so many pixels, nothing if they are not too many."""
    return [f"has {pixels / 1e6:.0f} million pixels, {MOST_PIXELS / 1e6:.0f} at most"] if pixels > MOST_PIXELS else []


def check_drawn_size(kind: str, drawn: Size, side: int) -> None:
    """Check that a display's whole picture can be drawn.

    Args:
        kind: Kind of the display.
        drawn: Width and height of its picture, all walls side by side [px].
        side: Largest width or height of a picture of the graphics driver [px].

    Raises:
        DeviceError: It is too large.
    """
    what = too_many_pixels(math.prod(drawn))
    if max(drawn) > side:
        what.append(f"is {drawn[0]} x {drawn[1]} px in one picture, and the graphics driver draws {side} at most")
    if what:
        raise DeviceError(f"the display {kind} {what[0]}", "give fewer or smaller walls, or a smaller --size")
