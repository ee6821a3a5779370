"""Pictures that repeat: bricks, plaster, tiles, asphalt, paving, grass, bark; each function returns a PNG."""

from __future__ import annotations

import numpy as np

from assets.builders.kit.lattice_noise import hash_noise, pixels, smooth_noise
from assets.builders.kit.palette_texture import Canvas, Ramp
from assets.builders.kit.rng import Rng

__all__ = [
    "LANE_HALF",
    "TILE",
    "paint_asphalt",
    "paint_bark",
    "paint_bay",
    "paint_brick",
    "paint_gardens",
    "paint_grass",
    "paint_paving",
    "paint_plaster",
    "paint_road",
    "paint_slate",
    "paint_stone",
    "paint_tiles",
    "paint_zebra",
]

TILE: dict[str, tuple[float, float]] = {
    "brick": (2.0, 2.4),
    "plaster": (4.0, 4.0),
    "stone": (2.4, 2.4),
    "tiles": (2.4, 2.4),
    "slate": (2.0, 2.0),
    "asphalt": (6.0, 6.0),
    "paving": (2.4, 2.4),
    "grass": (6.0, 6.0),
    "gardens": (72.0, 36.0),
    "road": (11.4, 12.0),
    "bark": (0.8, 1.6),
}
"""Metres one repetition covers, along and up."""

LANE_HALF = 5.7
"""Half the carriageway with its parking lanes, kerb to kerb [m]."""

_SIDE = 256


