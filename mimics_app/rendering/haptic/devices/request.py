"""Arguments of device builders."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.descriptors.joint_limits import JointLimits, joint_limits
from mimics_app.rendering.haptic.devices.device_objects import DeviceObject

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Patient, Robot

__all__ = ["DeviceBuilder", "DeviceRequest"]


def _nowhere() -> NDArray[np.float64]:
    return np.zeros((0, 3))


@dataclass(frozen=True, slots=True)
class DeviceRequest:
    """Arguments of a device builder.

    Attributes:
        robot: The scene's robot component.
        patient: The scene's patient component; None: a relaxed arm on the simulated robot.
        path_robot: Polyline that a simulated person intends to follow, robot frame [m], shape [n, 3].
        seed: Seed of all random numbers of the device.
        rate: Ticks per second.
        start_joints: Initial joints of a simulated robot [m or rad].
        samples: SAMPLE rows for the replay device.
        address: Address after the colon of the device's name; "" if not given.
        objects: Objects for a robot that renders objects itself, robot frame.
        descriptor: Joints, points of contact and kinematics of the device.
    """

    robot: Robot
    patient: Patient | None = None
    path_robot: NDArray[np.float64] = field(default_factory=_nowhere)
    seed: int = 0
    rate: int = 1000
    start_joints: tuple[float, ...] = (0.0, 0.0, 0.0)
    samples: NDArray[Any] | None = None
    address: str = ""
    objects: tuple[DeviceObject, ...] = ()
    descriptor: DeviceDescriptor = HAPTICMASTER

    @property
    def limits(self) -> JointLimits:
        """Joint limits in this scene.

        Raises:
            DeviceError: The robot's limits are for another number of joints than the device has.
        """
        return joint_limits(self.robot, self.descriptor)


DeviceBuilder = Callable[[DeviceRequest], DevicePlugin]
"""Type of the entry points of the group `mimics_app.devices`."""
