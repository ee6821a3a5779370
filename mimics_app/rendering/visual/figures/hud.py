"""Content of the heads-up display: rounded boxes, text and images as rows of one array."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, U1
from mimics_app.rendering.visual.figures.contrast import fill_in_contrast, in_high_contrast, ink_in_contrast
from mimics_app.rendering.visual.figures.glyphs import GlyphAtlas, load_glyph_atlas
from mimics_app.rendering.visual.kernels.text_rows import write_line

__all__ = ["CANVAS_HEIGHT", "FLOATS", "HUD_ROW", "KIND", "Align", "Colour", "Hud", "LayOut", "canvas_height"]

Colour = tuple[float, float, float, float]
"""Display values 0-1 with straight alpha: as in a colour picker, not linear light."""

Align = Literal["left", "centre", "right"]

LayOut = Callable[[], None]
"""Fills a display."""

CANVAS_HEIGHT = 720.0
"""Height of the canvas; its width follows the picture's aspect ratio [hud px]."""
_NARROWEST = 400.0
"""Smallest width of the canvas [hud px]: the widest card and the words of a message fit."""

HUD_ROW = np.dtype([("box", "f4", (4,)), ("picture", "f4", (4,)), ("tint", "f4", (4,)), ("style", "f4", (4,))])
"""One rectangle as shaders/hud/hud.vert reads it."""

_EDGE: Colour = (1.0, 1.0, 1.0, 1.0)
_EDGE_WIDTH = 1.5
"""Edge of a ground in high contrast [hud px]."""

_ROUNDING = 1e-6
"""Tolerance of a line that was made to fit [hud px]."""

_BOX, _GLYPH, _IMAGE = 0.0, 1.0, 2.0
FLOATS, KIND = HUD_ROW.itemsize // 4, 12
"""Numbers of a rectangle, and which of them is its kind."""

_BEFORE: dict[Align, float] = {"left": 0.0, "centre": 0.5, "right": 1.0}
"""Share of a line's length that is left of its place."""


def canvas_height(aspect: float, enlarged: float = 1.0) -> float:
    """Return the height of the canvas for a picture, by its aspect ratio (width / height) [hud px].

    What is on it is enlarged by a factor, as far as the canvas stays wide enough for its texts.
    """
    return max(CANVAS_HEIGHT / enlarged, _NARROWEST / aspect)


