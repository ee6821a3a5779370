"""Textures of skin, eyes, hair and cloth: rasterised attributes, normal maps of heights, JPEG files."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from assets.builders.avatars.fields import F8
from assets.builders.avatars.sheet import I8
from mimics_app.contracts.arrays import U1

__all__ = ["U1", "encode", "place_map", "slopes"]


_QUALITY = 88


def encode(pixels: F8 | U1, quality: int = _QUALITY) -> bytes:
    """Return sRGB values 0 to 255, [height, width, 3], as a JPEG file."""
    from PIL import Image

    kept = np.clip(np.round(pixels), 0, 255).astype(np.uint8)
    stream = io.BytesIO()
    Image.fromarray(kept).save(stream, "JPEG", quality=quality, subsampling=0, optimize=True)
    return stream.getvalue()


def place_map(uvs: F8, triangles: I8, values: F8, size: tuple[int, int]) -> tuple[F8, NDArray[np.bool_]]:
    """Rasterise vertex attributes into a texture; texels outside of all triangles take the nearest value.

    Args:
        uvs: Of the vertices, [n, 2].
        triangles: [m, 3].
        values: Of the vertices, [n, k].
        size: Width and height of the texture [texel].

    Returns:
        The values, [height, width, k], and where a triangle lies, [height, width].
    """
    width, height = size
    out = np.zeros((height, width, values.shape[1]))
    held = np.zeros((height, width), np.bool_)
    at = uvs * [width, height] - 0.5
    for corners in triangles:
        p = at[corners]
        low = np.maximum(np.floor(p.min(axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(p.max(axis=0)).astype(int), [width - 1, height - 1])
        if (high < low).any():
            continue
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        (ax, ay), (bx, by), (cx, cy) = p
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if abs(area) < 1e-9:
            continue
        one = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
        two = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
        inside = (one >= -1e-6) & (two >= -1e-6) & (one + two <= 1.0 + 1e-6)
        share = np.stack([one, two, 1.0 - one - two], axis=-1)[inside]
        out[y[inside], x[inside]] = share @ values[corners]
        held[y[inside], x[inside]] = True
    return _spread(out, held), held


def _spread(out: F8, held: NDArray[np.bool_]) -> F8:
    """Fill empty texels from their neighbours, ring by ring."""
    out, known = out.copy(), held.copy()
    for _ in range(24):
        if known.all():
            break
        for axis, step in ((0, 1), (0, -1), (1, 1), (1, -1)):
            near, there = np.roll(out, step, axis), np.roll(known, step, axis)
            take = there & ~known
            out[take] = near[take]
            known |= take
    return out


def slopes(heights: F8, pitch: F8 | float, *, wrap: bool = False, more: F8 | None = None) -> F8:
    """Return the normal map of heights [m], 0 to 255, [height, width, 3].

    Args:
        heights: [height, width].
        pitch: Metres between texels.
        wrap: Whether the texture repeats.
        more: Slopes added along u and against v, [height, width, 2].
    """
    if wrap:
        along = 0.5 * (np.roll(heights, -1, 1) - np.roll(heights, 1, 1))
        down = 0.5 * (np.roll(heights, -1, 0) - np.roll(heights, 1, 0))
    else:
        along, down = np.asarray(np.gradient(heights, axis=1)), np.asarray(np.gradient(heights, axis=0))
    # u grows to the right, and the map's second axis points up the picture
    normal = np.stack([-along / pitch, down / pitch, np.ones_like(heights)], axis=-1)
    if more is not None:
        normal[..., :2] += more
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    result: F8 = 127.5 + 127.5 * normal
    return result
