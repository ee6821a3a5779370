"""A hall of pillars and lamps, in which effects of the finished picture are measured."""

from __future__ import annotations

import numpy as np

from mimics_app.lab.visual.probe import frame_us
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import cylinder, plane, sphere
from mimics_app.world.content.world import World

__all__ = ["FEW", "PLAIN", "hall_us"]

PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, tone_map="none")
FEW = "how many copies, or places, is compiled into the shader: there is the effect and its absence"

_FRAME = (640, 360)
_FRAMES = 3


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


def hall_us(settings: RenderSettings) -> float:
    """Return the cost of a frame of the hall [us]."""
    pose = compose_look_at((0.3, 1.6, 3.0), (0.0, 1.2, -4.0))
    view = View(pose, (-0.9, 0.9, -0.5, 0.5), (0, 0, *_FRAME))
    return frame_us(_hall(), _FRAME, settings, lambda _: view, _FRAMES)
