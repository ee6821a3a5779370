"""Footsteps of a walker from the phase of its gait: a sound trigger at each heel strike.

A walker is an entity that moves. Its step length grows with the root of its speed, so the triggers follow its movement
in time and place. Avatars emit the same `SoundTrigger` from the contacts of their feet.
"""

from __future__ import annotations

from math import hypot, sqrt

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.stage_messages import SoundTrigger

__all__ = ["GaitClock"]


_LENGTH_AT_ONE = 0.66
"""Step length at 1 m/s [m]; it grows with the root of the speed (Grieve 1968)."""

_SLOWEST = 0.05
"""Lowest speed at which steps are triggered [m/s]."""


class GaitClock:
    """Step counter of one walker.

    Args:
        material: Material of the ground, for the trigger.
        strength: Linear factor on the level of the steps.
    """

    def __init__(self, material: str, strength: float = 1.0) -> None:
        self._material = material
        self._strength = strength
        self._phase = 0.0
        self._before: tuple[int, Vec3] | None = None

    def step(self, t_ns: int, place: Vec3) -> list[SoundTrigger]:
        """Return the heel strikes since the last call, each with its time and place; call once per frame.

        Args:
            t_ns: Session time [ns].
            place: Position of the walker's feet in the world, +y up [m].
        """
        before, self._before = self._before, (t_ns, place)
        if before is None or t_ns <= before[0]:
            return []
        begin_ns, (x, y, z) = before
        distance = hypot(place[0] - x, place[2] - z)
        span_ns = t_ns - begin_ns
        speed = distance / (span_ns * 1e-9)
        if speed < _SLOWEST:
            return []
        advance = distance / (_LENGTH_AT_ONE * sqrt(speed))  # in steps
        done, self._phase = self._phase, self._phase + advance
        triggers = []
        for number in range(int(done) + 1, int(self._phase) + 1):
            share = (number - done) / advance
            at = (x + share * (place[0] - x), y + share * (place[1] - y), z + share * (place[2] - z))
            when = begin_ns + round(share * span_ns)
            triggers.append(SoundTrigger("step", when, at, self._material, self._strength))
        self._phase -= int(self._phase)
        return triggers
