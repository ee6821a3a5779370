"""Obstacles on a walk in a gait orthosis: where they stand, their call, and the foot that touches them.

An obstacle is called when the person is near; while the belt comes to rest the person is led to where the felt and the
drawn obstacle are one. When the walk resumes, the way is open.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.tasks.observation import Observation
from mimics_app.world.components.bounds import Extent
from mimics_app.world.components.registry import Component

__all__ = ["MATERIALS", "StreetObstacle", "StreetObstacles", "Tap"]

MATERIALS = {"kerb": "stone", "box": "wood", "low_wall": "stone", "door": "wood"}
"""What each kind of obstacle sounds of."""
_REACH = 0.34
"""Distance of the person from the face of an obstacle that is explored [m]: the ball of the foot reaches it."""
_BELT_WAY = 0.75
"""Way that the belt still makes after a call [m]."""
_FACE, _LEAVES = 0.26, 0.02
"""Where the face is in the frame of the orthosis [m], and how far a foot goes back from it before the next touch."""
_NEAR = 4e-3
"""Distance at which a foot touches [m]."""
_LED = 2.5
"""Rate at which a person whose belt comes to rest is led to their place [1/s]."""
_OPENS_S = 1.0
"""Time in which the way opens [s]."""


class StreetObstacle(Component, frozen=True):
    """An obstacle on the way."""

    entity: Annotated[str, Meta(description="Entity that is placed there; its front is that of the obstacle.")]
    kind: Annotated[Literal["kerb", "box", "low_wall", "door"], Meta(description="What it is.")]
    at: Annotated[Extent, Meta(description="Distance of its front along the walk [m].")]
    foot: Annotated[Literal["left", "right"], Meta(description="Foot that explores it.")] = "left"


@dataclass(frozen=True, slots=True)
class Tap:
    """A foot that touched an obstacle.

    Attributes:
        obstacle: The obstacle.
        strength: 0 to 1.
    """

    obstacle: StreetObstacle
    strength: float


class StreetObstacles:
    """The obstacles of one walk, one after the other.

    Args:
        obstacles: In any order.

    Attributes:
        led: How much farther the person is than the legs have walked [m].
    """

    def __init__(self, obstacles: Sequence[StreetObstacle]) -> None:
        self._obstacles = obstacles
        self._order = sorted(range(len(obstacles)), key=lambda number: obstacles[number].at)
        self._number = 0
        self._open = [0.0] * len(obstacles)
        self._called = self._touches = False
        self.led = 0.0

    @property
    def ahead(self) -> StreetObstacle | None:
        """The next obstacle whose way is not open; None behind the last."""
        return self._obstacles[self._order[self._number]] if self._number < len(self._order) else None

    @property
    def opened(self) -> tuple[float, ...]:
        """How far each is open, 0 to 1, in the order in which they were given."""
        return tuple(round(share, 3) for share in self._open)

    def call(self, along: float, seen: Observation) -> str:
        """Return the obstacle to begin at a place [m], "" for none."""
        ahead = self.ahead
        if ahead is None or seen.snapshot.gait_state != GaitState.WALKING or along < ahead.at - _REACH - _BELT_WAY:
            return ""
        self._called = True
        return f"{ahead.kind} {ahead.foot}"

    def step(self, along: float, seen: Observation, seconds: float) -> Tap | None:
        """Advance by a time [s]; return a touch of the free foot."""
        self._open_passed(seconds)
        ahead, state = self.ahead, seen.snapshot.gait_state
        if ahead is None or not self._called or state < GaitState.STOPPING or state == GaitState.STANDING:
            return None
        if state == GaitState.RESUMING:
            self._number, self._called = self._number + 1, False
            return None
        self.led += min(_LED * seconds, 1.0) * (ahead.at - _REACH - along)
        if not GaitState.LEG_RELEASED <= state <= GaitState.EXPLORING:
            self._touches = False
            return None
        foot = seen.points[0 if ahead.foot == "left" else 1]
        behind = _FACE - foot.hip_world[0]
        begins = not self._touches and behind < _NEAR
        self._touches = behind < (_LEAVES if self._touches else _NEAR)
        return Tap(ahead, min(0.3 + 2.0 * foot.speed, 1.0)) if begins else None

    def _open_passed(self, seconds: float) -> None:
        for number in self._order[: self._number]:
            self._open[number] = min(self._open[number] + seconds / _OPENS_S, 1.0)
