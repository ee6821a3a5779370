"""Furniture of two more rooms behind the table: a kitchen, and a room to play in. Light is baked into their shades."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.kit.sketch import Point, Sketch
from assets.builders.room.furnished import FLOOR, curtain, disc, drum, plant, walls, window

__all__ = ["kitchen", "playroom"]

_WALL = -1.895
"""Front of the back wall in z [m]."""
_TOYS = ("red", "honey", "leaf", "navy", "rose")


def kitchen(sketch: Sketch, seed: int) -> None:
    """Add a worktop with cupboards below and above, a tiled wall, a window, pans on a rail, and jars."""
    rng = np.random.default_rng(seed)
    walls(sketch, "cream", "cream", "tile")
    window(sketch, (-0.62, 0.44), (0.50, 1.5), (2, 2), rng)
    _worktop(sketch)
    _tiles(sketch)
    for left, right in ((-1.75, -0.80), (0.78, 1.75)):
        _cupboard(sketch, left, right)
    sketch.box("steel", (-0.70, 0.60, -1.86), (-1.75, 0.612, -1.848), shade=1.2)
    for x, long in ((-1.62, 0.26), (-1.50, 0.22), (-1.38, 0.28), (-1.27, 0.20)):
        sketch.box("iron", (x - 0.006, 0.60 - long, -1.85), (x + 0.006, 0.60, -1.84), shade=2.0)
        disc(sketch, "steel", (x, 0.60 - long, -1.838), 0.045, 1.0, 20)
    drum(sketch, "red", (-1.02, 0.16, -1.60), 0.13, (0.12, 0.12))
    drum(sketch, "iron", (-1.02, 0.29, -1.60), 0.012, (0.125, 0.115))
    drum(sketch, "iron", (-1.02, 0.302, -1.60), 0.03, (0.02, 0.026))
    for x, high, colour in ((0.86, 0.20, "cream"), (1.02, 0.16, "honey"), (1.16, 0.13, "rose"), (1.29, 0.10, "leaf")):
        drum(sketch, colour, (x, 0.16, -1.70), high, (0.06, 0.06))
        drum(sketch, "oakwood", (x, 0.16 + high, -1.70), 0.018, (0.063, 0.063))
    for x, high, shade in ((1.46, 0.36, 0.9), (1.56, 0.28, 1.25)):
        sketch.box("oakwood", (x, 0.16, -1.80), (x + 0.22, 0.16 + high, -1.775), shade=shade)
    drum(sketch, "clay", (0.30, 0.415, -1.82), 0.11, (0.045, 0.06))
    plant(sketch, rng, (0.30, 0.52, -1.82), 16, 0.18)
    sketch.box("steel", (-0.09, 0.16, -1.80), (-0.06, 0.40, -1.77), shade=1.35)
    sketch.box("steel", (-0.09, 0.38, -1.80), (-0.06, 0.41, -1.58), shade=1.55)


def playroom(sketch: Sketch, seed: int) -> None:
    """Add a low shelf with books, bricks, a ring pyramid and a ball, bunting, a rainbow, a window and a chest."""
    rng = np.random.default_rng(seed)
    walls(sketch, "white", "powder", "oakwood")
    sketch.box("white", (-2.4, -0.06, -1.9), (2.4, -0.02, -1.87), hidden="n")
    window(sketch, (0.52, 0.02), (1.46, 1.4), (2, 2), rng)
    for left in (0.30, 1.48):
        curtain(sketch, left, left + 0.20)
    _shelf(sketch, rng)
    _bunting(sketch)
    _rainbow(sketch)
    for x, y in ((-0.74, 0.19), (0.14, 0.19)):
        for off, size in ((-0.08, 0.07), (0.0, 0.10), (0.09, 0.075)):
            disc(sketch, "white", (x + off, y, -1.856), size, 1.2, 24)
    sketch.box("honey", (0.50, FLOOR, -1.86), (1.44, -0.30, -1.40), shade=0.72)
    sketch.box("honey", (0.48, -0.30, -1.88), (1.46, -0.26, -1.38), shade=1.0)
    for number, colour in enumerate(_TOYS):
        _brick(sketch, colour, (0.58 + 0.18 * number, -0.26, -1.62), 0.11)
    for x, colour in ((0.65, "powder"), (0.83, "honey"), (1.20, "red")):
        _brick(sketch, colour, (x, -0.15, -1.61), 0.11)


def _brick(sketch: Sketch, colour: str, low: Point, side: float) -> None:
    high = (low[0] + side, low[1] + side, low[2] + side)
    sketch.box(colour, low, high, shade=1.3, hidden="nsewd")
    sketch.box(colour, low, high, shade=1.0, hidden="nud")
    sketch.box(
        "white",
        (low[0] + 0.2 * side, low[1] + 0.2 * side, high[2]),
        (high[0] - 0.2 * side, high[1] - 0.2 * side, high[2] + 0.002),
        hidden="nudew",
    )
    sketch.box(
        colour,
        (low[0] + 0.32 * side, low[1] + 0.32 * side, high[2]),
        (high[0] - 0.32 * side, high[1] - 0.32 * side, high[2] + 0.004),
        hidden="nudew",
    )


def _rainbow(sketch: Sketch) -> None:
    """Half discs on the wall over the rail."""
    turns = np.linspace(0.0, math.pi, 25)
    for number, colour in enumerate(("red", "honey", "lawn", "navy", "powder")):
        radius, z = 0.46 - 0.07 * number, -1.885 + 0.004 * number
        corners = [(float(-0.30 + radius * math.cos(t)), float(0.19 + radius * math.sin(t)), z) for t in turns]
        sketch.fan(colour, corners, [(0.0, 0.0)] * len(corners), 1.0)


def _worktop(sketch: Sketch) -> None:
    sketch.box("sage", (-1.95, FLOOR + 0.08, -1.88), (1.95, 0.12, -1.32), shade=0.78)
    sketch.box("oakwood", (-1.97, 0.12, -1.89), (1.97, 0.16, -1.28), shade=1.3)
    for number in range(6):
        x = -1.93 + 0.65 * number
        sketch.box("sage", (x + 0.02, FLOOR + 0.12, -1.32), (x + 0.63, -0.10, -1.305), shade=1.0, hidden="n")
        sketch.box("sage", (x + 0.02, -0.07, -1.32), (x + 0.63, 0.09, -1.305), shade=1.05, hidden="n")
        sketch.box("brass", (x + 0.24, 0.01, -1.305), (x + 0.40, 0.025, -1.28), shade=1.2, hidden="n")


def _tiles(sketch: Sketch) -> None:
    """White tiles between worktop and cupboards, joints between them."""
    for left, right, high in ((-1.95, -0.69, 0.66), (0.57, 1.95, 0.66), (-0.69, 0.57, 0.37)):
        sketch.box("white", (left, 0.16, _WALL), (right, high, -1.875), hidden="n", shade=1.02)
        for y in np.arange(0.26, high, 0.10):
            sketch.box("slate", (left, y, -1.876), (right, y + 0.005, -1.872), hidden="nwe", shade=2.0)
        for row, y in enumerate(np.arange(0.16, high - 0.01, 0.10)):
            for x in np.arange(left + 0.10 * (1 + row % 2), right, 0.20):
                sketch.box("slate", (x, y, -1.876), (x + 0.005, min(y + 0.10, high), -1.872), hidden="nud", shade=2.0)


def _cupboard(sketch: Sketch, left: float, right: float) -> None:
    sketch.box("sage", (left, 0.66, -1.89), (right, 1.5, -1.56), shade=0.82, under=0.5)
    half = 0.5 * (left + right)
    for x0, x1 in ((left, half), (half, right)):
        sketch.box("sage", (x0 + 0.02, 0.69, -1.56), (x1 - 0.02, 1.48, -1.545), shade=1.1, hidden="n")
        handle = x1 - 0.08 if x1 == half else x0 + 0.06
        sketch.box("brass", (handle, 0.73, -1.545), (handle + 0.018, 0.87, -1.52), shade=1.2, hidden="n")


def _shelf(sketch: Sketch, rng: np.random.Generator) -> None:
    """A shelf of two boards, with what is kept on it."""
    left, right = -1.80, -0.86
    sketch.box("white", (left, FLOOR, -1.88), (right, 0.56, -1.86), shade=0.72)
    for y in (-0.34, 0.06, 0.54):
        sketch.box("white", (left + 0.03, y - 0.03, -1.86), (right - 0.03, y, -1.57), hidden="nwe")
    for x in (left, right - 0.03):
        sketch.box("white", (x, FLOOR, -1.88), (x + 0.03, 0.56, -1.56), shade=0.88)
    x = left + 0.06
    while x < -1.40:
        thick, high = float(rng.uniform(0.03, 0.05)), float(rng.uniform(0.24, 0.36))
        colour = str(rng.choice(_TOYS))
        sketch.box(colour, (x, 0.06, -1.84), (x + thick, 0.06 + high, -1.62), shade=float(rng.uniform(0.9, 1.2)))
        x += thick + 0.003
    for number, (radius, colour) in enumerate(zip((0.13, 0.11, 0.09, 0.07, 0.05), _TOYS, strict=True)):
        drum(sketch, colour, (-1.10, 0.06 + 0.062 * number, -1.70), 0.06, (radius, 0.94 * radius))
    for x, y, colour in ((-1.68, 0.54, "honey"), (-1.50, 0.54, "navy"), (-1.59, 0.68, "red")):
        _brick(sketch, colour, (x, y, -1.78), 0.14)
    disc(sketch, "red", (-1.08, 0.67, -1.69), 0.13, 1.05, 28)
    for number in range(6):
        turn = math.pi * number / 3.0
        at = (-1.08 + 0.07 * math.cos(turn), 0.67 + 0.07 * math.sin(turn), -1.685)
        disc(sketch, "white", at, 0.026, 1.05, 16)


def _bunting(sketch: Sketch) -> None:
    """Flags on a line that sags between two points of the wall."""
    for first, last in ((-2.2, -0.2), (-0.2, 2.2)):
        count = 9
        step = (last - first) / count
        for number in range(count):
            x0, x1 = first + step * (number + 0.08), first + step * (number + 0.92)
            y0, y1 = (1.05 - 0.22 * math.sin(math.pi * (x - first) / (last - first)) for x in (x0, x1))
            corners = [(x0, y0, -1.86), (0.5 * (x0 + x1), 0.5 * (y0 + y1) - 0.22, -1.86), (x1, y1, -1.86)]
            sketch.fan(_TOYS[number % 5], corners, [(0.0, 0.0)] * 3, [1.15, 0.9, 1.15])
