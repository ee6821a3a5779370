"""The border between the frame governor and the stages whose quality it may trade for time."""

from __future__ import annotations

from typing import Protocol

__all__ = ["QualityStep"]


class QualityStep(Protocol):
    """One thing a stage can do in several qualities, each cheaper than the last."""

    @property
    def name(self) -> str:
        """As people read it, e.g. "resolution scale"."""
        ...

    @property
    def order(self) -> int:
        """Steps of a lower order are given up first, and taken back last."""
        ...

    @property
    def levels(self) -> tuple[str, ...]:
        """Names of its qualities, the full one first; at least two."""
        ...

    def apply(self, level: int) -> None:
        """Go over to `levels[level]` from the next frame on."""
        ...
