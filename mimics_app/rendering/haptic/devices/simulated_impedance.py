"""Simulated light robot that takes forces, with a simulated person or a relaxed arm."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_FORCE,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.maths.vec import all_finite
from mimics_app.rendering.haptic.descriptors.hapticmaster import axis_offset
from mimics_app.rendering.haptic.devices.device_settings import write_settings
from mimics_app.rendering.haptic.devices.dynamics import LIGHT_ENCODER, LIGHT_MASS, force_dynamics
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_person import move_person, write_person
from mimics_app.rendering.haptic.kernels import light_robot
from mimics_app.rendering.haptic.kernels.arm import ARM_LENGTH, GRIP_FORCE
from mimics_app.rendering.haptic.kernels.kinematics import forward
from mimics_app.rendering.haptic.kernels.light_robot import (
    HANDLE,
    LENGTH,
    TICK,
    command_force,
    sense_position,
    step_light_robot,
)

__all__ = ["build_simulated_impedance", "write_force"]


_SETTINGS = {
    "mass": (light_robot.MASS, LIGHT_MASS),  # felt at the handle [kg]
    "friction": (light_robot.DAMPING, 0.5),  # [N s/m]
    "motor_force": (light_robot.MOTOR_FORCE, 30.0),  # [N]
    "encoder": (light_robot.ENCODER, LIGHT_ENCODER),  # [m]
}


@typed_kernel(READ)
def _read_light_patient(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Simulate one tick of robot and person; write the sensor data. Memory: robot, then arm."""
    machine = memory[:LENGTH]
    person = memory[LENGTH:]
    if tick > 0:
        step_light_robot(machine, person[GRIP_FORCE : GRIP_FORCE + 3])
    move_person(person, machine[HANDLE : HANDLE + 6], 0, inbox, data, machine[TICK])
    sense_position(machine, data)
    return 0


@typed_kernel(WRITE)
def write_force(memory: Vec, command: Vec, tick: int) -> int:
    """Put the force on the user into the robot's delay line; without an enabled, finite one the motors brake."""
    force = command[COMMAND_FORCE : COMMAND_FORCE + 3]
    usable = all_finite(force)
    command_force(memory[:LENGTH], force, usable and command[COMMAND_ENABLED] != 0.0)
    return 0 if usable else 1


def build_simulated_impedance(request: DeviceRequest) -> DevicePlugin:
    """Build the light robot with the request's patient, or a relaxed arm.

    `robot.settings` may hold mass [kg], friction [N s/m], motor_force [N] and encoder [m].

    Raises:
        DeviceError: An unknown setting, or one that is not a positive number.
    """
    memory = np.zeros(LENGTH + ARM_LENGTH)
    _write_robot(memory[:LENGTH], request)
    write_person(memory[LENGTH:], request)
    return DevicePlugin(
        "simulated_impedance",
        _read_light_patient,
        write_force,
        memory,
        **force_dynamics(request.robot, request.rate),
        follows="force",
        simulated=True,
    )


def _write_robot(memory: Vec, request: DeviceRequest) -> None:
    wanted = request.robot
    d1 = axis_offset(wanted)
    write_settings(memory, _SETTINGS, wanted.settings, "simulated impedance device")
    memory[TICK] = 1.0 / request.rate
    memory[light_robot.AXIS_OFFSET] = d1
    limits = request.limits
    memory[light_robot.JOINT_MIN : light_robot.JOINT_MIN + 3] = limits.lowest
    memory[light_robot.JOINT_MAX : light_robot.JOINT_MAX + 3] = limits.highest
    memory[light_robot.DELAY] = wanted.delay_ticks
    forward(np.array(request.start_joints, np.float64), d1, memory[HANDLE : HANDLE + 3])
    memory[light_robot.SEEN : light_robot.SEEN + 3] = memory[HANDLE : HANDLE + 3]
