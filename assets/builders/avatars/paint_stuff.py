"""Textures that all people share: hands with nails and creases, cloth, hair; and the eyes of one person."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from assets.builders.avatars.eyes import IRIS
from assets.builders.avatars.face_shape import EYE_RADIUS
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.sheet import I8
from assets.builders.avatars.skeleton import FINGERS
from assets.builders.avatars.textures import encode, place_map, slopes
from assets.builders.kit.lattice_noise import hash_noise, smooth_noise
from assets.builders.kit.palette_texture import Rgb

__all__ = ["paint_cloth", "paint_curls", "paint_eye", "paint_hair", "paint_hands"]

_HAND_SIZE = 512
_CLOTH_SIZE, _CLOTH_TILE = 256, 0.30
_LOCKS, _HAIR_TILE = 9, 0.075
"""Number of locks on the texture of hair, and its width [m]."""
_NAIL = (0.0125, 0.0066)
"""Length and half breadth of a nail of a middle finger [m]."""


def paint_hands(uvs: F8, triangles: I8, places: F8, joints: dict[str, F8]) -> tuple[bytes, bytes]:
    """Return the factor on the colour of skin and the normal map of a hand.

    Args:
        uvs: Texture coordinates of a hand's vertices, [n, 2].
        triangles: [m, 3].
        places: Along the arm, towards the back of the hand, towards the thumb [m], [n, 3].
        joints: Places of knuckles and tips in the same frame, by the finger's name and joint's number 0 to 3.
    """
    sheet, held = place_map(uvs, triangles, places, (_HAND_SIZE, _HAND_SIZE))
    at = sheet.reshape(-1, 3)
    back = np.tile((np.arange(_HAND_SIZE) < _HAND_SIZE // 2), (_HAND_SIZE, 1)).ravel()
    grain = smooth_noise(_HAND_SIZE, _HAND_SIZE, 90, 90, 3).ravel() - 0.5
    patches = smooth_noise(_HAND_SIZE, _HAND_SIZE, 17, 17, 4).ravel() - 0.5
    colour = np.ones((len(at), 3)) * (238.0 * (1.0 + 0.035 * grain + 0.05 * patches))[:, None]
    heights = 0.00010 * grain + 0.00008 * patches
    for finger in FINGERS:
        colour, heights = _finger(finger, joints, at, back, colour, heights)
    palm = ~back & held.ravel()
    heights -= palm * _palm_lines(at)
    colour *= 1.0 - (palm * 80.0 * _palm_lines(at))[:, None] * [0.6, 1.0, 1.0]
    bones = back & held.ravel()
    for finger in FINGERS[1:]:
        knuckle = joints[f"{finger}0"]
        sinew = np.exp(-(((at[:, 2] - knuckle[2] * (0.35 + 0.65 * at[:, 0] / knuckle[0])) / 0.0028) ** 2))
        heights += bones * 0.0007 * sinew * step(0.03, 0.07, at[:, 0]) * step(0.095, 0.08, at[:, 0])
    below = np.repeat(np.arange(_HAND_SIZE) > 0.82 * _HAND_SIZE, _HAND_SIZE)  # plain skin: arms, legs, neck
    colour[below], heights[below] = 238.0, 0.0
    pitch = 0.5 * 0.16 / (_HAND_SIZE // 2) * 2.0
    picture = colour.reshape(_HAND_SIZE, _HAND_SIZE, 3)
    return encode(picture, 84), encode(slopes(heights.reshape(_HAND_SIZE, _HAND_SIZE), pitch), 84)


def _finger(
    finger: str, joints: dict[str, F8], at: F8, back: NDArray[np.bool_], colour: F8, heights: F8
) -> tuple[F8, F8]:
    """Creases over the joints of a finger, redder knuckles and tips, and its nail."""
    points = [joints[f"{finger}{number}"] for number in range(4)]
    direction = points[3] - points[2]
    axis = direction[[0, 2]] / np.linalg.norm(direction[[0, 2]])
    flat = at[:, [0, 2]]
    near = np.linalg.norm(flat - points[3][[0, 2]], axis=1) < 0.035
    for number in (1, 2):
        offset = flat - points[number][[0, 2]]
        s, t = offset @ axis, offset @ np.array([-axis[1], axis[0]])
        close = step(0.011, 0.007, np.abs(t))
        wrinkle = close * np.exp(-((s / 0.0042) ** 2)) * (0.5 + 0.5 * np.cos(s / 0.0025 * 2.0 * math.pi))
        heights = heights - 0.00022 * wrinkle * np.where(back, 1.0, 0.35)
        red = 0.55 * close * np.exp(-((s / 0.008) ** 2)) * np.where(back, 1.0, 0.3)
        colour = colour * (1.0 - red[:, None] * [0.03, 0.13, 0.12])
    tip = points[3][[0, 2]] - 0.0015 * axis
    offset = flat - tip
    s, t = offset @ axis, offset @ np.array([-axis[1], axis[0]])
    size = 0.86 if finger == "Little" else 1.18 if finger == "Thumb" else 1.0
    long, half = _NAIL[0] * size, _NAIL[1] * size
    round_ = (np.abs(t) / half) ** 3.0 + (np.abs(s + 0.5 * long) / (0.5 * long)) ** 3.2
    nail = back * near * step(1.12, 0.88, round_)
    rim = back * near * np.exp(-(((round_ - 1.1) / 0.30) ** 2))
    free = nail * step(-0.0022, -0.0008, s)
    moon = nail * np.exp(-(((s + 0.92 * long) / 0.0024) ** 2) - (t / (0.6 * half)) ** 2)
    heights = heights + 0.00035 * nail - 0.00040 * rim
    pink = np.array([250.0, 214.0, 206.0])
    colour = (
        colour
        + nail[:, None] * 0.62 * (pink - colour)
        + (free + 0.7 * moon)[:, None] * 0.5 * (np.array([252.0, 242.0, 232.0]) - colour)
    )
    colour = colour * (1.0 - 0.16 * rim[:, None])
    pad = ~back * near * np.exp(-(((s + 0.009) / 0.010) ** 2))
    return colour * (1.0 - pad[:, None] * [0.01, 0.08, 0.07]), heights


def _palm_lines(at: F8) -> F8:
    """Depth of the lines of the palm [m]."""
    along, across = at[:, 0], at[:, 2]
    heart = (
        np.exp(-(((along - 0.078 - 0.9 * np.maximum(across, -0.04) ** 2 / 0.03 - 0.10 * across) / 0.0011) ** 2))
        * step(-0.042, -0.036, across)
        * step(0.028, 0.020, across)
    )
    head = (
        np.exp(-(((along - 0.062 - 0.28 * across) / 0.0011) ** 2))
        * step(-0.034, -0.026, across)
        * step(0.040, 0.034, across)
    )
    far = np.hypot(along - 0.018, across - 0.034)
    life = np.exp(-(((far - 0.036) / 0.0012) ** 2)) * step(0.020, 0.010, across - 0.015) * step(0.062, 0.050, along)
    wrist = np.exp(-(((along - 0.002) / 0.0010) ** 2))
    result: F8 = 0.0005 * (heart + head + life) + 0.0002 * wrist
    return result


def paint_cloth() -> bytes:
    """Return the normal map of cloth: threads, and soft oblique folds; it repeats."""
    n = _CLOTH_SIZE
    y, x = np.mgrid[0:n, 0:n] / n
    turn = 2.0 * math.pi
    weave = np.sin(turn * 64.0 * x) * np.sin(turn * 64.0 * y)
    rough = smooth_noise(n, n, 40, 40, 31)
    soft = smooth_noise(n, n, 5, 4, 32) + 0.5 * smooth_noise(n, n, 9, 7, 33)
    ridged = 1.0 - np.abs(2.0 * smooth_noise(n, n, 4, 3, 34) - 1.0)
    heights = 0.00007 * weave + 0.00012 * rough + 0.0032 * soft + 0.0026 * ridged
    return encode(slopes(heights, _CLOTH_TILE / n, wrap=True), 80)


def paint_hair() -> tuple[bytes, bytes]:
    """Return the factor on the colour and the normal map of strands that run down the texture in locks; it repeats."""
    high, wide = 256, 256
    across = np.arange(wide)[None, :] / wide
    waver = smooth_noise(high, wide, 2, 6, 43) - 0.5
    uneven = 0.9 * (smooth_noise(1, wide, 1, 5, 45) - 0.5) / _LOCKS * 2.0
    locks = np.sin(math.pi * _LOCKS * (across + uneven + 0.10 * waver)) ** 2
    strands = hash_noise(np.arange(wide)[None, :], np.zeros((1, wide), np.int64), 41)
    fine = 0.6 * strands + 0.4 * smooth_noise(1, wide, 1, 48, 42)
    column = (np.arange(wide)[None, :] + np.round(0.10 * wide * waver).astype(int)) % wide
    tone = fine[0][column] * (0.85 + 0.3 * smooth_noise(high, wide, 4, 64, 44))
    colour = (128.0 + 127.0 * np.clip(tone, 0.0, 1.0)) * (0.80 + 0.20 * smooth_noise(high, wide, 3, 14, 46))
    colour *= 0.90 + 0.10 * locks
    heights = _HAIR_TILE * (0.0032 * tone + 0.0036 * locks)
    return encode(colour[..., None] * np.ones(3), 82), encode(slopes(heights, _HAIR_TILE / wide, wrap=True), 82)


def paint_curls() -> tuple[bytes, bytes]:
    """Return the factor on the colour and the normal map of curls, coils side by side; it repeats."""
    n, cells = 256, 12
    y, x = (np.mgrid[0:n, 0:n] + 0.5) * (cells / n)
    column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    nearest, angle, own = np.full((n, n), 9.0), np.zeros((n, n)), np.zeros((n, n))
    for down in (-1, 0, 1):
        for aside in (-1, 0, 1):
            i, j = (column + aside) % cells, (row + down) % cells
            at_x = column + aside + 0.15 + 0.7 * hash_noise(i, j, 51)
            at_y = row + down + 0.15 + 0.7 * hash_noise(i, j, 52)
            away = np.hypot(x - at_x, y - at_y)
            closer = away < nearest
            nearest = np.where(closer, away, nearest)
            angle = np.where(closer, np.arctan2(y - at_y, x - at_x), angle)
            own = np.where(closer, hash_noise(i, j, 53), own)
    dome = np.sqrt(np.clip(1.0 - nearest**2, 0.0, 1.0))
    coil = 0.5 + 0.5 * np.sin(13.0 * nearest + np.where(own > 0.5, 1.0, -1.0) * angle + 6.0 * own)
    frizz = 0.5 * smooth_noise(n, n, 128, 128, 54) + 0.5 * smooth_noise(n, n, 51, 51, 55)
    colour = (85.0 + 60.0 * dome + 35.0 * own + 75.0 * frizz) * (0.80 + 0.20 * coil)
    heights = _HAIR_TILE / cells * (0.24 * dome + 0.030 * coil + 0.16 * frizz)
    return encode(colour[..., None] * np.ones(3), 82), encode(slopes(heights, _HAIR_TILE / n, wrap=True), 82)


def paint_eye(iris: Rgb, seed: int) -> bytes:
    """Return the texture of an eyeball seen from the front; its edge is 1.75 rad from the centre."""
    n = 128
    y, x = (np.mgrid[0:n, 0:n] + 0.5) / n - 0.5
    angle = 2.0 * np.hypot(x, y) * 1.75
    turn = np.arctan2(y, x)
    edge = math.asin(IRIS / EYE_RADIUS)
    white = np.array([214.0, 205.0, 198.0]) * (1.0 - 0.30 * step(0.55, 1.25, angle))[..., None]
    veins = smooth_noise(n, n, 26, 26, seed) * step(0.62, 1.2, angle)
    white = white * (1.0 - veins[..., None] * [0.02, 0.12, 0.12])
    rays = 0.5 + 0.5 * np.sin(
        turn * 31.0 + 5.0 * hash_noise((turn * 20.0).astype(np.int64), np.zeros_like(turn, np.int64), seed)
    )
    share = np.clip(angle / edge, 0.0, 1.0)
    tint = np.array(iris, float) * (0.52 + 0.42 * rays * step(0.35, 0.6, share))[..., None]
    tint = (
        tint * (1.0 - 0.72 * step(0.78, 1.0, share))[..., None]
        + np.array([26.0, 14.0, 4.0]) * step(0.62, 0.38, share)[..., None]
    )
    colour = tint + step(edge * 0.93, edge * 1.07, angle)[..., None] * (white - tint)
    pupil = step(edge * 0.47, edge * 0.40, angle)[..., None]
    return encode(colour * (1.0 - pupil) + 8.0 * pupil, 90)
