"""Shading models with the cost of a frame and the error of simpler ones.

Cost: the shipped city from three viewpoints, with sun, sky and haze. Error: RMS difference of the display values from
those of each material's own technique, the larger of the city, nearly all matt, and of balls from rough to smooth, half
of them metallic, under sun and lamp.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.city import city_pictures, city_us
from mimics_app.lab.visual.probe import show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import icosphere, plane
from mimics_app.world.content.world import World

__all__: list[str] = []


_SIZE = (320, 180)
_FULL = RenderSettings(msaa=0, shadow_size=0)


def _shading_error(settings: RenderSettings) -> float:
    """Return the RMS difference of the display values from those of full shading [of 255]."""
    whole = replace(settings, shading="full")
    town = [_square(*pair) for pair in city_pictures(settings, whole)]
    balls, view = _balls(), _view()
    shown = [show_picture(balls, _SIZE, each, view) for each in (settings, whole)]
    return math.sqrt(max(sum(town) / len(town), _square(*shown)))


def _square(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    return float(np.mean((one[..., :3].astype(np.float64) - other[..., :3]) ** 2))


def _balls() -> World:
    """Return two rows of six balls on a floor, the upper one metallic."""
    world = World()
    world.environment = Sky((0.2, 0.35, 0.7), (0.7, 0.75, 0.8), (0.2, 0.2, 0.15), 0.7)
    world.meshes |= {"ball": icosphere(0.45, 4), "floor": plane(20.0, 20.0)}
    world.set_material(Material("floor", "lit", (0.5, 0.5, 0.5, 1.0), roughness=0.6))
    world.root.create_child("floor", (0.0, -0.5, 0.0)).create_entity("floor", "floor")
    for number in range(12):
        column, metal = number % 6, number // 6
        name = f"{number}"
        colour = (0.8, 0.15 + 0.1 * column, 0.2, 1.0)
        world.set_material(Material(name, "pbr", colour, float(metal), 0.1 + 0.15 * column))
        world.root.create_child(name, (column - 2.5, float(metal), 0.0)).create_entity("ball", name)
    sun = world.root.create_child("sun", (1.0, 3.0, 2.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0)
    world.root.create_child("lamp", (-2.0, 1.5, 1.5)).create_light("point", colour=(1.0, 0.7, 0.4), intensity=1.0)
    world.update()
    return world


def _view() -> View:
    pose = compose_look_at((0.0, 1.5, 6.0), (0.0, 0.4, 0.0))
    return View(pose, (-0.55, 0.55, -0.31, 0.31), (0, 0, *_SIZE))


_FULL_SOURCE = "each material's own technique: diffuse, mirrored and lamps' light per pixel (glTF 2.0, appendix B)"
_MATT_SOURCE = "diffuse light of sun and sky alone per pixel, shadows and haze kept"
_PLAIN_SOURCE = "light per vertex in display values (Gouraud 1971), and haze, without shadows"
compare(
    __name__,
    "a frame of the city from three places; error: root mean square of display values, there or of balls",
    "levels of 255",
    [
        Rival("full", _FULL_SOURCE, "any", {"shading": "full"}, (_FULL,)),
        Rival("matt", _MATT_SOURCE, "any", {"shading": "matt"}, (replace(_FULL, shading="matt"),)),
        Rival("plain", _PLAIN_SOURCE, "any", {"shading": "plain"}, (replace(_FULL, shading="plain"),)),
    ],
    Probes(city_us, _shading_error),
    default="full",
)
