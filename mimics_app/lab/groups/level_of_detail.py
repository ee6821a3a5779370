"""Levels of detail in the city.

Error: share of the pixels that differ from the picture with the finest levels.
"""

from __future__ import annotations

from dataclasses import replace

from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.lab.visual.city import PLAIN, city_error, city_us

__all__: list[str] = []


_FINEST = 4.0
_FINE = replace(PLAIN, detail=_FINEST)
_COVERED = "coarser forms by how much of the picture they cover"


def _forms(name: str, source: str, detail: float) -> Rival:
    return Rival(name, source, "any", {"detail": detail}, (replace(_FINE, detail=detail), _FINE))


compare(
    __name__,
    "a frame of the city from three places; error: share of pixels that differ from the finest forms",
    "share of pixels",
    [
        _forms("4 times as far", "coarser forms only from four times their distance", _FINEST),
        _forms("2 times as far", _COVERED, 2.0),
        _forms("as authored", _COVERED, 1.0),
        _forms("0.5 times as far", _COVERED, 0.5),
        _forms("0.25 times as far", _COVERED, 0.25),
    ],
    Probes(lambda settings, _: city_us(settings), city_error),
    default="as authored",
)
