"""Countdown before the first trial of a session in a window, after the page of what is to be done."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mimics_app.contracts.messages.trial_state import TrialState

__all__ = ["Countdown"]

_READING_S = 6.0
"""Time for which the page is shown where nobody presses a key, as a simulated person [s]."""

_BEGIN = frozenset({"enter", "mouse_left", "pad_a"})
"""Keys and buttons that end the reading."""


class Countdown:
    """Timer of the ready state until the first travel; without effect in other states.

    Args:
        seconds: Length of the countdown [s]; 0: neither reading time nor countdown.
        introduced: The page is shown in a window.
        waits: The page stays until a key ends it.

    Attributes:
        until_s: Earliest time of the go cue in the present state [s]; 0 without a countdown.
        reading: The page is shown; the countdown follows.
        count: Seconds left, rounded up; 0 before and after the countdown.
    """

    def __init__(self, seconds: float, *, introduced: bool, waits: bool = False) -> None:
        self._seconds = seconds if introduced else 0.0
        self._read_s = math.inf if waits else _READING_S
        self.until_s = 0.0
        self.reading = False
        self.count = 0

    def see(self, state: TrialState, elapsed_s: float, pressed: Sequence[str]) -> None:
        """Take a frame, `elapsed_s` [s] after the beginning of its state."""
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
