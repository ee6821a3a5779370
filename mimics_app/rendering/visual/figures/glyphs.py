"""The glyph atlas: signed distance fields of two faces of one font, with the position of each glyph.

Built by assets/builders/fonts/build.py; distance fields stay crisp at any size and angle.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system import resources

__all__ = ["Face", "Glyph", "GlyphAtlas", "Line", "load_glyph_atlas"]

_MISSING = "\N{WHITE SQUARE}"
_MAX_LINES = 512
"""Maximum number of lines that a face caches; running counters would fill it without bound."""

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Glyph:
    """One character of a face.

    Attributes:
        advance: Distance to the next character [em].
        box: Left, bottom, width and height relative to the pen on the baseline [em]; width 0: an empty glyph.
        picture: Rectangle in the atlas, lower left corner and extent [uv]; the height is negative, since the first row
            of the atlas is its top.
    """

    advance: float
    box: Box
    picture: Box


@dataclass(frozen=True, eq=False)
class Line:
    """A line of text at size 1, without its empty glyphs.

    Attributes:
        length: Length of the line [em].
        pens: Distance of the pen from the line's start before each glyph [em], float64 [n].
        boxes: Box of each glyph [em], float64 [n, 4]; see `Glyph`.
        pictures: Rectangle of each in the atlas [uv], float64 [n, 4].
    """

    length: float
    pens: F8
    boxes: F8
    pictures: F8


@dataclass(frozen=True, eq=False)
class Face:
    """One weight of the font: glyphs by character, kerning by pair [em], and a cache of recent lines."""

    glyphs: dict[str, Glyph]
    kerning: dict[str, float]
    _lines: dict[str, Line] = field(default_factory=dict)

    def layout(self, text: str) -> Line:
        """Return a line of text."""
        known = self._lines.get(text)
        if known is None:
            if len(self._lines) >= _MAX_LINES:
                self._lines.clear()
            known = self._lines[text] = self._set(text)
        return known

    def measure(self, text: str) -> float:
        """Return the length of a line [em]."""
        return self.layout(text).length

    def _set(self, text: str) -> Line:
        pen, before = 0.0, ""
        drawn: list[tuple[float, Glyph]] = []
        for character in text:
            glyph = self.glyphs.get(character) or self.glyphs[_MISSING]
            pen += self.kerning.get(before + character, 0.0)
            if glyph.box[2] > 0.0:
                drawn.append((pen, glyph))
            pen, before = pen + glyph.advance, character
        boxes = np.array([glyph.box for _, glyph in drawn], np.float64).reshape(-1, 4)
        pictures = np.array([glyph.picture for _, glyph in drawn], np.float64).reshape(-1, 4)
        return Line(pen, np.array([start for start, _ in drawn]), boxes, pictures)


@dataclass(frozen=True, eq=False)
class GlyphAtlas:
    """Both faces in one texture.

    Attributes:
        pixels: Distance to the outline, 128 on it, larger inside; uint8 [height, width], first row at the top.
        spread: Distance that corresponds to the whole range of `pixels` [atlas px].
        regular: The regular face.
        heavy: The bold face.
    """

    pixels: U1
    spread: float
    regular: Face
    heavy: Face

    def face(self, *, bold: bool) -> Face:
        """Return the regular or the bold face."""
        return self.heavy if bold else self.regular


@cache
def load_glyph_atlas(folder: Path | None = None) -> GlyphAtlas:
    """Read the glyph atlas of the application, or of another folder, once per process.

    Raises:
        SceneError: the files are missing, broken or inconsistent.
    """
    from PIL import Image

    folder = folder or resources.root() / "assets" / "fonts"
    try:
        table = json.loads((folder / "glyphs.json").read_text(encoding="utf-8"))
        with Image.open(folder / "glyphs.png") as picture:
            pixels = np.array(picture.convert("L"))
        faces = [_read_face(table["faces"][name], pixels.shape) for name in ("regular", "bold")]
        return GlyphAtlas(pixels, float(table["spread"]), *faces)
    except (OSError, ValueError, KeyError) as error:
        fix = "rebuild it in a checkout: mimics assets build fonts --out assets/fonts"
        raise SceneError(Issue(str(folder), "", f"the glyph atlas cannot be read ({error!r})", fix)) from error


def _read_face(table: dict[str, dict[str, list[float]]], shape: tuple[int, ...]) -> Face:
    height, width = shape
    glyphs = {}
    for character, (advance, left, bottom, wide, high, x, y, cell_width, cell_height) in table["glyphs"].items():
        picture = (x / width, (y + cell_height) / height, cell_width / width, -cell_height / height)
        glyphs[character] = Glyph(advance, (left, bottom, wide, high), picture)
    return Face(glyphs, {pair: float(shift) for pair, shift in table["kerning"].items()})  # type: ignore[arg-type]
