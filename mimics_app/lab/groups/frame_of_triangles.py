"""Growth of the cost of a frame with triangles.

Error: share of the pixels that differ from the picture with the finest levels.
"""

from __future__ import annotations

import math
from dataclasses import replace

from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.lab.visual.small_frame import PLAIN, MovingWorld, changed_share, cost_us, square_grid, view_over
from mimics_app.world.content.meshes.primitives import icosphere
from mimics_app.world.content.world import World

__all__ = ["ball_world"]


_COUNTS = (10_000, 100_000, 1_000_000, 10_000_000)
_BALL = 1280
"""Triangles of a ball in its finest level; the coarser ones have a quarter and a sixteenth."""

_COVERAGES = (2.84e-4, 2.84e-5, 0.0)
"""Coverages at which levels end in a picture of 480 x 270; in one of 128 x 72 at 14 times the share."""


def ball_world(count: int) -> MovingWorld:
    """Return a number of triangles in balls at rest with levels of detail."""
    world = World()
    for level in range(3):
        world.meshes[f"ball{level}"] = icosphere(0.5, 3 - level)
    balls = max(1, round(count / _BALL))
    for place in square_grid(balls, 1.2).tolist():
        forms = [[(f"ball{level}", "default")] for level in range(3)]
        world.content.add_levels(world.root.create_child("", tuple(place)).index, forms, _COVERAGES)
    world.update()
    view = view_over(1.2 * math.sqrt(balls))
    return world, lambda _: view


def _detailed(name: str, source: str, detail: float) -> Rival:
    return Rival(name, source, "any", {"detail": detail}, (ball_world, replace(PLAIN, detail=detail)))


_FINEST = replace(PLAIN, detail=4.0)
compare(
    __name__,
    "a frame of a million triangles in balls; error: share of pixels that differ from the finest forms",
    "share of pixels",
    [
        _detailed("finest forms", "levels change at four times their distance", 4.0),
        _detailed("twice as far", "levels change at twice their distance", 2.0),
        _detailed("levels of detail", "coarser forms by how much of the picture a body covers", 1.0),
    ],
    Probes(cost_us, lambda build, settings: changed_share(build, settings, _FINEST, 1_000_000)),
    default="levels of detail",
    growth=Growth(work="triangles", sizes=_COUNTS, typical=1_000_000),
)
