"""The gloved hand: palm, three fingers, thumb."""

from __future__ import annotations

import numpy as np

from mimics_app.builders.market.clay import (
    Clay,
    Colour,
    capsule_bar,
    plain,
    rounded_box,
    turned,
)
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.meshes.primitives import cylinder, torus

__all__ = ["fingers", "palm", "thumb"]

GLOVE: Colour = (0.90, 0.84, 0.72)


def palm() -> Clay:
    """The back of a gloved hand with a cuff; the origin lies between the fingertips below it."""
    clay = Clay()
    back = rounded_box(0.070, 0.026, 0.056, 0.0125, 4)
    clay.add(back, plain(GLOVE, 1, 0.7), at=(0.002, 0.069, 0.0), turn=turned(0.0, 0.0, -3.0))
    for z in (-0.0155, 0.0, 0.0155):
        seam = np.array([[-0.018 + 0.004 * i, 0.0822 - 0.0002 * i, 0.7 * z] for i in range(6)])
        clay.add(capsule_bar(seam, 0.0013, 6, 2), (0.66, 0.58, 0.46))
    clay.add(
        cylinder(0.0225, 0.034, top_radius=0.0195, segments=36), plain((0.085, 0.28, 0.55), 2), at=(0.0, 0.0965, 0.0)
    )
    for y, radius in ((0.0815, 0.0225), (0.113, 0.0200)):
        clay.add(torus(radius, 0.0032, 36), plain((0.12, 0.38, 0.68), 3), at=(0.0, y, 0.0))
    return clay


def fingers() -> Clay:
    """Three fingers at +x, the inner sides of their pads at x = 0 at the height of the origin."""
    clay = Clay()
    for z, long, out in ((-0.019, 0.92, 0.007), (0.0, 1.0, 0.0), (0.019, 0.90, -0.005)):
        clay.add(_bent(0.0090, z, long, out), plain(GLOVE, 4, 0.75))
    return clay


def thumb() -> Clay:
    """The thumb, made at +x as the fingers; the scene turns it to the other side."""
    clay = Clay()
    clay.add(_bent(0.0112, 0.004, 0.92, -0.003), plain(GLOVE, 5, 0.75))
    return clay


def _bent(radius: float, z: float, long: float, out: float) -> MeshData:
    """One finger from the palm over the knuckle, `out` farther from the middle, down to its tip."""
    t = np.linspace(0.0, 1.0, 17)[:, None]
    corners = (
        (-0.030, 0.070, 0.75 * z),
        (0.016 + out, 0.080, z),
        (0.028 + out, 0.040, z),
        (radius, 0.006 - 0.010 * long, 0.8 * z),
    )
    a, b, c, d = (np.array(corner) for corner in corners)
    way = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t * t * (1 - t) * c + t**3 * d
    return capsule_bar(way, radius * np.linspace(1.12, 0.92, 17), 16, 5)
