"""Countdown before the first trial of a session in a window, after the page of what is to be done."""

from __future__ import annotations

import math

from mimics_app.contracts.messages.trial_state import TrialState

__all__ = ["Countdown"]

_READING_S = 6.0
"""Time for which the page is shown where nobody begins, as a simulated person [s]."""


class Countdown:
    """Timer of the ready state until the first travel; without effect in other states.

    Args:
        seconds: Length of the countdown [s]; 0: neither reading time nor countdown.
        introduced: The page is shown in a window.
        waits: The page stays until a command ends it.

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
        self._begin = False

    def begin(self) -> None:
        """End the reading with the next frame."""
        self._begin = True

    def see(self, state: TrialState, elapsed_s: float) -> None:
        """Take a frame, `elapsed_s` [s] after the beginning of its state."""
        begin, self._begin = self._begin, False
        self.until_s, self.reading, self.count = 0.0, False, 0
        if state is TrialState.TRAVEL:
            self._seconds = 0.0
        if state is not TrialState.READY or self._seconds == 0.0:
            return
        if elapsed_s < self._read_s and begin:
            self._read_s = elapsed_s
        self.until_s = self._read_s + self._seconds
        self.reading = elapsed_s < self._read_s
        if not self.reading:
            self.count = max(0, math.ceil(self.until_s - elapsed_s))
