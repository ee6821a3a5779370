"""Legs of a person without an orthosis: angles of hip and knee at a walking speed, healthy or impaired.

The angles are those of the published curves (`world.content.motion.reference_gait`). The degrees of impairment are
settings, not data: they give a paretic left leg that steps short, bends its knee less in swing and takes more time, as
gait after stroke is described (shorter and longer step, stiff knee, slow). No publication is claimed for the numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.world.content.motion.reference_gait import NATURAL_STANCE, SAMPLES, shape_gait, stance_share

__all__ = ["GAITS", "SHANK", "THIGH", "Impairment", "Legs", "natural_step"]

THIGH, SHANK = 0.42, 0.40
"""Lengths of the bones, hip to knee to ankle [m], of a person 1.75 m tall."""
_NATURAL_STEP, _PREFERRED = 0.80 * (THIGH + SHANK), 1.3
"""Step at the preferred speed [m], and that speed [m/s]."""
_CRAWL = 0.02
"""Speed below which the legs stand [m/s]."""
_TABLE_SPEED, _TABLE_STRETCH = 0.02, 0.02
"""Resolution of the cached curves in speed [m/s] and in stretch of the step."""
_LEAST_STRETCH = 0.12
_STANDS_AT = 2.5
"""Rate at which a leg that stands comes to its standing angles [1/s]."""
_STANDING_KNEE = math.radians(5.0)


@dataclass(frozen=True, slots=True)
class Impairment:
    """How a person's legs differ from healthy ones.

    Attributes:
        fastest: Largest walking speed [m/s].
        short: Angle by which the left hip stays back over the whole cycle, and the right one ahead, as a share of the
            range of the hip: 0 none.
        stiff: Share of the flexion of the left knee in swing that is missing.
        spread: Standard deviation of where a foot comes down aside of its place [m].
    """

    fastest: float
    short: float
    stiff: float
    spread: float


GAITS: Mapping[str, Impairment] = {
    "healthy": Impairment(fastest=1.4, short=0.0, stiff=0.0, spread=0.012),
    "hemiparetic": Impairment(fastest=0.8, short=0.06, stiff=0.25, spread=0.025),
    "severe": Impairment(fastest=0.45, short=0.10, stiff=0.40, spread=0.04),
}
"""Degrees of impairment by name."""


def natural_step(speed: float) -> float:
    """Return the natural step [m] at a speed [m/s]: it grows with the root (Grieve 1968)."""
    return _NATURAL_STEP * math.sqrt(abs(speed) / _PREFERRED)


class Legs:
    """Angles of two legs over time.

    Args:
        impairment: Of the person.

    Attributes:
        phase: Phase of the left leg, 0 at its heel strike.
        motion: Angles after the last step.
    """

    def __init__(self, impairment: Impairment) -> None:
        self._impairment = impairment
        self.phase = 0.0
        self._share = 0.0
        self.motion = LegMotion(0.0, _STANDING_KNEE, 0.0, _STANDING_KNEE, 0.0)

    def step(self, speed: float, seconds: float) -> LegMotion:
        """Walk for a time [s] at a speed [m/s], not faster than the person can; return the angles and the speed."""
        speed = min(speed, self._impairment.fastest)
        walks = speed > _CRAWL
        step = natural_step(speed)
        if walks:
            self.phase = (self.phase + seconds * speed / (2.0 * step)) % 1.0
        change = _STANDS_AT * seconds
        self._share += min(max(float(walks) - self._share, -change), change)
        angles = self._walking(max(speed, 0.1))
        standing = (0.0, _STANDING_KNEE, 0.0, _STANDING_KNEE)
        a, b, c, d = (self._share * w + (1.0 - self._share) * s for w, s in zip(angles, standing, strict=True))
        self.motion = LegMotion(a, b, c, d, speed if walks else 0.0)
        return self.motion

    def _walking(self, speed: float) -> tuple[float, float, float, float]:
        """Return [left hip, left knee, right hip, right knee] at the present phase [rad]."""
        stance = stance_share(speed)
        stretch = natural_step(speed) * stance / (_NATURAL_STEP * NATURAL_STANCE)
        table = shape_gait(
            round(_TABLE_SPEED * round(speed / _TABLE_SPEED), 2),
            round(max(_LEAST_STRETCH, _TABLE_STRETCH * round(min(stretch, 1.3) / _TABLE_STRETCH)), 2),
        )
        offset = self._impairment.short * float(np.ptp(table[:, 0]))
        hip, knee = _at(table, self.phase)
        if self.phase > stance:
            share = math.sin(math.pi * (self.phase - stance) / (1.0 - stance))
            knee *= 1.0 - self._impairment.stiff * share
        other_hip, other_knee = _at(table, (self.phase + 0.5) % 1.0)
        return hip - offset, knee, other_hip + offset, other_knee


def _at(table: F8, phase: float) -> tuple[float, float]:
    """Return thigh and knee of a table at a phase [rad]."""
    place = phase * SAMPLES
    k = int(place)
    share = place - k
    now, then = table[k % SAMPLES], table[(k + 1) % SAMPLES]
    return float(now[0] + share * (then[0] - now[0])), float(now[1] + share * (then[1] - now[1]))
