"""Atlas of letters: signed distances to the outlines of DejaVu Sans, regular and bold, and where each glyph lies.

DejaVu fonts are free to use, embed and redistribute (Bitstream Vera and Arev licences; the DejaVu changes are in the
public domain): assets/fonts/LICENSE-DejaVu.txt. Debian: fonts-dejavu-core.
"""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mimics_app.contracts.arrays import B1, F8, U1
from mimics_app.contracts.errors import UsageError

__all__ = ["FOLDER", "compose"]

EM = 40  # atlas px of the em square
SPREAD = 8  # atlas px from distance value 0 to 1; the outline has half of it on each side
OVERSAMPLE = 8  # the outline is rasterised this much larger before distances are taken
WIDTH = 1024
FOLDER = Path("/usr/share/fonts/truetype/dejavu")
FACES = {"regular": "DejaVuSans.ttf", "bold": "DejaVuSans-Bold.ttf"}
CHARACTERS = [chr(c) for c in (*range(0x20, 0x7F), *range(0xA0, 0x100))] + list(
    "‘’“”–—…•−×≤≥≈√∞µΩαβγδθλπστφωΔΣ°₀₁₂²³←↑→↓▲▼◀▶●○■□✓✗★☆ŁłŚśŻżŹźĆćŃńĄąĘęŠšŽžČčĞğİıŞşŐőŰű€"
)
KERNED = "AFLPTVWYvwyfrkKR.,-'" + "aceousTVWYA"


def compose(seed: int) -> dict[str, bytes]:
    """Return the atlas and its table by file name; nothing in them is random.

    Raises:
        UsageError: The fonts are not installed.
    """
    shelf = _Shelf()
    faces = {name: _build_face(FOLDER / file, shelf) for name, file in FACES.items()}
    picture = BytesIO()
    Image.fromarray(shelf.picture()).save(picture, "PNG", optimize=True)
    table = {"font": "DejaVu Sans", "em": EM, "spread": SPREAD, "faces": faces}
    text = json.dumps(table, ensure_ascii=False, separators=(",", ":")).replace('},"', '},\n"') + "\n"
    return {"glyphs.png": picture.getvalue(), "glyphs.json": text.encode()}


class _Shelf:
    """Packs cells left to right, row upon row."""

    def __init__(self) -> None:
        self.rows: list[U1] = []
        self.x = self.y = self.height = 0
        self.cells: list[tuple[int, int, U1]] = []

    def place(self, cell: U1) -> tuple[int, int]:
        height, width = cell.shape
        if self.x + width > WIDTH:
            self.x, self.y, self.height = 0, self.y + self.height, 0
        self.cells.append((self.x, self.y, cell))
        self.x, self.height = self.x + width, max(self.height, height)
        return self.cells[-1][:2]

    def picture(self) -> U1:
        height = 4 * -(-(self.y + self.height) // 4)
        picture = np.zeros((height, WIDTH), np.uint8)
        for x, y, cell in self.cells:
            picture[y : y + cell.shape[0], x : x + cell.shape[1]] = cell
        return picture


def _build_face(path: Path, shelf: _Shelf) -> dict[str, object]:
    try:
        font = ImageFont.truetype(str(path), EM * OVERSAMPLE, layout_engine=ImageFont.Layout.BASIC)
    except OSError as error:
        raise UsageError(f"{path} cannot be read", "install fonts-dejavu-core") from error
    unit = float(EM * OVERSAMPLE)
    glyphs: dict[str, object] = {}
    for character in dict.fromkeys(CHARACTERS):
        glyphs[character] = _build_glyph(font, character, shelf)
    kerning = {}
    for first in dict.fromkeys(KERNED):
        for second in dict.fromkeys(KERNED):
            shift = (font.getlength(first + second) - font.getlength(first) - font.getlength(second)) / unit
            if abs(shift) > 0.005:
                kerning[first + second] = round(shift, 4)
    return {"glyphs": glyphs, "kerning": kerning}


def _build_glyph(font: ImageFont.FreeTypeFont, character: str, shelf: _Shelf) -> list[float]:
    advance = round(font.getlength(character) / (EM * OVERSAMPLE), 4)
    left, top, right, bottom = font.getbbox(character, anchor="ls")
    if right <= left or bottom <= top:
        return [advance, 0, 0, 0, 0, 0, 0, 0, 0]
    # Cells begin on whole atlas pixels left of and above the ink, with room for the falling distance around it.
    margin = SPREAD // 2 + 1
    x0, y0 = (int(np.floor(side / OVERSAMPLE)) - margin for side in (left, top))
    x1, y1 = (int(np.ceil(side / OVERSAMPLE)) + margin for side in (right, bottom))
    size = ((x1 - x0) * OVERSAMPLE, (y1 - y0) * OVERSAMPLE)
    image = Image.new("L", size, 0)
    ImageDraw.Draw(image).text((-x0 * OVERSAMPLE, -y0 * OVERSAMPLE), character, 255, font=font, anchor="ls")
    cell = _distance_cell(np.array(image) > 127)
    x, y = shelf.place(cell)
    em = float(EM)
    box = [round(value, 4) for value in (x0 / em, -y1 / em, (x1 - x0) / em, (y1 - y0) / em)]
    return [advance, *box, x, y, x1 - x0, y1 - y0]


def _distance_cell(ink: B1) -> U1:
    """Signed distance at the middle of each atlas pixel, as 0-255 over SPREAD atlas px."""
    signed = _distance(~ink) - _distance(ink)
    middle = OVERSAMPLE // 2
    # The middle of an atlas pixel lies on the corner of four large ones.
    before = signed[middle - 1 :: OVERSAMPLE, middle - 1 :: OVERSAMPLE]
    after = signed[middle::OVERSAMPLE, middle::OVERSAMPLE]
    value = 0.5 - 0.5 * (before + after) / (OVERSAMPLE * SPREAD)
    return np.asarray(np.clip(np.round(255.0 * value), 0, 255), np.uint8)


def _distance(away: B1) -> F8:
    """Distance of each true pixel to the nearest false one; the margin around the ink always has false ones."""
    from scipy.ndimage import distance_transform_edt

    # Half a pixel: distances are to the border between two pixels, not to the middle of the next.
    return np.where(away, distance_transform_edt(away) - 0.5, 0.0)
