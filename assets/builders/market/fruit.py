"""The apple that is carried, and the fruit on the stall."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.market.sculpt import (
    F8,
    Colour,
    Painter,
    Sculpt,
    capsule_bar,
    joined,
    mix,
    noise,
    surface,
    turned,
)
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["APPLE_RADIUS", "apple", "coarse_fruit", "fruit_paint"]

APPLE_RADIUS = 0.032
"""[m]"""

_RED, _YELLOW = (0.55, 0.012, 0.018), (0.72, 0.42, 0.06)


def apple_body(radius: float) -> tuple[MeshData, Painter]:
    """The fruit alone, stalk end up, and its paint: red, yellow about the stalk and in streaks."""

    def point(polar: F8, around: F8) -> F8:
        rho = 1.0 - 0.30 * np.exp(-((polar / 0.40) ** 2)) - 0.13 * np.exp(-(((math.pi - polar) / 0.42) ** 2))
        rho *= 1.0 + 0.022 * np.cos(5.0 * around) * np.clip((polar - 1.9) / 1.0, 0.0, 1.0)
        wide = 1.0 + 0.06 * np.sin(polar) ** 2 * np.cos(polar)
        return radius * np.stack(
            [
                rho * wide * np.sin(polar) * np.cos(around),
                rho * np.cos(polar) * 0.98,
                -rho * wide * np.sin(polar) * np.sin(around),
            ],
            axis=1,
        )

    mesh = surface(point, np.linspace(0.0, math.pi, 27), np.linspace(0.0, 2.0 * math.pi, 57))

    def paint(at: F8, normals: F8) -> F8:
        local = at / radius
        height = local[:, 1]
        around = np.arctan2(local[:, 2], local[:, 0])
        streaks = noise(np.stack([4.0 * np.cos(around), 0.35 * height, 4.0 * np.sin(around)], 1), 0.22, 3)
        cheek = 0.5 + 0.5 * np.cos(around - 0.9)
        blush = (
            np.clip(1.25 * height - 0.62, 0.0, 1.0) + 0.42 * np.clip(streaks - 0.52, 0.0, 1.0) + 0.18 * cheek * streaks
        )
        colour = mix(_RED, _YELLOW, np.clip(blush, 0.0, 0.85))
        specks = noise(local, 0.055, 9) > 0.86
        colour = np.where(specks[:, None], mix(colour, (0.85, 0.6, 0.25), 0.35), colour)
        hollow = np.clip((0.30 - np.hypot(local[:, 0], local[:, 2])) / 0.30, 0.0, 1.0) * (height > 0.0)
        return mix(colour, (0.16, 0.17, 0.03), 0.75 * hollow) * (0.80 + 0.20 * np.clip(height + 0.9, 0.0, 1.0))[:, None]

    return mesh, paint


def apple() -> Sculpt:
    """An apple with stalk and leaf; its middle at the origin."""
    sculpt = Sculpt()
    mesh, paint = apple_body(APPLE_RADIUS)
    sculpt.add(mesh, paint)
    r = APPLE_RADIUS
    t = np.linspace(0.0, 1.0, 7)
    stalk = np.stack([0.10 * r * t**2, r * (0.62 + 0.62 * t), 0.06 * r * t], axis=1)
    sculpt.add(capsule_bar(stalk, r * np.linspace(0.050, 0.075, 7), 10, 3), (0.16, 0.075, 0.03))
    sculpt.add(*leaf(1.05 * r), at=(0.06 * r, 1.02 * r, 0.03 * r), turn=turned(8.0, -28.0, 22.0))
    return sculpt


def leaf(length: float) -> tuple[MeshData, Painter]:
    """A folded leaf along +x, seen from both sides."""

    def sheet(lift: float) -> Painter:
        def point(u: F8, v: F8) -> F8:
            half = 0.30 * length * np.sin(math.pi * u**0.8) ** 0.9
            return np.stack(
                [u * length, 0.20 * length * u * (1.0 - 0.6 * u) + 0.55 * np.abs(v) * half + lift, -v * half], 1
            )

        return point

    us, vs = np.linspace(0.0, 1.0, 13), np.linspace(-1.0, 1.0, 7)
    upper = surface(sheet(2e-4), us, vs)
    lower = surface(sheet(-2e-4), us, vs, flip=True)

    def paint(at: F8, normals: F8) -> F8:
        return mix((0.10, 0.30, 0.03), (0.20, 0.46, 0.06), noise(at, 0.004, 5))

    return joined([upper, lower]), paint


def coarse_fruit(radius: float) -> MeshData:
    """A fruit of few triangles, stalk end up; radius [m]."""

    def point(polar: F8, around: F8) -> F8:
        rho = radius * (1.0 - 0.28 * np.exp(-((polar / 0.42) ** 2)) - 0.08 * np.exp(-(((math.pi - polar) / 0.4) ** 2)))
        return np.stack(
            [rho * np.sin(polar) * np.cos(around), rho * np.cos(polar), -rho * np.sin(polar) * np.sin(around)], 1
        )

    return surface(point, np.linspace(0.0, math.pi, 11), np.linspace(0.0, 2.0 * math.pi, 15))


def fruit_paint(colours: tuple[Colour, Colour], seed: int) -> Painter:
    """Its paint, the second colour where it is lit."""

    def paint(at: F8, normals: F8) -> F8:
        share = 0.25 + 0.6 * np.clip(normals[:, 1], 0.0, 1.0) * noise(at, 0.006, seed)
        return mix(colours[0], colours[1], share) * (0.55 + 0.45 * np.clip(normals[:, 1] + 0.9, 0.0, 1.0))[:, None]

    return paint
