"""Frames off the screen for measurements: what one costs, and what it shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.probe import shortest_us
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View
from mimics_app.world.world import World

__all__ = ["differing_pixels", "frame_us", "show_picture"]

_WARM_UP = 2
"""Frames drawn first: the driver compiles in the one, buffers grow in the next."""

Move = Callable[[int], View]
"""Moves the world for a frame and returns the eye."""


def frame_us(world: World, size: Size, settings: RenderSettings, move: Move, frames: int) -> float:
    """Cost of a frame to its last pixel [us]: the mean over some frames, the shortest of a few runs of them.

    Args:
        world: What is drawn.
        size: Of the picture [px].
        settings: Quality.
        move: Called before each frame, whose cost counts too.
        frames: Of a run.

    Raises:
        DeviceError: nothing here draws without a display.
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
    """Display values of a frame, [height, width, 4], row 0 at the top.

    Raises:
        DeviceError: nothing here draws without a display.
    """
    with open_offscreen("auto", size) as surface:
        renderer = Renderer(surface, world, settings)
        renderer.draw([view])
        picture = read_pixels(surface)
        renderer.release()
    return picture


def differing_pixels(one: NDArray[Any], other: NDArray[Any], level: int = 0) -> float:
    """Share of the pixels of which any channel differs by more than `level` of 255."""
    apart = np.abs(one.astype(np.int16) - other.astype(np.int16)).max(axis=-1)
    return float((apart > level).mean())
