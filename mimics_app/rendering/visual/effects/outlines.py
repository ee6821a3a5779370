"""Outlines of sprite textures: what is transparent around a shape costs as much as the shape, unless it is cut off."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.kernels.sprites import MAX_PIECES
from mimics_app.world.content.materials.material import TextureData

__all__ = ["outline_of", "whole_outline"]

_MARGIN = 1.0 / 32.0
"""Margin around the shape, as a share of the texture. Texels of the mipmaps of a sprite of `MIN_OUTLINED` pixels or
more mix in transparent ones of twice 1/128 around it."""

_WORTH = 0.9
"""Share of the texture within the outline from which all of it is drawn."""


def whole_outline() -> F8:
    """Return the outline of a texture that is drawn as one piece."""
    return np.tile([-1.0, 1.0], (MAX_PIECES + 1, 1))


def outline_of(picture: TextureData) -> F8 | None:
    """Return left and right of everything visible at equal heights from bottom to top, each -1 to 1.

    Straight lines between them stay outside of the shape.

    Args:
        picture: The texture.

    Returns:
        float64 [MAX_PIECES + 1, 2]; None where cutting saves little, or the texture repeats across its border.
    """
    if picture.pixels.shape[2] < 4 or tuple(picture.wrap) != ("clamp", "clamp"):
        return None
    visible = picture.pixels[::-1, :, 3] > 0
    height, width = visible.shape
    # Per piece: the outermost visible columns, as shares of the width.
    bounds = np.tile([1.0, 0.0], (MAX_PIECES, 1))
    for piece in range(MAX_PIECES):
        low, high = (piece / MAX_PIECES - _MARGIN) * height, ((piece + 1) / MAX_PIECES + _MARGIN) * height
        columns = np.flatnonzero(visible[max(0, int(np.floor(low))) : int(np.ceil(high))].any(axis=0))
        if len(columns):
            bounds[piece] = columns[0] / width - _MARGIN, (columns[-1] + 1) / width + _MARGIN
    padded = np.concatenate([bounds[:1], bounds, bounds[-1:]])
    left, right = np.minimum(padded[:-1, 0], padded[1:, 0]), np.maximum(padded[:-1, 1], padded[1:, 1])
    empty = left > right
    left[empty] = right[empty] = 0.5
    outline = np.clip(np.stack([left, right], axis=1), 0.0, 1.0)
    mean = np.ptp(outline, axis=1)
    return None if 0.5 * float((mean[:-1] + mean[1:]).mean()) > _WORTH else np.asarray(2.0 * outline - 1.0)
