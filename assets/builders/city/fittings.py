"""Pictures with many cells: windows; doors, shop fronts, signs and plain colours; leaves; railings."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.kit.lattice_noise import smooth_noise
from assets.builders.kit.palette_texture import Canvas, Ramp
from assets.builders.kit.rng import Rng
from assets.builders.kit.solids import Skin
from mimics_app.rendering.visual.effects.captions import draw_letters
from mimics_app.rendering.visual.figures.glyphs import GlyphAtlas, load_glyph_atlas

__all__ = [
    "DOORS",
    "SHOPS",
    "SIGNS",
    "WINDOWS",
    "detail",
    "paint_details",
    "paint_leaves",
    "paint_railing",
    "paint_windows",
    "plain",
    "window",
]

Cell = tuple[int, int, int, int]

_SHOP_TOPS = (128, 768)
"""Of the two rows of shop fronts in the picture [px]."""
_WORDS = ("BOOKS & PAPER", "BAKERY", "WINE & CHEESE", "TAILOR", "TOYS", "PATISSERIE", "KITCHENWARE", "HATS & GLOVES")
"""Over the shops, by their number."""

WINDOWS = 12
"""Number of window designs."""
DOORS, SHOPS, SIGNS = 8, 8, 8
_WINDOW_SIZE, _DETAIL_SIZE = (512, 256), (512, 1024)

_PLAIN: dict[str, tuple[int, float]] = {
    "stone": (1, 0.72),
    "stone_dark": (1, 0.42),
    "white": (1, 0.95),
    "iron": (2, 0.2),
    "zinc": (3, 0.55),
    "lead": (3, 0.3),
    "wood": (4, 0.6),
    "green": (5, 0.35),
    "red": (6, 0.5),
    "blue": (7, 0.45),
    "lamp": (1, 1.0),
    "tyre": (2, 0.08),
    "glass": (8, 0.3),
    "soffit": (4, 0.3),
    "yellow": (9, 0.75),
    "grey": (2, 0.75),
    "clay": (10, 0.45),
}
"""Colours of one patch: ramp and tone."""


def window(number: int) -> Skin:
    """The skin of a window design."""
    column, row = number % 6, number // 6
    cell = _shares((column * 85, row * 128, column * 85 + 85, row * 128 + 128), _WINDOW_SIZE)
    return Skin("window", cell=cell, shade=1.0)


def detail(kind: str, number: int) -> Skin:
    """The skin of a "door", "shop", "sign", "dormer", "oriel" or "awning" design, or of a car's parts."""
    cells: dict[str, Cell] = {
        "door": (number * 64, 0, number * 64 + 64, 128),
        "shop": (number % 4 * 128, _SHOP_TOPS[number // 4], number % 4 * 128 + 128, _SHOP_TOPS[number // 4] + 128),
        "sign": (0, 512 + number * 32, 512, 544 + number * 32),
        "wheel": (0, 896, 64, 960),
        "screen": (64, 896, 128, 960),
        "side": (128, 896, 256, 960),
        "dormer": (number * 64, 320, number * 64 + 64, 384),
        "oriel": (256 + number * 64, 320, 320 + number * 64, 384),
        "awning": (number * 128, 384, number * 128 + 128, 416),
    }
    return Skin("detail", cell=_shares(cells[kind], _DETAIL_SIZE))


def plain(name: str, shade: float = 1.0) -> Skin:
    """The skin of one colour of `detail`."""
    place = list(_PLAIN).index(name)
    x, y = place % 10 * 51, 432 + place // 10 * 40
    return Skin("detail", cell=_shares((x + 14, y + 10, x + 38, y + 30), _DETAIL_SIZE), shade=shade)


def _shares(cell: Cell, size: tuple[int, int]) -> tuple[float, float, float, float]:
    """A cell without its outermost pixel, which filtering mixes with the neighbour's."""
    left, top, right, bottom = cell
    return (left + 1) / size[0], (top + 1) / size[1], (right - 1) / size[0], (bottom - 1) / size[1]


_WINDOW_RAMPS: list[Ramp] = [
    ((22, 28, 36), (132, 154, 176)),  # glass: dark room to mirrored sky
    ((150, 148, 142), (252, 250, 244)),  # white frame
    ((70, 60, 50), (150, 134, 114)),  # wood
    ((40, 58, 54), (96, 128, 118)),  # green paint
    ((120, 112, 98), (226, 216, 198)),  # curtain
    ((120, 66, 40), (250, 190, 110)),  # warm light inside
    ((46, 48, 52), (104, 108, 114)),  # dark frame
]


def paint_windows(seed: int) -> bytes:
    """Twelve windows, each with its own frame, bars, curtain and what the glass mirrors."""
    canvas = Canvas(*_WINDOW_SIZE, _WINDOW_RAMPS)
    rng = Rng(seed, "windows")
    frames = [1, 1, 6, 1, 3, 2]
    for number in range(WINDOWS):
        left, top = number % 6 * 85, number // 6 * 128
        _paint_glass(canvas, left, top, rng)
        _paint_bars(canvas, left, top, frames[number % 6], number)
    canvas.grain(0.05, seed)
    return canvas.to_png()


def _paint_glass(canvas: Canvas, left: int, top: int, rng: Rng) -> None:
    """Sky above, the houses opposite as a dark band below, sometimes a curtain or a light."""
    right, bottom = left + 85, top + 128
    skyline = top + 50 + rng.below(40)
    canvas.rectangle(left, top, right, skyline, 0, (rng.between(0.6, 0.8), 0.45))
    canvas.rectangle(left, skyline, right, bottom, 0, (0.22, 0.12))
    for _ in range(3):
        at = left + rng.below(60)
        canvas.rectangle(at, skyline - 4 - rng.below(14), at + 12 + rng.below(12), skyline, 0, 0.2)
    style = rng.below(4)
    if style == 0:  # curtains drawn to both sides
        wide = 14 + rng.below(8)
        for first, last in ((left, left + wide), (right - wide, right)):
            for fold in range(first, last, 4):
                canvas.rectangle(fold, top, fold + 4, bottom, 4, 0.4 + 0.1 * (fold // 4 % 3))
    elif style == 1:  # a blind
        canvas.rectangle(left, top, right, top + 30 + rng.below(40), 4, (0.75, 0.6))
    elif style == 2:  # a lamp behind the glass
        at, level = left + 20 + rng.below(40), top + 78 + rng.below(20)
        canvas.rectangle(at, level, at + 12, level + 9, 5, (0.6, 0.4))


def _paint_bars(canvas: Canvas, left: int, top: int, frame: int, number: int) -> None:
    right, bottom = left + 85, top + 128
    canvas.rectangle(left, top, right, top + 10, 0, 0.05)  # the lintel's shadow
    edges = [
        (left, top, left + 7, bottom),
        (right - 7, top, right, bottom),
        (left, top, right, top + 7),
        (left, bottom - 9, right, bottom),
    ]
    middle = left + 42
    bars = [(middle - 4, top, middle + 4, bottom)]
    if number % 3 != 2:
        bars.append((left, top + 40, right, top + 46))
    if number % 4 == 3:
        bars += [
            (left, top + 84, right, top + 87),
            (left + 22, top + 46, left + 25, bottom),
            (right - 25, top + 46, right - 22, bottom),
        ]
    for bar in (*bars, *edges):
        canvas.rectangle(*bar, frame, 0.82)
        canvas.rectangle(bar[0], bar[3] - 2, bar[2], bar[3], frame, 0.5)
        canvas.rectangle(bar[2] - 1, bar[1], bar[2], bar[3], frame, 0.55)


_DETAIL_RAMPS: list[Ramp] = [
    ((24, 24, 26), (60, 60, 64)),
    ((120, 114, 104), (252, 248, 240)),  # stone, white
    ((26, 27, 30), (170, 172, 176)),  # iron to grey
    ((70, 76, 84), (170, 178, 188)),  # zinc
    ((58, 38, 26), (186, 138, 92)),  # wood
    ((18, 46, 34), (96, 150, 118)),  # green
    ((78, 18, 18), (206, 84, 66)),  # red
    ((20, 36, 72), (112, 146, 196)),  # blue
    ((16, 22, 28), (150, 174, 192)),  # glass
    ((150, 96, 26), (250, 214, 120)),  # yellow, warm light
    ((88, 48, 38), (196, 134, 108)),  # clay
]


def paint_details(seed: int) -> bytes:
    """Doors, shop fronts, sign boards, dormer and oriel faces, awnings, plain colours."""
    canvas = Canvas(*_DETAIL_SIZE, _DETAIL_RAMPS)
    rng = Rng(seed, "details")
    for number in range(DOORS):
        _paint_door(canvas, number * 64, (4, 5, 6, 7, 4, 2, 5, 1)[number], rng)
    atlas = load_glyph_atlas()
    for number, ramp in enumerate((5, 7, 4, 6, 5, 7, 4, 6)):
        _paint_shop(canvas, (number % 4 * 128, _SHOP_TOPS[number // 4]), ramp, number, rng)
        _paint_sign(canvas, 512 + number * 32, (5, 7, 6, 2, 4, 9, 7, 1)[number], _WORDS[number], atlas)
    _paint_car_parts(canvas)
    for number in range(4):
        _paint_dormer(canvas, number * 64, (1, 3, 4, 1)[number])
        _paint_oriel(canvas, 256 + number * 64, (1, 1, 4, 5)[number])
        for stripe in range(8):
            ramp = (6, 5, 7, 9)[number] if stripe % 2 else 1
            canvas.rectangle(number * 128 + stripe * 16, 384, number * 128 + stripe * 16 + 16, 416, ramp, (0.85, 0.65))
    for place, (ramp, tone) in enumerate(_PLAIN.values()):
        x, y = place % 10 * 51, 432 + place // 10 * 40
        canvas.rectangle(x, y, x + 51, y + 40, ramp, tone)
    fine = smooth_noise(1024, 512, 192, 96, seed)
    canvas.tone = canvas.tone + 0.06 * (fine - 0.5)
    return canvas.to_png()


def _paint_door(canvas: Canvas, left: int, ramp: int, rng: Rng) -> None:
    canvas.rectangle(left, 0, left + 64, 128, 1, 0.8)
    canvas.rectangle(left + 5, 5, left + 59, 128, ramp, (0.42, 0.55))
    canvas.rectangle(left + 5, 5, left + 59, 30, 8, (0.3, 0.5))  # light above the door
    canvas.rectangle(left + 5, 28, left + 59, 32, 1, 0.7)
    glazed = rng.happens(0.5)
    for first in (left + 9, left + 34):
        for top, bottom in ((38, 74), (80, 118)):
            canvas.rectangle(first, top, first + 21, bottom, ramp, 0.25)
            canvas.rectangle(first + 2, top + 2, first + 21, bottom, ramp, 0.7)
            if glazed and top == 38:
                canvas.rectangle(first + 2, top + 2, first + 20, bottom - 2, 8, (0.55, 0.25))
    canvas.rectangle(left + 31, 32, left + 33, 128, ramp, 0.12)
    canvas.rectangle(left + 35, 76, left + 39, 79, 9, 0.8)
    canvas.rectangle(left, 124, left + 64, 128, 0, 0.4)


def _paint_shop(canvas: Canvas, corner: tuple[int, int], ramp: int, goods: int, rng: Rng) -> None:
    """A timber shop front: large panes over a panelled base, a lit room with goods on shelves behind them."""
    left, top = corner
    canvas.rectangle(left, top, left + 128, top + 128, ramp, (0.5, 0.36))
    for first in (left + 6, left + 66):
        canvas.rectangle(first, top + 12, first + 56, top + 98, 8, (0.40, 0.16))
        for shelf in (top + 48, top + 70, top + 92):
            _paint_goods(canvas, (first + 4, shelf), goods, rng)
            canvas.rectangle(first + 2, shelf, first + 54, shelf + 2, 4, 0.5)
        canvas.rectangle(first, top + 12, first + 56, top + 18, 0, 0.1)
        canvas.rectangle(first, top + 26, first + 56, top + 28, ramp, 0.6)
        canvas.rectangle(first + 27, top + 12, first + 29, top + 98, ramp, 0.6)
        canvas.rectangle(first + 4, top + 104, first + 52, top + 122, ramp, 0.62)
        canvas.rectangle(first + 6, top + 106, first + 52, top + 122, ramp, 0.4)
    canvas.rectangle(left, top + 125, left + 128, top + 128, 0, 0.3)


_GOODS: tuple[tuple[int, int, int, tuple[int, ...], bool], ...] = (
    (5, 6, 12, (1, 4, 5, 6, 7, 9), False),  # books
    (9, 4, 6, (4, 9), True),  # loaves
    (6, 12, 16, (5, 6, 8), False),  # bottles
    (14, 14, 18, (7, 6, 2, 1), False),  # coats
    (9, 5, 13, (6, 7, 9, 5), False),  # toys
    (8, 4, 8, (1, 6, 9), True),  # cakes
    (10, 5, 9, (1, 3, 10), True),  # crockery
    (12, 5, 7, (4, 2, 6), True),  # hats
)
"""What stands on the shelves of each shop: width, least and greatest height [px], ramps, whether it is round above."""


def _paint_goods(canvas: Canvas, foot: tuple[int, int], number: int, rng: Rng) -> None:
    wide, least, most, ramps, is_round = _GOODS[number]
    left, shelf = foot
    for item in range(left, left + 49 - wide, wide + 2):
        high, ramp, tone = least + rng.below(most - least + 1), rng.pick(ramps), rng.between(0.45, 0.85)
        canvas.rectangle(item, shelf - high, item + wide, shelf, ramp, tone)
        if is_round:
            canvas.rectangle(item + 2, shelf - high - 2, item + wide - 2, shelf - high, ramp, min(1.0, tone + 0.1))
        else:
            canvas.rectangle(item + wide - 1, shelf - high, item + wide, shelf, ramp, 0.6 * tone)


def _paint_sign(canvas: Canvas, top: int, ramp: int, words: str, atlas: GlyphAtlas) -> None:
    """A board as long as the shop, its words in the middle; the board is about sixteen times as long as high."""
    canvas.rectangle(0, top, 512, top + 32, ramp, (0.42, 0.32))
    canvas.rectangle(3, top + 2, 509, top + 30, ramp, 0.3)
    ink, tone = (2, 0.1) if ramp in (1, 9) else (9, 0.9)
    letters = draw_letters(atlas, words, (512, 32), 25.0) > 0.5
    canvas.ramp[top : top + 32][letters] = ink
    canvas.tone[top : top + 32][letters] = tone


def _paint_car_parts(canvas: Canvas) -> None:
    """A wheel with its rim, a windscreen that mirrors the sky, and a side's windows with pillars."""
    y, x = np.mgrid[0:64, 0:64] + 0.5 - 32.0
    away = x * x + y * y
    spoke = np.abs(x * y) * (x * x - y * y) ** 2 < 0.012 * away**3  # eight, about the axes and the diagonals
    canvas.rectangle(0, 896, 64, 960, 2, 0.06)
    rim = canvas.tone[896:960, 0:64]
    rim[away < 21.0**2] = np.where(spoke | (away > 17.0**2), 0.95, 0.30)[away < 21.0**2]
    rim[away < 5.0**2] = 0.7
    canvas.rectangle(64, 896, 128, 960, 8, (0.95, 0.28))
    canvas.rectangle(64, 896, 128, 899, 2, 0.1)
    canvas.rectangle(128, 896, 256, 960, 2, 0.08)
    for left, right in ((134, 188), (196, 250)):
        canvas.rectangle(left, 901, right, 956, 8, (0.9, 0.25))


def _paint_dormer(canvas: Canvas, left: int, ramp: int) -> None:
    canvas.rectangle(left, 320, left + 64, 384, ramp, 0.75)
    canvas.rectangle(left + 12, 334, left + 52, 380, 8, (0.6, 0.2))
    for bar in (
        (left + 12, 334, left + 15, 380),
        (left + 49, 334, left + 52, 380),
        (left + 30, 334, left + 34, 380),
        (left + 12, 334, left + 52, 337),
        (left + 12, 352, left + 52, 354),
    ):
        canvas.rectangle(*bar, 1, 0.95)
    canvas.rectangle(left + 8, 380, left + 56, 384, 1, 0.9)


def _paint_oriel(canvas: Canvas, left: int, ramp: int) -> None:
    """One face of a projecting window, one storey high."""
    canvas.rectangle(left, 320, left + 64, 384, ramp, 0.7)
    canvas.rectangle(left + 6, 328, left + 58, 368, 8, (0.66, 0.22))
    for bar in ((left + 30, 328, left + 34, 368), (left + 6, 340, left + 58, 343)):
        canvas.rectangle(*bar, 1, 0.95)
    canvas.rectangle(left + 6, 328, left + 58, 331, 0, 0.2)
    canvas.rectangle(left + 6, 370, left + 58, 382, ramp, 0.5)
    canvas.rectangle(left + 8, 372, left + 58, 382, ramp, 0.66)
    canvas.rectangle(left, 366, left + 64, 369, 1, 0.9)


def paint_leaves(seed: int) -> bytes:
    """A tuft of leaves on nothing: many small ellipses, darker ones first."""
    side, count = 256, 620
    canvas = Canvas(
        side, side, [((34, 52, 24), (134, 158, 82)), ((48, 66, 28), (158, 174, 96)), ((38, 60, 34), (118, 150, 88))]
    )
    canvas.clear[:] = True
    canvas.tone[:] = 0.35
    rng = Rng(seed, "leaves")
    for number in range(count):
        # The golden angle spreads them; a power above one half, with which they would fill the disc evenly, thins its
        # edge, so that no card shows its outline in a crown.
        place = number * 7 % count
        share = (place + 0.5) / count
        reach = 116.0 * math.sqrt(share) * math.sqrt(math.sqrt(share))
        along, across = _golden(place)
        middle = (128.0 + reach * along + rng.between(-6.0, 6.0), 128.0 + reach * across + rng.between(-6.0, 6.0))
        tone = 0.22 + 0.6 * number / count + rng.between(-0.15, 0.15)
        _paint_leaf(canvas, middle, rng, tone)
    canvas.grain(0.06, seed)
    return canvas.to_png()


def _paint_leaf(canvas: Canvas, middle: tuple[float, float], rng: Rng, tone: float) -> None:
    """An ellipse with a rib, one half in the light."""
    cx, cy = middle
    tx, ty = _golden(rng.below(1000))
    long, wide, ramp = rng.between(8.0, 12.0), rng.between(3.6, 5.2), rng.below(3)
    size = canvas.size[0]
    left, right = max(0, int(cx) - 13), min(size, int(cx) + 14)
    top, bottom = max(0, int(cy) - 13), min(size, int(cy) + 14)
    x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
    s, t = (x - cx) * tx + (y - cy) * ty, (y - cy) * tx - (x - cx) * ty
    leaf = (s / long) * (s / long) + (t / wide) * (t / wide) < 1.0
    patch = (slice(top, bottom), slice(left, right))
    canvas.ramp[patch][leaf] = ramp
    canvas.tone[patch][leaf] = (tone + 0.10 * np.sign(t) + np.where(np.abs(t) < 0.6, -0.12, 0.0))[leaf]
    canvas.clear[patch][leaf] = False


def _golden(number: int) -> tuple[float, float]:
    """A unit vector at `number` golden angles, by products alone: sines may differ between machines."""
    cos, sin = -0.7373688780783197, 0.6754902942615238
    x, y = 1.0, 0.0
    bits = number
    while bits:
        if bits & 1:
            x, y = x * cos - y * sin, x * sin + y * cos
        cos, sin = cos * cos - sin * sin, 2.0 * cos * sin
        bits >>= 1
    return x, y


def paint_railing(seed: int) -> bytes:
    """Wrought iron: a hand rail, bars, circles below."""
    width, height = 128, 64
    canvas = Canvas(width, height, [((14, 15, 17), (70, 72, 76)), ((14, 15, 17), (70, 72, 76))])
    canvas.clear[:] = True
    for left in range(2, width, 8):
        canvas.rectangle(left, 4, left + 3, height, 0, 0.5)
    for top, thick in ((0, 5), (44, 3), (58, 6)):
        canvas.rectangle(0, top, width, top + thick, 0, 0.7)
    canvas.grain(0.1, seed)
    return canvas.to_png()
