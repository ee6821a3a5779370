"""Offscreen rendering: choice of the backend, pixels, PNG files."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import U1
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["WritePng", "mesa_version", "open_offscreen", "read_pixels", "save_png", "write_png"]

_OFFSCREEN = ("egl", "osmesa")
"""Offscreen backends in the order in which "auto" tries them."""

WritePng = Callable[[U1, Path], None]
"""Writes pixels, uint8 [height, width, 4], to a file, at once or later."""

_PNG_LEVEL = 2
"""Compression level, 0 to 9: a picture of the tunnel takes 23 ms and 314 kB, at zlib's default 6 45 ms and 271 kB."""


def open_offscreen(backend: str, size: Size) -> Surface:
    """Open an offscreen surface of a backend, or with "auto" of the first that works.

    Raises:
        DeviceError: no backend works; has the message of each one.
        UsageError: unknown backend.
    """
    if backend != "auto":
        return create_surface(backend, size)
    refused = []
    for name in _OFFSCREEN:
        try:
            return create_surface(name, size)
        except DeviceError as error:
            refused.append(f"{name}: {error}")
    raise DeviceError("no offscreen backend works; " + "; ".join(refused))


def mesa_version() -> str:
    """Return the version of Mesa that draws off screen in this process, "" where another driver or none does."""
    try:
        with open_offscreen("auto", (1, 1)) as surface:
            match = re.search(r"\bMesa (\d[\w.]*)", surface.ctx.info["GL_VERSION"])
    except DeviceError:
        return ""
    return match[1] if match else ""


def read_pixels(surface: Surface) -> U1:
    """Return the picture drawn last: RGBA display values, uint8 [height, width, 4], row 0 at the top."""
    width, height = surface.size
    pixels = np.frombuffer(surface.framebuffer.read(components=4), np.uint8).reshape(height, width, 4)
    return pixels[::-1].copy()


def save_png(surface: Surface, file: Path) -> None:
    """Save the picture drawn last as an opaque PNG."""
    write_png(read_pixels(surface), file)


def write_png(pixels: U1, file: Path) -> None:
    """Save pixels, uint8 [height, width, 3 or 4], as an opaque PNG; compression runs without the GIL.

    Raises:
        OSError: The file cannot be written; its `filename` is the file also where the disk is full. What was written
            of it is removed.
    """
    from PIL import Image

    with whole_file(file), file.open("wb") as stream:
        Image.fromarray(pixels[:, :, :3]).save(stream, "PNG", compress_level=_PNG_LEVEL)
