"""Props: crate, barrel, garden bed, fence, jug."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.market.sculpt import (
    F8,
    Colour,
    Sculpt,
    capsule_bar,
    mix,
    noise,
    plain,
    planked,
    rounded_box,
    surface,
    uniform_draws,
)
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.primitives import box, cylinder

__all__ = ["barrel", "bed", "crate", "fence", "jug"]


def crate(width: float, height: float, depth: float) -> Sculpt:
    """An empty crate of laths on its end; its middle at the origin."""
    sculpt = Sculpt()
    sculpt.add(box(width - 0.008, height - 0.006, depth - 0.008), (0.05, 0.03, 0.016))
    wood = plain((0.50, 0.27, 0.10), 90)
    laths = 4
    step = height / laths
    for i in range(laths):
        y = -0.5 * height + (i + 0.5) * step
        for z in (-0.5 * depth + 0.002, 0.5 * depth - 0.002):
            sculpt.add(
                rounded_box(width, step - 0.004, 0.004, 0.001, 1),
                plain((0.52 + 0.03 * (i % 2), 0.29, 0.11), 91 + i),
                at=(0.0, y, z),
            )
        for x in (-0.5 * width + 0.002, 0.5 * width - 0.002):
            sculpt.add(
                rounded_box(0.004, step - 0.004, depth - 0.008, 0.001, 1),
                plain((0.47, 0.25 + 0.02 * (i % 2), 0.095), 95 + i),
                at=(x, y, 0.0),
            )
    for x in (-1.0, 1.0):
        for z in (-1.0, 1.0):
            sculpt.add(
                rounded_box(0.011, height, 0.011, 0.002, 1),
                wood,
                at=(x * (0.5 * width - 0.0055), 0.0, z * (0.5 * depth - 0.0055)),
            )
    sculpt.add(rounded_box(width - 0.002, 0.004, depth - 0.002, 0.001, 1), wood, at=(0.0, 0.5 * height - 0.002, 0.0))
    return sculpt


def barrel() -> Sculpt:
    """A barrel with three hoops, lid up; its middle at the origin."""
    sculpt, radius, height = Sculpt(), 0.036, 0.115

    def point(around: F8, y: F8) -> F8:
        r = radius * (0.86 + 0.14 * (1.0 - (2.0 * y) ** 2)) * (1.0 - 0.012 * (np.abs(np.sin(9.0 * around)) < 0.12))
        return np.stack([r * np.cos(around), y * height, -r * np.sin(around)], 1)

    def staves(at: F8, normals: F8) -> F8:
        stave = np.floor(np.arctan2(at[:, 2], at[:, 0]) / (2.0 * math.pi) * 18.0)
        tone = 0.85 + 0.3 * noise(np.stack([stave * 3.7, 0 * stave, 0 * stave], 1), 1.0, 7)
        return (
            np.asarray((0.40, 0.18, 0.07))
            * (tone * (0.75 + 0.25 * np.clip(at[:, 1] / height + 0.5, 0.0, 1.0)))[:, None]
        )

    sculpt.add(surface(point, np.linspace(0.0, 2.0 * math.pi, 109), np.linspace(-0.5, 0.5, 13)), staves)
    sculpt.add(cylinder(0.86 * radius, 0.004, segments=36), (0.50, 0.27, 0.11), at=(0.0, 0.5 * height - 0.005, 0.0))
    for y, r in ((-0.36, 0.945), (0.0, 1.012), (0.36, 0.945)):
        sculpt.add(cylinder(radius * r + 0.0012, 0.008, segments=40), (0.10, 0.105, 0.115), at=(0.0, y * height, 0.0))
    return sculpt


BED_LOW, BED_HIGH = (-0.205, -0.075), (0.022, 0.125)
"""Inner corners of the bed in x and z [m]: an apple inside it can be reached with both fingers."""
BED_HEIGHT, BED_BOARD = 0.020, 0.008


def bed() -> Sculpt:
    """Boards about the place where the apple falls; origin on the ground at the world's origin."""
    sculpt = Sculpt()
    (x0, z0), (x1, z1) = BED_LOW, BED_HIGH
    h, t = BED_HEIGHT, BED_BOARD
    wood = planked((0.46, 0.25, 0.10), 1, 0.02, 101)
    for z in (z0 - 0.5 * t, z1 + 0.5 * t):
        sculpt.add(rounded_box(x1 - x0 + 2 * t, h, t, 0.002, 1), wood, at=(0.5 * (x0 + x1), 0.5 * h, z))
    for x in (x0 - 0.5 * t, x1 + 0.5 * t):
        sculpt.add(rounded_box(t, h, z1 - z0, 0.002, 1), wood, at=(x, 0.5 * h, 0.5 * (z0 + z1)))
        for z in (z0 - 0.5 * t, z1 + 0.5 * t):
            post = planked((0.40, 0.21, 0.085), 1, 0.02, 102)
            sculpt.add(rounded_box(0.013, 0.024, 0.013, 0.003, 1), post, at=(x, 0.012, z))
    return sculpt