def _courses(canvas: Canvas, wide: int, high: int, joint: int, seed: int, spread: float, ramps: int) -> None:
    """Blocks in running bond; ramp 0 is the joint's, 1 to `ramps` - 1 the blocks'."""
    x, y = pixels(*canvas.size)
    row = y // high
    shifted = x + (row % 2) * (wide // 2)
    column = (shifted % canvas.size[0]) // wide
    chosen = hash_noise(column, row, seed)
    canvas.ramp[:] = 1 + np.floor(chosen * (ramps - 1)).astype(np.uint8)
    canvas.tone = 0.55 + spread * (hash_noise(column, row, seed + 1) - 0.5)
    in_x, in_y = shifted % wide, y % high
    canvas.tone += np.where((in_y == joint) | (in_x == joint), 0.12, 0.0)  # light catches the upper edge
    canvas.tone -= np.where((in_y == high - 1) | (in_x == wide - 1), 0.14, 0.0)
    mortar = (in_y < joint) | (in_x < joint)
    canvas.ramp[mortar] = 0
    canvas.tone[mortar] = 0.5


def paint_brick(seed: int) -> bytes:
    """Facing bricks of 25 x 7.5 cm, pale: the material's colour dyes them."""
    ramps: list[Ramp] = [
        ((150, 142, 132), (226, 220, 210)),
        ((134, 96, 84), (250, 208, 190)),
        ((118, 88, 80), (232, 190, 176)),
        ((142, 106, 90), (255, 222, 200)),
        ((104, 78, 74), (214, 172, 160)),
    ]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    _courses(canvas, 32, 8, 1, seed, 0.5, len(ramps))
    canvas.shade(0.82 + 0.36 * smooth_noise(_SIDE, _SIDE, 5, 5, seed + 7))
    canvas.grain(0.10, seed + 8)
    return canvas.to_png()


def paint_plaster(seed: int) -> bytes:
    """Painted plaster, nearly white, with a little weather."""
    canvas = Canvas(_SIDE, _SIDE, [((176, 170, 162), (255, 254, 250))])
    broad = smooth_noise(_SIDE, _SIDE, 4, 3, seed)
    streaks = smooth_noise(_SIDE, _SIDE, 3, 40, seed + 1)
    canvas.tone = 0.62 + 0.22 * broad + 0.10 * streaks + 0.08 * smooth_noise(_SIDE, _SIDE, 32, 32, seed + 2)
    canvas.grain(0.12, seed + 3)
    return canvas.to_png()


def paint_stone(seed: int) -> bytes:
    """Blocks of light stone, 60 x 30 cm, with deep joints."""
    ramps: list[Ramp] = [
        ((96, 90, 82), (150, 143, 132)),
        ((150, 142, 128), (246, 240, 226)),
        ((140, 134, 124), (236, 231, 220)),
    ]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    _courses(canvas, 64, 32, 2, seed, 0.3, len(ramps))
    canvas.shade(0.86 + 0.3 * smooth_noise(_SIDE, _SIDE, 9, 9, seed + 4))
    canvas.grain(0.14, seed + 5)
    return canvas.to_png()


def paint_tiles(seed: int) -> bytes:
    """Clay pantiles: rounded rows, each row shading the one below."""
    ramps: list[Ramp] = [
        ((92, 52, 40), (236, 168, 132)),
        ((78, 46, 38), (214, 142, 112)),
        ((104, 60, 44), (250, 186, 150)),
    ]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    x, y = pixels(_SIDE, _SIDE)
    wide, high = 16, 32
    column, row = x // wide, y // high
    canvas.ramp[:] = np.floor(hash_noise(column, row, seed) * 3).astype(np.uint8)
    across = (x % wide + 0.5) / wide
    down = (y % high + 0.5) / high
    round_tile = 0.32 + 1.9 * across * (1.0 - across)
    canvas.tone = round_tile * (0.66 + 0.34 * down) + 0.22 * (hash_noise(column, row, seed + 1) - 0.5)
    canvas.tone -= np.where(y % high < 3, 0.3, 0.0)
    canvas.shade(0.8 + 0.36 * smooth_noise(_SIDE, _SIDE, 4, 4, seed + 2))
    canvas.grain(0.10, seed + 3)
    return canvas.to_png()


def paint_slate(seed: int) -> bytes:
    """Slates in running bond, blue grey."""
    ramps: list[Ramp] = [
        ((34, 38, 44), (78, 84, 92)),
        ((62, 68, 78), (150, 158, 170)),
        ((56, 60, 68), (136, 140, 150)),
        ((66, 70, 76), (160, 162, 168)),
    ]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    _courses(canvas, 32, 32, 1, seed, 0.44, len(ramps))
    canvas.shade(0.85 + 0.3 * smooth_noise(_SIDE, _SIDE, 6, 6, seed + 2))
    canvas.grain(0.12, seed + 3)
    return canvas.to_png()


def _asphalt(canvas: Canvas, seed: int) -> None:
    width, height = canvas.size
    broad = smooth_noise(height, width, 5, 5, seed)
    canvas.tone = 0.34 + 0.24 * broad + 0.12 * smooth_noise(height, width, 24, 24, seed + 1)
    canvas.grain(0.34, seed + 2)


def _road_ramps() -> list[Ramp]:
    return [
        ((44, 45, 48), (122, 122, 122)),
        ((150, 150, 146), (240, 240, 234)),
        ((74, 72, 70), (168, 164, 158)),
        ((40, 40, 40), (60, 60, 62)),
    ]


def paint_asphalt(seed: int) -> bytes:
    """Asphalt without markings, for crossings and yards."""
    canvas = Canvas(_SIDE, _SIDE, _road_ramps()[:1])
    _asphalt(canvas, seed)
    return canvas.to_png()


def _parking(canvas: Canvas, seed: int) -> None:
    """Setts of the parking lanes and gutters along both kerbs, worn wheel tracks between."""
    width, height = canvas.size
    x, y = pixels(width, height)
    centre = np.abs(2 * x + 1 - width)  # twice the distance from the middle
    lane = int(width * 3.5 / LANE_HALF)
    setts = centre > lane
    joints = ((x + (y // 8 % 2) * 3) % 6 == 0) | (y % 8 == 0)
    canvas.ramp[setts] = 2
    stone = 0.44 + 0.36 * (hash_noise((x + (y // 8 % 2) * 3) // 6, y // 8, seed) - 0.5)
    canvas.tone = np.where(setts, np.where(joints, 0.12, stone), canvas.tone)
    track = np.abs(centre - int(width * 1.75 / LANE_HALF)) < width // 9
    canvas.shade(0.9, track & ~setts)
    gutter = centre > width - 8
    canvas.shade(0.55, gutter)
    edge = setts & (centre <= lane + 6)
    canvas.ramp[edge] = 1
    canvas.tone[edge] = 0.6


def paint_road(seed: int) -> bytes:
    """Carriageway across its whole width and 12 m of its length: parking lanes, edge lines, a broken centre line."""
    canvas = Canvas(_SIDE, _SIDE, _road_ramps())
    _asphalt(canvas, seed)
    _parking(canvas, seed + 5)
    for top in (16, 144):  # strokes of 3 m, gaps of 3 m
        canvas.rectangle(126, top, 130, top + 64, 1, 0.8)
    worn = hash_noise(*pixels(_SIDE, _SIDE), seed + 9) < 0.18
    canvas.shade(0.62, worn & (canvas.ramp == 1))
    return canvas.to_png()


def paint_zebra(seed: int) -> bytes:
    """A crossing for people: bars along the street over the whole width and 4 m of length."""
    width, height = _SIDE, 64
    canvas = Canvas(width, height, _road_ramps())
    _asphalt(canvas, seed)
    for left in range(6, width - 8, 22):
        canvas.rectangle(left, 2, left + 11, height - 2, 1, 0.82)
    worn = hash_noise(*pixels(width, height), seed + 9) < 0.2
    canvas.shade(0.6, worn & (canvas.ramp == 1))
    return canvas.to_png()


def paint_paving(seed: int) -> bytes:
    """Slabs of 30 x 30 cm, warm grey."""
    ramps: list[Ramp] = [
        ((84, 80, 76), (130, 126, 120)),
        ((128, 122, 114), (216, 209, 198)),
        ((122, 118, 112), (206, 202, 194)),
    ]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    _courses(canvas, 32, 32, 1, seed, 0.26, len(ramps))
    canvas.shade(0.84 + 0.32 * smooth_noise(_SIDE, _SIDE, 5, 5, seed + 2))
    canvas.grain(0.16, seed + 3)
    return canvas.to_png()


def paint_grass(seed: int) -> bytes:
    """Lawn."""
    ramps: list[Ramp] = [((44, 64, 26), (120, 148, 72)), ((52, 70, 28), (136, 156, 80))]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    patches = smooth_noise(_SIDE, _SIDE, 6, 6, seed)
    canvas.ramp[:] = (patches + 0.3 * hash_noise(*pixels(_SIDE, _SIDE), seed + 1) > 0.66).astype(np.uint8)
    canvas.tone = 0.42 + 0.12 * patches + 0.24 * smooth_noise(_SIDE, _SIDE, 48, 48, seed + 2)
    canvas.grain(0.3, seed + 3)
    return canvas.to_png()


def paint_gardens(seed: int) -> bytes:
    """Back gardens from above: six plots of 12 x 36 m, each of a kind of its own, with hedges and paths between."""
    ramps: list[Ramp] = [
        ((44, 62, 28), (128, 150, 78)),
        ((24, 40, 18), (78, 104, 50)),
        ((96, 90, 82), (196, 186, 172)),
        ((70, 50, 34), (140, 108, 78)),
        ((120, 60, 60), (226, 190, 150)),
        ((40, 96, 118), (150, 206, 214)),
    ]
    wide = 2 * _SIDE
    canvas = Canvas(wide, _SIDE, ramps)
    canvas.tone = 0.4 + 0.3 * smooth_noise(_SIDE, wide, 9, 18, seed)
    rng = Rng(seed, "gardens")
    for plot in range(6):
        _paint_garden(canvas, (plot * 85 + 2, 0), ("lawn", "beds", "lawn", "yard", "beds")[plot * 3 % 5], rng)
    for row in range(0, wide, 85):
        canvas.rectangle(row, 0, row + 3, _SIDE, 1, 0.4)
    canvas.rectangle(0, 250, wide, 256, 1, 0.4)
    canvas.grain(0.24, seed + 1)
    return canvas.to_png()


def _paint_garden(canvas: Canvas, corner: tuple[int, int], kind: str, rng: Rng) -> None:
    """One plot: a lawn with a pool or a shed, vegetable beds with a greenhouse, or a paved yard with a few tubs."""
    left, top = corner
    ramp, tone = {"lawn": (0, 0.62), "beds": (3, 0.35), "yard": (2, 0.42)}[kind]
    canvas.rectangle(left + 2, top + 30, left + 82, top + 246, ramp, (tone, tone + 0.14 * rng.share()))
    canvas.rectangle(left + 2, top + 2, left + 82, top + 26, 2, 0.3 + 0.3 * rng.share())  # terrace
    if kind == "lawn":
        x, y = left + 8 + rng.below(30), top + 60 + rng.below(110)
        if rng.happens(0.3):
            canvas.rectangle(x - 3, y - 3, x + 37, y + 57, 2, 0.8)
            canvas.rectangle(x, y, x + 34, y + 54, 5, 0.6)  # pool
        else:
            canvas.rectangle(x, y, x + 26, y + 20, 4, 0.45)  # shed
    if kind == "beds":
        for row in range(9):
            y = top + 40 + 22 * row
            canvas.rectangle(left + 6, y, left + 40, y + 14, rng.below(2), 0.35 + 0.4 * rng.share())
            canvas.rectangle(left + 48, y, left + 78, y + 14, rng.pick((0, 1, 3, 4)), 0.35 + 0.4 * rng.share())
        canvas.rectangle(left + 48, top + 180, left + 78, top + 232, 5, 0.85)  # greenhouse
    if kind == "yard":
        canvas.rectangle(left + 10, top + 150, left + 74, top + 240, 0, 0.5)
    at = left + 10 + rng.below(50)
    canvas.rectangle(at, top + 26, at + 4, top + 240, 2, 0.5)
    for _ in range(7 if kind != "beds" else 3):
        _paint_bush(canvas, left + 8 + rng.below(66), top + 50 + rng.below(180), 5 + rng.below(9))


def _paint_bush(canvas: Canvas, cx: int, cy: int, radius: int) -> None:
    """A round crown from above, lit from the upper left."""
    x, y = pixels(*canvas.size)
    inside = (x - cx) * (x - cx) + (y - cy) * (y - cy) < radius * radius
    canvas.ramp[inside] = 1
    canvas.tone = np.where(inside, 0.5 - 0.35 * ((x - cx) + (y - cy)) / (1.4 * radius), canvas.tone)


def paint_bark(seed: int) -> bytes:
    """Bark with furrows along the trunk."""
    width, height = 64, 128
    canvas = Canvas(width, height, [((44, 36, 30), (152, 134, 114))])
    canvas.tone = (
        0.15 + 0.6 * smooth_noise(height, width, 8, 16, seed) + 0.2 * smooth_noise(height, width, 32, 16, seed + 1)
    )
    canvas.grain(0.2, seed + 2)
    return canvas.to_png()


def paint_bay(seed: int, kind: str) -> bytes:
    """One storey of one bay: a wall of `kind` with a window, for backs and for what is far."""
    wall: Ramp = ((104, 78, 72), (226, 186, 170)) if kind == "brick" else ((176, 170, 162), (255, 254, 250))
    ramps: list[Ramp] = [wall, ((150, 146, 140), (250, 248, 242)), ((22, 28, 36), (150, 170, 190))]
    width, height = 128, 128
    canvas = Canvas(width, height, ramps)
    canvas.tone = 0.58 + 0.2 * smooth_noise(height, width, 4, 4, seed)
    if kind == "brick":
        x, y = pixels(width, height)
        joints = (y % 6 == 0) | ((x + (y // 6 % 2) * 10) % 20 == 0)
        canvas.tone = np.where(
            joints, 0.8, canvas.tone - 0.12 + 0.3 * hash_noise((x + (y // 6 % 2) * 10) // 20, y // 6, seed)
        )
    canvas.grain(0.1, seed + 1)
    canvas.rectangle(40, 30, 88, 98, 1, 0.72)  # surround
    canvas.rectangle(42, 32, 86, 94, 2, (0.3, 0.62))
    canvas.rectangle(42, 32, 86, 35, 2, 0.02)  # the reveal's shadow
    for left, top, right, bottom in (
        (42, 32, 46, 94),
        (82, 32, 86, 94),
        (62, 32, 66, 94),
        (42, 54, 86, 57),
        (42, 91, 86, 94),
    ):
        canvas.rectangle(left, top, right, bottom, 1, 0.85)
    canvas.rectangle(38, 94, 90, 99, 1, 0.9)  # sill
    canvas.rectangle(38, 99, 90, 102, 0, 0.2)
    return canvas.to_png()
