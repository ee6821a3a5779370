"""The stall: table, panels, posts, awning, sign, and trays of fruit."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.market.fruit import coarse_fruit, fruit_paint
from assets.builders.market.sculpt import (
    F8,
    Colour,
    Painter,
    Sculpt,
    capsule_bar,
    noise,
    plain,
    planked,
    rounded_box,
    surface,
    turned,
    uniform_draws,
)
from mimics_app.world.content.meshes.primitives import box, icosphere

__all__ = ["awning", "goods", "stall_wood"]

WOOD: Colour = (0.42, 0.21, 0.085)
PALE_WOOD: Colour = (0.62, 0.38, 0.17)
TEAL: Colour = (0.055, 0.27, 0.27)
CREAM: Colour = (0.88, 0.80, 0.62)
RED: Colour = (0.62, 0.035, 0.03)


STALL_LOW, STALL_HIGH = (0.088, -0.150), (0.300, 0.030)
"""Corners of the table in x and z [m]."""
TABLE = 0.160


def stall_wood() -> Sculpt:
    """Table, panels, posts and beams."""
    sculpt = Sculpt()
    (x0, z0), (x1, z1) = STALL_LOW, STALL_HIGH
    middle, deep = 0.5 * (x0 + x1), 0.5 * (z0 + z1)
    _table_top(sculpt)
    _panels(sculpt)
    sculpt.add(box(x1 - x0 - 0.02, 0.15, z1 - z0 - 0.024), (0.03, 0.02, 0.015), at=(middle, 0.075, deep))
    for y in (0.022, 0.130):
        sculpt.add(rounded_box(x1 - x0 + 0.004, 0.011, 0.006, 0.002, 1), plain(CREAM, 7), at=(middle, y, z1 - 0.004))
        sculpt.add(rounded_box(0.006, 0.011, z1 - z0 + 0.002, 0.002, 1), plain(CREAM, 8), at=(x0 + 0.003, y, deep))
    _frame_of_awning(sculpt)
    _sign(sculpt)
    return sculpt


def _table_top(sculpt: Sculpt) -> None:
    """Five boards of pale wood."""
    (x0, z0), (x1, z1) = STALL_LOW, STALL_HIGH
    boards = 5
    deep = (z1 - z0 + 0.012) / boards
    for i in range(boards):
        tone = 0.92 + 0.16 * uniform_draws(8, 3)[i]
        sculpt.add(
            rounded_box(x1 - x0 + 0.014, 0.013, deep - 0.0012, 0.0022, 1),
            planked(tuple(tone * part for part in PALE_WOOD), 2, deep, 20 + i),
            at=(0.5 * (x0 + x1), TABLE - 0.0065, z0 - 0.004 + (i + 0.5) * deep),
        )


def _panels(sculpt: Sculpt) -> None:
    """Nine teal boards in front, seven at either side."""
    (x0, z0), (x1, z1) = STALL_LOW, STALL_HIGH
    count = 9
    wide = (x1 - x0 - 0.008) / count
    for i in range(count):
        tone = 0.86 + 0.28 * uniform_draws(32, 5)[i]
        sculpt.add(
            rounded_box(wide - 0.0012, 0.140, 0.007, 0.0018, 1),
            planked(tuple(tone * c for c in TEAL), 0, wide, 40 + i),
            at=(x0 + 0.004 + (i + 0.5) * wide, 0.075, z1 - 0.010),
        )
    count = 7
    wide = (z1 - z0 - 0.012) / count
    for i in range(count):
        tone = 0.80 + 0.28 * uniform_draws(32, 6)[i]
        for x in (x0 + 0.008, x1 - 0.008):
            sculpt.add(
                rounded_box(0.007, 0.140, wide - 0.0012, 0.0018, 1),
                planked(tuple(tone * c for c in TEAL), 2, wide, 60 + i),
                at=(x, 0.075, z0 + 0.004 + (i + 0.5) * wide),
            )


def _frame_of_awning(sculpt: Sculpt) -> None:
    (x0, z0), x1 = STALL_LOW, STALL_HIGH[0]
    for x in (x0 + 0.012, x1 - 0.012):
        sculpt.add(rounded_box(0.013, 0.34, 0.013, 0.003, 1), plain(WOOD, 11), at=(x, TABLE + 0.17, z0 + 0.010))
        reach = np.linspace(0.0, 1.0, 5)
        brace = np.stack([np.full(5, x), 0.395 + 0.055 * reach, z0 + 0.014 + 0.085 * reach], 1)
        sculpt.add(capsule_bar(brace, 0.0042, 8, 2), plain(WOOD, 12))
    sculpt.add(
        rounded_box(x1 - x0 + 0.01, 0.012, 0.012, 0.003, 1), plain(WOOD, 13), at=(0.5 * (x0 + x1), 0.484, z0 + 0.010)
    )
    sculpt.add(
        rounded_box(x1 - x0 - 0.01, 0.010, 0.008, 0.002, 1), plain(WOOD, 14), at=(0.5 * (x0 + x1), 0.300, z0 + 0.010)
    )


def _sign(sculpt: Sculpt) -> None:
    """A slate with a painted apple on the front."""
    z = STALL_HIGH[1] - 0.002
    sculpt.add(rounded_box(0.062, 0.052, 0.005, 0.002, 1), plain(PALE_WOOD, 15), at=(0.226, 0.076, z))
    sculpt.add(rounded_box(0.053, 0.043, 0.005, 0.001, 1), (0.022, 0.026, 0.024), at=(0.226, 0.076, z + 0.0012))
    flat = turned(scale=(1.0, 1.0, 0.12))
    sculpt.add(icosphere(0.0125, 3), (0.70, 0.05, 0.04), at=(0.226, 0.073, z + 0.0038), turn=flat)
    sculpt.add(
        icosphere(0.0045, 2),
        (0.20, 0.50, 0.06),
        at=(0.232, 0.088, z + 0.0038),
        turn=turned(0.0, 0.0, 35.0) @ turned(scale=(1.4, 0.7, 0.2)),
    )
    stem = np.array([[0.226, 0.083, z + 0.004], [0.2265, 0.087, z + 0.004], [0.228, 0.090, z + 0.004]])
    sculpt.add(capsule_bar(stem, 0.0011, 6, 2), (0.75, 0.62, 0.40))


def awning() -> Sculpt:
    """Striped cloth over the table, sagging between its beams, with a scalloped border."""
    sculpt = Sculpt()
    (x0, z0), (x1, z1) = STALL_LOW, STALL_HIGH
    x0, x1, z0, z1 = x0 - 0.022, x1 + 0.022, z0 - 0.012, z1 + 0.028
    stripes = 10
    wide = (x1 - x0) / stripes
    for i in range(stripes):
        colour = RED if i % 2 == 0 else CREAM
        left = x0 + i * wide
        for lift, shade, below in ((0.0, 1.0, False), (-0.0012, 0.6, True)):
            paint = _cloth(colour, shade)
            roof = surface(
                _roof(left, wide, (z0, z1), lift), np.linspace(0.0, 1.0, 13), np.linspace(0.0, 1.0, 3), flip=below
            )
            edge = surface(
                _border(left, wide, z1, lift), np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 15), flip=below
            )
            sculpt.add(roof, paint).add(edge, paint)
    return sculpt


def _cloth(colour: Colour, shade: float) -> Painter:
    def paint(at: F8, normals: F8) -> F8:
        return shade * np.asarray(colour) * (0.90 + 0.16 * noise(at, 0.02, 4))[:, None]

    return paint


def _height(u: F8) -> F8:
    """Of the cloth from its back beam (0) to its front (1) [m]."""
    return np.asarray(0.505 - 0.075 * u - 0.030 * u * u + 0.010 * np.sin(math.pi * u))


def _roof(left: float, wide: float, z: tuple[float, float], lift: float) -> Painter:
    """One stripe of the roof by its two coordinates."""

    def point(u: F8, v: F8) -> F8:
        return np.stack([left + v * wide, _height(u) + lift, z[0] + u * (z[1] - z[0])], 1)

    return point


def _border(left: float, wide: float, front: float, lift: float) -> Painter:
    """What hangs down of one stripe, round below, by its two coordinates."""

    def point(u: F8, v: F8) -> F8:
        drop = 0.020 + 0.017 * np.sqrt(np.clip(1.0 - (2.0 * v - 1.0) ** 2, 0.0, 1.0))
        y = float(_height(np.ones(1))[0])
        return np.stack([left + v * wide, y - u * drop, front + 0.0006 + lift + 0.004 * u], 1)

    return point


def goods() -> Sculpt:
    """Fruit in crates at the table's far side, and a basket."""
    sculpt = Sculpt()
    kinds: list[tuple[Colour, Colour]] = [
        ((0.50, 0.012, 0.015), (0.70, 0.36, 0.05)),
        ((0.80, 0.34, 0.015), (0.85, 0.45, 0.03)),
        ((0.34, 0.52, 0.05), (0.60, 0.62, 0.10)),
    ]
    for i, colours in enumerate(kinds):
        z = -0.118 + 0.052 * i
        lift = 0.012 * (2 - i)
        _tray(sculpt, (0.252, TABLE + lift, z), colours, i)
        if lift > 0.0:
            sculpt.add(
                rounded_box(0.088, lift, 0.046, 0.001, 1), plain(WOOD, 70 + i), at=(0.252, TABLE + 0.5 * lift, z)
            )
    return sculpt


