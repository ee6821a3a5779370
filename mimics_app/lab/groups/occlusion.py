"""Occlusion culling in the city.

Error: share of the pixels that differ from the picture without occlusion culling.
"""

from __future__ import annotations

from dataclasses import replace

from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.city import PLAIN, city_error, city_us
from mimics_app.rendering.visual.settings import Occlusion

__all__: list[str] = []


_OPEN = replace(PLAIN, occlusion="off")


def _boxes(name: Occlusion, source: str, valid: str = "any") -> Rival:
    settings = replace(_OPEN, occlusion=name)
    return Rival(name, source, valid, {"occlusion": name}, (settings, _OPEN))


compare(
    __name__,
    "a frame of the city from three places; error: share of pixels that differ from nothing hidden",
    "share of pixels",
    [
        _boxes("off", "every body in the view is drawn"),
        _boxes("derived", "boxes proven inside opaque meshes hide what is behind"),
        _boxes("authored", "boxes their authors wrote hide", "authored models"),
        _boxes("all", "both kinds of boxes hide"),
    ],
    Probes(lambda settings, _: city_us(settings), city_error),
    default="all",
    why_default="it hides as well without authored boxes; the city, measured here, has boxes by its author",
)
