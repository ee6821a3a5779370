"""Pictures without a display: choice of the surface, frames one after another, PNG files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.view import View

__all__ = ["OFFSCREEN", "FrameSet", "open_offscreen", "read_pixels", "render_frames", "save_png"]

OFFSCREEN = ("egl", "osmesa")
"""Offscreen backends in the order "auto" tries them."""


@dataclass(frozen=True)
class FrameSet:
    """What `render_frames` made: the files in order, and the median time of drawing a frame [ms]."""

    files: list[Path]
    ms_median: float


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


def render_frames(
    renderer: Renderer,
    surface: Surface,
    count: int,
    views: Callable[[int], Sequence[View]],
    folder: Path,
) -> FrameSet:
    """Draw frames and save each as frame_00000.png, frame_00001.png, ...

    The first is drawn once before, so that the driver's compiling is not counted.

    Args:
        renderer: Draws on `surface`.
        surface: Any; a window shows the frames too.
        count: Number of frames, >= 1.
        views: Called with the number of each frame before it is drawn: moves the world, returns the eyes.
        folder: Where the files go; made when it is missing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files, spent = [], []
    renderer.draw(views(0))
    surface.ctx.finish()
    for number in range(count):
        spent.append(renderer.draw_finished(views(number)).cpu_ms)
        file = folder / f"frame_{number:05d}.png"
        save_png(surface, file)
        surface.swap()
        files.append(file)
    return FrameSet(files, median(spent))


def read_pixels(surface: Surface) -> NDArray[np.uint8]:
    """The picture drawn last: RGBA display values, uint8 [height, width, 4], row 0 at the top."""
    width, height = surface.size
    pixels = np.frombuffer(surface.framebuffer.read(components=4), np.uint8).reshape(height, width, 4)
    return pixels[::-1].copy()


def save_png(surface: Surface, file: Path) -> None:
    """Write the picture drawn last as an opaque PNG."""
    from PIL import Image

    Image.fromarray(read_pixels(surface)[:, :, :3]).save(file, compress_level=6)