class Hud:
    """Collects rectangles over the picture; later ones cover earlier ones.

    The canvas is 720 px high, or more where the picture is narrow, its origin the lower left corner, x right and y up.
    It is drawn in every view at a depth, so that both eyes see it at the same place.

    Attributes:
        width: Width of the canvas [hud px]; set by the caller from the picture's aspect ratio.
        height: Height of the canvas [hud px]; less than `CANVAS_HEIGHT` enlarges everything, more shrinks it.
        revision: Changes with the content.
        images: Images for `image`, display values, uint8 [n, height, width, 4], row 0 at the top.
    """

    def __init__(self, atlas: GlyphAtlas | None = None) -> None:
        self._atlas = atlas
        self._rows: list[tuple[float, ...]] = []
        self._parts: list[F4] = []
        self.width = CANVAS_HEIGHT * 16.0 / 9.0
        self.height = CANVAS_HEIGHT
        self.revision = 0
        self.images: U1 | None = None

    def fit(self, size: tuple[int, int]) -> None:
        """Set the canvas to a picture of this size [px] that has one view."""
        aspect = size[0] / size[1]
        self.height = canvas_height(aspect)
        self.width = self.height * aspect

    @property
    def atlas(self) -> GlyphAtlas:
        """The glyphs, loaded on first use."""
        if self._atlas is None:
            self._atlas = load_glyph_atlas()
        return self._atlas

    @property
    def empty(self) -> bool:
        """Whether there is nothing to draw."""
        return not (self._rows or self._parts)

    def clear(self) -> None:
        """Remove all content."""
        self._rows.clear()
        self._parts.clear()
        self.revision += 1

    def rows(self) -> NDArray[np.void]:
        """Return the content, HUD_ROW [n], in drawing order."""
        return self.numbers().view(HUD_ROW)[:, 0]

    def numbers(self) -> F4:
        """Return the content as plain numbers, which numpy handles faster than records, float32 [n, `FLOATS`]."""
        self._pack()
        if not self._parts:
            return np.zeros((0, FLOATS), np.float32)
        if len(self._parts) > 1:
            self._parts = [np.concatenate(self._parts)]
        return self._parts[0]

    def extend(self, rows: NDArray[np.void] | F4) -> None:
        """Add many rectangles at once, HUD_ROW [n] or float32 [n, `FLOATS`]."""
        self._pack()
        self._append(np.ascontiguousarray(rows).view(np.float32).reshape(-1, FLOATS))

    def box(
        self,
        x: float,
        y: float,
        width: float,
        height: float,
        colour: Colour,
        *,
        radius: float = 0.0,
        border: float = 0.0,
    ) -> None:
        """Add a rounded box, filled, or an outline of width `border` [hud px].

        In high contrast a rounded ground has an edge.
        """
        if width <= 0.0 or height <= 0.0:
            return
        limit, edged = min(radius, 0.5 * width, 0.5 * height), False
        if in_high_contrast():
            colour, edged = (ink_in_contrast(colour), False) if border else fill_in_contrast(colour)
        self._add((x, y, width, height), (0.0,) * 4, colour, (_BOX, limit, border, 0.0))
        if edged and radius:
            self._add((x, y, width, height), (0.0,) * 4, _EDGE, (_BOX, limit, _EDGE_WIDTH, 0.0))

    def bar(
        self,
        box: tuple[float, float, float, float],
        share: float,
        colour: Colour,
        *,
        track: Colour = (1.0, 1.0, 1.0, 0.16),
        upwards: bool = False,
    ) -> None:
        """Add a rounded bar filled to `share` (clamped to 0-1), to the right or upwards."""
        x, y, width, height = box
        radius = 0.5 * min(width, height)
        self.box(x, y, width, height, track, radius=radius)
        share = min(max(share, 0.0), 1.0) if share == share else 0.0
        if share <= 0.0:
            return
        # At least as long as its rounded ends, so that a small share is a dot.
        if upwards:
            self.box(x, y, width, max(share * height, width), colour, radius=radius)
        else:
            self.box(x, y, max(share * width, height), height, colour, radius=radius)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        colour: Colour = (1.0, 1.0, 1.0, 1.0),
        *,
        bold: bool = False,
        align: Align = "left",
        width: float = float("inf"),
    ) -> float:
        """Add one line of text.

        Args:
            x: Left end, centre or right end by `align` [hud px].
            y: Baseline [hud px].
            text: The text; characters that the font lacks become a box.
            size: Em size [hud px]; capitals have 0.73 of it.
            colour: Colour of the text.
            bold: True for the bold face.
            align: Meaning of `x`.
            width: Maximum width; longer text is cut and ends in an ellipsis [hud px].

        Returns:
            The width drawn [hud px].
        """
        face = self.atlas.face(bold=bold)
        line = self._shorten(text, size, width, bold=bold)
        laid = face.layout(line)
        length = laid.length * size
        rows = np.empty((len(laid.pens), FLOATS), np.float32)
        start = x - _BEFORE[align] * length
        write_line(laid.pens, laid.boxes, laid.pictures, start, float(y), float(size), _GLYPH, rows)
        rows[:, 8:12] = ink_in_contrast(colour) if in_high_contrast() else colour
        self._pack()
        self._append(rows)
        return length

    def fitted(
        self,
        x: float,
        y: float,
        text: str,
        sizes: tuple[float, float],
        width: float,
        colour: Colour,
        *,
        bold: bool = False,
        align: Align = "left",
    ) -> float:
        """Add a line as large as fits into a width, between a least and a greatest size; return its width [hud px]."""
        least, greatest = sizes
        size = greatest * width / max(self.measure(text, greatest, bold=bold), 1.0)
        size = min(greatest, max(least, size))
        return self.text(x, y, text, size, colour, bold=bold, align=align, width=max(0.0, width) + _ROUNDING)

    def measure(self, text: str, size: float, *, bold: bool = False) -> float:
        """Return the width of a line of text [hud px]."""
        return self.atlas.face(bold=bold).measure(text) * size

    def wrap(self, text: str, size: float, width: float, lines: int, *, bold: bool = False) -> list[str]:
        """Break text at spaces into at most `lines` lines of `width` [hud px]; longer text ends in an ellipsis."""
        out: list[str] = []
        rest = text.split()
        while rest and len(out) < lines:
            count = 1
            while count < len(rest) and self.measure(" ".join(rest[: count + 1]), size, bold=bold) <= width:
                count += 1
            last = len(out) == lines - 1
            line = " ".join(rest if last else rest[:count])
            out.append(self._shorten(line, size, width, bold=bold))
            rest = rest[count:]
        return out

    def image(self, box: tuple[float, float, float, float], layer: int, *, radius: float = 0.0) -> None:
        """Add one of `images`, stretched over a rounded box."""
        self._add(box, (0.0, 1.0, 1.0, -1.0), (1.0, 1.0, 1.0, 1.0), (_IMAGE, radius, 0.0, float(layer)))

    def _shorten(self, text: str, size: float, width: float, *, bold: bool) -> str:
        if self.measure(text, size, bold=bold) <= width:
            return text
        while text and self.measure(text + "…", size, bold=bold) > width:
            text = text[:-1]
        return text.rstrip() + "…"

    def _pack(self) -> None:
        """Convert the rows added one by one to an array."""
        if self._rows:
            self._parts.append(np.array(self._rows, np.float32))
            self._rows.clear()

    def _append(self, rows: F4) -> None:
        if len(rows):
            self._parts.append(rows)
            self.revision += 1

    def _add(self, box: tuple[float, ...], picture: tuple[float, ...], tint: Colour, style: tuple[float, ...]) -> None:
        self._rows.append((*box, *picture, *tint, *style))
        self.revision += 1
