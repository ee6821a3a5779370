"""Pictures of the canyon: layers of rock, rubble, water and planks; each function returns a PNG."""

from __future__ import annotations

import numpy as np

from assets.builders.kit.lattice_noise import hash_noise, pixels, smooth_noise
from assets.builders.kit.palette_texture import Canvas, Ramp

__all__ = ["LAYERED", "paint_layers", "paint_planks", "paint_rubble", "paint_water"]

_SIDE = 256
LAYERED = 40.0
"""Height that one repetition of the layers covers [m]."""
_BEDS = 23
"""Beds of rock in one repetition."""


def paint_layers(seed: int) -> bytes:
    """Beds of sandstone and shale, level, of uneven thickness; darker joints between, stains running down."""
    ramps: list[Ramp] = [
        ((96, 52, 36), (214, 138, 98)),
        ((122, 74, 48), (232, 174, 124)),
        ((86, 58, 50), (186, 140, 118)),
        ((140, 98, 66), (240, 206, 160)),
    ]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    _, y = pixels(_SIDE, _SIDE)
    sag = np.rint(5.0 * smooth_noise(_SIDE, _SIDE, 2, 3, seed)).astype(np.int64)
    level = (y + sag) % _SIDE
    edges = np.sort((hash_noise(np.arange(_BEDS), np.arange(_BEDS), seed + 1) * _SIDE).astype(np.int64))
    bed = np.searchsorted(edges, level.ravel(), side="right").reshape(level.shape) % _BEDS
    canvas.ramp[:] = (hash_noise(bed, bed * 0 + 7, seed + 2) * len(ramps)).astype(np.uint8)
    canvas.tone = 0.38 + 0.34 * hash_noise(bed, bed * 0 + 3, seed + 3)
    joint = np.isin(level, edges) | np.isin(level + 1, edges)
    canvas.tone = np.where(joint, canvas.tone - 0.22, canvas.tone)
    canvas.tone = canvas.tone + 0.20 * (smooth_noise(_SIDE, _SIDE, 40, 8, seed + 4) - 0.5)
    stain = smooth_noise(_SIDE, _SIDE, 3, 22, seed + 5)
    canvas.shade(0.74 + 0.36 * stain)
    canvas.grain(0.16, seed + 6)
    return canvas.to_png()


def paint_rubble(seed: int) -> bytes:
    """Fallen stones and sand between them."""
    ramps: list[Ramp] = [((112, 78, 56), (220, 174, 132)), ((92, 70, 58), (196, 158, 128))]
    canvas = Canvas(_SIDE, _SIDE, ramps)
    broad, fine = smooth_noise(_SIDE, _SIDE, 9, 9, seed), smooth_noise(_SIDE, _SIDE, 38, 38, seed + 1)
    canvas.ramp[:] = (fine > 0.55).astype(np.uint8)
    canvas.tone = 0.26 + 0.32 * broad + 0.42 * np.abs(fine - 0.5)
    canvas.grain(0.24, seed + 2)
    return canvas.to_png()


def paint_water(seed: int) -> bytes:
    """A river seen from far above: green, with white water in streaks."""
    canvas = Canvas(_SIDE, _SIDE, [((26, 66, 66), (92, 148, 138)), ((150, 186, 178), (244, 250, 248))])
    streaks = smooth_noise(_SIDE, _SIDE, 34, 7, seed)
    broad = smooth_noise(_SIDE, _SIDE, 5, 5, seed + 1)
    white = streaks * (0.5 + broad) > 0.86
    canvas.ramp[:] = white.astype(np.uint8)
    canvas.tone = np.where(white, 0.7, 0.3 + 0.4 * broad + 0.2 * streaks)
    canvas.grain(0.12, seed + 2)
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
