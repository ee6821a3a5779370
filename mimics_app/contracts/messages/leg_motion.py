"""Motion of two legs on a treadmill: what a gait orthosis, a simulated person or a synthesised gait gives a walk."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["LegMotion"]


class LegMotion(NamedTuple):
    """Angles of both legs in the sagittal plane, flexion positive, the hip's to the vertical, and the belt's speed.

    Attributes:
        hip_left, knee_left, hip_right, knee_right: Angles [rad].
        belt_speed: Speed of the belt, which is that of the walk [m/s].
        strikes: Heel strikes of the left and the right foot so far, where the loop finds them; () otherwise.
    """

    hip_left: float
    knee_left: float
    hip_right: float
    knee_right: float
    belt_speed: float
    strikes: tuple[int, ...] = ()
