"""Textures of the room and of surfaces to stroke, which look as they feel. Each function returns a PNG that repeats."""

from __future__ import annotations

import numpy as np

from assets.builders.kit.lattice_noise import hash_noise, pixels, smooth_noise
from assets.builders.kit.palette_texture import Canvas, Ramp
from mimics_app.contracts.arrays import F8

__all__ = [
    "paint_boards",
    "paint_cushion",
    "paint_grain",
    "paint_ice",
    "paint_oak",
    "paint_ripples",
    "paint_rubber",
]


_SIDE = 256


def _grain(canvas: Canvas, seed: int, high: int) -> F8:
    """Streaks of wood along x; `high` of them over the picture."""
    width, height = canvas.size
    streaks = smooth_noise(height, width, high, 3, seed)
    return 0.7 * streaks + 0.3 * smooth_noise(height, width, 2 * high, 8, seed + 1)


def paint_oak(seed: int) -> bytes:
    """A table's top of glued staves, light oak, grain along x."""
    ramps: list[Ramp] = [((104, 72, 44), (206, 164, 116)), ((96, 64, 38), (196, 152, 104))]
    canvas = Canvas(2 * _SIDE, _SIDE, ramps)
    x, y = pixels(2 * _SIDE, _SIDE)
    stave = y // 32
    part = ((x + 149 * stave) % 512) // 256
    canvas.ramp[:] = (hash_noise(part, stave, seed + 3) > 0.5).astype(np.uint8)
    tone = 0.52 + 0.26 * (hash_noise(part, stave, seed) - 0.5)
    canvas.tone = tone + 0.46 * (_grain(canvas, seed, 64) - 0.5)
    canvas.shade(0.82, (y % 32 == 0) | ((x + 149 * stave) % 256 == 0))
    canvas.grain(0.05, seed + 2)
    return canvas.to_png()


def paint_boards(seed: int) -> bytes:
    """Floor boards along x, warm and worn."""
    canvas = Canvas(2 * _SIDE, _SIDE, [((70, 50, 36), (176, 138, 104))])
    x, y = pixels(2 * _SIDE, _SIDE)
    board = y // 64
    tone = 0.5 + 0.24 * (hash_noise(board, board * 0, seed) - 0.5)
    canvas.tone = tone + 0.4 * (_grain(canvas, seed, 48) - 0.5)
    canvas.shade(0.45, (y % 64 < 2) | ((x + 131 * board) % 512 < 2))
    canvas.grain(0.06, seed + 2)
    return canvas.to_png()


def paint_grain(seed: int) -> bytes:
    """Grain of painted wood, nearly white, to be tinted by a material."""
    side = _SIDE // 2
    canvas = Canvas(side, side, [((172, 168, 160), (255, 255, 252))])
    canvas.tone = 0.72 + 0.75 * (_grain(canvas, seed, 24) - 0.5)
    canvas.grain(0.06, seed + 2)
    return canvas.to_png()


def paint_ice(seed: int) -> bytes:
    """Ice: pale blue, cloudy within, with white cracks."""
    canvas = Canvas(_SIDE, _SIDE, [((96, 152, 188), (240, 250, 255))])
    cloud = smooth_noise(_SIDE, _SIDE, 5, 5, seed)
    canvas.tone = 0.42 + 0.34 * cloud
    for number in range(3):
        fold = smooth_noise(_SIDE, _SIDE, 4 + number, 5 + number, seed + 11 + number)
        crack = np.clip(1.0 - np.abs(fold - 0.5) / 0.008, 0.0, 1.0)
        canvas.tone = canvas.tone + (0.75 - 0.2 * number) * crack * (1.0 - canvas.tone)
    canvas.grain(0.05, seed + 5)
    return canvas.to_png()


def paint_rubber(seed: int) -> bytes:
    """A rubber mat: dark red, with studs in rows."""
    canvas = Canvas(_SIDE, _SIDE, [((70, 20, 16), (206, 84, 66))])
    x, y = pixels(_SIDE, _SIDE)
    shifted = x + (y // 32 % 2) * 16
    across, down = (shifted % 32) - 15.5, (y % 32) - 15.5
    away = np.hypot(across, down)
    lit = 0.5 - 0.035 * (across + down)
    canvas.tone = np.where(away < 9.0, 0.58 + 0.28 * (lit - 0.5), np.where(away < 11.0, 0.12, 0.34))
    canvas.grain(0.12, seed)
    return canvas.to_png()


def paint_ripples(seed: int) -> bytes:
    """Planed wood with ripples across the grain, lit from one side."""
    canvas = Canvas(_SIDE, _SIDE, [((84, 50, 26), (226, 172, 112))])
    x, y = pixels(_SIDE, _SIDE)
    wave = np.sin(2.0 * np.pi * (x + 2.0 * np.sin(2.0 * np.pi * y / _SIDE)) / 16.0)
    canvas.tone = 0.5 + 0.34 * wave + 0.16 * (_grain(canvas, seed, 32) - 0.5)
    canvas.grain(0.05, seed + 1)
    return canvas.to_png()


def paint_cushion(seed: int) -> bytes:
    """Woven cloth of a cushion, green, with seams that draw it in."""
    canvas = Canvas(_SIDE, _SIDE, [((28, 74, 44), (138, 192, 132))])
    x, y = pixels(_SIDE, _SIDE)
    weave = np.where((x // 4 + y // 4) % 2 == 0, 0.06, -0.06)
    puff = np.abs(np.sin(np.pi * (x + y) / 64.0) * np.sin(np.pi * (x - y) / 64.0)) ** 0.5
    canvas.tone = 0.22 + 0.48 * puff + weave
    canvas.grain(0.10, seed)
    return canvas.to_png()
