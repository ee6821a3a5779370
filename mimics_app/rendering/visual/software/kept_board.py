"""The heads-up display over a kept picture: only what changed of both is drawn again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, U1
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.figures.hud import HUD_ROW, Hud
from mimics_app.rendering.visual.passes.hud import HudPass, clip_from_hud, places_of, plane_of_views
from mimics_app.rendering.visual.software.screen_places import mark_cells_of, pieces_of
from mimics_app.rendering.visual.stages.board_copy import BoardCopy
from mimics_app.rendering.visual.surfaces.raw_gl import RawGL
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import Rect, View

if TYPE_CHECKING:
    import moderngl

__all__ = ["KeptBoard"]


@dataclass(frozen=True, eq=False)
class _Drawn:
    """What a display drew.

    Attributes:
        hud: The display.
        revision: Its revision.
        images: Its images.
        clip: Its projection.
        place: Rectangle of the view [px].
        rows: Its rectangles, HUD_ROW [n].
        bounds: Where they are, as shares of the view: left, right, bottom, top; [n, 4].
    """

    hud: Hud
    revision: int
    images: U1 | None
    clip: F8
    place: Rect
    rows: NDArray[np.void]
    bounds: F8

    @cached_property
    def cells(self) -> U1:
        """1 for each cell of the view that it overlaps."""
        return mark_cells_of(self.bounds, self.place[2:])

    def differing(self, other: _Drawn) -> U1:
        """Return 1 for each cell with a rectangle that only one of two contents has, or has in another order."""
        if other is self:
            return np.zeros_like(self.cells)
        mine, others = (each.rows.view(f"V{HUD_ROW.itemsize}").tolist() for each in (self, other))
        both = set(mine) & set(others)
        if [row for row in mine if row in both] != [row for row in others if row in both]:
            both = set()
        places = (each.bounds[[row not in both for row in rows]] for each, rows in ((self, mine), (other, others)))
        return mark_cells_of(np.concatenate([*places]), self.place[2:])

    def has_place_of(self, hud: Hud, clip: F8, place: Rect) -> bool:
        """Whether a display, its projection and its view draw equal rows as here."""
        alike = self.hud is hud and self.images is hud.images and self.place == place
        return alike and np.array_equal(self.clip, clip)


class KeptBoard(BoardCopy):
    """Remembers what the display drew, and where."""

    def __init__(self, surface: Surface, hud_pass: HudPass) -> None:
        self._surface, self._gl, self._hud_pass = surface, RawGL(surface.ctx), hud_pass
        self._drawn: _Drawn | None = None

    def draw(
        self,
        finished: moderngl.Framebuffer | None,
        parts: Sequence[ChangedPart] | None,
        hud: Hud,
        view: View,
        depth: float,
        enlarged: float,
    ) -> int | None:
        if finished is None or parts is None or hud.empty or view.screen < 0:
            self._surface.drawn_by = self._drawn = None
            return None
        plane = plane_of_views([view], depth, enlarged)
        before, clip, place = self._drawn, clip_from_hud(view, plane), view.rectangle
        kept = before is not None and self._surface.drawn_by is self and before.has_place_of(hud, clip, place)
        if before is None or not kept or before.revision != hud.revision:
            rows = hud.rows()
            self._drawn = _Drawn(hud, hud.revision, hud.images, clip, place, rows, places_of(rows, plane))
            self._surface.drawn_by = self
        if before is None or not kept or self._drawn is None:
            return None
        pieces = [piece for part in parts for piece in part.pieces]
        marked = before.differing(self._drawn) | (self._drawn.cells & _cells_of(pieces, place))
        renewed = pieces_of(marked, place[2:])
        renewed = [(place[0] + x, place[1] + y, width, height) for x, y, width, height in renewed]
        if pieces or renewed:
            self._gl.copy_colours(finished, self._surface.framebuffer, [*pieces, *renewed])
        self._surface.note_changed([*pieces, *renewed])
        self._surface.framebuffer.use()
        return self._hud_pass.draw(hud, view, plane, renewed) if renewed else 0


def _cells_of(pieces: Sequence[Rect], place: Rect) -> U1:
    """Return 1 for each cell of a view that pieces of the picture overlap."""
    corner, size = np.array(pieces, np.float64).reshape(-1, 2, 2).transpose(1, 0, 2)
    low, high = corner - place[:2], corner + size - place[:2]
    return mark_cells_of(np.stack([low, high], axis=2).reshape(-1, 4) / np.repeat(place[2:], 2), place[2:])
