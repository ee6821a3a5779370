"""Counts of the culling of a frame."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Tally"]


@dataclass(slots=True)
class Tally:
    """Counts of a frame, over all views: items, those outside, those occluded, frustum tests, skinned vertices."""

    items: int = 0
    culled: int = 0
    hidden: int = 0
    tests: int = 0
    bent: int = 0

    @property
    def figures(self) -> tuple[int, int, int, int, int]:
        """All counts, in this order: `astuple` would copy each, in thirty calls a frame."""
        return self.items, self.culled, self.hidden, self.tests, self.bent

    def count(self, items: int, in_frustum: int, drawn: int, tests: int) -> None:
        """Add the counts of one view."""
        self.tests += tests
        self.items += items
        self.culled += items - in_frustum
        self.hidden += in_frustum - drawn
