"""Words of encouragement on the way: at the half of a walk, and shortly before its end."""

from __future__ import annotations

from mimics_app.contracts.system.phrases import phrase

__all__ = ["Encouragement"]

_SAID_S = 4.0
"""How long something is said [s]."""
_AT = (
    (0.9, phrase("Nearly there: a few more steps")),
    (0.5, phrase("Half the way is done: well walked")),
)
"""Shares of the way with what is said there, the farthest first."""


class Encouragement:
    """Follows one walk.

    Attributes:
        words: What is said now; "" for nothing.
    """

    def __init__(self) -> None:
        self._newest, self._since, self._farthest = "", 0.0, 0.0
        self.words = ""

    def follow(self, progress: float, seconds: float) -> None:
        """Take the share of the way that is done, 0 to 1, after a time step [s]; who falls back hears nothing twice."""
        self._farthest = max(self._farthest, progress)
        due = next((words for share, words in _AT if self._farthest >= share), "")
        self._since = 0.0 if due != self._newest else self._since + seconds
        self._newest = due
        self.words = due if self._since < _SAID_S else ""
