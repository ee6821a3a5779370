"""Passes in which the eyes of one queue are drawn, and the defines of their shaders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["AT_ONCE", "EyePass", "EyePasses", "passes_of"]

EyePasses = Literal["alone", "viewports", "viewports_in_turn", "halves", "halves_in_turn"]
"""Passes of the eyes of one queue: each with programs for one eye; or with stereo programs into two viewports or the
halves of one, in one pass or in turn. In turn gives the same pixels as in one pass: another program may round
differently, and so may a half and a viewport of its own."""


@dataclass(frozen=True, slots=True)
class EyePass:
    """One pass over a queue.

    Attributes:
        defines: Additional defines of the shaders.
        instances: Instances per object.
        eye: Number of the only eye drawn; -1: all.
    """

    defines: tuple[str, ...] = ()
    instances: int = 1
    eye: int = -1


_DEFINES: dict[EyePasses, tuple[str, ...]] = {
    "alone": (),
    "viewports": ("EYES_BY_VIEWPORT",),
    "viewports_in_turn": ("EYES_BY_VIEWPORT",),
    "halves": ("EYES_BY_CLIPPING",),
    "halves_in_turn": ("EYES_BY_CLIPPING",),
}
AT_ONCE: tuple[EyePasses, ...] = ("viewports", "halves")
"""Kinds in which every second instance is for the other eye."""
_IN_TURN: tuple[EyePasses, ...] = ("viewports_in_turn", "halves_in_turn")


def passes_of(eyes: EyePasses) -> tuple[EyePass, ...]:
    """Return the passes in which the eyes of one queue are drawn."""
    defines = _DEFINES[eyes]
    if eyes in _IN_TURN:
        return tuple(EyePass(defines, eye=eye) for eye in (0, 1))
    return (EyePass(defines, 2 if eyes in AT_ONCE else 1),)
