"""The church on the square, the skyline round the city, and the land beyond."""

from __future__ import annotations

import math

from assets.builders.city.fittings import plain, window
from assets.builders.city.streets import SIDE
from assets.builders.city.textures import TILE
from assets.builders.kit.facade import Opening, Zone, add_zone, wall_axes
from assets.builders.kit.rng import Rng
from assets.builders.kit.sketch import Point, Sketch
from assets.builders.kit.solids import ALONG_X, UPRIGHT, Axes, Skin, add_column, add_prism, circle, rectangle

__all__ = ["build_church", "build_hills", "build_land", "build_skyline", "build_workshop"]

_BELT = 16.0
"""Width of the trees about a block of flats [m]."""


def build_church() -> Sketch:
    """A nave along -z with a tower before it; the door looks along +z."""
    sketch = Sketch()
    stone, slate = Skin("stone", TILE["stone"]), Skin("slate", TILE["slate"])
    nave = Sketch()
    for side in ("left", "right"):
        row = [Opening(2.2 + 5.0 * n, 4.0 + 5.0 * n, 2.4, 8.6, window(3), 0.35, 0.2) for n in range(5)]
        zone = Zone(0.0, 26.0, 0.0, 10.5, [row], stone, plain("stone"))
        add_zone(nave, wall_axes(13.0, 26.0, side), zone)
    for side in ("front", "back"):
        add_zone(nave, wall_axes(13.0, 26.0, side), Zone(0.0, 13.0, 0.0, 10.5, [], stone, plain("stone")))
    lead = plain("lead")
    for y, corners in ((10.5, 1.0), (0.0, -1.0)):
        lid: list[Point] = [(-6.5, y, 0.0), (6.5, y, 0.0), (6.5, y, -26.0), (-6.5, y, -26.0)]
        lid = lid if corners > 0 else lid[::-1]
        nave.fan(lead.material, lid, lead.lay([(x, z) for x, _, z in lid]))
    roof = [(-7.0, 10.5), (7.0, 10.5), (0.0, 18.0)]
    add_prism(nave, Axes(), roof, -26.3, 0.3, (stone, stone), (plain("soffit"), slate, slate))
    for x in (-6.5, 6.5):
        for n in range(6):
            z = -0.6 - 5.0 * n
            outline = [(x - 0.7, 0.0), (x + 0.7, 0.0), (x + 0.45, 9.0), (x - 0.45, 9.0)]
            add_prism(nave, Axes(), outline, z - 0.45, z + 0.45, (stone, stone), (stone,))
    sketch.add(nave, lambda p: (p[0], p[1], p[2] - 7.0))
    _add_tower(sketch, stone, slate)
    return sketch


def _add_tower(sketch: Sketch, stone: Skin, slate: Skin) -> None:
    body = rectangle(-3.6, 3.6, 0.0, 25.0)
    add_prism(sketch, Axes(), body, -7.4, 0.0, (stone, stone), (stone,))
    for y in (8.5, 16.5, 24.6):
        ledge = rectangle(-3.8, 3.8, y, y + 0.5)
        add_prism(
            sketch, Axes(), ledge, -7.6, 0.2, (plain("stone"), plain("stone")), (plain("stone", 0.6), plain("stone"))
        )
    door = [(-1.3, 0.0), (1.3, 0.0), (1.3, 3.2), (0.0, 4.6), (-1.3, 3.2)]
    add_prism(sketch, Axes(), door, -0.05, 0.12, (plain("wood", 0.7), plain("wood", 0.7)), (plain("stone"),))
    for y, high in ((10.5, 4.0), (18.5, 4.6)):
        pane = [(-0.9, y), (0.9, y), (0.9, y + high - 0.9), (0.0, y + high), (-0.9, y + high - 0.9)]
        dark = plain("glass", 0.5)
        for low, top in ((-0.05, 0.1), (-7.5, -7.35)):
            add_prism(sketch, Axes(), pane, low, top, (dark, dark), (plain("stone"),))
        shifted = [(a + 3.7, b) for a, b in pane]
        for low, top in ((-3.7, -3.55), (3.55, 3.7)):
            add_prism(sketch, ALONG_X, shifted, low, top, (dark, dark), (plain("stone"),))
    add_column(sketch, (0.0, 25.0, -3.7), (0.0, 45.0, -3.7), (5.1, 0.0), 8, slate, bulge=math.pi / 8)
    for x in (-3.2, 3.2):
        for z in (-0.4, -7.0):
            add_column(sketch, (x, 25.1, z), (x, 29.0, z), (0.7, 0.0), 4, stone, bulge=math.pi / 4)
    gold = plain("yellow")
    add_prism(sketch, UPRIGHT, [(a - 3.7, b) for a, b in circle(6, 0.12)], 44.6, 46.6, (gold, gold), (gold,))


