"""Rectangles of the glyphs of a line of text, as rows of the heads-up display."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8

__all__ = ["write_line"]

_PICTURE, _STYLE = 4, 12
"""First columns of a rectangle's place in the atlas, and of its style."""


@kernel
def write_line(
    pens: F8,
    boxes: F8,
    pictures: F8,
    start: float,
    baseline: float,
    size: float,
    style: float,
    out: F4,
) -> None:
    """Write the glyphs of a line of text.

    Args:
        pens: Distance of the pen from the line's start before each glyph [em], [n].
        boxes: Left, bottom, width and height of each relative to the pen [em], [n, 4].
        pictures: Its rectangle in the atlas [uv], [n, 4].
        start: Left end of the line [hud px].
        baseline: Its height [hud px].
        size: Em size [hud px].
        style: Kind of the rows.
        out: Written but for the colour: rows of `figures.hud.HUD_ROW` as plain numbers, [n, 16].
    """
    for n in range(pens.shape[0]):
        out[n, 0] = size * boxes[n, 0] + (start + pens[n] * size)
        out[n, 1] = size * boxes[n, 1] + baseline
        out[n, 2] = size * boxes[n, 2]
        out[n, 3] = size * boxes[n, 3]
        for k in range(pictures.shape[1]):
            out[n, _PICTURE + k] = pictures[n, k]
            out[n, _STYLE + k] = 0.0
        out[n, _STYLE] = style
