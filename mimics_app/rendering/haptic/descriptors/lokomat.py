"""Descriptor of the gait orthosis Lokomat: hips and knees of both legs, points of contact the feet.

Joint ranges and speeds are those of a gait with a margin; they, and all figures of the machine, are settings that no
source at hand verifies.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor, Joint
from mimics_app.rendering.haptic.descriptors.leg import LEG_KINEMATICS
from mimics_app.rendering.haptic.descriptors.segments import HEIGHT, WEIGHT, segments_of

__all__ = ["LOKOMAT"]


def _joints(side: str) -> tuple[Joint, Joint]:
    hip = math.radians(-30.0), math.radians(60.0)
    knee = math.radians(-6.0), math.radians(90.0)
    return (
        Joint(f"{side} hip", "rad", *hip, 5.0, 60.0, inertia=0.3),
        Joint(f"{side} knee", "rad", *knee, 8.0, 120.0, inertia=0.1),
    )


def _geometry(settings: Mapping[str, float]) -> tuple[float, ...]:
    """Return the geometry of `leg_kinematics` for the person of the settings of a scene's robot."""
    own = segments_of(settings.get("height", HEIGHT), settings.get("weight", WEIGHT))
    return (2.0, own.thigh, own.shank + own.ankle, own.ball, own.hips)


LOKOMAT = DeviceDescriptor(
    joints=(*_joints("left"), *_joints("right")),
    contacts=("left foot", "right foot"),
    kinematics=LEG_KINEMATICS,
    geometry=lambda robot: _geometry(robot.settings),
    torques=True,
)
"""The gait orthosis with a person of the robot's settings `height` [m] and `weight` [kg]."""
