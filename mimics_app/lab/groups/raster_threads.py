"""Placement of the software rasteriser's threads on the cores.

Error: share of the pixels that differ from those with the threads left to the system.
"""

from __future__ import annotations

from dataclasses import replace

from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.city import PLAIN, city_error, city_us
from mimics_app.rendering.visual.settings import RenderSettings

__all__: list[str] = []


_SIZE, _FRAMES = (1280, 720), 90
"""Size [px], and frames of a run: the threads meet on one core in a part of them."""

_LEFT = replace(PLAIN, place_threads=False)


def _placed(name: str, source: str, valid: str, settings: RenderSettings) -> Rival:
    return Rival(name, source, valid, {"place_threads": settings.place_threads}, (settings, _LEFT))


compare(
    __name__,
    "a frame of the city from three places; error: share of pixels that differ from threads left to the system",
    "share of pixels",
    [
        _placed("system", "the scheduler of the system places them", "any", _LEFT),
        _placed(
            "frame by frame",
            "away from the thread that submits, then one per core",
            "llvmpipe on Linux, two to four cores",
            PLAIN,
        ),
    ],
    Probes(lambda settings, _: city_us(settings, _SIZE, _FRAMES), city_error),
    default="frame by frame",
    few="each thread on one core for good lost where the submitting thread is busy for long (decision 118)",
)
