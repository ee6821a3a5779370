"""What stands in a street: lamps, benches, bins, signs, bollards, tree grates; and parked cars."""

from __future__ import annotations

from pathlib import Path

from assets.builders.city.fittings import detail, plain
from assets.builders.kit.sketch import Point, Sketch, Uv
from assets.builders.kit.solids import UPRIGHT, Axes, Skin, add_column, add_prism, circle, rectangle
from mimics_app.contracts.system.table_file import read_table_file

__all__ = [
    "CARS",
    "build_bench",
    "build_bin",
    "build_bollard",
    "build_car",
    "build_lamp",
    "build_planter",
    "build_sign",
]


def _block(sketch: Sketch, low: Point, high: Point, skin: Skin) -> None:
    outline = rectangle(low[0], high[0], low[1], high[1])
    under = Skin(skin.material, skin.tile, skin.cell, 0.55 * skin.shade)
    add_prism(sketch, Axes(), outline, low[2], high[2], (skin, skin), (under, skin, skin, skin))


def build_lamp() -> Sketch:
    """A post with an arm over the street, +z."""
    sketch = Sketch()
    iron = plain("green", 0.6)
    add_column(sketch, (0.0, 0.0, 0.0), (0.0, 5.2, 0.0), (0.09, 0.045), 6, iron, open_foot=True)
    _block(sketch, (-0.03, 5.1, 0.0), (0.03, 5.16, 0.9), iron)
    add_prism(
        sketch,
        UPRIGHT,
        [(a + 0.9, b) for a, b in circle(6, 0.2)],
        4.98,
        5.14,
        (plain("lamp"), iron),
        (plain("yellow"),),
    )
    return sketch


def build_bench() -> Sketch:
    """A wooden bench that looks along +z."""
    sketch = Sketch()
    wood, iron = plain("wood"), plain("iron")
    for z in (-0.12, 0.16):
        _block(sketch, (-0.9, 0.42, z), (0.9, 0.46, z + 0.25), wood)
    _block(sketch, (-0.9, 0.6, -0.22), (0.9, 0.86, -0.18), wood)
    for x in (-0.75, 0.7):
        _block(sketch, (x, 0.0, -0.1), (x + 0.05, 0.42, 0.36), iron)
        _block(sketch, (x, 0.42, -0.26), (x + 0.05, 0.9, -0.22), iron)
    return sketch


def build_bin() -> Sketch:
    """A litter bin."""
    sketch = Sketch()
    add_column(sketch, (0.0, 0.0, 0.0), (0.0, 0.85, 0.0), (0.22, 0.27), 8, plain("green", 0.8), open_foot=True)
    add_prism(sketch, UPRIGHT, circle(8, 0.29), 0.85, 0.93, (plain("iron"), plain("iron")), (plain("iron"),))
    return sketch


def build_bollard() -> Sketch:
    """A low iron post at a corner."""
    sketch = Sketch()
    add_column(sketch, (0.0, 0.0, 0.0), (0.0, 0.85, 0.0), (0.07, 0.06), 5, plain("iron"), open_foot=True)
    return sketch


def build_sign() -> Sketch:
    """A round traffic sign that looks along +z."""
    sketch = Sketch()
    add_column(sketch, (0.0, 0.0, -0.05), (0.0, 2.7, -0.05), (0.035, 0.035), 4, plain("grey"), open_foot=True)
    round_plate = [(a, b + 2.4) for a, b in circle(10, 0.32)]
    add_prism(sketch, Axes(), round_plate, -0.02, 0.0, (plain("grey"), plain("red")), (plain("grey"),))
    inner = [(a, b + 2.4) for a, b in circle(10, 0.23)]
    add_prism(sketch, Axes(), inner, -0.005, 0.012, (plain("white"), plain("white")), (plain("white"),))
    return sketch


