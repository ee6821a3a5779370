"""Joint limits of a device in one scene: those of its descriptor, which the scene's robot may narrow."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER

if TYPE_CHECKING:
    from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
    from mimics_app.world.components.robot import Robot

__all__ = ["JointLimits", "joint_limits"]

Joints = tuple[float, ...]


class JointLimits(NamedTuple):
    """Limits of each joint, in its unit (m or rad).

    Attributes:
        lowest: Smallest position [unit].
        highest: Largest position [unit].
        velocity: Largest commanded velocity [unit/s].
        acceleration: Largest rate of its change [unit/s^2].
    """

    lowest: Joints
    highest: Joints
    velocity: Joints
    acceleration: Joints


def joint_limits(robot: Robot, descriptor: DeviceDescriptor = HAPTICMASTER) -> JointLimits:
    """Return the effective joint limits: the narrower of the robot's and of the device's own, for every joint.

    Raises:
        DeviceError: The robot's limits are for another number of joints than the device has.
    """
    joints = descriptor.joints
    return JointLimits(
        _given(robot.joint_min, "joint_min", tuple(joint.lowest for joint in joints), max),
        _given(robot.joint_max, "joint_max", tuple(joint.highest for joint in joints), min),
        _given(robot.velocity_limit, "velocity_limit", tuple(joint.velocity for joint in joints), min),
        _given(robot.acceleration_limit, "acceleration_limit", tuple(joint.acceleration for joint in joints), min),
    )


def _given(values: Joints | None, name: str, own: Joints, narrower: Callable[[float, float], float]) -> Joints:
    if values is None:
        return own
    if len(values) != len(own):
        raise DeviceError(
            f"the robot's {name} has {len(values)} numbers, its device {len(own)} joints",
            "give one number for each joint, or leave it out",
        )
    return tuple(narrower(asked, limit) for asked, limit in zip(values, own, strict=True))
