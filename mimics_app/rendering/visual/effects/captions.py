"""Textures of captions: a line of text on a plate, drawn from the glyph atlas."""

from __future__ import annotations

from functools import cache

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.rendering.visual.figures.glyphs import GlyphAtlas, load_glyph_atlas
from mimics_app.world.content.materials.material import TextureData

__all__ = ["caption_key", "caption_picture", "draw_letters"]


_HEIGHT = 96
"""Height of the texture [px]: a caption fills at most an eighth of the screen."""
_EM = 0.58
"""Largest em size of the text over the plate's height."""
_MARGIN = 0.30
"""Margin on the left and on the right over the plate's height."""
_MIDDLE = 0.33
"""Height of the text's centre above its baseline: half of a capital, less a little for descenders [em]."""
_CORNER = 0.28
"""Radius of the corners over the plate's height."""
_PLATE = np.array([0.955, 0.950, 0.930])
_INK = np.array([0.085, 0.105, 0.140])
"""Colours of plate and text [display values]."""
_COVER = 0.94
_ATLAS_EM = 40.0
"""Em size of the glyphs in the atlas [atlas px]."""


def caption_key(text: str, size: tuple[float, float]) -> str:
    """Return the texture name of a `caption_picture`."""
    return f"#caption {_width(size)} {text}"


@cache
def caption_picture(text: str, size: tuple[float, float]) -> TextureData:
    """Return the texture of a caption.

    Args:
        text: One line.
        size: Width and height of the plate [m]; the texture has the same aspect ratio.
    """
    width = _width(size)
    atlas = load_glyph_atlas()
    ink = draw_letters(atlas, text, (width, _HEIGHT), _EM * _HEIGHT)
    colour = _PLATE + (_INK - _PLATE) * ink[..., None]
    pixels = np.concatenate([colour, (_COVER * _plate(width))[..., None]], axis=-1)
    return TextureData(np.round(255.0 * pixels).astype(np.uint8), wrap=("clamp", "clamp"))


def _width(size: tuple[float, float]) -> int:
    """Return the texture's width [px], a multiple of four, so that captions of similar shape share a texture array."""
    return max(4, 4 * round(_HEIGHT * size[0] / size[1] / 4.0))


def _plate(width: int) -> F8:
    """Return the plate's coverage of each pixel, [height, width]."""
    y, x = np.mgrid[0:_HEIGHT, 0:width] + 0.5
    radius, half = _CORNER * _HEIGHT, 0.5 * np.array([width, _HEIGHT]) - 1.0
    across = np.maximum(np.abs(x - 0.5 * width) - half[0] + radius, 0.0)
    along = np.maximum(np.abs(y - 0.5 * _HEIGHT) - half[1] + radius, 0.0)
    return np.asarray(np.clip(radius - np.hypot(across, along) + 0.5, 0.0, 1.0))


def draw_letters(atlas: GlyphAtlas, text: str, size: tuple[int, int], em: float) -> F8:
    """Return the coverage of each pixel by bold, centred text, [height, width].

    Args:
        atlas: Glyph atlas.
        text: One line.
        size: Width and height of the picture [px].
        em: Largest em size; less where the text would be too wide [px].
    """
    width, height = size
    face = atlas.face(bold=True)
    room = max(width - 2.0 * _MARGIN * height, 1.0)
    em = min(em, room / max(face.measure(text), 1e-3))
    pen, base = 0.5 * (width - em * face.measure(text)), 0.5 * height - _MIDDLE * em
    ink = np.zeros((height, width))
    line = face.layout(text)
    for along, box, picture in zip(line.pens, line.boxes, line.pictures, strict=True):
        _add_glyph(ink, atlas, (box, picture), (pen + em * along, base), em)
    return ink


def _add_glyph(ink: F8, atlas: GlyphAtlas, glyph: tuple[F8, F8], pen: tuple[float, float], em: float) -> None:
    """Draw one glyph by its box and picture (see `Line`); `pen` is its position from the lower left corner [px]."""
    (left, bottom, wide, high), (u, v, across, up) = glyph
    rows, columns = (np.arange(size) + 0.5 for size in ink.shape)
    share_x = (columns - pen[0] - em * left) / (em * wide)
    share_y = (ink.shape[0] - rows - pen[1] - em * bottom) / (em * high)
    inside_x, inside_y = ((share >= 0.0) & (share <= 1.0) for share in (share_x, share_y))
    height, width = atlas.pixels.shape
    x, y = (u + across * share_x[inside_x]) * width - 0.5, (v + up * share_y[inside_y]) * height - 0.5
    away = (_sample(atlas.pixels, x[None, :], y[:, None]) - 0.5) * atlas.spread * em / _ATLAS_EM
    ink[np.ix_(inside_y, inside_x)] = np.maximum(ink[np.ix_(inside_y, inside_x)], np.clip(away + 0.5, 0.0, 1.0))


def _sample(pixels: U1, x: F8, y: F8) -> F8:
    """Return bilinear samples, 0 to 1."""
    height, width = pixels.shape
    x, y = np.clip(x, 0.0, width - 1.001), np.clip(y, 0.0, height - 1.001)
    column, row = x.astype(np.int64), y.astype(np.int64)
    right, down = x - column, y - row
    above = pixels[row, column] * (1.0 - right) + pixels[row, column + 1] * right
    below = pixels[row + 1, column] * (1.0 - right) + pixels[row + 1, column + 1] * right
    return np.asarray((above * (1.0 - down) + below * down) / 255.0)
