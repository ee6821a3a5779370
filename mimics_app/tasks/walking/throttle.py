"""What leads a walk without an orthosis: the hand as a throttle, a tracked person's steps in a room, and the head.

The hand: up is faster, aside turns or leans, closing it is a kick.
"""

from __future__ import annotations

from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.deflection import deflection
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.head_steering import head_aside
from mimics_app.tasks.walking.room_steps import RoomSteps

__all__ = ["WALK_IN_ROOM", "Throttle"]

WALK_IN_ROOM = phrase("Walk about the room: you come ahead while you walk where you look")
"""Message for a tracked person who stands."""

_KICKS = 4.0
"""Grasp force from which a closing hand counts as a kick [N]."""
_KEYS = ("k", "pad_x")
"""Keys and buttons that kick."""


class Throttle:
    """Reads the person frame by frame.

    Args:
        full: Full deflection of the hand from where the trial began [m].
        fastest: Largest speed [m/s].
        room_gain: Way per metre that a tracked person walks in the room; None: the hand gives the speed.
        by_head: Whether the person turns where the head looks.

    Attributes:
        speed: Wanted speed [m/s].
        aside: To the right, -1 to 1.
        kicks: True in the frame in which the hand closes, or a key for it goes down.
    """

    def __init__(self, full: float, fastest: float, *, room_gain: float | None = None, by_head: bool = False) -> None:
        self._full, self._fastest, self._by_head = full, fastest, by_head
        self._room = None if room_gain is None else RoomSteps(room_gain)
        self._from = (0.0, 0.0)
        self._closed = False
        self.speed = self.aside = 0.0
        self.kicks = False

    def start(self, seen: Observation) -> None:
        """Take the person's place at the begin of the travel."""
        self._from = seen.hip_world[0], seen.hip_world[1]
        self._closed = seen.grasp > _KICKS
        if self._room is not None:
            self._room.start()

    def read(self, seen: Observation, seconds: float) -> None:
        """Take a frame, after a time step [s]."""
        if self._room is None:
            up = deflection(seen.hip_world[1] - self._from[1], self._full)
            self.speed = self._fastest * max(up, 0.0)
            self.aside = deflection(seen.hip_world[0] - self._from[0], self._full)
        else:
            self._room.read(seen.head, seconds)
            self.speed, self.aside = min(self._room.speed, self._fastest), self._room.aside
        if self._by_head:
            self.aside = head_aside(seen.head)
        closed = seen.grasp > _KICKS
        self.kicks = (closed and not self._closed) or any(key in seen.pressed for key in _KEYS)
        self._closed = closed
