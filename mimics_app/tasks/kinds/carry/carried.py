"""State of the carried object, frame by frame, and the place it falls from."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from enum import StrEnum

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.orders import HapticField, Numbers
from mimics_app.tasks.kinds.carry.spec import BoxSpec, CarrySpec
from mimics_app.tasks.observation import Observation

__all__ = ["Carried", "CarriedFrame", "Stage"]

_LOST_S = 2.0
"""Time out of reach after which the object falls again [s]."""
_NEAR = 0.02
"""Distance from the object's centre at which the hand may close [m]."""
_FROM_OUTSIDE = 0.1
"""Distance from the object's centre at which any hand has surely reached it [m]."""
_SHARE_OF_REACH = 0.3
"""Progress when the object is in the hand."""
_FIRST_SPAWN = 2
"""First spawn number after that of the scene's own placement, 1."""


class Stage(StrEnum):
    """Next step of the person."""

    REACH = "reach"
    CLOSE = "close"
    CARRY = "carry"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class CarriedFrame:
    """State of the carried object in one frame.

    Attributes:
        placed: It lies at its mark, released.
        drops: Number of times it was lost while carried, in this attempt.
        bruises: Number of times it was pressed too hard, in this attempt.
        bruised: It was pressed too hard since the last frame.
        gripped: It was gripped since the last frame.
        dropped: It was lost since the last frame.
        held: It is in the hand.
        grasp_error: Deviation of the grasp force from the right range, while it is held [N].
        progress: Share of the path, 0-1.
        distance: Horizontal distance from the straight path [m]; None while it is not held.
        stage: Next step of the person.
    """

    placed: bool = False
    drops: int = 0
    bruises: int = 0
    bruised: bool = False
    gripped: bool = False
    dropped: bool = False
    held: bool = False
    grasp_error: float = 0.0
    progress: float = 0.0
    distance: float | None = None
    stage: Stage = Stage.REACH


