"""Skies for the examples: a box of six pictures with mountains, a dome at evening, a plane of clouds."""

from __future__ import annotations

import io
import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from assets.builders.kit.lattice_noise import smooth_step
from mimics_app.contracts.arrays import F8

__all__ = ["compose"]


_FACE, _DOME, _PLANE = 512, 640, 512
"""Sides of a face of the box, height of the dome, and side of the clouds [px]."""
_FACES: dict[str, tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]]] = {
    "box_px": ((1, 0, 0), (0, 0, 1), (0, 1, 0)),
    "box_nx": ((-1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "box_py": ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    "box_ny": ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    "box_pz": ((0, 0, 1), (-1, 0, 0), (0, 1, 0)),
    "box_nz": ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
}
"""Centre, right and up of each face, seen from inside."""
_STARS = 0.0004
"""Share of the dome's pixels that are stars."""
_WAVES = 7
"""Octaves of a ridge's outline."""


def compose(seed: int) -> dict[str, bytes]:
    """Return all images as PNG files.

    Args:
        seed: Of mountains and clouds.
    """
    files = {f"{name}.png": _png(_mountains(_directions(*axes), seed)) for name, axes in _FACES.items()}
    v, u = np.mgrid[0:_DOME, 0 : 2 * _DOME] + 0.5
    longitude, latitude = math.pi * (u / _DOME - 1.0), math.pi * v / _DOME
    ring = np.sin(latitude)
    dome = np.stack([ring * np.sin(longitude), np.cos(latitude), -ring * np.cos(longitude)], -1)
    return files | {"dome.png": _png(_evening(dome, seed)), "clouds.png": _clouds(seed)}


def _directions(middle: tuple[int, ...], right: tuple[int, ...], up: tuple[int, ...]) -> F8:
    """Unit directions of a face's pixels, [side, side, 3]."""
    down, across = (np.mgrid[0:_FACE, 0:_FACE] + 0.5) / (0.5 * _FACE) - 1.0
    directions = np.array(middle) + across[..., None] * np.array(right) - down[..., None] * np.array(up)
    return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))


def _mountains(directions: F8, seed: int) -> F8:
    """Noon over three ridges, each paler the farther it is; display values."""
    up = directions[..., 1]
    share = np.clip(up, 0.0, 1.0)[..., None] ** 0.6
    shown = (1.0 - share) * np.array([0.80, 0.89, 0.96]) + share * np.array([0.30, 0.53, 0.84])
    puff = _fibre(directions, seed + 5)
    shown = shown + (0.97 - shown) * (0.75 * smooth_step(0.52, 0.70, puff) * smooth_step(0.06, 0.22, up))[..., None]
    around = np.arctan2(directions[..., 0], -directions[..., 2])
    for number, (high, rough, colour) in enumerate(
        ((0.16, 0.10, (0.62, 0.71, 0.80)), (0.10, 0.07, (0.47, 0.58, 0.62)), (0.045, 0.035, (0.35, 0.48, 0.36)))
    ):
        edge = high + rough * _ridge(around, seed + number)
        inside = smooth_step(-0.004, 0.004, edge - up)[..., None]
        lit = 0.10 * np.clip((edge - up) / 0.2, 0.0, 1.0)[..., None]
        shown = shown + inside * (np.array(colour) + lit - shown)
    field = np.clip(-up, 0.0, 1.0)[..., None] ** 0.5
    ground = (1.0 - field) * np.array([0.44, 0.55, 0.36]) + field * np.array([0.36, 0.44, 0.28])
    return np.asarray(np.where((up < 0.0)[..., None], ground, shown))


