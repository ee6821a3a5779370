"""What a simulated person is able to do, which a calibration should find."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Abilities"]


class Abilities(NamedTuple):
    """Abilities of one person.

    Attributes:
        range_of_motion: How far the hand gets from where it rests: to the right, left, up, down, forwards and back [m];
            (): as far as the device.
        ease: Share of that range within which a movement is comfortable.
        strength: Largest grasp force [N].
        hearing_left, hearing_right: Softest audible level at a side [dB, 0 as authored].
        letter: Height of the smallest letter that is read [px of a picture 720 px high].
    """

    range_of_motion: tuple[float, ...]
    ease: float
    strength: float
    hearing_left: float
    hearing_right: float
    letter: float
