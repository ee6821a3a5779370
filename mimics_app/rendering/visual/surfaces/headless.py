"""Pictures without a display: choice of the surface, pixels, PNG files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["OFFSCREEN", "open_offscreen", "read_pixels", "save_png"]

OFFSCREEN = ("egl", "osmesa")
"""Offscreen backends in the order "auto" tries them."""


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
    from PIL import Image

    Image.fromarray(read_pixels(surface)[:, :, :3]).save(file, compress_level=6)
