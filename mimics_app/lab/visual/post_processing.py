"""Bloom and ambient occlusion, with the cost of a frame and the error of the effect; registered by importing.

Cost: a finished frame of 640 x 360 pixels of a hall of pillars and lamps. Error as a share of the effect: of bloom, the
change of the total light; of ambient occlusion, the deviation from the half of the sky that an infinite wall hides from
its foot. Without the effect the error is 1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.lab.rivals import Rival, compare
from mimics_app.lab.visual.probe import frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.environment import Sky
from mimics_app.world.materials.material import Material
from mimics_app.world.meshes.primitives import box, cylinder, plane, sphere
from mimics_app.world.world import World

__all__ = ["BLOOM", "CORNERS", "bloom_error", "corner_error"]


BLOOM, CORNERS = "bloom", "ambient occlusion"

_FRAME, _PROBE = (640, 360), (192, 108)
_FRAMES = 3
_SHARE = 0.3
_PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, tone_map="none")
_MIDDLE = slice(86, 106)
"""Evaluated columns of the picture of the wall, far from its ends."""


def _hall() -> World:
    """Return pillars and lamps on a floor before the evening sky."""
    world = World()
    world.environment = Sky((0.1, 0.15, 0.3), (0.3, 0.2, 0.25), (0.1, 0.1, 0.1), 0.9)
    world.set_material(Material("stone", "lit", (0.6, 0.55, 0.5, 1.0)))
    world.set_material(Material("flame", "unlit", (0.0, 0.0, 0.0, 1.0), emission=(20.0, 10.0, 4.0)))
    world.meshes |= {"floor": plane(12.0, 20.0), "pillar": cylinder(0.2, 2.5), "lamp": sphere(0.12, 24)}
    world.root.create_child("floor", (0.0, 0.0, -6.0)).create_entity("floor", "stone")
    for k in range(12):
        place = np.array([1.5 if k % 2 else -1.5, 1.25, -1.5 * (k // 2)])
        world.root.create_child("", place).create_entity("pillar", "stone")
        world.root.create_child("", place + (0.0, 0.4, 0.4)).create_entity("lamp", "flame")
    world.update()
    return world


def _hall_us(settings: RenderSettings) -> float:
    pose = compose_look_at((0.3, 1.6, 3.0), (0.0, 1.2, -4.0))
    view = View(pose, (-0.9, 0.9, -0.5, 0.5), (0, 0, *_FRAME))
    return frame_us(_hall(), _FRAME, settings, lambda _: view, _FRAMES)


def _light(picture: NDArray[np.uint8]) -> F8:
    """Return the linear red light of display values, 0-1."""
    share = picture[..., 0] / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def bloom_error(settings: RenderSettings) -> float:
    """Return the relative change of the light of a bright square by bloom; 1 without bloom."""
    if settings.bloom == 0.0:
        return 1.0
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("card", "unlit", (0.8, 0.8, 0.8, 1.0)))
    world.meshes["card"] = box(0.3, 0.3, 0.01)
    world.root.create_child("card").create_entity("card", "card")
    world.update()
    view = View(compose_look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)), (-0.5, 0.5, -0.28125, 0.28125), (0, 0, *_PROBE))
    spread, bare = (
        float(_light(show_picture(world, _PROBE, each, view)).sum()) for each in (settings, replace(settings, bloom=0))
    )
    return abs(spread / bare - 1.0)


def corner_error(settings: RenderSettings) -> float:
    """Return the relative deviation from the half of the sky that an infinite wall hides from its foot."""
    world = World()
    world.environment = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3, 0.9)
    world.set_material(Material("white", "lit_matt", (1.0,) * 4, roughness=1.0))
    world.meshes |= {"floor": plane(6.0, 6.0), "wall": box(6.0, 3.0, 0.5)}
    world.root.create_child("floor").create_entity("floor", "white")
    world.root.create_child("wall", (0.0, 1.5, -0.25)).create_entity("wall", "white")
    world.update()
    view = View(compose_look_at((0.0, 1.5, 1.5), (0.0, 0.0, 0.0)), (-0.4, 0.4, -0.225, 0.225), (0, 0, *_PROBE))
    shaded, bare = (
        _light(show_picture(world, _PROBE, each, view))[:, _MIDDLE].mean(axis=1)
        for each in (settings, replace(settings, ambient_occlusion=0.0))
    )
    return float(abs((shaded / bare).min() - 0.5) / 0.5)


_FEW = "how many copies, or places, is compiled into the shader: there is the effect and its absence"
compare(
    BLOOM,
    "a frame of a hall with 12 lamps, 640x360; error: light lost or made by spreading it, 1 without",
    "of the effect",
    [
        Rival("none", "light stays where it is seen", "any", {"bloom": 0.0}, (_PLAIN,)),
        Rival(
            "six copies",
            "a share of the light in six copies of half the size",
            "any",
            {},
            (replace(_PLAIN, bloom=_SHARE),),
        ),
    ],
    cost=_hall_us,
    error=bloom_error,
    default="none",
    few=_FEW,
)
compare(
    CORNERS,
    "a frame of a hall with 12 pillars, 640x360; error: of the half that a wall takes from its foot",
    "of the effect",
    [
        Rival("none", "all of the sky arrives everywhere", "any", {"ambient_occlusion": 0.0}, (_PLAIN,)),
        Rival(
            "eight places",
            "depth at eight places about each, at half the size (McGuire et al. 2012)",
            "any",
            {},
            (replace(_PLAIN, ambient_occlusion=1.0),),
        ),
    ],
    cost=_hall_us,
    error=corner_error,
    default="none",
    few=_FEW,
)
