"""Steps of a tracked person in a room: how fast the head goes where it looks, and how far it is moved aside.

A room is smaller than a walk. Each metre in it is several metres of the way (`gain`), and whoever comes to a wall
turns round and walks on: only the speed in the direction of the eyes counts, and steps backwards count as none.
"""

from __future__ import annotations

import math
from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.messages.head_place import HeadPlace

__all__ = ["RoomGain", "RoomSteps"]

RoomGain = Annotated[
    Annotated[float, Meta(ge=0.5, le=20.0)] | None,
    Meta(description="Way per metre that a tracked person walks in the room, who needs no hand; null: the hand leads."),
]
"""Setting of a walk."""

_SMOOTH_S = 0.3
"""Time constant of the speed [s]: less than a step, more than the noise of a tracker."""
_STILL = 0.12
"""Speed of the head that counts as standing [m/s]: beyond that of one who sways in place."""
_JUMP = 0.4
"""Way of the head from one frame to the next beyond which a tracker has found it anew, and nobody has walked [m]."""
_BESIDE, _FULL = 0.05, 0.25
"""Displacements of the head aside up to which it counts as in the middle, and from which it is fully aside [m]."""


class RoomSteps:
    """Watches the head.

    Args:
        gain: Way per metre in the room.

    Attributes:
        speed: Of the walk [m/s].
        aside: To the right of where the trial began, -1 to 1.
    """

    def __init__(self, gain: float) -> None:
        self._gain = gain
        self._before: HeadPlace | None = None
        self._middle: float | None = None
        self._pace = self.speed = self.aside = 0.0

    def start(self) -> None:
        """Take the next place as the one where the trial begins."""
        self._before = self._middle = None
        self._pace = self.speed = self.aside = 0.0

    def read(self, head: HeadPlace | None, seconds: float) -> None:
        """Take the head after a time step [s]; one that is not tracked stands."""
        before, self._before = self._before, head
        ahead = 0.0
        if head is not None:
            if before is not None and seconds > 0.0:
                x, z = head.x - before.x, head.z - before.z
                if math.hypot(x, z) < _JUMP:
                    ahead = (-x * math.sin(head.yaw) - z * math.cos(head.yaw)) / seconds
            self._middle = head.x if self._middle is None else self._middle
            moved = head.x - self._middle
            beyond = min(max(abs(moved) - _BESIDE, 0.0) / (_FULL - _BESIDE), 1.0)
            self.aside = math.copysign(beyond, moved)
        self._pace += min(seconds / _SMOOTH_S, 1.0) * (ahead - self._pace)
        self.speed = self._gain * self._pace if self._pace > _STILL else 0.0
