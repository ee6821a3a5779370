"""The shipped city from three viewpoints in its streets: cost of a frame, and share of the pixels that differ."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.system.resources import root
from mimics_app.lab.visual.probe import differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import load_model_world

__all__ = ["PLAIN", "city_error", "city_pictures", "city_us"]

Picture = NDArray[np.uint8]

_FILE = "assets/models/city/city.glb"
_PLACES = (
    ((-1.75, 1.7, 330.0), (-1.75, 3.0, 200.0)),
    ((-1.6, 1.75, 150.0), (-1.0, 3.4, 60.0)),
    ((8.6, 1.8, 13.4), (-14.0, 5.4, -14.0)),
)
"""Viewpoints and their targets [m]: along two streets, and over a crossing."""

_SIZE = (640, 360)
_SIDE, _UP = 0.89, 0.5
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0, shading="plain")


@cache
def _city() -> World:
    world = load_model_world(root() / _FILE)
    world.environment = Sky((0.5,) * 3, (0.5,) * 3, (0.5,) * 3, 0.5)
    sun = world.root.create_child("sun", (40.0, 90.0, 30.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0, casts_shadow=0)
    world.update()
    return world


def _view(number: int, size: tuple[int, int]) -> View:
    eye, target = (np.array(point) for point in _PLACES[number % len(_PLACES)])
    return View(compose_look_at(eye, target), (-_SIDE, _SIDE, -_UP, _UP), (0, 0, *size), 0.15, 3000.0)


def city_us(settings: RenderSettings, size: tuple[int, int] = _SIZE, frames: int = len(_PLACES)) -> float:
    """Return the cost of a frame of the city [us], the mean over the viewpoints in turn.

    Args:
        settings: Settings of the renderer.
        size: Size of the picture [px].
        frames: Number of frames of a run.
    """
    return frame_us(_city(), size, settings, partial(_view, size=size), frames)


def city_pictures(settings: RenderSettings, whole: RenderSettings) -> Iterator[tuple[Picture, Picture]]:
    """Yield the display values at each viewpoint by two settings, [height, width, 4] each."""
    for number in range(len(_PLACES)):
        view = _view(number, _SIZE)
        yield show_picture(_city(), _SIZE, settings, view), show_picture(_city(), _SIZE, whole, view)


def city_error(settings: RenderSettings, whole: RenderSettings) -> float:
    """Return the share of the pixels that differ from those by the settings `whole` by more than one level of 255."""
    return float(np.mean([differing_pixels(*pair, level=1) for pair in city_pictures(settings, whole)]))
