"""Pictures of the canyon: layers of rock, rubble, water, planks and hewn stone; each function returns a PNG."""

from __future__ import annotations

import numpy as np

from assets.builders.kit.lattice_noise import hash_noise, pixels, smooth_noise
from assets.builders.kit.palette_texture import Canvas, Ramp

__all__ = ["LAYERED", "paint_layers", "paint_planks", "paint_rubble", "paint_stone", "paint_water"]

_SIDE, _FINE_SIDE = 256, 512
"""Width and height of a picture, and of one that is seen from near by [px]."""
LAYERED = 40.0
"""Height that one repetition of the layers covers [m]."""
_BEDS = 23
"""Beds of rock in one repetition."""


def paint_layers(seed: int) -> bytes:
    """Beds of sandstone and shale, level, of uneven thickness, each of thin laminae; joints, stains running down."""
    ramps: list[Ramp] = [
        ((96, 52, 36), (214, 138, 98)),
        ((122, 74, 48), (232, 174, 124)),
        ((86, 58, 50), (186, 140, 118)),
        ((140, 98, 66), (240, 206, 160)),
    ]
    side = _FINE_SIDE
    canvas = Canvas(side, side, ramps)
    _, y = pixels(side, side)
    sag = np.rint(0.02 * side * smooth_noise(side, side, 2, 3, seed)).astype(np.int64)
    level = (y + sag) % side
    edges = np.sort((hash_noise(np.arange(_BEDS), np.arange(_BEDS), seed + 1) * side).astype(np.int64))
    bed = np.searchsorted(edges, level.ravel(), side="right").reshape(level.shape) % _BEDS
    canvas.ramp[:] = (hash_noise(bed, bed * 0 + 7, seed + 2) * len(ramps)).astype(np.uint8)
    canvas.tone = 0.38 + 0.34 * hash_noise(bed, bed * 0 + 3, seed + 3)
    wavy = (level + np.rint(3.0 * smooth_noise(side, side, 24, 10, seed + 7)).astype(np.int64)) // 3
    canvas.tone = canvas.tone + 0.24 * (hash_noise(wavy, wavy * 0 + 5, seed + 8) - 0.5)
    joint = np.isin(level, edges) | np.isin(level + 1, edges) | np.isin(level + 2, edges)
    canvas.tone = np.where(joint, canvas.tone - 0.22, canvas.tone)
    canvas.tone = canvas.tone + 0.24 * (smooth_noise(side, side, 90, 34, seed + 4) - 0.5)
    crack = np.abs(smooth_noise(side, side, 9, 44, seed + 9) - 0.5) < 0.016
    canvas.tone = np.where(crack, canvas.tone - 0.16, canvas.tone)
    stain = smooth_noise(side, side, 3, 22, seed + 5)
    canvas.shade(0.74 + 0.36 * stain)
    canvas.grain(0.16, seed + 6)
    return canvas.to_png()


def paint_rubble(seed: int) -> bytes:
    """Fallen stones of all sizes and sand between them; nothing in it is large, so that its repeats do not show."""
    side = _FINE_SIDE
    canvas = Canvas(side, side, [((112, 78, 56), (222, 176, 134)), ((104, 76, 58), (208, 166, 130))])
    stones = np.zeros((side, side))
    for number, (cells, share) in enumerate(((19, 0.16), (43, 0.26), (97, 0.30))):
        stones += share * np.abs(2.0 * smooth_noise(side, side, cells, cells, seed + number) - 1.0)
    canvas.ramp[:] = (smooth_noise(side, side, 71, 71, seed + 5) > 0.6).astype(np.uint8)
    canvas.tone = 0.28 + 0.9 * stones
    canvas.grain(0.22, seed + 9)
    return canvas.to_png()


def paint_water(seed: int) -> bytes:
    """A river seen from far above: green, with fine ripples, and white water in few thin streaks."""
    side = _FINE_SIDE
    canvas = Canvas(side, side, [((30, 72, 70), (86, 140, 130)), ((110, 158, 148), (206, 226, 220))])
    ripples = 0.6 * smooth_noise(side, side, 120, 28, seed) + 0.4 * smooth_noise(side, side, 61, 13, seed + 3)
    broad = smooth_noise(side, side, 7, 3, seed + 1)
    white = ripples * (0.6 + 0.4 * broad) > 0.71
    canvas.ramp[:] = white.astype(np.uint8)
    canvas.tone = np.where(white, 0.5, 0.30 + 0.14 * broad + 0.26 * ripples)
    canvas.grain(0.08, seed + 2)
    return canvas.to_png()


def paint_stone(seed: int) -> bytes:
    """Hewn stones in two courses, each half a block aside of the one below; a metre in one repetition."""
    canvas = Canvas(_SIDE, _SIDE, [((108, 84, 62), (214, 182, 146)), ((98, 78, 60), (200, 170, 138))])
    x, y = pixels(_SIDE, _SIDE)
    course = y // 128
    along = (x + 64 * course) % _SIDE
    block = course * 2 + along // 128
    canvas.ramp[:] = (hash_noise(block, block * 0, seed) > 0.5).astype(np.uint8)
    canvas.tone = 0.52 + 0.14 * hash_noise(block, block * 0 + 1, seed + 1)
    canvas.tone = canvas.tone + 0.3 * (smooth_noise(_SIDE, _SIDE, 37, 37, seed + 2) - 0.5)
    joint = (y % 128 < 5) | (along % 128 < 5)
    canvas.tone = np.where(joint, 0.18, canvas.tone)
    canvas.grain(0.14, seed + 3)
    return canvas.to_png()


def paint_planks(seed: int) -> bytes:
    """Worn planks across the beam, eight in one repetition."""
    ramps: list[Ramp] = [((84, 66, 50), (190, 160, 126)), ((70, 56, 44), (168, 142, 112))]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    x, y = pixels(_SIDE, _SIDE)
    plank = y // 32
    canvas.ramp[:] = (hash_noise(plank, plank * 0, seed) > 0.5).astype(np.uint8)
    canvas.tone = 0.42 + 0.3 * hash_noise(plank, plank * 0 + 1, seed + 1)
    canvas.tone = canvas.tone + 0.26 * (smooth_noise(_SIDE, _SIDE, 64, 6, seed + 2) - 0.5)
    canvas.tone = np.where(y % 32 < 3, 0.06, canvas.tone)
    nails = ((x % 128 - 20) ** 2 + (y % 32 - 16) ** 2) < 7
    canvas.tone = np.where(nails, 0.1, canvas.tone)
    canvas.grain(0.10, seed + 3)
    return canvas.to_png()
