"""Device descriptor for the loop: joints, points of contact, and kinematics as compiled functions.

Every kinematics function has one signature, compiled alone with `typed_kernel(KINEMATICS)`:

    status = f(geometry, q, given, out)

`geometry` holds the numbers that the descriptor computes from a scene's robot (lengths, offsets), `q` the joints;
points are concatenated, x y z each, in the device's own frame ("robot frame") [m]. A Jacobian is stored row by row:
entry [3 c + i, j] of point c, axis i and joint j is at (3 c + i) * joints + j. The rules of every plug-in of the loop
apply: no allocation, no exception, no access beyond the lengths of the descriptor.

`forward` and `jacobian` are required. Other closed forms are used where given, and computed from these two elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple, TypedDict, TypeVar

import numpy as np
from numba import types

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import MAX_GEOMETRY
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS, MAX_JOINTS, Extent

__all__ = [
    "FORWARD",
    "INVERSE",
    "JACOBIAN",
    "KINEMATICS",
    "KINEMATICS_SET",
    "RATES",
    "TORQUE",
    "TO_ROBOT",
    "VELOCITY",
    "DeviceDescriptor",
    "Dynamics",
    "Joint",
    "Kin",
    "Kinematics",
    "KinematicsStatus",
    "described",
    "not_given",
]


_LONGEST_NAME = 32
"""Largest length of the name of a point of contact [characters]."""

_VECTOR = types.float64[::1]

KINEMATICS = types.int64(_VECTOR, _VECTOR, _VECTOR, _VECTOR)
"""Signature of a kinematics function `f(geometry, q, given, out) -> KinematicsStatus`."""


class KinematicsStatus(IntEnum):
    """Return value of a kinematics function."""

    DONE = 0
    SINGULAR = 1  # closest solution: the device cannot move in some direction
    UNREACHABLE = 2  # closest solution: no joints reach the point
    NOT_GIVEN = 3  # no closed form; `out` is unchanged


FORWARD, JACOBIAN, INVERSE, VELOCITY, TORQUE, RATES, TO_ROBOT = range(7)
"""Indices of the functions in a device's `Kinematics`."""

Kin = tuple[Callable[..., int], ...]
"""Functions of a device in the loop, in that order."""

KINEMATICS_SET = types.UniTuple(types.FunctionType(KINEMATICS), 7)  # type: ignore[no-untyped-call]
"""Compiled type of a device's functions: first-class, so that the loop's code does not depend on the device."""


