"""Bloom, with the cost of a frame of a hall and the error of the effect.

Error: relative change of the total light of a bright square; 1 without bloom.
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
from mimics_app.world.content.meshes.primitives import box
from mimics_app.world.content.world import World

__all__: list[str] = []


_PROBE = (192, 108)
_SHARE = 0.3


def _error(settings: RenderSettings) -> float:
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
        float(linear_light(show_picture(world, _PROBE, each, view)[..., 0] / 255.0).sum())
        for each in (settings, replace(settings, bloom=0))
    )
    return abs(spread / bare - 1.0)


compare(
    __name__,
    "a frame of a hall with 12 lamps, 640x360; error: light lost or made by spreading it, 1 without",
    "of the effect",
    [
        Rival("none", "light stays where it is seen", "any", {"bloom": 0.0}, (PLAIN,)),
        Rival(
            "six copies",
            "a share of the light in six copies of half the size",
            "any",
            {},
            (replace(PLAIN, bloom=_SHARE),),
        ),
    ],
    Probes(hall_us, _error),
    default="none",
    few=FEW,
)
