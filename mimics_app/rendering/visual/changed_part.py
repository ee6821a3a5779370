"""A part of a picture that is drawn again."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.rendering.visual.view import Rect

__all__ = ["ChangedPart"]


@dataclass(frozen=True, slots=True)
class ChangedPart:
    """A part of a picture that is drawn again.

    Attributes:
        rectangle: The smallest rectangle around it [px].
        pieces: Disjoint rectangles in it that hold all changed pixels [px].
    """

    rectangle: Rect
    pieces: list[Rect]

    def moved(self, x: int, y: int) -> ChangedPart:
        """Return the part that lies elsewhere by a number of pixels."""
        every = (self.rectangle, *self.pieces)
        first, *pieces = ((left + x, bottom + y, width, height) for left, bottom, width, height in every)
        return ChangedPart(first, pieces)