FENCE = (0.010, 0.100, 0.176)
"""Edges of the fence [m]: the apple must be lifted over it."""


def fence() -> Sculpt:
    """White pickets on two rails, along z; its middle at the origin."""
    sculpt = Sculpt()
    thick, high, long = FENCE
    white: Colour = (0.84, 0.80, 0.72)
    for y in (-0.022, 0.024):
        sculpt.add(rounded_box(0.4 * thick, 0.011, long, 0.0015, 1), plain(white, 110), at=(-0.2 * thick, y, 0.0))
    count = 8
    step = long / count
    for i in range(count):
        z = -0.5 * long + (i + 0.5) * step
        tone = 0.93 + 0.1 * uniform_draws(16, 9)[i]
        paint = planked(tuple(tone * part for part in white), 2, step, 111 + i)
        sculpt.add(_picket(0.66 * step, high, 0.5 * thick), paint, at=(0.2 * thick, -0.5 * high, z))
    return sculpt


def _picket(wide: float, high: float, thick: float) -> MeshData:
    """A board along y with a pointed head, its foot at the origin; broad along z."""
    outline = np.array([[-0.5, 0.0], [0.5, 0.0], [0.5, 0.86], [0.0, 1.0], [-0.5, 0.86]]) * [wide, high]
    corners: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    for side in (-0.5, 0.5):
        first = len(corners)
        corners += [(side * thick, y, z) for z, y in outline]
        fan = [(0, i, i + 1) if side < 0.0 else (0, i + 1, i) for i in range(1, 4)]
        triangles += [(first + i, first + j, first + k) for i, j, k in fan]
    for i in range(5):
        j, first = (i + 1) % 5, len(corners)
        (z0, y0), (z1, y1) = outline[i], outline[j]
        corners += [(-0.5 * thick, y0, z0), (-0.5 * thick, y1, z1), (0.5 * thick, y1, z1), (0.5 * thick, y0, z0)]
        triangles += [(first, first + 2, first + 1), (first, first + 3, first + 2)]
    positions, indices = np.array(corners), np.array(triangles, np.uint32).ravel()
    return MeshData(positions.astype(np.float32), compute_normals(positions, indices), indices)


JUG_RADIUS, JUG_HEIGHT = 0.015, 0.046


def jug() -> Sculpt:
    """A glazed jug with a band; its middle at the origin."""
    sculpt = Sculpt()

    def point(around: F8, t: F8) -> F8:
        belly = (
            0.62
            + 0.38 * np.sin(math.pi * np.clip(0.10 + 0.72 * t, 0.0, 1.0)) ** 1.4
            + 0.14 * np.clip((t - 0.84) / 0.16, 0.0, 1.0)
        )
        r = JUG_RADIUS * belly
        return np.stack([r * np.cos(around), (t - 0.5) * JUG_HEIGHT, -r * np.sin(around)], 1)

    def glaze(at: F8, normals: F8) -> F8:
        t = at[:, 1] / JUG_HEIGHT + 0.5
        colour = mix((0.80, 0.78, 0.70), (0.05, 0.16, 0.42), (np.abs(t - 0.45) < 0.10).astype(float))
        return mix(colour, (0.05, 0.16, 0.42), (t > 0.94).astype(float))

    sculpt.add(surface(point, np.linspace(0.0, 2.0 * math.pi, 41), np.linspace(0.0, 1.0, 25)), glaze)
    sculpt.add(
        cylinder(0.6 * JUG_RADIUS, 0.001, segments=32), (0.03, 0.03, 0.03), at=(0.0, 0.5 * JUG_HEIGHT - 0.004, 0.0)
    )
    t = np.linspace(0.0, math.pi, 13)
    handle = np.stack([JUG_RADIUS * (0.78 + 0.62 * np.sin(t)), 0.013 * np.cos(t) + 0.002, 0.0 * t], 1)
    sculpt.add(capsule_bar(handle, 0.0022, 8, 2), (0.80, 0.78, 0.70))
    return sculpt
