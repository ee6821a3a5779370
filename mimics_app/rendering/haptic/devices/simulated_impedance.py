"""A simulated light robot that is told forces, with a simulated person on it, or with nobody."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.kernel import typed_kernel
from mimics_app.contracts.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_FORCE,
    DATA_BUTTONS,
    DATA_GRASP,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    INBOX_TRIAL,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.patients import impairment_of, write_arm
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.kernels import arm, light_robot
from mimics_app.rendering.haptic.kernels.arm import ARM_LENGTH, GRIP_FORCE, step_arm
from mimics_app.rendering.haptic.kernels.kinematics import forward
from mimics_app.rendering.haptic.kernels.light_robot import (
    HANDLE,
    LENGTH,
    TICK,
    command_force,
    sense_position,
    step_light_robot,
)
from mimics_app.rendering.haptic.kernels.noise import seed_noise, uniform
from mimics_app.rendering.haptic.kernels.vectors import all_finite

__all__ = ["build_simulated_impedance", "read_light_patient", "write_force"]

Vec = NDArray[np.float64]

_SETTINGS = {
    "mass": (light_robot.MASS, 0.2),  # felt at the handle [kg]
    "friction": (light_robot.DAMPING, 0.5),  # [N s/m]
    "motor_force": (light_robot.MOTOR_FORCE, 30.0),  # [N]
    "encoder": (light_robot.ENCODER, 2e-5),  # [m]
}


@typed_kernel(READ)
def read_light_patient(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """One tick of robot and person; what the sensors show. Memory: robot, then arm."""
    machine = memory[:LENGTH]
    person = memory[LENGTH:]
    if tick > 0:
        step_light_robot(machine, person[GRIP_FORCE : GRIP_FORCE + 3])
    active = all_finite(inbox) and inbox[INBOX_ACTIVE] != 0.0
    handle = machine[HANDLE : HANDLE + 6]
    target = inbox[INBOX_TARGET : INBOX_TARGET + 3]
    data[DATA_GRASP] = step_arm(person, handle, active, inbox[INBOX_TRIAL], target, inbox[INBOX_GRASP], machine[TICK])
    data[DATA_BUTTONS] = inbox[INBOX_BUTTONS]
    sense_position(machine, data)
    return 0


@typed_kernel(WRITE)
def write_force(memory: Vec, command: Vec, tick: int) -> int:
    """The force on the user into the robot's delay line; without one that is enabled and finite the motors brake."""
    force = command[COMMAND_FORCE : COMMAND_FORCE + 3]
    usable = all_finite(force)
    command_force(memory[:LENGTH], force, usable and command[COMMAND_ENABLED] != 0.0)
    return 0 if usable else 1


def build_simulated_impedance(request: DeviceRequest) -> DevicePlugin:
    """The light robot, held by the request's patient, or by a relaxed arm when there is none.

    `robot.settings` may hold mass [kg], friction [N s/m], motor_force [N] and encoder [m].

    Raises:
        DeviceError: An unknown setting, or one that is not a positive number.
    """
    memory = np.zeros(LENGTH + ARM_LENGTH)
    _write_robot(memory[:LENGTH], request)
    person = memory[LENGTH:]
    seed_noise(person, arm.GENERATOR, 2 * request.seed + 1)
    if request.patient is None:
        person[arm.ARM_MASS] = 1.5
    else:
        write_arm(person, impairment_of(request.patient), request.way_robot, request.patient.intent)
        for axis in range(3):
            person[arm.TREMOR_PHASE + axis] = 2.0 * math.pi * uniform(person, arm.GENERATOR)
    delay = request.robot.delay_ticks / request.rate
    return DevicePlugin("simulated_impedance", read_light_patient, write_force, memory, delay=delay, follows="force")


def _write_robot(memory: Vec, request: DeviceRequest) -> None:
    wanted = request.robot
    d1 = wanted.stroke / 2.0 + wanted.offset if wanted.axis_offset is None else wanted.axis_offset
    for place, value in _SETTINGS.values():
        memory[place] = value
    for name, value in wanted.settings.items():
        if name not in _SETTINGS:
            raise DeviceError(f'the simulated impedance device has no setting "{name}"', nearest(name, _SETTINGS))
        if not isinstance(value, int | float) or not 0.0 < value < 1e5:
            raise DeviceError(f'the setting "{name}" is {value!r}', "give a positive number")
        memory[_SETTINGS[name][0]] = value
    memory[TICK] = 1.0 / request.rate
    memory[light_robot.AXIS_OFFSET] = d1
    memory[light_robot.JOINT_MIN : light_robot.JOINT_MIN + 3] = wanted.joint_min
    memory[light_robot.JOINT_MAX : light_robot.JOINT_MAX + 3] = wanted.joint_max
    memory[light_robot.DELAY] = wanted.delay_ticks
    forward(np.array(request.start_joints, np.float64), d1, memory[HANDLE : HANDLE + 3])
    memory[light_robot.SEEN : light_robot.SEEN + 3] = memory[HANDLE : HANDLE + 3]
