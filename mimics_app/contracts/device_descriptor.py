"""A device as the loop knows it: its joints, its points of contact, and its kinematics as compiled functions.

Every kinematics function has one signature, compiled alone with `typed_kernel(KINEMATICS)`:

    status = f(geometry, q, given, out)

`geometry` are the numbers the descriptor computes from a scene's robot (lengths, offsets), `q` the joints; points come
one behind the other, x y z each, in the device's own frame ("robot frame") [m]. A Jacobian is row by row: entry
[3 c + i, j] of point c, axis i and joint j stands at (3 c + i) * joints + j. Rules as of every plug-in of the loop: no
allocation, no exception, nothing beyond the lengths the descriptor states.

`forward` and `jacobian` must be given. What else is given in closed form is used, what is not is computed from them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba import types

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.haptic import MAX_GEOMETRY
from mimics_app.contracts.kernel import typed_kernel
from mimics_app.contracts.loop_fields import MAX_CONTACTS, MAX_JOINTS, Extent

__all__ = [
    "CONTACTS",
    "FORWARD",
    "INVERSE",
    "JACOBIAN",
    "KINEMATICS",
    "KINEMATICS_SET",
    "RATES",
    "TORQUE",
    "TO_ROBOT",
    "TO_TOOL",
    "VELOCITY",
    "DeviceDescriptor",
    "Joint",
    "Kin",
    "Kinematics",
    "KinematicsStatus",
    "described",
    "not_given",
]


CONTACTS = ("hand", "fingers", "left foot", "right foot", "tool")
"""What a point of contact may be."""

_VECTOR = types.float64[::1]

KINEMATICS = types.int64(_VECTOR, _VECTOR, _VECTOR, _VECTOR)
"""Signature of a kinematics function `f(geometry, q, given, out) -> KinematicsStatus`."""


class KinematicsStatus(IntEnum):
    """What a kinematics function returns."""

    DONE = 0
    SINGULAR = 1  # the answer is the nearest there is: some direction cannot be moved in
    UNREACHABLE = 2  # likewise: no joints reach the place
    NOT_GIVEN = 3  # this device has no closed form; `out` is untouched


FORWARD, JACOBIAN, INVERSE, VELOCITY, TORQUE, RATES, TO_ROBOT, TO_TOOL = range(8)
"""Places of the functions in a device's `Kinematics`."""

Kin = tuple[Callable[..., int], ...]
"""A device's functions as the loop has them, in that order."""

KINEMATICS_SET = types.UniTuple(types.FunctionType(KINEMATICS), 8)  # type: ignore[no-untyped-call]
"""Compiled type of a device's functions, so that the loop's own code is the same whatever they are."""

_NOT_GIVEN = int(KinematicsStatus.NOT_GIVEN)


@typed_kernel(KINEMATICS)
def not_given(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    """What stands in the place of a closed form that a device does not have."""
    return _NOT_GIVEN


class Kinematics(NamedTuple):
    """The functions of a device, in the order of FORWARD .. TO_TOOL.

    Attributes:
        forward: Points x of the joints q [m]; nothing is given.
        jacobian: dx/dq, row by row; nothing is given.
        inverse: Joints of given points; `out` holds the last joints on entry.
        velocity: Velocities of the points, J dq, of given joint velocities.
        torque: J^T f of given forces on the points: forces [N] of sliding, torques [N m] of turning joints.
        rates: Joint velocities of given velocities of the points.
        to_robot: Forces from the frame of the sensor to the robot frame; absent: they are the same.
        to_tool: The inverse.
    """

    forward: Callable[..., Any]
    jacobian: Callable[..., Any]
    inverse: Callable[..., Any] = not_given
    velocity: Callable[..., Any] = not_given
    torque: Callable[..., Any] = not_given
    rates: Callable[..., Any] = not_given
    to_robot: Callable[..., Any] = not_given
    to_tool: Callable[..., Any] = not_given


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint.

    Attributes:
        name: For people.
        unit: "m" for a sliding, "rad" for a turning joint.
        lowest: Least position, where a scene states none.
        highest: Largest position.
        velocity: Largest velocity [unit/s].
        acceleration: Largest acceleration [unit/s^2].
        inertia: Virtual inertia of the joint itself [kg, kg m^2], beside the virtual mass at the points; keeps a
            singular pose bounded.
    """

    name: str
    unit: str
    lowest: float
    highest: float
    velocity: float
    acceleration: float
    inertia: float = 0.0


@dataclass(frozen=True, slots=True)
class DeviceDescriptor:
    """What the loop must know of a device, known before it is opened.

    Attributes:
        joints: 1 to MAX_JOINTS.
        contacts: Names of its points of contact, 1 to MAX_CONTACTS of CONTACTS; the first is the one that a tunnel,
            effects and a grip act on.
        kinematics: Its functions.
        geometry: Up to MAX_GEOMETRY numbers for them, from the scene's robot component.
        polar: Its joints are radial, angle about the vertical, vertical: the admittance forms of D2.1 4.2.7 hold, and
            joints are driven by the velocity of the one point. Otherwise motion is computed in its joints.
        torques: It measures torques at its joints, and takes torques.
    """

    joints: tuple[Joint, ...]
    contacts: tuple[str, ...]
    kinematics: Kinematics
    geometry: Callable[[Any], Sequence[float]]
    polar: bool = False
    torques: bool = False

    def __post_init__(self) -> None:
        if not 1 <= len(self.joints) <= MAX_JOINTS:
            raise ValueError(f"a device has 1 to {MAX_JOINTS} joints, not {len(self.joints)}")
        if not 1 <= len(self.contacts) <= MAX_CONTACTS or len(set(self.contacts)) != len(self.contacts):
            raise ValueError(f"a device has 1 to {MAX_CONTACTS} different points of contact, not {self.contacts}")
        if unknown := set(self.contacts) - set(CONTACTS):
            raise ValueError(f"a point of contact is one of {', '.join(CONTACTS)}, not {unknown.pop()!r}")
        for joint in self.joints:
            if joint.unit not in ("m", "rad") or not joint.lowest < joint.highest:
                raise ValueError(f'joint "{joint.name}": its unit is m or rad, and lowest is below highest')
        if self.polar and [joint.unit for joint in self.joints] != ["m", "rad", "m"]:
            raise ValueError("a polar device has the joints m, rad, m")

    @property
    def extent(self) -> Extent:
        """Which of the loop's numbers this device has."""
        return Extent(tuple(joint.unit for joint in self.joints), len(self.contacts), self.torques)

    def geometry_of(self, robot: object) -> Vec:
        """The geometry of a scene's robot, shape [MAX_GEOMETRY], zeros behind.

        Raises:
            ValueError: More numbers than there is room for.
        """
        numbers = np.asarray(self.geometry(robot), np.float64)
        if numbers.size > MAX_GEOMETRY:
            raise ValueError(f"a geometry has at most {MAX_GEOMETRY} numbers, not {numbers.size}")
        return np.concatenate([numbers, np.zeros(MAX_GEOMETRY - numbers.size)])


B = TypeVar("B", bound=Callable[..., Any])


def described(descriptor: DeviceDescriptor) -> Callable[[B], B]:
    """Decorator of a device's builder: its joints, points of contact and kinematics, known before it is built."""

    def decorate(builder: B) -> B:
        builder.descriptor = descriptor  # type: ignore[attr-defined]
        return builder

    return decorate
