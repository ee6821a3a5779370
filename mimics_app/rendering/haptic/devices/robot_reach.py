"""Reach of a scene's robot: its kinematics callable from Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import KinematicsStatus, not_given
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS, MAX_JOINTS
from mimics_app.rendering.haptic.descriptors.joint_limits import joint_limits
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.scene_block import apply_robot, robot_from_world

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Robot

__all__ = ["Reach"]


class Reach:
    """Kinematics of one robot with one device.

    Args:
        robot: The scene's robot component.

    Attributes:
        descriptor: Descriptor of its device.
        limits: Limits of its joints.

    Raises:
        DeviceError: No such device, or limits for another number of joints.
    """

    def __init__(self, robot: Robot) -> None:
        self.descriptor = descriptor_of(robot.device)
        self.limits = joint_limits(robot, self.descriptor)
        self._robot = robot
        self._kin = self.descriptor.kinematics
        self._block = np.zeros(1, SCENE)
        apply_robot(self._block, robot, self.descriptor)

    def points(self, q: Vec) -> Vec:
        """Return the points of contact at joints q, robot frame [m], shape [contacts, 3]."""
        joints, x = self._joints(q), np.zeros(3 * MAX_CONTACTS)
        self._kin.forward(self._block[0]["geometry"], joints, joints, x)
        return x[: 3 * len(self.descriptor.contacts)].reshape(-1, 3)

    def joints(self, point: Vec) -> tuple[Vec, KinematicsStatus]:
        """Return the joints for a position of the first point of contact, robot frame [m]; the others stay centred.

        Returns:
            (joints, shape [joints], without limits; status of the inverse kinematics).
        """
        middle = 0.5 * (np.array(self.limits.lowest) + np.array(self.limits.highest))
        # HapticMaster: on the axis any angle will do; zero is kept there.
        q = self._joints(np.zeros(len(middle)) if self.descriptor.polar else middle)
        wanted = self.points(middle)
        wanted[0] = point
        x = np.concatenate([wanted.ravel(), np.zeros(3 * MAX_CONTACTS - wanted.size)])
        status = self._inverse(x, q)
        return q[: len(middle)].copy(), KinematicsStatus(status)

    def reaches(self, point_world: Vec) -> bool:
        """Whether the first point of contact can reach a point of the world [m]."""
        q, status = self.joints(self.from_world(point_world))
        inside = bool(np.all(q >= self.limits.lowest) and np.all(q <= self.limits.highest))
        return inside and status is not KinematicsStatus.UNREACHABLE

    def from_world(self, point_world: Vec) -> Vec:
        """Return a point of the world in the robot frame [m]."""
        return robot_from_world(self._robot, np.asarray(point_world, np.float64).reshape(1, 3))[0]

    def _joints(self, q: Vec) -> Vec:
        return np.concatenate([q, np.zeros(MAX_JOINTS - len(q))])

    def _inverse(self, x: Vec, q: Vec) -> int:
        if self._kin.inverse is not not_given:
            return int(self._kin.inverse(self._block[0]["geometry"], q.copy(), x, q))
        from mimics_app.contracts.loop.controller_port import CONTROL_WORK
        from mimics_app.rendering.haptic.devices.inverse_by_steps import inverse_by_steps

        return int(inverse_by_steps(tuple(self._kin), self._block, x, np.zeros(1, CONTROL_WORK), q))