class Carried:
    """The carried object through the attempts of a session.

    Args:
        spec: Section of the task.
        target: Position of the mark [m].
        seed: Seed of the session; determines the places it falls from.

    Attributes:
        within: Largest horizontal distance from the mark that counts as placed [m].
        orders: Haptic fields of the last place the object fell from; empty before the first.
    """

    def __init__(self, spec: CarrySpec, target: Vec3, seed: int) -> None:
        self.within = spec.within
        self._spec = spec
        self._target = target
        self._source = random.Random(seed * 1_000_003 + 11)
        self._spawn = _FIRST_SPAWN - 1
        self.orders: dict[HapticField, Numbers] = {}
        self._lost_since_ns: int | None = None
        self._restart()

    def _restart(self) -> None:
        self._drops = 0
        self._bruises = 0
        self._crushed = False
        self._held = False
        self._picked_at: Vec3 | None = None
        self._reach = 0.0

    def begin_attempt(self) -> None:
        """Reset the counts and let the object fall from a new place."""
        self._restart()
        self._fall()

    @property
    def picked(self) -> bool:
        """Whether it was in the hand in this attempt."""
        return self._picked_at is not None

    def way(self, seen: Observation) -> float:
        """Return the way of the hand to the object and with it to the mark, level for the latter [m]."""
        place = seen.bodies.get(self._spec.body)
        if place is None:
            return 0.0
        reach = max(0.0, math.dist(seen.hip_world, place) - _FROM_OUTSIDE)
        return reach + max(0.0, _level(place, self._target) - self.within)

    def see(self, seen: Observation) -> CarriedFrame | None:
        """Take a frame and return the object's state; None while the loop has not placed it."""
        place = seen.bodies.get(self._spec.body)
        if place is None:
            return None
        held = seen.held == self._spec.body
        gripped, released = held and not self._held, self._held and not held
        self._held = held
        at_mark = self._is_at_mark(place)
        dropped = released and not at_mark
        self._drops += int(dropped)
        crushed = seen.crushed == self._spec.body
        bruised, self._crushed = crushed and not self._crushed, crushed
        self._bruises += int(bruised)
        if gripped:
            self._picked_at = place
        self._watch_lost(place, held=held, now_ns=seen.now_ns)
        return CarriedFrame(
            placed=at_mark and not held,
            drops=self._drops,
            bruises=self._bruises,
            bruised=bruised,
            gripped=gripped,
            dropped=dropped,
            held=held,
            grasp_error=self._grasp_error(seen.grasp) if held else 0.0,
            progress=self._progress(seen.hip_world, place, held=held, at_mark=at_mark),
            distance=self._off_line(place) if held else None,
            stage=self._stage(seen.hip_world, place, held=held, at_mark=at_mark),
        )

    def _is_at_mark(self, place: Vec3) -> bool:
        above = place[1] - self._target[1]
        return 0.0 <= above <= self._spec.height and _level(place, self._target) <= self.within

    def _stage(self, hand: Vec3, place: Vec3, *, held: bool, at_mark: bool) -> Stage:
        if at_mark:  # a placed object is not gripped again: the hand stays open until the attempt ends
            return Stage.OPEN
        if held:
            return Stage.CARRY
        return Stage.CLOSE if math.dist(hand, place) <= _NEAR else Stage.REACH

    def _progress(self, hand: Vec3, place: Vec3, *, held: bool, at_mark: bool) -> float:
        if at_mark:
            return 1.0
        if not held:
            gap = math.dist(hand, place)
            self._reach = max(self._reach, gap)
            return _SHARE_OF_REACH * (1.0 - gap / self._reach) if self._reach > 0.0 else 0.0
        whole = _level(self._picked_at or place, self._target)
        share = 1.0 - _level(place, self._target) / whole if whole > 0.0 else 1.0
        return _SHARE_OF_REACH + (1.0 - _SHARE_OF_REACH) * min(max(share, 0.0), 0.99)

    def _off_line(self, place: Vec3) -> float:
        """Return the horizontal distance from the straight path between pick-up and mark [m]."""
        if self._picked_at is None:
            return 0.0
        (x0, _, z0), (x1, _, z1) = self._picked_at, self._target
        length = math.hypot(x1 - x0, z1 - z0)
        if length == 0.0:
            return _level(place, self._target)
        along = ((place[0] - x0) * (x1 - x0) + (place[2] - z0) * (z1 - z0)) / length
        along = min(max(along, 0.0), length)
        return math.hypot(place[0] - x0 - along * (x1 - x0) / length, place[2] - z0 - along * (z1 - z0) / length)

    def _grasp_error(self, grasp: float) -> float:
        grip = self._spec.grip
        return max(grip.least - grasp, grasp - grip.most, 0.0)

    def _watch_lost(self, place: Vec3, *, held: bool, now_ns: int) -> None:
        if held or not self._is_out_of_reach(place):
            self._lost_since_ns = None
            return
        if self._lost_since_ns is None:
            self._lost_since_ns = now_ns
        elif (now_ns - self._lost_since_ns) / 1e9 >= _LOST_S:
            self._lost_since_ns = None
            self._fall()

    def _is_out_of_reach(self, place: Vec3) -> bool:
        outside, inside = self._spec.lost_outside, self._spec.lost_inside
        return (outside is not None and not _inside(outside, place)) or (inside is not None and _inside(inside, place))

    def _fall(self) -> None:
        box = self._spec.falls_from
        body = self._spec.body
        self._spawn += 1
        self.orders = {HapticField("spawn", "bodies", body): self._spawn}
        if box is not None:
            place = tuple(
                low + self._source.random() * (high - low) for low, high in zip(box.low, box.high, strict=True)
            )
            turn = math.pi * self._source.random()
            self.orders[HapticField("position", "bodies", body)] = place
            self.orders[HapticField("orientation", "bodies", body)] = (0.0, math.sin(turn), 0.0, math.cos(turn))


def _level(a: Vec3, b: Vec3) -> float:
    """Return the horizontal distance [m]."""
    return math.hypot(a[0] - b[0], a[2] - b[2])


def _inside(box: BoxSpec, place: Vec3) -> bool:
    return all(low <= x <= high for low, x, high in zip(box.low, place, box.high, strict=True))
