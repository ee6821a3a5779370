"""Before the first trial of a session in a window: time to read the page of keys, then a count down to the go."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mimics_app.contracts.trial_state import TrialState

__all__ = ["Countdown"]

_READING_S = 6.0
"""How long the page of keys is read unless somebody begins sooner [s]: ten short lines."""

_BEGIN = frozenset({"enter", "h", "mouse_left", "pad_a"})
"""Keys and buttons that end the reading."""


class Countdown:
    """Times the ready state until somebody was let go for the first time; of every other state it asks nothing.

    Args:
        seconds: To count [s]; 0: there is neither reading nor a count.
        introduced: Somebody at a window is shown the page of keys.

    Attributes:
        until_s: Earliest time of the go in the present state [s]; 0 where nothing is counted.
        reading: The page of keys is read; the count comes after it.
        count: Seconds still to go, rounded up; 0 before and after the count.
    """

    def __init__(self, seconds: float, *, introduced: bool) -> None:
        self._seconds = seconds if introduced else 0.0
        self._read_s = _READING_S
        self.until_s = 0.0
        self.reading = False
        self.count = 0

    def see(self, state: TrialState, elapsed_s: float, pressed: Sequence[str]) -> None:
        """One frame, `elapsed_s` [s] after its state began."""
        self.until_s, self.reading, self.count = 0.0, False, 0
        if state is TrialState.TRAVEL:
            self._seconds = 0.0
        if state is not TrialState.READY or self._seconds == 0.0:
            return
        if elapsed_s < self._read_s and not _BEGIN.isdisjoint(pressed):
            self._read_s = elapsed_s
        self.until_s = self._read_s + self._seconds
        self.reading = elapsed_s < self._read_s
        if not self.reading:
            self.count = max(0, math.ceil(self.until_s - elapsed_s))