def build_workshop() -> Sketch:
    """A long low building in a yard."""
    sketch = Sketch()
    walls, roof, lead = Skin("yard", (3.6, 3.4)), Skin("slate", TILE["slate"]), plain("lead")
    body = rectangle(-10.0, 10.0, 0.0, 3.8)
    add_prism(sketch, Axes(), body, -4.5, 4.5, (walls, walls), (lead, walls, lead, walls))
    add_prism(sketch, ALONG_X, [(-4.8, 3.8), (4.8, 3.8), (0.0, 6.4)], -10.2, 10.2, (lead, lead), (lead, roof, roof))
    return sketch


def build_skyline(seed: int) -> Sketch:
    """Blocks of flats on a ring beyond the border, each in a belt of trees; none so high that haze cuts it off."""
    sketch = Sketch()
    rng = Rng(seed, "skyline")
    bay, lid, trees = Skin("skyline", (3.6, 3.4)), plain("lead"), Skin("hills", (14.0, 14.0), shade=0.6)
    count = 96
    for number in range(count):
        turn = 2.0 * math.pi * (number + rng.between(-0.35, 0.35)) / count
        away = rng.between(620.0, 900.0)
        x, z = round(away * math.cos(turn), 2), round(away * math.sin(turn), 2)
        if max(abs(x), abs(z)) < 0.5 * SIDE + 60.0:
            continue
        tall = rng.between(9.0, 17.0) if rng.happens(0.72) else rng.between(18.0, 30.0)
        half, deep = (
            (rng.between(9.0, 13.0), rng.between(9.0, 13.0))
            if tall > 17.0
            else (rng.between(14.0, 34.0), rng.between(7.0, 12.0))
        )
        outline = rectangle(z - deep, z + deep, x - half, x + half)
        add_prism(sketch, UPRIGHT, outline, 0.0, tall, (lid, lid), (bay,))
        wood = [(a + _BELT * (1 if a > z else -1), b + _BELT * (1 if b > x else -1)) for a, b in outline]
        add_prism(sketch, UPRIGHT, wood, -1.0, 5.5, (trees, trees), (trees,))
    return sketch


def build_hills(seed: int) -> Sketch:
    """Two wooded ridges all round, the farther one higher."""
    sketch = Sketch()
    rng = Rng(seed, "hills")
    steps = 72
    for away, low, high in ((1350.0, 30.0, 75.0), (1750.0, 80.0, 170.0)):
        tops = [rng.between(low, high) for _ in range(steps)]
        tops = [(tops[n - 1] + 2.0 * tops[n] + tops[(n + 1) % steps]) / 4.0 for n in range(steps)]
        rim = [
            (away * math.cos(2.0 * math.pi * n / steps), away * math.sin(2.0 * math.pi * n / steps))
            for n in range(steps)
        ]
        for n in range(steps):
            m = (n + 1) % steps
            (ax, az), (bx, bz) = rim[n], rim[m]
            corners = [(ax, -1.0, az), (bx, -1.0, bz), (bx * 1.12, tops[m], bz * 1.12), (ax * 1.12, tops[n], az * 1.12)]
            sketch.fan(
                "hills",
                corners,
                [(n / 4.0, 1.0), ((n + 1) / 4.0, 1.0), ((n + 1) / 4.0, 0.0), (n / 4.0, 0.0)],
                [0.8, 0.8, 1.0, 1.0],
            )
    return sketch


def build_land() -> Sketch:
    """Meadows from the city's border to the hills."""
    sketch = Sketch()
    near, far = 0.5 * SIDE, 1800.0
    inner = [(-near, near), (near, near), (near, -near), (-near, -near)]
    outer = [(-far, far), (far, far), (far, -far), (-far, -far)]
    for number in range(4):
        following = (number + 1) % 4
        corners = [outer[number], outer[following], inner[following], inner[number]]
        tile = TILE["grass"]
        sketch.fan(
            "grass",
            [(x, 0.0, z) for x, z in corners],
            [(x / (4 * tile[0]), z / (4 * tile[1])) for x, z in corners],
            0.85,
        )
    return sketch
