"""Obstacles on a walk: where they stand, and the foot that touches them.

In a gait orthosis an obstacle is called when the person is near; while the belt comes to rest the person is led to
where the felt and the drawn obstacle are one. When the walk resumes, the way is open. By hand the person stands before
it, and the way opens once the foot has touched it often enough, or after the time of an exploration.
"""

from __future__ import annotations

import math
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
_ENOUGH, _EXPLORATION_S = 3, 8.0
"""Touches by hand, and time before an obstacle [s], after which the way opens."""
_TAP_S, _MEETS, _FORWARD = 0.6, 0.5, 0.2
"""Duration of a touch by hand [s], the share of it after which the foot meets the face, and how far it swings [m]."""
_AT_HAND = 0.03
"""Way left to an obstacle at which somebody stands before it by hand [m]."""
_BY_HAND = 0.7
"""Strength of a touch by hand."""


class StreetObstacle(Component, frozen=True):
    """An obstacle on the way."""

    entity: Annotated[str, Meta(description="Entity that is placed there; its front is that of the obstacle.")]
    kind: Annotated[Literal["kerb", "box", "low_wall", "door"], Meta(description="What it is.")]
    at: Annotated[Extent, Meta(description="Distance of its front along the walk [m].")]
    foot: Annotated[Literal["left", "right"], Meta(description="Foot that explores it.")] = "left"
    frame: Annotated[str | None, Meta(description="Entity that is placed there, too, and stays: a doorway.")] = None


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
        rate: Share of them that is in the way, 0 to 1, evenly along it; the others are open from the beginning.

    Attributes:
        led: How much farther the person is than the legs have walked [m].
        tap: Share of a touch by hand that is over, 0 to 1; -1: none.
        explored: Number of obstacles that a foot has touched.
    """

    def __init__(self, obstacles: Sequence[StreetObstacle], rate: float = 1.0) -> None:
        self._obstacles = obstacles
        in_order = sorted(range(len(obstacles)), key=lambda number: obstacles[number].at)
        self._order = [k for i, k in enumerate(in_order, 1) if int(i * rate) > int((i - 1) * rate)]
        self._number = 0
        self._open = [float(k not in self._order) for k in range(len(obstacles))]
        self._called = self._touches = False
        self._taps, self._stood_s = 0, 0.0
        self.led, self.tap = 0.0, -1.0
        self.explored, self._newest = 0, -1

    @property
    def ahead(self) -> StreetObstacle | None:
        """The next obstacle whose way is not open; None behind the last."""
        return self._obstacles[self._order[self._number]] if self._number < len(self._order) else None

    def within(self, metres: float) -> int:
        """Return how many are in the way over a distance from the begin [m]."""
        return sum(self._obstacles[k].at < metres for k in self._order)

    @property
    def opened(self) -> tuple[float, ...]:
        """How far each is open, 0 to 1, in the order in which they were given."""
        return tuple(round(share, 3) for share in self._open)

    @property
    def swing(self) -> tuple[float, float]:
        """Share of a touch by hand that is over, below 0 for none, and how far the ankle is ahead of the hip [m]."""
        return round(self.tap, 4), round(_FORWARD * math.sin(math.pi * max(self.tap, 0.0)), 4)

    def touches_left(self, along: float) -> int:
        """Return how many touches by hand open the way at a place [m]; 0 where nothing is in the way, or it opens."""
        return _ENOUGH - self._taps if self.room(along) <= _AT_HAND else 0

    def stops(self, along: float) -> bool:
        """Whether somebody who walks by hand stands at a place [m]: before an obstacle, or while its way opens."""
        opens = self._number > 0 and self._open[self._order[self._number - 1]] < 1.0
        return opens or self.room(along) <= _AT_HAND

    def room(self, along: float) -> float:
        """Return how far somebody may walk by hand from a place [m]."""
        return math.inf if self.ahead is None else max(self.ahead.at - _REACH - along, 0.0)

    def meet(self, along: float, kicks: bool, seconds: float) -> Tap | None:
        """Advance by a time [s] by hand, with a touch that begins or not; return a touch of the foot."""
        self._open_passed(seconds)
        ahead = self.ahead
        if ahead is None or self.room(along) > _AT_HAND:
            return None
        self._stood_s += seconds
        if kicks and self.tap < 0.0:
            self.tap = 0.0
        before = self.tap
        if before >= 0.0:
            self.tap = before + seconds / _TAP_S if before < 1.0 else -1.0
        meets = 0.0 <= before < _MEETS <= self.tap
        self._taps += int(meets)
        if self.tap < 0.0 and (self._taps >= _ENOUGH or self._stood_s > _EXPLORATION_S):
            self._number, self._taps, self._stood_s = self._number + 1, 0, 0.0
        return self._tap(ahead, _BY_HAND) if meets else None

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
        return self._tap(ahead, min(0.3 + 2.0 * foot.speed, 1.0)) if begins else None

    def _tap(self, obstacle: StreetObstacle, strength: float) -> Tap:
        """Count the obstacle ahead with its first touch."""
        self.explored += int(self._newest != self._number)
        self._newest = self._number
        return Tap(obstacle, strength)

    def _open_passed(self, seconds: float) -> None:
        for number in self._order[: self._number]:
            self._open[number] = min(self._open[number] + seconds / _OPENS_S, 1.0)
