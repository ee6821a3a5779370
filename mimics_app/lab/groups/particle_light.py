"""Light of particles: at each pixel, or at the vertices of their sprites.

Probe: the smoke of a fire at dusk, in the light of its flame, of a low sun with shadows, and of the sky. Error: share
of the pixels that differ by more than 8 of 255 from light at each pixel; smoke covers a tenth of the picture.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.probe import differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import ParticleLight, RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.components.effects import Particles
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World

__all__: list[str] = []

_SIZE, _SIDE, _UP = (1280, 720), 0.7, 0.394
_FRAMES, _RATE = 4, 30.0
_BEGUN = 6.0
"""Time for which the fire has burned [s], by which as many puffs fade as come."""
_LEVEL = 8
"""Smallest difference that counts [of 255]: smaller ones are not visible in motion."""
_SETTINGS = RenderSettings(msaa=0, shadow_size=1024)
_GREY = (0.5, 0.48, 0.47)
_SMOKE = Particles(
    shape="puff",
    rate=9.0,
    lifetime=(3.0, 4.5),
    box=(0.15, 0.1, 0.15),
    speed=(0.35, 0.6),
    cone=0.2,
    drag=0.6,
    gravity=(0.0, 0.3, 0.0),
    wind=(0.35, 0.2, 0.0),
    size=(0.25, 0.4),
    growth=4.5,
    spin=0.5,
    colours=((*_GREY, 0.0), (*_GREY, 0.16), (*_GREY, 0.0)),
    lit=True,
)


def _fire() -> World:
    """Return smoke over a flame at dusk."""
    world = World()
    world.environment = Sky((0.07, 0.11, 0.22), (0.46, 0.27, 0.2), (0.08, 0.08, 0.08), 0.85)
    world.meshes["grass"] = plane(60.0, 60.0)
    world.set_material(Material("grass", "lit", (0.16, 0.21, 0.08, 1.0), roughness=1.0))
    world.root.create_child("grass").create_entity("grass", "grass")
    sun = world.root.create_child("sun", (-6.0, 1.9, -3.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", colour=(1.0, 0.55, 0.3), intensity=0.95, casts_shadow=1)
    flame = world.root.create_child("flame", (0.0, 0.95, 0.15))
    flame.create_light("point", colour=(1.0, 0.48, 0.18), intensity=1.7, range=12.0)
    world.effects.add(world.root.create_child("smoke", (0.0, 0.55, 0.0)).index, _SMOKE)
    world.effects.time = _BEGUN
    world.update()
    return world


def _view() -> View:
    pose = compose_look_at((0.0, 1.15, 3.3), (0.0, 0.75, -0.4))
    return View(pose, (-_SIDE, _SIDE, -_UP, _UP), (0, 0, *_SIZE), 0.05, 80.0)


def _cost_us(light: ParticleLight) -> float:
    world, view = _fire(), _view()

    def burn(_: int) -> View:
        world.effects.time += 1.0 / _RATE
        world.update()
        return view

    return frame_us(world, _SIZE, replace(_SETTINGS, particle_light=light), burn, _FRAMES)


def _show(light: ParticleLight) -> NDArray[np.uint8]:
    return show_picture(_fire(), _SIZE, replace(_SETTINGS, particle_light=light), _view())


compare(
    __name__,
    "a frame of the smoke of a fire; error: share of pixels that differ from light at each pixel",
    "share of pixels",
    [
        Rival("pixel", "light of sun, lamps and sky at each pixel", "any", {"particle_light": "pixel"}),
        Rival("vertex", "light at the vertices of the sprites (Gouraud 1971)", "any", {"particle_light": "vertex"}),
    ],
    Probes(_cost_us, lambda light: differing_pixels(_show(light), _show("pixel"), level=_LEVEL)),
    default="vertex",
    few="light is computed at pixels or at vertices; there is nothing between",
)
