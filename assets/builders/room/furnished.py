"""Furniture of three rooms behind the table: a study, a workshop, a conservatory. Light is baked into their shades."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np

from assets.builders.kit.sketch import Point, Sketch

__all__ = [
    "COLOURS",
    "FLOOR",
    "conservatory",
    "curtain",
    "disc",
    "drum",
    "plant",
    "study",
    "waiting_room",
    "walls",
    "window",
    "workshop",
]

FLOOR = -0.74
"""Height of the floor below the table [m]."""
_BACK, _SIDE, _FRONT, _HIGH = -1.9, 2.4, 2.4, 1.9
"""Back wall in z, side walls in x, the open side in z, upper edge [m]."""
_LIGHT = (0.55, 0.68, 0.48)
"""Direction to the light that round things are shaded by."""

COLOURS = {
    "white": (0.80, 0.79, 0.75, 1.0),
    "walnut": (0.20, 0.105, 0.055, 1.0),
    "brass": (0.56, 0.40, 0.15, 1.0),
    "lamp": (0.90, 0.74, 0.46, 1.0),
    "cloth": (0.58, 0.40, 0.22, 1.0),
    "red": (0.44, 0.075, 0.055, 1.0),
    "navy": (0.06, 0.11, 0.24, 1.0),
    "cream": (0.66, 0.58, 0.42, 1.0),
    "sky": (0.50, 0.68, 0.86, 1.0),
    "far": (0.30, 0.44, 0.50, 1.0),
    "leaf": (0.11, 0.25, 0.06, 1.0),
    "lawn": (0.26, 0.40, 0.10, 1.0),
    "clay": (0.50, 0.20, 0.10, 1.0),
    "teal": (0.10, 0.30, 0.32, 1.0),
    "sage": (0.34, 0.42, 0.34, 1.0),
    "oakwood": (0.46, 0.30, 0.16, 1.0),
    "tile": (0.56, 0.53, 0.47, 1.0),
    "slate": (0.30, 0.35, 0.40, 1.0),
    "concrete": (0.33, 0.33, 0.33, 1.0),
    "peg": (0.46, 0.30, 0.15, 1.0),
    "powder": (0.46, 0.58, 0.68, 1.0),
    "rose": (0.66, 0.36, 0.32, 1.0),
    "honey": (0.78, 0.56, 0.22, 1.0),
    "steel": (0.44, 0.47, 0.50, 1.0),
    "iron": (0.10, 0.11, 0.12, 1.0),
    "safety": (0.78, 0.34, 0.03, 1.0),
}
"""Linear colours of surfaces without texture."""


def study(sketch: Sketch, seed: int) -> None:
    """Add a sideboard with books and a lamp, a window with a curtain, and a picture, to panelled walls."""
    rng = np.random.default_rng(seed)
    _sideboard(sketch, -1.62, -0.30)
    _books(sketch, rng, -1.56, -0.98, 0.012)
    _lamp(sketch, (-0.48, 0.012, -1.66))
    drum(sketch, "clay", (-0.80, 0.012, -1.66), 0.14, (0.05, 0.075))
    plant(sketch, rng, (-0.80, 0.14, -1.66), 14, 0.20)
    window(sketch, (0.28, -0.12), (1.36, 1.5), (3, 2), rng)
    for left in (0.02, 1.40):
        curtain(sketch, left, left + 0.24)


def workshop(sketch: Sketch, seed: int) -> None:
    """Add walls of slate blue, a board with tools, and a bench with drawers and tins."""
    rng = np.random.default_rng(seed)
    walls(sketch, "slate", "slate", "concrete")
    sketch.box("peg", (-1.35, 0.02, -1.895), (1.20, 0.85, -1.865), hidden="n")
    for row in range(7):
        for column in range(26):
            x, y = -1.30 + 0.097 * column, 0.08 + 0.11 * row
            sketch.box("iron", (x, y, -1.866), (x + 0.008, y + 0.008, -1.864), hidden="nweud", shade=1.6)
    _tools(sketch)
    sketch.box("cream", (-1.75, -0.20, -1.88), (1.75, -0.14, -1.30), shade=0.62)
    for number in range(5):
        x = -1.70 + 0.69 * number
        sketch.box("steel", (x, -0.70, -1.86), (x + 0.64, -0.21, -1.34), shade=0.62, hidden="n")
        for y in (-0.36, -0.52, -0.68):
            sketch.box("iron", (x + 0.02, y, -1.342), (x + 0.62, y + 0.012, -1.338), hidden="nweud", shade=1.5)
            sketch.box("safety", (x + 0.25, y + 0.07, -1.34), (x + 0.39, y + 0.09, -1.32), hidden="n")
    tins = ((-1.5, "red"), (-1.36, "navy"), (-1.24, "cream"), (1.25, "safety"), (1.40, "steel"), (1.55, "leaf"))
    for x, colour in tins:
        high = 0.12 + 0.05 * float(rng.random())
        drum(sketch, colour, (x, -0.14, -1.62), high, (0.055, 0.055))
        drum(sketch, "steel", (x, -0.14 + high, -1.62), 0.008, (0.057, 0.057))
    _vice(sketch)


def conservatory(sketch: Sketch, seed: int) -> None:
    """Add a wall of windows to a garden, tiles, and plants in pots."""
    rng = np.random.default_rng(seed)
    walls(sketch, "white", "white", "tile", back=False)
    _garden(sketch, rng)
    sketch.box("white", (-_SIDE, FLOOR, -1.93), (_SIDE, -0.22, -1.87), shade=0.92)
    sketch.box("white", (-_SIDE, -0.22, -1.95), (_SIDE, -0.18, -1.80))
    for x in np.linspace(-2.1, 2.1, 7):
        sketch.box("white", (x - 0.03, -0.20, -1.93), (x + 0.03, _HIGH, -1.87), shade=0.96)
    sketch.box("white", (-_SIDE, 0.60, -1.92), (_SIDE, 0.64, -1.88), shade=0.90)
    for line in np.arange(-2.2, 2.3, 0.4):
        sketch.box("slate", (line, FLOOR, -1.9), (line + 0.008, FLOOR + 0.002, 2.4), hidden="nsewd")
        sketch.box("slate", (-2.4, FLOOR, line), (2.4, FLOOR + 0.002, line + 0.008), hidden="nsewd")
    for x, z, size in ((-1.45, -1.55, 1.0), (-1.12, -1.60, 0.7), (1.30, -1.52, 1.15), (0.95, -1.66, 0.6)):
        top = -0.52 + 0.30 * size
        drum(sketch, "clay", (x, FLOOR, z), top - FLOOR, (0.13 * size, 0.18 * size))
        drum(sketch, "clay", (x, top - 0.04, z), 0.05, (0.195 * size, 0.195 * size))
        plant(sketch, rng, (x, top, z), 34, 0.48 * size)


def waiting_room(sketch: Sketch, seed: int) -> None:
    """Add walls, a window, a door, chairs, a table with magazines, and a plant; the floor, y = 0, is left out."""
    rng = np.random.default_rng(seed)
    half, high, back = 3.2, 2.8, -3.4

    def corner(point: Point) -> float:
        near = max(min(half - abs(point[0]), point[2] - back), 0.0)
        edge = 1.0 - 0.26 * math.exp(-near / 0.5) - 0.22 * math.exp(-max(point[1], 0.0) / 0.2)
        return edge - 0.14 * math.exp(-max(high - point[1], 0.0) / 0.4)

    sides = (
        ((-half, 0.0, back), (2 * half, 0.0, 0.0)),
        ((-half, 0.0, 3.4), (0.0, 0.0, back - 3.4)),
        ((half, 0.0, back), (0.0, 0.0, 3.4 - back)),
        ((half, 0.0, 3.4), (-2 * half, 0.0, 0.0)),
    )
    for start, along in sides:
        sketch.sheet("plaster", start, along, (0.0, high, 0.0), (14, 10), 1.0, corner)
    sketch.sheet("white", (-half, high, back), (2 * half, 0, 0), (0, 0, 3.4 - back), (6, 6), 1.0, lambda p: 0.96)
    for low, top, deep, colour in ((0.0, 0.12, 0.03, "white"), (0.92, 1.0, 0.03, "sage")):
        sketch.box(colour, (-half, low, back), (half, top, back + deep), hidden="n")
        sketch.box(colour, (-half, low, back), (-half + deep, top, 3.4), hidden="w", shade=0.9)
        sketch.box(colour, (half - deep, low, back), (half, top, 3.4), hidden="e", shade=0.9)
    _place(sketch, lambda part: window(part, (-0.62, 1.04), (0.62, 2.1), (2, 2), rng), (-1.75, 0.0, back + 1.9))
    _place(sketch, _door, (2.25, 0.0, back))
    for number in range(4):
        _place(sketch, _chair, (-2.62 + 0.68 * number, 0.0, back + 0.42))
    _place(sketch, _chair, (1.15, 0.0, back + 0.42))
    _place(sketch, _frame, (0.62, 1.62, back))
    drum(sketch, "clay", (0.55, 0.0, back + 0.40), 0.42, (0.15, 0.20))
    plant(sketch, rng, (0.55, 0.42, back + 0.40), 34, 0.62)
    _magazines(sketch, rng, (-1.6, 0.0, back + 1.25))


def _place(sketch: Sketch, draw: Callable[[Sketch], None], at: Point) -> None:
    part = Sketch()
    draw(part)
    sketch.add(part, lambda point: (point[0] + at[0], point[1] + at[1], point[2] + at[2]))


def _chair(sketch: Sketch) -> None:
    """An upholstered chair that looks at the room."""
    sketch.box("teal", (-0.27, 0.38, -0.26), (0.27, 0.47, 0.24), shade=1.0)
    sketch.box("teal", (-0.27, 0.50, -0.32), (0.27, 0.92, -0.25), shade=0.82)
    for x in (-0.27, 0.23):
        for z in (-0.26, 0.20):
            sketch.box("oakwood", (x, 0.0, z), (x + 0.04, 0.38, z + 0.04), shade=0.8)
        sketch.box("oakwood", (x, 0.60, -0.26), (x + 0.045, 0.635, 0.22))
        sketch.box("oakwood", (x, 0.47, 0.18), (x + 0.045, 0.60, 0.22), shade=0.85)


def _door(sketch: Sketch) -> None:
    sketch.box("white", (-0.52, 0.0, 0.0), (0.52, 2.14, 0.05), hidden="n", shade=0.94)
    sketch.box("oakwood", (-0.44, 0.0, 0.05), (0.44, 2.06, 0.06), hidden="n", shade=0.85)
    for low, top in ((0.16, 0.92), (1.04, 1.92)):
        sketch.box("oakwood", (-0.32, low, 0.06), (0.32, top, 0.066), hidden="n", shade=0.72)
    sketch.box("steel", (-0.41, 0.99, 0.06), (-0.28, 1.015, 0.10), shade=1.5)


def _frame(sketch: Sketch) -> None:
    """A framed landscape."""
    sketch.box("oakwood", (-0.36, -0.26, 0.0), (0.36, 0.26, 0.03), hidden="n", shade=0.7)
    sketch.box("white", (-0.33, -0.23, 0.03), (0.33, 0.23, 0.032), hidden="n")
    part = Sketch()
    _view(part, np.random.default_rng(5), (-0.27, 0.27), (-0.17, 0.17), 0.034)
    sketch.add(part, lambda point: point)


def _magazines(sketch: Sketch, rng: np.random.Generator, at: Point) -> None:
    x, y, z = at
    sketch.box("oakwood", (x - 0.5, y + 0.36, z - 0.28), (x + 0.5, y + 0.40, z + 0.28), shade=1.1)
    for left in (-0.46, 0.41):
        for deep in (-0.24, 0.19):
            sketch.box("oakwood", (x + left, y, z + deep), (x + left + 0.05, y + 0.36, z + deep + 0.05), shade=0.75)
    for number, colour in enumerate(("red", "cream", "navy", "safety", "white")):
        low = y + 0.40 + 0.006 * (number % 3)
        left, deep = x - 0.38 + 0.16 * number + rng.uniform(-0.03, 0.03), z - 0.12 + rng.uniform(-0.06, 0.06)
        sketch.box(colour, (left, low, deep), (left + 0.17, low + 0.006, deep + 0.23), shade=1.1)


def walls(sketch: Sketch, lower: str, upper: str, floor: str, *, back: bool = True) -> None:
    """Add floor and walls of two colours, darker in the corners and below the table."""

    def corner(point: Point) -> float:
        near = max(min(point[2] - _BACK, _SIDE - abs(point[0])), 0.0)
        low = max(point[1] - FLOOR, 0.0)
        return (1.0 - 0.28 * math.exp(-near / 0.35)) * (1.0 - 0.35 * math.exp(-low / 0.12))

    def below(point: Point) -> float:
        away = math.hypot(max(abs(point[0]) - 0.8, 0.0), max(-0.6 - point[2], point[2] - 0.56, 0.0))
        near = max(min(point[2] - _BACK, _SIDE - abs(point[0])), 0.0)
        return (1.0 - 0.5 * math.exp(-away / 0.25)) * (1.0 - 0.3 * math.exp(-near / 0.25))

    sketch.sheet(floor, (-_SIDE, FLOOR, _FRONT), (2 * _SIDE, 0, 0), (0, 0, _BACK - _FRONT), (14, 14), 1.0, below)
    sides = [
        ((-_SIDE, 0.0, _FRONT), (0.0, 0.0, _BACK - _FRONT)),
        ((_SIDE, 0.0, _BACK), (0.0, 0.0, _FRONT - _BACK)),
    ]
    if back:
        sides.append(((-_SIDE, 0.0, _BACK), (2 * _SIDE, 0.0, 0.0)))
    for (x, _, z), along in sides:
        sketch.sheet(lower, (x, FLOOR, z), along, (0.0, 0.7, 0.0), (10, 5), 1.0, lambda p: 0.75 * corner(p))
        sketch.sheet(upper, (x, FLOOR + 0.7, z), along, (0.0, _HIGH - FLOOR - 0.7, 0.0), (10, 5), 1.0, corner)


def _sideboard(sketch: Sketch, left: float, right: float) -> None:
    sketch.box("walnut", (left, FLOOR + 0.08, -1.88), (right, -0.016, -1.50), shade=0.9)
    sketch.box("walnut", (left - 0.02, -0.016, -1.89), (right + 0.02, 0.012, -1.48), shade=1.35)
    doors = 3
    wide = (right - left) / doors
    for number in range(doors):
        x = left + wide * number
        sketch.box("walnut", (x + 0.02, FLOOR + 0.12, -1.50), (x + wide - 0.02, -0.05, -1.49), shade=1.12, hidden="n")
        sketch.box("brass", (x + wide - 0.07, -0.34, -1.49), (x + wide - 0.05, -0.24, -1.475), hidden="n")


def _books(sketch: Sketch, rng: np.random.Generator, left: float, right: float, foot: float) -> None:
    x = left
    colours = ("red", "navy", "cream", "leaf", "walnut", "brass")
    while x < right:
        thick, high = rng.uniform(0.022, 0.052), rng.uniform(0.17, 0.27)
        colour = str(rng.choice(colours))
        sketch.box(colour, (x, foot, -1.86), (x + thick, foot + high, -1.66), shade=float(rng.uniform(0.8, 1.15)))
        band = "brass" if colour != "brass" else "cream"
        sketch.box(
            band,
            (x + 0.003, foot + 0.75 * high, -1.66),
            (x + thick - 0.003, foot + 0.82 * high, -1.658),
            hidden="nweud",
        )
        x += thick + 0.002


def _lamp(sketch: Sketch, foot: Point) -> None:
    x, y, z = foot
    drum(sketch, "brass", foot, 0.02, (0.07, 0.06))
    drum(sketch, "brass", (x, y + 0.02, z), 0.20, (0.012, 0.010))
    drum(sketch, "lamp", (x, y + 0.20, z), 0.19, (0.145, 0.085), even=0.85)


def window(
    sketch: Sketch,
    low: tuple[float, float],
    high: tuple[float, float],
    panes: tuple[int, int],
    rng: np.random.Generator,
) -> None:
    """Add a window in the back wall with a sill, its panes across and up, and a view."""
    (x0, y0), (x1, y1) = low, high
    _view(sketch, rng, (x0, x1), (y0, y1), -1.888)
    for number in range(panes[0] + 1):
        x = x0 + (x1 - x0) * number / panes[0]
        sketch.box("white", (x - 0.022, y0 - 0.03, -1.89), (x + 0.022, y1, -1.85), hidden="n")
    for y in (y0, y0 + 0.42, y1):
        sketch.box("white", (x0 - 0.022, y - 0.02, -1.89), (x1 + 0.022, y + 0.02, -1.852), hidden="n", shade=0.95)
    sketch.box("white", (x0 - 0.07, y0 - 0.06, -1.89), (x1 + 0.07, y0 - 0.03, -1.76), shade=0.98)


def _view(
    sketch: Sketch, rng: np.random.Generator, across: tuple[float, float], up: tuple[float, float], z: float
) -> None:
    """Sky over far hills, woods and a lawn, painted on the pane."""
    (x0, x1), (y0, y1) = across, up
    wide = x1 - x0
    horizon = y0 + 0.22
    sketch.sheet(
        "sky", (x0, y0, z), (wide, 0, 0), (0, y1 - y0, 0), (2, 8), 1.0, lambda p: min(1.0, 1.18 - 0.30 * (p[1] - y0))
    )
    rows = (("far", 0.0, 0.10, 0.001, 1.15), ("leaf", -0.06, 0.07, 0.002, 1.5), ("lawn", -0.11, 0.015, 0.003, 1.1))
    for colour, under, rise, depth, shade in rows:
        base = horizon + under
        phase = rng.uniform(0.0, 6.0, 3)
        xs = np.linspace(x0, x1, 25)
        tops = base + rise * (
            0.5 + 0.3 * np.sin(4.0 * xs / wide + phase[0]) + 0.2 * np.sin(11.0 * xs / wide + phase[1])
        )
        if colour == "leaf":
            tops += 0.02 * np.abs(np.sin(34.0 * xs / wide + phase[2]))
        for (a, left), (b, right) in zip(
            zip(xs, tops, strict=True), list(zip(xs, tops, strict=True))[1:], strict=False
        ):
            corners = [(a, y0, z + depth), (b, y0, z + depth), (b, right, z + depth), (a, left, z + depth)]
            corners = [(float(x), float(y), float(d)) for x, y, d in corners]
            sketch.fan(colour, corners, [(0.0, 0.0)] * 4, [0.75 * shade, 0.75 * shade, shade, shade])


def curtain(sketch: Sketch, left: float, right: float) -> None:
    """Add a curtain before the back wall, in folds."""
    steps = 16
    xs = np.linspace(left, right, steps + 1)
    shades = [0.62 + 0.38 * abs(math.sin(2.2 * number)) for number in range(steps + 1)]
    for number in range(steps):
        a, b = float(xs[number]), float(xs[number + 1])
        corners = [(a, -0.55, -1.84), (b, -0.55, -1.84), (b, 1.6, -1.84), (a, 1.6, -1.84)]
        one, two = shades[number], shades[number + 1]
        sketch.fan("cloth", corners, [(0.0, 0.0)] * 4, [one, two, two, one])


def _garden(sketch: Sketch, rng: np.random.Generator) -> None:
    _view(sketch, rng, (-3.4, 3.4), (-0.5, 2.3), -2.9)
    for _ in range(9):
        x, size = float(rng.uniform(-2.6, 2.6)), float(rng.uniform(0.16, 0.34))
        _crown(sketch, rng, (x, -0.10 + 0.6 * size, float(rng.uniform(-2.8, -2.4))), size)


def _crown(sketch: Sketch, rng: np.random.Generator, centre: Point, size: float) -> None:
    """A bush: discs from dark and large behind to light and small before."""
    x, y, z = centre
    for number in range(26):
        share = number / 25
        turn, far = rng.uniform(0.0, 2.0 * math.pi), size * math.sqrt(rng.random()) * (1.0 - 0.3 * share)
        at = (x + far * math.cos(turn), y + 0.8 * far * math.sin(turn) + 0.15 * size * share, z + 0.01 + 0.004 * number)
        disc(sketch, "leaf", at, size * (0.36 - 0.22 * share), 0.7 + 1.1 * share)


def disc(sketch: Sketch, material: str, centre: Point, radius: float, shade: float, sides: int = 9) -> None:
    """Add a flat disc that faces +z, lighter above."""
    turns = [2.0 * math.pi * number / sides for number in range(sides)]
    corners = [(centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t), centre[2]) for t in turns]
    sketch.fan(material, corners, [(0.0, 0.0)] * sides, [shade * (0.86 + 0.14 * math.sin(t)) for t in turns])


def plant(sketch: Sketch, rng: np.random.Generator, foot: Point, count: int, length: float) -> None:
    """Long leaves that rise from a pot and hang over."""
    x, y, z = foot
    for number in range(count):
        turn, lean = 2.4 * number + rng.uniform(-0.3, 0.3), rng.uniform(0.25, 1.15)
        long, wide = length * rng.uniform(0.7, 1.15), 0.075 * length * rng.uniform(0.8, 1.3)
        out, side = (math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))
        rows = []
        for step in np.linspace(0.0, 1.0, 5):
            far = long * step * math.sin(lean) * (0.5 + 0.5 * step)
            up = long * step * math.cos(lean) - 0.28 * long * step**3 * lean
            half = wide * math.sin(math.pi * (0.12 + 0.86 * step))
            middle = (x + far * out[0], y + up, z + far * out[1])
            rows.append([(middle[0] + s * half * side[0], middle[1], middle[2] + s * half * side[1]) for s in (-1, 1)])
        shade = float(rng.uniform(0.75, 1.7)) * (1.0 + 0.25 * out[0])
        for step, (low, high) in enumerate(itertools.pairwise(rows)):
            corners = [low[0], low[1], high[1], high[0]]
            shades = [shade * (0.6 + 0.1 * step)] * 2 + [shade * (0.7 + 0.1 * step)] * 2
            sketch.fan("leaf", corners, [(0.0, 0.0)] * 4, shades)
            sketch.fan("leaf", corners[::-1], [(0.0, 0.0)] * 4, [0.8 * s for s in shades])


def drum(
    sketch: Sketch, material: str, foot: Point, high: float, radii: tuple[float, float], *, even: float = 0.0
) -> None:
    """A round thing, shaded by the light from the right; `even` shines by its own light."""
    sides = 20
    x, y, z = foot
    turns = [2.0 * math.pi * number / sides for number in range(sides + 1)]

    def shade(turn: float) -> float:
        lit = max(math.cos(turn) * _LIGHT[0] + math.sin(turn) * _LIGHT[2], 0.0)
        return max(even, 0.0) + (1.0 - even) * (0.45 + 0.75 * lit)

    for a, b in itertools.pairwise(turns):
        corners = [
            (x + radii[0] * math.cos(b), y, z + radii[0] * math.sin(b)),
            (x + radii[0] * math.cos(a), y, z + radii[0] * math.sin(a)),
            (x + radii[1] * math.cos(a), y + high, z + radii[1] * math.sin(a)),
            (x + radii[1] * math.cos(b), y + high, z + radii[1] * math.sin(b)),
        ]
        sketch.fan(material, corners, [(0.0, 0.0)] * 4, [0.85 * shade(b), 0.85 * shade(a), shade(a), shade(b)])
    top = [(x + radii[1] * math.cos(t), y + high, z - radii[1] * math.sin(t)) for t in turns[:-1]]
    sketch.fan(material, top, [(0.0, 0.0)] * sides, 1.0)


def _shape(sketch: Sketch, material: str, outline: Sequence[tuple[float, float]], shade: float = 1.0) -> None:
    """A flat tool on the board, with a darker edge below it that lifts it off."""
    for colour, off, depth, tone in (("iron", 0.012, -1.862, 1.0), (material, 0.0, -1.850, shade)):
        corners = [(x + off, y - off, depth) for x, y in outline]
        sketch.fan(colour, corners, [(0.0, 0.0)] * len(corners), tone)


def _bar(
    sketch: Sketch, material: str, low: tuple[float, float], high: tuple[float, float], shade: float = 1.0
) -> None:
    (x0, y0), (x1, y1) = low, high
    _shape(sketch, material, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)], shade)


def _tools(sketch: Sketch) -> None:
    _bar(sketch, "peg", (-1.12, 0.10), (-1.08, 0.42), 1.7)  # hammer
    _bar(sketch, "steel", (-1.20, 0.40), (-1.00, 0.47), 0.9)
    _shape(sketch, "steel", [(-0.86, 0.20), (-0.40, 0.27), (-0.40, 0.38), (-0.86, 0.44)], 1.25)  # saw
    _bar(sketch, "walnut", (-0.94, 0.18), (-0.84, 0.46), 1.6)
    for number in range(5):  # wrenches
        x, long = -0.26 + 0.10 * number, 0.30 - 0.035 * number
        _bar(sketch, "steel", (x, 0.46 - long), (x + 0.024, 0.46), 1.0)
        _bar(sketch, "steel", (x - 0.014, 0.45), (x + 0.038, 0.49), 1.15)
    for number, colour in enumerate(("red", "safety", "navy", "red")):  # screwdrivers
        x = 0.36 + 0.09 * number
        _bar(sketch, "steel", (x + 0.012, 0.12), (x + 0.022, 0.30), 1.2)
        _bar(sketch, colour, (x, 0.29), (x + 0.034, 0.42), 1.2)
    _bar(sketch, "safety", (0.30, 0.04), (0.98, 0.09), 0.9)  # level
    _bar(sketch, "lawn", (0.60, 0.05), (0.68, 0.08), 2.0)
    for radius, colour, shade in ((0.17, "safety", 0.8), (0.11, "peg", 0.9)):  # coil of cable
        disc(sketch, colour, (0.98, 0.32, -1.852 + 0.001 * (radius < 0.15)), radius, shade, 28)


def _vice(sketch: Sketch) -> None:
    sketch.box("navy", (-0.95, -0.14, -1.50), (-0.72, -0.02, -1.34), shade=1.6)
    sketch.box("steel", (-0.99, -0.04, -1.48), (-0.68, 0.05, -1.42), shade=0.9)
    sketch.box("steel", (-0.99, -0.04, -1.34), (-0.68, 0.05, -1.28), shade=1.0)
    sketch.box("iron", (-0.845, -0.03, -1.28), (-0.825, -0.01, -1.14), shade=2.0)
