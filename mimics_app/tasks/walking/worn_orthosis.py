"""Legs of a person in a gait orthosis: its four joints as angles of both legs, and the speed of the belt under them.

A standing foot goes backwards with the belt, and the foot that stands is the lower one; of two feet that stand, the one
that goes back faster is taken, since the other one is about to leave. The speed is smoothed over a step.
"""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.footfalls import ankle

__all__ = ["OrthosisLegs", "legs_in", "strikes_in"]

_JOINTS, _LIMB = 4, "left foot"
"""Joints of an orthosis, hip and knee of the left leg and of the right one, and its first point of contact."""
_SMOOTH_S = 0.35
"""Time constant of the belt's speed [s]."""
_LEVEL = 0.03
"""Difference of the heights of two feet up to which both stand [m]."""
_STILL = 0.04
"""Speed of the belt that counts as none [m/s]."""


class OrthosisLegs:
    """Reads both legs frame by frame."""

    def __init__(self) -> None:
        self._before: tuple[float, float] | None = None
        self._belt = 0.0

    def read(self, joints: Sequence[float], strikes: Sequence[int], seconds: float) -> LegMotion:
        """Return both legs after a time step [s].

        Args:
            joints: Left hip, left knee, right hip, right knee, flexion positive [rad].
            strikes: Heel strikes of both feet so far, as the loop finds them; -1: it does not watch.
            seconds: Time since the last call [s].
        """
        hip_left, knee_left, hip_right, knee_right = joints
        left, right = ankle(hip_left, knee_left), ankle(hip_right, knee_right)
        before, self._before = self._before, (left[0], right[0])
        if before is not None and seconds > 0.0:
            back = [(was - now) / seconds for was, now in zip(before, (left[0], right[0]), strict=True)]
            if abs(left[1] - right[1]) <= _LEVEL:
                speed = max(back)
            else:
                speed = back[0] if left[1] > right[1] else back[1]
            self._belt += min(seconds / _SMOOTH_S, 1.0) * (max(speed, 0.0) - self._belt)
        belt = self._belt if self._belt > _STILL else 0.0
        return LegMotion(hip_left, knee_left, hip_right, knee_right, belt, tuple(strikes) if min(strikes) >= 0 else ())


def legs_in(context: TaskContext) -> OrthosisLegs | None:
    """Return the reader of the legs where the device is a gait orthosis; None where the task's own legs walk."""
    is_orthosis = context.limb == _LIMB and len(context.start_joints) == _JOINTS
    return OrthosisLegs() if is_orthosis else None


def strikes_in(seen: Observation) -> tuple[int, int]:
    """Return the heel strikes of the left and the right foot so far, as the loop counts them; -1: it does not watch."""
    return seen.snapshot.left_strikes, seen.snapshot.right_strikes
