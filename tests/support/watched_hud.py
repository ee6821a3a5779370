"""A canvas that notices texts that are cut, that leave their box or the canvas, or that were not looked up."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.system.language import catalogue, spoken, translated
from mimics_app.rendering.visual.figures.glyphs import GlyphAtlas
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, Align, Colour, Hud

__all__ = ["Fault", "WatchedHud", "page_canvas"]

_ROUNDING = 0.51
"""Tolerance of a text's ends [hud px]."""


@dataclass(frozen=True)
class Fault:
    """A text that does not fit, and how."""

    text: str
    how: str


class WatchedHud(Hud):
    """Collects the faults of what is drawn on it, and on others that share the list: `faults`.

    A text that would be translated into the present language has been drawn without being looked up.
    """

    def __init__(self, atlas: GlyphAtlas | None = None, faults: list[Fault] | None = None) -> None:
        super().__init__(atlas)
        self.faults: list[Fault] = [] if faults is None else faults
        self._boxes: list[tuple[float, float, float, float]] = []

    def clear(self) -> None:
        super().clear()
        self._boxes.clear()

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
        super().box(x, y, width, height, colour, radius=radius, border=border)
        if border == 0.0:
            self._boxes.append((x, y, width, height))

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
        self._look_up(text)
        if self.measure(text, size, bold=bold) > width + _ROUNDING:
            self.faults.append(Fault(text, "cut"))
        length = super().text(x, y, text, size, colour, bold=bold, align=align, width=width)
        left = x - {"left": 0.0, "centre": 0.5, "right": 1.0}[align] * length
        self._check(text, left, left + length, y, y + 0.73 * size)
        missing = sorted({letter for letter in text if letter not in self.atlas.face(bold=bold).glyphs})
        if missing:
            self.faults.append(Fault(text, f"no glyphs for {missing}"))
        return length

    def wrap(self, text: str, size: float, width: float, lines: int, *, bold: bool = False) -> list[str]:
        self._look_up(text)
        out = super().wrap(text, size, width, lines, bold=bold)
        if " ".join(out).split() != text.split():
            self.faults.append(Fault(text, f"cut to {len(out)} lines"))
        return out

    def _look_up(self, text: str) -> None:
        if translated(text) != text and text not in catalogue(spoken()).values():
            self.faults.append(Fault(text, "not translated"))

    def _check(self, text: str, left: float, right: float, bottom: float, top: float) -> None:
        middle = 0.5 * (left + right), 0.5 * (bottom + top)
        around = [box for box in self._boxes if _holds(box, middle)] or [(0.0, 0.0, self.width, self.height)]
        begin, _, width, _ = around[-1]
        if left < begin - _ROUNDING or right > begin + width + _ROUNDING:
            self.faults.append(Fault(text, "outside its box"))


def page_canvas(size: tuple[int, int]) -> WatchedHud:
    """Return the canvas of a page in a window of a size [px], as `PageSurface.fit` sets it."""
    hud = WatchedHud()
    scale = CANVAS_HEIGHT / min(size)
    hud.width, hud.height = scale * size[0], scale * size[1]
    return hud


def _holds(box: tuple[float, float, float, float], place: tuple[float, float]) -> bool:
    x, y, width, height = box
    return x <= place[0] <= x + width and y <= place[1] <= y + height
