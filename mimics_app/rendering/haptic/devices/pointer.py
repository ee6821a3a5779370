"""Simulated robot moved by mouse, gamepad or keyboard through a virtual coupling."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import (
    DATA_BUTTONS,
    DATA_GRASP,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    READ,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.device_settings import write_settings
from mimics_app.rendering.haptic.devices.dynamics import servo_dynamics
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import write_robot, write_robot_memory
from mimics_app.rendering.haptic.kernels import virtual_coupling
from mimics_app.rendering.haptic.kernels.robot import HANDLE, ROBOT_LENGTH, TICK, sense, step_robot
from mimics_app.rendering.haptic.kernels.virtual_coupling import COUPLING_FORCE, COUPLING_LENGTH, step_coupling

__all__ = ["build_pointer"]


_SETTINGS = {
    "hand_force": (virtual_coupling.COUPLING_LIMIT, 15.0),  # [N]
    "hand_stiffness": (virtual_coupling.COUPLING_STIFFNESS, 800.0),  # [N/m]
    "hand_damping": (virtual_coupling.COUPLING_DAMPING, 90.0),  # [N s/m]: critical for 3 kg
    "follow_rate": (
        virtual_coupling.FOLLOW_RATE,
        40.0,
    ),  # [rad/s]: 60 Hz steps are smoothed, the cursor is reached in 0.2 s
}


@typed_kernel(READ)
def _read_pointer(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Simulate one tick of robot and virtual coupling; write the sensor data. Memory: robot, then coupling."""
    machine = memory[:ROBOT_LENGTH]
    own = memory[ROBOT_LENGTH:]
    if tick > 0:
        step_robot(machine)
    target = inbox[INBOX_TARGET : INBOX_TARGET + 3]
    step_coupling(own, machine[HANDLE : HANDLE + 6], target, inbox[INBOX_ACTIVE] != 0.0, machine[TICK])
    data[DATA_GRASP] = max(0.0, inbox[INBOX_GRASP])
    data[DATA_BUTTONS] = inbox[INBOX_BUTTONS]
    sense(machine, own[COUPLING_FORCE : COUPLING_FORCE + 3], data)
    return 0


def build_pointer(request: DeviceRequest) -> DevicePlugin:
    """Build the simulated robot moved by the virtual coupling of a pointing device.

    `robot.settings` may hold hand_force [N], hand_stiffness [N/m], hand_damping [N s/m] and follow_rate [rad/s].

    Raises:
        DeviceError: An unknown setting, or one that is not a positive number.
    """
    memory = np.zeros(ROBOT_LENGTH + COUPLING_LENGTH)
    write_robot_memory(memory[:ROBOT_LENGTH], request)
    own = memory[ROBOT_LENGTH:]
    write_settings(own, _SETTINGS, request.robot.settings, "pointer")
    return DevicePlugin(
        "pointer", _read_pointer, write_robot, memory, simulated=True, **servo_dynamics(request.robot, request.rate)
    )
