"""In how many passes eyes are drawn over one queue, and what their shaders are given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["AT_ONCE", "EyePass", "EyePasses", "passes_of"]

EyePasses = Literal["alone", "viewports", "viewports_in_turn", "halves", "halves_in_turn"]
"""How eyes are drawn over one queue: each by programs that know one eye; or by programs that know both, into two
viewports or the halves of one, both at once or one after the other. In turn no pixel differs from both at once: another
program may round the same formula otherwise, and a half rounds other places than a viewport."""


@dataclass(frozen=True, slots=True)
class EyePass:
    """What shaders that ask which eye they draw for are given, and how often each instance is drawn.

    Attributes:
        defines: Names besides their own.
        instances: Of what stands once.
        eye: The one that is drawn alone; -1: both.
    """

    defines: tuple[str, ...] = ()
    instances: int = 1
    eye: int = -1


_GIVEN: dict[EyePasses, tuple[str, ...]] = {
    "alone": (),
    "viewports": ("EYES_BY_VIEWPORT",),
    "viewports_in_turn": ("EYES_BY_VIEWPORT",),
    "halves": ("EYES_BY_CLIPPING",),
    "halves_in_turn": ("EYES_BY_CLIPPING",),
}
AT_ONCE: tuple[EyePasses, ...] = ("viewports", "halves")
"""Those in which every second instance is the other eye's."""
_IN_TURN: tuple[EyePasses, ...] = ("viewports_in_turn", "halves_in_turn")


def passes_of(eyes: EyePasses) -> tuple[EyePass, ...]:
    """The passes in which eyes are drawn over one queue."""
    given = _GIVEN[eyes]
    if eyes in _IN_TURN:
        return tuple(EyePass(given, eye=eye) for eye in (0, 1))
    return (EyePass(given, 2 if eyes in AT_ONCE else 1),)
