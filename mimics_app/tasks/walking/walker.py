"""A person who walks freely on the ground: speed and turn in, place, heading, legs and footfalls out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.messages.orders import Feature
from mimics_app.tasks.walking.footfalls import Footfalls
from mimics_app.tasks.walking.legs import Impairment, Legs

__all__ = ["HALF_STEP_WIDTH", "PERSON", "STANDS", "FigurePose", "FootPlace", "Walker"]

HALF_STEP_WIDTH = 0.06
"""Distance of a foot from the person's middle line [m]."""
STANDS = 0.02
"""Speed below which somebody stands, and the message says how to walk [m/s]."""
_PUSH = 1.0
"""Largest acceleration of a walker [m/s^2]."""


class FigurePose(NamedTuple):
    """What poses a figure that walks.

    Attributes:
        x, y, z: Its place, world [m].
        yaw: Where it looks: angle about +y from +z [rad].
        speed: Of the legs [m/s].
        step: Their step [m].
        phase: Of their cycle, 0 to 1.
        hip_left, knee_left, hip_right, knee_right: Angles of the legs [rad].
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    yaw: float = 0.0
    speed: float = 0.0
    step: float = 0.0
    phase: float = 0.0
    hip_left: float = 0.0
    knee_left: float = 0.0
    hip_right: float = 0.0
    knee_right: float = 0.0

    @property
    def legs(self) -> tuple[float, float, float, float]:
        """Angles of both legs [rad]."""
        return self.hip_left, self.knee_left, self.hip_right, self.knee_right


PERSON = Feature("person", FigurePose())
"""The figure of the person who walks."""


@dataclass(frozen=True, slots=True)
class FootPlace:
    """Where a foot came down.

    Attributes:
        side: "left" or "right".
        x, z: Its middle, world [m].
    """

    side: str
    x: float
    z: float


class Walker:
    """One person. Places are in the plane of the ground; the heading is the angle about +y from +z.

    Args:
        impairment: Of the person's own legs.
        seed: Seed of where the feet come down.

    Attributes:
        x, z: Place [m].
        yaw: Heading [rad].
        speed: Present speed [m/s].
        walked: Distance walked [m].
        footfalls: Of the walk so far.
    """

    def __init__(self, impairment: Impairment, seed: int) -> None:
        self.impairment = impairment
        self._rng = np.random.default_rng([seed, 533])
        self._legs = Legs(impairment)
        self.x = self.z = self.yaw = self.speed = self._pace = self.walked = 0.0
        self.footfalls = Footfalls()
        self._given: LegMotion | None = None

    @property
    def legs(self) -> LegMotion:
        """The newest angles of both legs, and the speed."""
        return self._given or self._legs.motion

    def put(self, x: float, z: float, yaw: float) -> None:
        """Stand at a place [m] with a heading [rad]."""
        self.x, self.z, self.yaw = x, z, yaw
        self.speed = self._pace = 0.0

    def begin(self) -> None:
        """Forget the distance and the footfalls."""
        self.walked, self.footfalls = 0.0, Footfalls()

    def step(
        self, speed: float, turn: float, seconds: float, drift: tuple[float, float] = (0.0, 0.0)
    ) -> list[FootPlace]:
        """Walk for a time by one's own legs.

        Args:
            speed: Wanted speed [m/s].
            turn: Rate of turn, to the left [rad/s].
            seconds: Time step [s].
            drift: Velocity over the ground beside that of the legs, x and z [m/s].

        Returns:
            The feet that came down.
        """
        change = _PUSH * seconds
        wanted = min(max(speed, 0.0), self.impairment.fastest)
        self._pace += min(max(wanted - self._pace, -change), change)
        return self.step_by_legs(self._legs.step(self._pace, seconds), turn, seconds, drift)

    def step_by_legs(
        self, legs: LegMotion, turn: float, seconds: float, drift: tuple[float, float] = (0.0, 0.0)
    ) -> list[FootPlace]:
        """Walk for a time by given legs, those of an orthosis or of `step`; arguments and result as there."""
        self._given, self.speed = legs, legs.belt_speed
        self.yaw = math.remainder(self.yaw + turn * seconds, 2.0 * math.pi)
        ahead = legs.belt_speed * seconds
        self.walked += ahead
        self.x += ahead * math.sin(self.yaw) + drift[0] * seconds
        self.z += ahead * math.cos(self.yaw) + drift[1] * seconds
        return [self._place(fall.side, fall.length) for fall in self.footfalls.watch(legs, seconds)]

    def pose(self, y: float = 0.0) -> FigurePose:
        """Return what poses the person's figure; `y` is the height of the ground [m]."""
        legs = self.legs
        numbers = (
            *(self.x, y, self.z, self.yaw, self.speed, self.footfalls.step_at(self.speed), self.footfalls.phase),
            *(legs.hip_left, legs.knee_left, legs.hip_right, legs.knee_right),
        )
        return FigurePose(*(round(number, 5) for number in numbers))

    def _place(self, side: str, length: float) -> FootPlace:
        """Return where a foot came down, half its step ahead of the person and aside."""
        aside = (HALF_STEP_WIDTH if side == "left" else -HALF_STEP_WIDTH) + float(
            self._rng.normal(0.0, self.impairment.spread)
        )
        ahead = 0.5 * length
        s, c = math.sin(self.yaw), math.cos(self.yaw)
        return FootPlace(side, self.x + ahead * s + aside * c, self.z + ahead * c - aside * s)
