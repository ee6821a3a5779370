"""Mouth of a person who speaks: it opens as far as the voice is loud."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.motion.pose import Pose

__all__ = ["LEVELS_PER_S", "Mouth"]

LEVELS_PER_S = 50
"""Rate of the levels of a voice [Hz]: a syllable lasts a fifth of a second."""
_WIDEST = 0.6
"""Weight of the jaw at the loudest syllable: people open the mouth no farther when they speak."""


class Mouth:
    """A step of an animator.

    Args:
        slots: Morph weights that open the jaw.
    """

    def __init__(self, slots: list[int]) -> None:
        self._slots = np.array(slots, np.intp)
        self._levels: F8 = np.zeros(0)
        self._since = 0.0

    def say(self, levels: F8) -> None:
        """Begin to speak; what was said before breaks off.

        Args:
            levels: Loudness of the voice, 0 to 1, LEVELS_PER_S times a second, [n].
        """
        self._levels, self._since = levels, 0.0

    def __call__(self, pose: Pose, seconds: float) -> None:
        place = self._since * LEVELS_PER_S
        if place < len(self._levels):
            level = _WIDEST * float(np.interp(place, np.arange(len(self._levels)), self._levels))
            pose.morphs[self._slots] = np.maximum(pose.morphs[self._slots], level)
            self._since += seconds
