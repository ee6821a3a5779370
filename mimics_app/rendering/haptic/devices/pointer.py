"""Simulated robot moved by mouse, gamepad or keyboard through a virtual coupling."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel, typed_kernel
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
from mimics_app.maths.vec import clamp_norm, copy, fill
from mimics_app.rendering.haptic.devices.device_settings import write_settings
from mimics_app.rendering.haptic.devices.dynamics import servo_dynamics
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import write_robot, write_robot_memory
from mimics_app.rendering.haptic.kernels.robot import HANDLE, ROBOT_LENGTH, TICK, sense, step_robot

__all__ = [
    "COUPLING_FORCE",
    "COUPLING_LENGTH",
    "COUPLING_LIMIT",
    "COUPLING_STIFFNESS",
    "FOLLOW_RATE",
    "build_pointer",
    "step_coupling",
]

# Virtual coupling of a pointing device: makes 60 Hz steps of a cursor into a smooth, limited force on the handle. A
# critically damped second-order filter follows the cursor; a spring and damper from its state to the handle exert a
# force that is limited in magnitude. The farther a person moves the cursor into a wall, the harder the robot presses,
# up to that limit.
FOLLOWER_POSITION = 0  # of the filtered cursor [m], and velocity 3:6 [m/s], robot frame
HELD = 6  # 1: the pointer was active in the last tick
COUPLING_FORCE = 7  # on the handle 7:10 [N], robot frame
FOLLOW_RATE = 10  # natural frequency of the following [rad/s]
COUPLING_STIFFNESS = 11  # [N/m]
COUPLING_DAMPING = 12  # [N s/m]
COUPLING_LIMIT = 13  # [N]
COUPLING_LENGTH = 14


@kernel
def step_coupling(memory: Vec, handle: Vec, target: Vec, active: bool, dt: float) -> None:
    """Advance the coupling by one tick and write its force to memory[COUPLING_FORCE:COUPLING_FORCE + 3].

    Args:
        memory: State and parameters, shape [COUPLING_LENGTH].
        handle: Position [m] and velocity [m/s] of the handle, robot frame, shape [6].
        target: Position of the cursor, robot frame [m].
        active: False while the pointer is released: no force.
        dt: Tick [s].
    """
    force = memory[COUPLING_FORCE : COUPLING_FORCE + 3]
    if not active:
        memory[HELD] = 0.0
        fill(force, 0.0)
        return
    if memory[HELD] == 0.0:
        memory[HELD] = 1.0
        copy(handle[0:3], memory[FOLLOWER_POSITION : FOLLOWER_POSITION + 3])
        fill(memory[FOLLOWER_POSITION + 3 : FOLLOWER_POSITION + 6], 0.0)
    w = memory[FOLLOW_RATE]
    for i in range(3):
        x = memory[FOLLOWER_POSITION + i]
        v = memory[FOLLOWER_POSITION + 3 + i]
        v += dt * (w * w * (target[i] - x) - 2.0 * w * v)
        x += dt * v
        memory[FOLLOWER_POSITION + i] = x
        memory[FOLLOWER_POSITION + 3 + i] = v
        force[i] = memory[COUPLING_STIFFNESS] * (x - handle[i]) + memory[COUPLING_DAMPING] * (v - handle[3 + i])
    clamp_norm(force, memory[COUPLING_LIMIT])


_SETTINGS = {
    "hand_force": (COUPLING_LIMIT, 15.0),  # [N]
    "hand_stiffness": (COUPLING_STIFFNESS, 800.0),  # [N/m]
    "hand_damping": (COUPLING_DAMPING, 90.0),  # [N s/m]: critical for 3 kg
    "follow_rate": (
        FOLLOW_RATE,
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