@typed_kernel(KINEMATICS)
def not_given(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    """Placeholder for a missing closed form."""
    return KinematicsStatus.NOT_GIVEN


class Kinematics(NamedTuple):
    """Functions of a device, in the order of FORWARD .. TO_ROBOT.

    Attributes:
        forward: Points x at joints q [m]; `given` is unused.
        jacobian: dx/dq, row by row; `given` is unused.
        inverse: Joints at given points; `out` holds the last joints on entry.
        velocity: J dq, velocities of the points at given joint velocities.
        torque: J^T f of given forces on the points: forces [N] of prismatic, torques [N m] of revolute joints.
        rates: Joint velocities at given velocities of the points.
        to_robot: Forces from the sensor frame to the robot frame; absent: the frames are equal.
    """

    forward: Callable[..., Any]
    jacobian: Callable[..., Any]
    inverse: Callable[..., Any] = not_given
    velocity: Callable[..., Any] = not_given
    torque: Callable[..., Any] = not_given
    rates: Callable[..., Any] = not_given
    to_robot: Callable[..., Any] = not_given


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint.

    Attributes:
        name: Name for the user.
        unit: "m" for a prismatic, "rad" for a revolute joint.
        lowest: Smallest position, unless the scene sets one; likewise the limits below.
        highest: Largest position.
        velocity: Largest velocity [unit/s].
        acceleration: Largest acceleration [unit/s^2].
        inertia: Virtual inertia of the joint itself [kg, kg m^2], added to the virtual mass at the points; it bounds
            the motion in a singular pose.
    """

    name: str
    unit: str
    lowest: float
    highest: float
    velocity: float
    acceleration: float
    inertia: float = 0.0


class Dynamics(TypedDict):
    """What limits the stiffness and damping that a device can hold, as its `DevicePlugin` states it.

    Attributes:
        delay: From a command to its motion [s].
        lag: Part of it that is the lag of a velocity servo [s].
        filtering: Time constant of the filter of the velocity [s].
        quantum: Resolution of the position [m].
        mass: Of a device that takes forces, without a hand [kg]; 0: it takes velocities.
    """

    delay: float
    lag: float
    filtering: float
    quantum: float
    mass: float


@dataclass(frozen=True, slots=True)
class DeviceDescriptor:
    """Description of a device for the loop, available before the device is opened.

    Attributes:
        joints: 1 to MAX_JOINTS joints.
        contacts: Names of its points of contact, 1 to MAX_CONTACTS different ones, as "hand" or "left foot": scenes
            name them, and the person reads them. The first one leads: a task is about it unless it names another.
        kinematics: Kinematics functions.
        geometry: Computes up to MAX_GEOMETRY numbers for them from the scene's robot component.
        polar: The joints are radial, angle about the vertical, vertical: the admittance forms of D2.1 4.2.7 apply, and
            the joints follow the velocity of the one point. Otherwise motion is computed in joint space.
        torques: The device measures joint torques, and takes torques.
        dynamics: Computes from the scene's robot component and the ticks per second what `mimics check` may count on,
            without opening the device; None: nothing is known before it is open.
    """

    joints: tuple[Joint, ...]
    contacts: tuple[str, ...]
    kinematics: Kinematics
    geometry: Callable[[Any], Sequence[float]]
    polar: bool = False
    torques: bool = False
    dynamics: Callable[[object, int], Dynamics] | None = None

    def __post_init__(self) -> None:
        if not 1 <= len(self.joints) <= MAX_JOINTS:
            raise ValueError(f"a device has 1 to {MAX_JOINTS} joints, not {len(self.joints)}")
        if not 1 <= len(self.contacts) <= MAX_CONTACTS or len(set(self.contacts)) != len(self.contacts):
            raise ValueError(f"a device has 1 to {MAX_CONTACTS} different points of contact, not {self.contacts}")
        for name in self.contacts:
            if not name.isprintable() or name != name.strip() or not 1 <= len(name) <= _LONGEST_NAME:
                raise ValueError(f"the name of a point of contact has 1 to {_LONGEST_NAME} characters, not {name!r}")
        for joint in self.joints:
            if joint.unit not in ("m", "rad") or not joint.lowest < joint.highest:
                raise ValueError(f'joint "{joint.name}": its unit is m or rad, and lowest is below highest')
        if self.polar and [joint.unit for joint in self.joints] != ["m", "rad", "m"]:
            raise ValueError("a polar device has the joints m, rad, m")

    @property
    def extent(self) -> Extent:
        """Subset of the loop's numbers that this device has."""
        return Extent(tuple(joint.unit for joint in self.joints), len(self.contacts), self.torques)

    def geometry_of(self, robot: object) -> Vec:
        """Return the geometry of a scene's robot padded with zeros, shape [MAX_GEOMETRY].

        Raises:
            ValueError: More than MAX_GEOMETRY numbers.
        """
        numbers = np.asarray(self.geometry(robot), np.float64)
        if numbers.size > MAX_GEOMETRY:
            raise ValueError(f"a geometry has at most {MAX_GEOMETRY} numbers, not {numbers.size}")
        return np.concatenate([numbers, np.zeros(MAX_GEOMETRY - numbers.size)])


B = TypeVar("B", bound=Callable[..., Any])


def described(descriptor: DeviceDescriptor) -> Callable[[B], B]:
    """Decorator that attaches a descriptor to the builder of a device, available before it is built."""

    def decorate(builder: B) -> B:
        builder.descriptor = descriptor  # type: ignore[attr-defined]
        return builder

    return decorate
