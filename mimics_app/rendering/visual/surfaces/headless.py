"""Pictures without a display: choice of the surface, pixels, PNG files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["OFFSCREEN", "WritePng", "open_offscreen", "read_pixels", "save_png", "write_png"]

OFFSCREEN = ("egl", "osmesa")
"""Offscreen backends in the order "auto" tries them."""

WritePng = Callable[[NDArray[np.uint8], Path], None]
"""Writes pixels, uint8 [height, width, 4], to a file: now, or later."""

_PNG_LEVEL = 2
"""Of 9; of a picture of the tunnel 23 ms and 314 kB, at zlib's usual 6 45 ms and 271 kB."""


def open_offscreen(backend: str, size: Size) -> Surface:
    """An offscreen surface of the wanted backend, or with "auto" of the first that answers.

    Raises:
        DeviceError: none answers; carries what each one said.
        UsageError: no such backend.
    """
    if backend != "auto":
        return create_surface(backend, size)
    refused = []
    for name in OFFSCREEN:
        try:
            return create_surface(name, size)
        except DeviceError as error:
            refused.append(f"{name}: {error}")
    raise DeviceError("no way to draw without a display; " + "; ".join(refused))


def read_pixels(surface: Surface) -> NDArray[np.uint8]:
    """The picture drawn last: RGBA display values, uint8 [height, width, 4], row 0 at the top."""
    width, height = surface.size
    pixels = np.frombuffer(surface.framebuffer.read(components=4), np.uint8).reshape(height, width, 4)
    return pixels[::-1].copy()


def save_png(surface: Surface, file: Path) -> None:
    """Write the picture drawn last as an opaque PNG."""
    write_png(read_pixels(surface), file)


def write_png(pixels: NDArray[np.uint8], file: Path) -> None:
    """Write pixels, uint8 [height, width, 4], as an opaque PNG; most of the time without Python's lock."""
    from PIL import Image

    Image.fromarray(pixels[:, :, :3]).save(file, compress_level=_PNG_LEVEL)
