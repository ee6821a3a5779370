"""Off-screen frames for measurements: their cost and their pixels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.probe import shortest_us
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World

__all__ = ["differing_pixels", "frame_us", "show_picture"]

_WARM_UP = 2
"""Frames before a measurement: the driver compiles in the first, buffers grow in the second."""

Move = Callable[[int], View]
"""Moves the world for a frame and returns the view."""


def frame_us(world: World, size: Size, settings: RenderSettings, move: Move, frames: int) -> float:
    """Return the cost of a finished frame [us]: the mean over a run, the shortest of a few runs.

    Args:
        world: The world.
        size: Size of the picture [px].
        settings: Settings of the renderer.
        move: Called before each frame; its cost is included.
        frames: Number of frames of a run.

    Raises:
        DeviceError: No driver works without a display.
    """
    with open_offscreen("auto", size) as surface:
        renderer = Renderer(surface, world, settings)

        def run(count: int = frames) -> None:
            for frame in range(count):
                renderer.draw_finished([move(frame)])

        run(_WARM_UP)
        cost = shortest_us(run, frames, repeats=3)
        renderer.release()
    return cost


def show_picture(world: World, size: Size, settings: RenderSettings, view: View) -> NDArray[np.uint8]:
    """Return the display values of a frame, [height, width, 4], row 0 at the top.

    Raises:
        DeviceError: No driver works without a display.
    """
    with open_offscreen("auto", size) as surface:
        renderer = Renderer(surface, world, settings)
        renderer.draw([view])
        picture = read_pixels(surface)
        renderer.release()
    return picture


def differing_pixels(one: NDArray[Any], other: NDArray[Any], level: int = 0) -> float:
    """Return the share of the pixels of which any channel differs by more than `level` of 255."""
    apart = np.abs(one.astype(np.int16) - other.astype(np.int16)).max(axis=-1)
    return float((apart > level).mean())