def _tray(sculpt: Sculpt, at: tuple[float, float, float], colours: tuple[Colour, Colour], seed: int) -> None:
    x, y, z = at
    w, d, h, t = 0.092, 0.048, 0.020, 0.003
    wood = plain(PALE_WOOD, 80 + seed)
    for dz in (-0.5 * d, 0.5 * d):
        sculpt.add(rounded_box(w, h, t, 0.001, 1), wood, at=(x, y + 0.5 * h, z + dz))
    for dx in (-0.5 * w, 0.5 * w):
        sculpt.add(rounded_box(t, h, d, 0.001, 1), wood, at=(x + dx, y + 0.5 * h, z))
    sculpt.add(box(w, 0.002, d), (0.10, 0.06, 0.03), at=(x, y + 0.002, z))
    wobble = uniform_draws(64, 30 + seed)
    radius = 0.0105
    place = 0
    for layer, (rows, columns) in enumerate(((2, 4), (1, 3))):
        for r in range(rows):
            for c in range(columns):
                dx = (c - 0.5 * (columns - 1)) * 0.0212 + 0.002 * (wobble[place] - 0.5)
                dz = (r - 0.5 * (rows - 1)) * 0.0215 + 0.002 * (wobble[place + 20] - 0.5)
                up = 0.0125 + 0.0155 * layer
                turn = turned(
                    40.0 * (wobble[place + 30] - 0.5), 360.0 * wobble[place], 40.0 * (wobble[place + 40] - 0.5)
                )
                small = coarse_fruit(radius)
                sculpt.add(small, fruit_paint(colours, seed * 40 + place), at=(x + dx, y + up, z + dz), turn=turn)
                place += 1
