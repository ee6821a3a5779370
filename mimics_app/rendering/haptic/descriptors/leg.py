"""Descriptors of one or two planar legs on a gait orthosis: joints hip and knee, point of contact the foot."""

from __future__ import annotations

import math
from typing import Any

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import (
    KINEMATICS,
    DeviceDescriptor,
    Joint,
    Kinematics,
    KinematicsStatus,
)
from mimics_app.rendering.haptic.kernels.leg_kinematics import (
    LEGS as HOW_MANY,
)
from mimics_app.rendering.haptic.kernels.leg_kinematics import (
    foot_torques,
    foot_velocity,
    leg_jacobian,
    leg_joints,
    place_foot,
)

__all__ = ["LEG", "LEGS", "LEG_KINEMATICS", "LENGTHS"]


LENGTHS = {"thigh": 0.43, "shank": 0.50, "foot": 0.12, "hip_width": 0.20}
"""Default lengths [m] of the robot's settings of the same names: a person of 1.75 m (Winter's table: thigh 0.245, shank
0.246 and ankle 0.039 of the height); `foot` is the distance of the ball of the foot before the ankle."""


_ENTRIES = 6
"""Entries of the Jacobian per pair of legs: three components of one foot by two joints of the other leg."""


@typed_kernel(KINEMATICS)
def _forward(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    for leg in range(int(geometry[HOW_MANY])):
        place_foot(geometry, leg, q[2 * leg : 2 * leg + 2], out[3 * leg : 3 * leg + 3])
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _jacobian(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    legs = int(geometry[HOW_MANY])
    for i in range(_ENTRIES * legs * legs):
        out[i] = 0.0
    for leg in range(legs):
        x1, x2, z1, z2 = leg_jacobian(geometry, q[2 * leg : 2 * leg + 2])
        first = 3 * leg * 2 * legs + 2 * leg
        out[first], out[first + 1] = x1, x2
        out[first + 4 * legs], out[first + 4 * legs + 1] = z1, z2
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _inverse(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    status = KinematicsStatus.DONE
    for leg in range(int(geometry[HOW_MANY])):
        if not leg_joints(geometry, leg, given[3 * leg : 3 * leg + 3], out[2 * leg : 2 * leg + 2]):
            status = KinematicsStatus.UNREACHABLE
    return status


@typed_kernel(KINEMATICS)
def _velocity(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    for leg in range(int(geometry[HOW_MANY])):
        joints = q[2 * leg : 2 * leg + 2]
        foot_velocity(geometry, joints, given[2 * leg : 2 * leg + 2], out[3 * leg : 3 * leg + 3])
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _torque(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    for leg in range(int(geometry[HOW_MANY])):
        joints = q[2 * leg : 2 * leg + 2]
        foot_torques(geometry, joints, given[3 * leg : 3 * leg + 3], out[2 * leg : 2 * leg + 2])
    return KinematicsStatus.DONE


def _geometry(robot: Any, legs: int) -> tuple[float, ...]:
    """Return the geometry of a scene's robot: number of legs, then their lengths."""
    lengths = (float(robot.settings.get(name, usual)) for name, usual in LENGTHS.items())
    return (float(legs), *lengths)


def _joints(side: str) -> tuple[Joint, Joint]:
    """Return hip and knee with ranges of gait; the virtual inertia keeps singular poses bounded."""
    return (
        Joint(f"{side}hip", "rad", math.radians(-20.0), math.radians(60.0), 4.0, 60.0, inertia=0.3),
        Joint(f"{side}knee", "rad", 0.0, math.radians(90.0), 6.0, 90.0, inertia=0.1),
    )


LEG_KINEMATICS = Kinematics(_forward, _jacobian, _inverse, _velocity, _torque)
"""Kinematics of one or two legs; their geometry begins with the number of legs, then the lengths as in LENGTHS."""

LEG = DeviceDescriptor(
    joints=_joints(""),
    contacts=("right foot",),
    kinematics=LEG_KINEMATICS,
    geometry=lambda robot: _geometry(robot, 1),
    torques=True,
)
"""One leg."""

LEGS = DeviceDescriptor(
    joints=(*_joints("left "), *_joints("right ")),
    contacts=("left foot", "right foot"),
    kinematics=LEG_KINEMATICS,
    geometry=lambda robot: _geometry(robot, 2),
    torques=True,
)
"""Two legs."""
