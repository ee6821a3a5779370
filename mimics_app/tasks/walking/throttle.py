"""The hand as the throttle of a walk: up is faster, aside turns or leans, closing it is a kick."""

from __future__ import annotations

from mimics_app.tasks.deflection import deflection
from mimics_app.tasks.observation import Observation

__all__ = ["Throttle"]

_KICKS = 4.0
"""Grasp force from which a closing hand counts as a kick [N]."""
_KEYS = ("k", "pad_x")
"""Keys and buttons that kick."""


class Throttle:
    """Deflection of the hand from where the trial began.

    Args:
        full: Full deflection [m].

    Attributes:
        ahead: Share of the largest speed, 0 to 1.
        aside: To the right, -1 to 1.
        kicks: True in the frame in which the hand closes, or a key for it goes down.
    """

    def __init__(self, full: float) -> None:
        self._full = full
        self._from = (0.0, 0.0)
        self._closed = False
        self.ahead = self.aside = 0.0
        self.kicks = False

    def start(self, seen: Observation) -> None:
        """Take the hand's place at the begin of the travel."""
        self._from = seen.hip_world[0], seen.hip_world[1]
        self._closed = seen.grasp > _KICKS

    def read(self, seen: Observation) -> None:
        """Take a frame."""
        self.ahead = max(deflection(seen.hip_world[1] - self._from[1], self._full), 0.0)
        self.aside = deflection(seen.hip_world[0] - self._from[0], self._full)
        closed = seen.grasp > _KICKS
        self.kicks = (closed and not self._closed) or any(key in seen.pressed for key in _KEYS)
        self._closed = closed
