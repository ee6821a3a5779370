"""Built-in sprite textures: white, so that the sprite's colour applies."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.effects import SpriteShape
from mimics_app.world.content.materials.material import TextureData

__all__ = ["sprite_picture"]


_SIDE = 64
"""Width and height [texels], equal so that all sprites share a texture."""


@cache
def sprite_picture(shape: SpriteShape) -> TextureData:
    """Return the texture of a shape, 64 by 64 texels, transparent at its border."""
    y, x = (np.mgrid[0:_SIDE, 0:_SIDE] + 0.5) / (0.5 * _SIDE) - 1.0
    cover = np.clip(_COVERS[shape](x, y), 0.0, 1.0)
    pixels = np.full((_SIDE, _SIDE, 4), 255, np.uint8)
    pixels[..., 3] = np.round(255.0 * cover)
    return TextureData(pixels, wrap=("clamp", "clamp"))


def _dot(x: F8, y: F8) -> F8:
    """A spot with a soft edge."""
    return np.asarray(_smooth(1.0 - np.hypot(x, y)))


def _puff(x: F8, y: F8) -> F8:
    """A cloud: overlapping soft spots, always the same."""
    places = np.random.default_rng(7).uniform(-0.45, 0.45, (14, 2))
    clear = np.ones_like(x)
    for left, top in places:
        clear = clear * (1.0 - 0.45 * _smooth(1.0 - np.hypot(x - left, y - top) / 0.5))
    return np.asarray((1.0 - clear) * _smooth(2.5 * (1.0 - np.hypot(x, y))))


def _paper(x: F8, y: F8) -> F8:
    """A square with a border of one texel."""
    return np.asarray((np.maximum(np.abs(x), np.abs(y)) < 1.0 - 2.0 / _SIDE).astype(np.float64))


def _spark(x: F8, y: F8) -> F8:
    """A star of four rays."""
    away = np.hypot(x, y)
    rays = np.exp(-40.0 * np.minimum(np.abs(x), np.abs(y))) * _smooth(1.0 - away)
    return np.asarray(rays + _smooth(1.0 - 2.5 * away))


def _ring(x: F8, y: F8) -> F8:
    """A ring with sharp edges."""
    texel = 2.0 / _SIDE
    away = np.hypot(x, y)
    return np.asarray(np.minimum((0.94 - away) / texel + 0.5, (away - 0.78) / texel + 0.5))


def _smooth(share: F8) -> F8:
    inside = np.clip(share, 0.0, 1.0)
    return np.asarray(inside * inside * (3.0 - 2.0 * inside))


_COVERS: dict[SpriteShape, Callable[[F8, F8], F8]] = {
    "dot": _dot,
    "puff": _puff,
    "paper": _paper,
    "spark": _spark,
    "ring": _ring,
}
"""Opacity by position in the texture, both coordinates -1 to 1."""