def build_planter() -> Sketch:
    """A stone tub with a shrub."""
    sketch = Sketch()
    add_column(sketch, (0.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.42, 0.52), 8, plain("stone", 0.85), open_foot=True)
    leaf = Skin("leaves", cell=(0.3, 0.3, 0.7, 0.7), shade=0.8)
    add_column(sketch, (0.0, 0.45, 0.0), (0.0, 0.95, 0.0), (0.46, 0.3), 7, leaf, open_foot=True)
    return sketch


CARS = read_table_file(Path(__file__).with_name("cars.json"), dict[str, dict[str, list[Uv]]])
"""Side views, (along, up) [m], counter-clockwise, the front at +x."""


def build_car(kind: str) -> Sketch:
    """A car that looks along +x, wheels on y = 0."""
    sketch = Sketch()
    outlines = CARS[kind]
    paint, rubber, wheel = Skin("paint"), plain("tyre"), detail("wheel", 0)
    wide = 0.95 if kind == "van" else 0.86
    add_prism(
        sketch, Axes(), outlines["body"], -wide, wide, (paint, paint), (rubber, *[paint] * (len(outlines["body"]) - 1))
    )
    _add_cabin(sketch, outlines["cabin"], wide, paint)
    front, rear = (1.32, -1.3) if kind != "van" else (1.5, -1.45)
    for x in (front, rear):
        for z in (-wide + 0.11, wide - 0.11):
            tyre = [(a + x, b + 0.31) for a, b in circle(9, 0.31)]
            add_prism(sketch, Axes(), tyre, z - 0.13, z + 0.13, (wheel, wheel), (rubber,))
    nose, tail = max(x for x, _ in outlines["body"]), min(x for x, _ in outlines["body"])
    for z in (-wide + 0.3, wide - 0.3):
        _block(sketch, (nose - 0.25, 0.56, z - 0.2), (nose + 0.012, 0.7, z + 0.2), plain("lamp"))
        _block(sketch, (tail - 0.012, 0.66, z - 0.16), (tail + 0.2, 0.82, z + 0.16), plain("red"))
    _add_bumpers(sketch, (tail, nose), wide)
    return sketch


def _add_bumpers(sketch: Sketch, ends: Uv, wide: float) -> None:
    """Bumpers with number plates; a grille between the lamps."""
    tail, nose = ends
    rubber, plate = plain("iron", 1.4), plain("white")
    for end, out in ((tail, -1.0), (nose, 1.0)):
        low, high = sorted((end - out * 0.22, end + out * 0.05))
        _block(sketch, (low, 0.33, -wide + 0.04), (high, 0.50, wide - 0.04), rubber)
        faces = ((plate, 0.058, 0.26, 0.36, 0.47),) + (((plain("iron"), 0.015, 0.30, 0.57, 0.69),) if out > 0.0 else ())
        for skin, off, half, bottom, top in faces:
            x = end + out * off
            across = [(-half, bottom), (-half, top), (half, top), (half, bottom)][:: round(out)]
            corners = [(x, y, z) for z, y in across]
            sketch.fan(skin.material, corners, skin.lay(across), skin.shade)


def _add_cabin(sketch: Sketch, outline: list[Uv], wide: float, paint: Skin) -> None:
    """Windows that lean inwards under a painted roof, with painted pillars at the sides."""
    low, high = wide - 0.05, wide - 0.2
    glass, panes = detail("screen", 0), detail("side", 0)
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = outline
    left = [(x0, y0, low), (x1, y1, low), (x2, y2, high), (x3, y3, high)]
    right = [(x, y, -z) for x, y, z in left]
    for side, reverse in ((left, False), (right, True)):
        corners = side[::-1] if reverse else side
        sketch.fan(panes.material, corners, panes.lay([(x, y) for x, y, _ in corners]), panes.shade)
    shells = (
        ([left[1], right[1], right[2], left[2]], glass),
        ([left[2], right[2], right[3], left[3]], paint),
        ([left[3], right[3], right[0], left[0]], glass),
        ([left[0], right[0], right[1], left[1]], glass),
    )
    for corners, skin in shells:
        sketch.fan(skin.material, corners, skin.lay([(z, x + y) for x, y, z in corners]), skin.shade)