def _evening(directions: F8, seed: int) -> F8:
    """After sunset towards -z: red below, violet, and the first stars above; display values."""
    up = directions[..., 1]
    towards = 0.5 - 0.5 * directions[..., 2]
    warm = np.exp(-np.clip(up, 0.0, 1.0) / (0.10 + 0.22 * towards))[..., None]
    shown = np.array([0.20, 0.24, 0.46]) * (1.0 - 0.45 * np.clip(up, 0.0, 1.0)[..., None])
    glow = (1.0 - towards[..., None]) * np.array([0.52, 0.40, 0.56]) + towards[..., None] * np.array([1.0, 0.60, 0.32])
    shown = shown + warm * (glow - shown)
    band = smooth_step(0.50, 0.72, _fibre(directions * [1.0, 4.0, 1.0], seed + 7)) * smooth_step(0.02, 0.10, up)
    edge = np.array([0.95, 0.50, 0.42]) * (0.45 + 0.55 * warm)
    shown = shown + (0.7 * band * np.exp(-np.clip(up, 0.0, 1.0) / 0.35))[..., None] * (edge - shown)
    stars = (np.random.default_rng(seed).random(up.shape) > 1.0 - _STARS) & (up > 0.35)
    shown = np.where(stars[..., None], np.array([0.92, 0.93, 1.0]), shown)
    around = np.arctan2(directions[..., 0], -directions[..., 2])
    for number, (high, rough, soft, colour) in enumerate(
        ((0.055, 0.045, 0.004, (0.47, 0.31, 0.37)), (0.025, 0.025, 0.003, (0.29, 0.22, 0.30)))
    ):
        hill = smooth_step(-soft, soft, high + rough * _ridge(around, seed + 3 + number) - up)[..., None]
        shown = shown + hill * (np.array(colour) - shown)
    below = np.clip(-up, 0.0, 1.0)[..., None]
    plain = np.array([0.31, 0.24, 0.30]) + 0.45 * below * (np.array([0.12, 0.11, 0.16]) - 0.31)
    return np.asarray(shown + smooth_step(0.0, 0.012, -up)[..., None] * (plain - shown))


def _clouds(seed: int) -> bytes:
    """White clouds on nothing, which repeat; opacity is their thickness."""
    y, x = np.mgrid[0:_PLANE, 0:_PLANE] * (2.0 * math.pi / _PLANE)
    directions = np.stack([np.cos(x), np.sin(x), np.cos(y), np.sin(y)], -1)
    thick = smooth_step(0.42, 0.86, _fibre(1.2 * directions, seed + 9))
    pixels = np.full((_PLANE, _PLANE, 4), 255, np.uint8)
    pixels[..., :3] = np.round(255.0 * (1.0 - 0.16 * thick))[..., None]
    pixels[..., 3] = np.round(235.0 * thick)
    return _packed(pixels)


def _ridge(around: F8, seed: int) -> F8:
    """Height of a ridge by the direction it is seen in, about -1 to 1; closes on itself."""
    random, total = np.random.default_rng(seed), np.zeros_like(around)
    for octave in range(_WAVES):
        total += 0.62**octave * np.sin((2**octave + 2) * around + random.uniform(0.0, 6.28))
    return np.asarray(0.6 * total)


def _fibre(directions: F8, seed: int) -> F8:
    """Soft noise of places in any number of dimensions, 0 to 1: waves in many directions, bent by each other."""
    random, total, weight = np.random.default_rng(seed), np.zeros(directions.shape[:-1]), 0.0
    bend = np.zeros(directions.shape[:-1])
    for octave in range(5):
        for _ in range(5):
            direction = random.normal(size=directions.shape[-1])
            along = direction * (2.6 * 2.0**octave / float(np.linalg.norm(direction)))
            wave = np.sin(directions @ along + 1.7 * bend + random.uniform(0.0, 6.28))
            bend = 0.6 * bend + 0.4 * wave
            total += 0.6**octave * wave
            weight += float(0.6**octave)
    return np.asarray(0.5 + 1.1 * total / weight)


def _png(shown: F8) -> bytes:
    """A PNG of display values, [height, width, 3], 0 to 1."""
    return _packed(np.round(255.0 * np.clip(shown, 0.0, 1.0)).astype(np.uint8))


def _packed(pixels: NDArray[np.uint8]) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "png", optimize=True)
    return file.getvalue()
