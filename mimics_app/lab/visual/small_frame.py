"""Frames of many nodes or triangles in a small picture, so that culling, submission and vertex processing dominate."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.visual.probe import Move, differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.world import World

__all__ = ["PLAIN", "MovingWorld", "changed_share", "cost_us", "square_grid", "view_over"]

PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0, shading="plain", occlusion="off")
"""Settings without anything that costs per pixel."""

MovingWorld = tuple[World, Move]
"""A world, and a function that moves it to a frame and returns the view."""

_SIZE = (128, 72)
_FRAMES = 4


def square_grid(count: int, step: float) -> F8:
    """Return positions on a square grid around the origin [m], [count, 3]."""
    k, side = np.arange(count), math.isqrt(max(0, count - 1)) + 1
    middle = 0.5 * (side - 1)
    return np.stack([(k % side - middle) * step, 0.0 * k, (k // side - middle) * step], axis=1)


def view_over(width: float) -> View:
    """Return a view from above in which a square of a width [m] approximately fills the picture."""
    eye = np.array([0.0, 0.6 * width, 0.8 * width])
    pose = compose_look_at(eye, np.zeros(3))
    return View(pose, (-0.9, 0.9, -0.5, 0.5), (0, 0, *_SIZE), 0.01 * width, 10.0 * width)


def cost_us(build: Callable[[int], MovingWorld], settings: RenderSettings, count: int) -> float:
    """Return the cost of a frame [us]."""
    world, move = build(count)
    return frame_us(world, _SIZE, settings, move, _FRAMES)


def changed_share(
    build: Callable[[int], MovingWorld], settings: RenderSettings, first: RenderSettings, count: int
) -> float:
    """Return the share of the pixels that differ from those by the settings `first` by more than one level of 255."""
    world, move = build(count)
    view = move(1)
    one, other = (show_picture(world, _SIZE, each, view) for each in (settings, first))
    return differing_pixels(one, other, level=1)
