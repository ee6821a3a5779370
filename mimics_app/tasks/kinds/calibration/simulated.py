"""A simulated person in a calibration: where the hand goes for what the person is shown, by their abilities."""

from __future__ import annotations

from typing import NamedTuple

from mimics_app.contracts.messages.abilities import Abilities
from mimics_app.contracts.messages.calibration_record import DIRECTIONS
from mimics_app.tasks.kinds.calibration.step import Cue

__all__ = ["Wish", "wish_of"]

_ANSWERS = 2.0
"""How far the hand goes for an answer, as a multiple of what counts as one."""


class Wish(NamedTuple):
    """What a simulated person wants in a frame.

    Attributes:
        x, y, z: From where the hand rests to where it is to go [m].
        squeezes: Whether the hand closes with all strength.
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    squeezes: bool = False


def wish_of(cue: Cue, able: Abilities, answer: float) -> Wish:
    """Return what a person wants for a cue.

    Args:
        cue: What they are shown and told.
        able: What they are able to do; the range of motion itself is the arm's.
        answer: Movement that counts as an answer [m].
    """
    if cue.tone is not None:
        softest = able.hearing_left if cue.tone.side == "left" else able.hearing_right
        return _towards(cue.tone.side, _ANSWERS * answer) if cue.tone.level >= softest else Wish()
    if cue.letter is not None:
        return _towards(cue.letter.direction, _ANSWERS * answer) if cue.letter.height >= able.letter else Wish()
    x, y, z = cue.light or (0.0, 0.0, 0.0)
    if cue.comfortable and cue.direction and able.range_of_motion:
        limits = dict(zip(DIRECTIONS, able.range_of_motion, strict=True))
        far = max(abs(x), abs(y), abs(z))
        return _towards(cue.direction, min(far, able.ease * limits[cue.direction]))
    return Wish(x, y, z, cue.squeeze)


def _towards(direction: str, way: float) -> Wish:
    x, y, z = (way * part for part in DIRECTIONS[direction])
    return Wish(x, y, z)
