"""Simulated HapticMaster with a simulated person or a relaxed arm."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.maths.vec import all_finite
from mimics_app.rendering.haptic.descriptors.hapticmaster import axis_offset
from mimics_app.rendering.haptic.devices.dynamics import ENCODER_QUANTUM, servo_dynamics
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_person import move_person, write_person
from mimics_app.rendering.haptic.kernels import robot
from mimics_app.rendering.haptic.kernels.arm import ARM_LENGTH, GRIP_FORCE
from mimics_app.rendering.haptic.kernels.noise import seed_noise
from mimics_app.rendering.haptic.kernels.robot import (
    HANDLE,
    ROBOT_LENGTH,
    TICK,
    coast_robot,
    command_robot,
    sense,
    step_robot,
)

__all__ = ["build_simulated_hapticmaster", "read_patient", "write_robot", "write_robot_memory"]


@typed_kernel(READ)
def read_patient(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Simulate one tick of robot and person; write the sensor data. Memory: robot, then arm."""
    machine = memory[:ROBOT_LENGTH]
    person = memory[ROBOT_LENGTH:]
    if tick > 0:
        step_robot(machine)
    move_person(person, machine[HANDLE : HANDLE + 6], 0, inbox, data, machine[TICK])
    sense(machine, person[GRIP_FORCE : GRIP_FORCE + 3], data)
    return 0


@typed_kernel(WRITE)
def write_robot(memory: Vec, command: Vec, tick: int) -> int:
    """Put joint velocities into the robot's delay line; without enabled, finite ones the robot coasts."""
    machine, dq = memory[:ROBOT_LENGTH], command[COMMAND_DQ : COMMAND_DQ + 3]
    usable = all_finite(dq)
    if usable and command[COMMAND_ENABLED] != 0.0:
        command_robot(machine, dq)
    else:
        coast_robot(machine)
    return 0 if usable else 1


def write_robot_memory(memory: Vec, request: DeviceRequest) -> None:
    """Fill a robot's memory, shape [robot.ROBOT_LENGTH], from the scene's robot component."""
    wanted = request.robot
    d1 = axis_offset(wanted)
    memory[robot.Q : robot.Q + 3] = request.start_joints
    memory[robot.MEASURED : robot.MEASURED + 3] = request.start_joints
    memory[robot.AXIS_OFFSET] = d1
    limits = request.limits
    memory[robot.JOINT_MIN : robot.JOINT_MIN + 3] = limits.lowest
    memory[robot.JOINT_MAX : robot.JOINT_MAX + 3] = limits.highest
    memory[robot.SERVO] = 2.0 * math.pi * wanted.servo_bandwidth_hz
    memory[robot.MASSES : robot.MASSES + 3] = wanted.masses
    memory[robot.DRIVE_FORCE] = wanted.force_limit
    memory[robot.VELOCITY_LIMIT : robot.VELOCITY_LIMIT + 3] = limits.velocity
    memory[robot.ENCODER : robot.ENCODER + 3] = (ENCODER_QUANTUM, ENCODER_QUANTUM / d1, ENCODER_QUANTUM)
    memory[robot.SENSOR_NOISE] = wanted.sensor_noise
    memory[robot.SENSOR_QUANTUM] = wanted.sensor_quantum
    memory[robot.SENSOR_GAIN] = 1.0
    memory[robot.TICK] = 1.0 / request.rate
    memory[robot.DELAY] = wanted.delay_ticks
    seed_noise(memory, robot.NOISE, 2 * request.seed)
    robot.place_handle(memory)


def build_simulated_hapticmaster(request: DeviceRequest) -> DevicePlugin:
    """Build the simulated robot with the request's patient, or a relaxed arm."""
    memory = np.zeros(ROBOT_LENGTH + ARM_LENGTH)
    write_robot_memory(memory[:ROBOT_LENGTH], request)
    write_person(memory[ROBOT_LENGTH:], request)
    return DevicePlugin(
        "simulated_hapticmaster",
        read_patient,
        write_robot,
        memory,
        simulated=True,
        **servo_dynamics(request.robot, request.rate),
    )
