"""Ambient occlusion, with the cost of a frame of a hall and the error of the effect.

Error: relative deviation from the half of the sky that an infinite wall hides from its foot; 1 without the effect.
"""

from __future__ import annotations

from dataclasses import replace

from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.hall import FEW, PLAIN, hall_us
from mimics_app.lab.visual.probe import show_picture
from mimics_app.maths.colour import linear_light
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane
from mimics_app.world.content.world import World

__all__: list[str] = []


_PROBE = (192, 108)
_MIDDLE = slice(86, 106)
"""Evaluated columns of the picture of the wall, far from its ends."""


def _error(settings: RenderSettings) -> float:
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
        linear_light(show_picture(world, _PROBE, each, view)[..., 0] / 255.0)[:, _MIDDLE].mean(axis=1)
        for each in (settings, replace(settings, ambient_occlusion=0.0))
    )
    return float(abs((shaded / bare).min() - 0.5) / 0.5)


compare(
    __name__,
    "a frame of a hall with 12 pillars, 640x360; error: of the half that a wall takes from its foot",
    "of the effect",
    [
        Rival("none", "all of the sky arrives everywhere", "any", {"ambient_occlusion": 0.0}, (PLAIN,)),
        Rival(
            "eight places",
            "depth at eight places about each, at half the size (McGuire et al. 2012)",
            "any",
            {},
            (replace(PLAIN, ambient_occlusion=1.0),),
        ),
    ],
    Probes(hall_us, _error),
    default="none",
    few=FEW,
)
