"""Light at the vertices of people: how small their triangles have to be on the picture.

Probe: eight of the shipped people who walk at distances of 2.4 to 8 m in the sun, with shadows. Error: share of the
pixels that differ by more than 8 of 255 from light at each pixel; people cover a fifth of the picture.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.system.resources import root
from mimics_app.lab.groups.crowd import load_person
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.probe import differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World

__all__: list[str] = []

_KINDS = ("man_omar", "woman_anna", "player_white", "man_tom", "woman_mara", "therapist", "player_red", "twin_woman")
_NEAREST, _FARTHEST = 2.4, 8.0
"""Distances of the first and the last [m], the others in equal ratios between them."""
_APART = 3
"""Places between two people of successive distances."""
_CLIP, _RATE = "walk", 30.0
_SIZE, _SIDE, _UP = (1280, 720), 0.89, 0.5
_FRAMES = 6
_LEVEL = 8
"""Smallest difference that counts [of 255]: smaller ones are not visible in motion."""
_PIXEL = RenderSettings(msaa=0, shadow_size=1024, fog_density=0.0)


def _people() -> World:
    """Return people on a floor in the sun, in the midst of their walk."""
    world = World()
    world.environment = Sky((0.3, 0.4, 0.6), (0.6, 0.65, 0.7), (0.3, 0.28, 0.25), 0.8)
    world.meshes["floor"] = plane(60.0, 60.0)
    world.set_material(Material("floor", "lit", (0.5, 0.5, 0.5, 1.0), roughness=1.0))
    world.root.create_child("floor").create_entity("floor", "floor")
    sun = world.root.create_child("sun", (3.0, 6.0, 4.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0, casts_shadow=1)
    for number, name in enumerate(_KINDS):
        away = _NEAREST * (_FARTHEST / _NEAREST) ** (number / (len(_KINDS) - 1))
        side = 1.3 * away * (_APART * number % len(_KINDS) / (len(_KINDS) - 1) - 0.5)
        person = world.root.create_child(name, (side, 0.0, -away))
        load_person(root() / "assets" / "models" / "avatars" / f"{name}.glb", full=False).instantiate(world, person)
        world.motion.animators[person.index].play(_CLIP, at=0.1 * number)
    world.update()
    return world


def _view() -> View:
    pose = compose_look_at((0.0, 1.5, 0.0), (0.0, 1.1, -4.0))
    return View(pose, (-_SIDE, _SIDE, -_UP, _UP), (0, 0, *_SIZE), 0.1, 100.0)


def _cost_us(limit: float) -> float:
    world, view = _people(), _view()

    def walk(_: int) -> View:
        world.motion.time += 1.0 / _RATE
        world.update()
        return view

    return frame_us(world, _SIZE, replace(_PIXEL, vertex_light=limit), walk, _FRAMES)


def _error(limit: float) -> float:
    whole, shown = (_show(each) for each in (0.0, limit))
    return differing_pixels(shown, whole, level=_LEVEL)


def _show(limit: float) -> NDArray[np.uint8]:
    return show_picture(_people(), _SIZE, replace(_PIXEL, vertex_light=limit), _view())


def _up_to(limit: float) -> Rival:
    source = "light per vertex (Gouraud 1971) where triangles have such sides, without normal maps; textures per pixel"
    return Rival(f"up to {limit:g} px", source, "any", {"vertex_light": limit}, (limit,))


compare(
    __name__,
    "a frame of eight people 2.4 to 8 m away; error: share of pixels that differ from light at each pixel",
    "share of pixels",
    [
        Rival("per pixel", "light at each pixel, whatever the triangles' size", "any", {"vertex_light": 0.0}, (0.0,)),
        *(_up_to(limit) for limit in (4.0, 8.0, 12.0, 16.0)),
    ],
    Probes(_cost_us, _error),
    default="up to 16 px",
)
