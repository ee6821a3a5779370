"""Limits of a device's joints in one scene: those of the scene's robot, else the device's own."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER

if TYPE_CHECKING:
    from mimics_app.contracts.device_descriptor import DeviceDescriptor
    from mimics_app.world.components.robot import Robot

__all__ = ["JointLimits", "joint_limits"]

Joints = tuple[float, ...]


class JointLimits(NamedTuple):
    """Per joint, in its unit.

    Attributes:
        lowest: Least position [m, rad].
        highest: Largest position.
        velocity: Largest velocity of a command [1/s].
        acceleration: Largest change of it [1/s^2].
    """

    lowest: Joints
    highest: Joints
    velocity: Joints
    acceleration: Joints


def joint_limits(robot: Robot, descriptor: DeviceDescriptor = HAPTICMASTER) -> JointLimits:
    """The limits that hold.

    Raises:
        DeviceError: The robot states limits of another number of joints than the device has.
    """
    joints = descriptor.joints
    return JointLimits(
        _given(robot.joint_min, "joint_min", tuple(joint.lowest for joint in joints)),
        _given(robot.joint_max, "joint_max", tuple(joint.highest for joint in joints)),
        _given(robot.velocity_limit, "velocity_limit", tuple(joint.velocity for joint in joints)),
        _given(robot.acceleration_limit, "acceleration_limit", tuple(joint.acceleration for joint in joints)),
    )


def _given(values: Joints | None, name: str, own: Joints) -> Joints:
    if values is None:
        return own
    if len(values) != len(own):
        raise DeviceError(
            f"the robot's {name} is of {len(values)} joints, its device has {len(own)}",
            "give one number for each joint, or leave it out",
        )
    return values
