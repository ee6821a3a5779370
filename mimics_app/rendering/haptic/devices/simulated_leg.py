"""One or two simulated legs on a gait orthosis; a simulated person moves every foot."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_TORQUE,
    DATA_AGE,
    DATA_DQ,
    DATA_Q,
    DATA_TORQUE,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.maths.vec import all_finite
from mimics_app.rendering.haptic.descriptors.leg import LENGTHS
from mimics_app.rendering.haptic.devices.device_settings import write_settings
from mimics_app.rendering.haptic.devices.dynamics import (
    COM_SHARE,
    GYRATION_SHARE,
    LEG_SERVO_HZ,
    SHANK_MASS,
    leg_dynamics,
)
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_person import move_person, write_person
from mimics_app.rendering.haptic.kernels import leg_machine as machine
from mimics_app.rendering.haptic.kernels.arm import ARM_LENGTH, GRIP_FORCE
from mimics_app.rendering.haptic.kernels.leg_kinematics import (
    GEOMETRY,
    HIP_WIDTH,
    foot_torques,
    foot_velocity,
    place_foot,
)
from mimics_app.rendering.haptic.kernels.leg_machine import LENGTH, order_leg, sense_leg, step_leg
from mimics_app.rendering.haptic.kernels.noise import seed_noise

__all__ = ["build_simulated_leg", "read_legs", "write_legs"]


_FOOT = ARM_LENGTH
_MACHINE = _FOOT + 6
_LEG = _MACHINE + LENGTH
"""Memory: the geometry, then for each leg the person's limb, place and velocity of its foot, and its machine."""

_SETTINGS = {
    "thigh_mass": (machine.THIGH_MASS, 9.0),  # [kg] thigh of a person of 75 kg (0.100) with its part of the orthosis
    "shank_mass": (machine.SHANK_MASS, SHANK_MASS),  # [kg]
    "drive_damping": (machine.DRIVE_DAMPING, 1.0),  # [N m s/rad]
    "servo_bandwidth_hz": (machine.SERVO, LEG_SERVO_HZ),  # [Hz]
    "torque_noise": (machine.SENSOR_NOISE, 0.05),  # [N m]
    "torque_quantum": (machine.SENSOR_QUANTUM, 0.02),  # [N m]
    "torque_range": (machine.SENSOR_RANGE, 150.0),  # [N m]
    "encoder": (machine.ENCODER, 1e-5),  # [rad]
}
_DRIVES = {"hip_torque": (machine.TORQUE_MAX, 120.0), "knee_torque": (machine.TORQUE_MAX + 1, 80.0)}  # [N m]
"""Peak torques of the magnitude of a gait orthosis; marked in docs/devices as not verified."""

_MODES = ("motion", "torque")

_DRIVE_INERTIA = (0.15, 0.08)
"""Inertia of hip and knee drive at the joint [kg m^2]."""


@kernel
def _of_leg(memory: Vec, number: int) -> Vec:
    """Part of the memory that belongs to one leg, shape [_LEG]."""
    return memory[GEOMETRY + number * _LEG : GEOMETRY + (number + 1) * _LEG]


@typed_kernel(READ)
def read_legs(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Simulate one tick of legs and person; write the sensor data."""
    geometry = memory[:GEOMETRY]
    for k in range(int(geometry[0])):
        own = _of_leg(memory, k)
        limb, foot, leg, at = own[:ARM_LENGTH], own[_FOOT:_MACHINE], own[_MACHINE:], 2 * k
        if tick > 0:
            step_leg(leg)
        q = leg[machine.Q : machine.Q + 2]
        place_foot(geometry, k, q, foot[0:3])
        foot_velocity(geometry, q, leg[machine.DQ : machine.DQ + 2], foot[3:6])
        move_person(limb, foot, k, inbox, data, leg[machine.TICK])
        foot_torques(geometry, q, limb[GRIP_FORCE : GRIP_FORCE + 3], leg[machine.PERSON : machine.PERSON + 2])
        shown = data[DATA_Q + at : DATA_Q + at + 2], data[DATA_DQ + at : DATA_DQ + at + 2]
        sense_leg(leg, shown[0], shown[1], data[DATA_TORQUE + at : DATA_TORQUE + at + 2])
    data[DATA_AGE] = 0.0
    return 0


@typed_kernel(WRITE)
def write_legs(memory: Vec, command: Vec, tick: int) -> int:
    """Put joint velocities or torques into the drives' delay lines; without enabled, finite ones the drives brake."""
    start = COMMAND_DQ if memory[GEOMETRY + _MACHINE + machine.MOTION] != 0.0 else COMMAND_TORQUE
    joints = 2 * int(memory[0])
    usable = all_finite(command[start : start + joints])
    for k in range(joints // 2):
        leg = _of_leg(memory, k)[_MACHINE:]
        order_leg(leg, command[start + 2 * k : start + 2 * k + 2], usable and command[COMMAND_ENABLED] != 0.0)
    return 0 if usable else 1


def _segment(leg: Vec, mass: int, com: int, inertia: int, length: float) -> None:
    """Write centre of mass and inertia of a segment of this length [m]."""
    leg[com] = COM_SHARE * length
    leg[inertia] = leg[mass] * (GYRATION_SHARE * length) ** 2


def _write_leg(leg: Vec, request: DeviceRequest, number: int, geometry: Vec, mode: str) -> None:
    own = (*LENGTHS, "mode")
    settings = {name: value for name, value in request.robot.settings.items() if name not in own}
    write_settings(leg, _SETTINGS | _DRIVES, settings, "simulated leg")
    leg[machine.SERVO] *= 2.0 * math.pi
    leg[machine.THIGH_LENGTH] = geometry[1]
    _segment(leg, machine.THIGH_MASS, machine.THIGH_COM, machine.THIGH_INERTIA, geometry[1])
    _segment(leg, machine.SHANK_MASS, machine.SHANK_COM, machine.SHANK_INERTIA, geometry[2])
    leg[machine.DRIVE_INERTIA : machine.DRIVE_INERTIA + 2] = _DRIVE_INERTIA
    leg[machine.SUPPORT] = 1.0
    limits, at = request.limits, 2 * number
    leg[machine.JOINT_MIN : machine.JOINT_MIN + 2] = limits.lowest[at : at + 2]
    leg[machine.JOINT_MAX : machine.JOINT_MAX + 2] = limits.highest[at : at + 2]
    standing = [min(most, max(least, 0.1)) for least, most in zip(limits.lowest, limits.highest, strict=True)]
    leg[machine.Q : machine.Q + 2] = leg[machine.MEASURED : machine.MEASURED + 2] = standing[at : at + 2]
    leg[machine.TICK] = 1.0 / request.rate
    leg[machine.DELAY] = request.robot.delay_ticks
    leg[machine.MOTION] = float(mode == "motion")
    seed_noise(leg, machine.NOISE, 2 * request.seed + 4 * number)


def build_simulated_leg(request: DeviceRequest) -> DevicePlugin:
    """Build one leg per point of contact of the descriptor, nearly stretched; a limb of the person moves each foot.

    `robot.settings` may hold mode ("motion", or "torque"), lengths thigh, shank, foot, hip_width [m], thigh_mass,
    shank_mass [kg], hip_torque, knee_torque [N m], drive_damping [N m s/rad], servo_bandwidth_hz, torque_noise,
    torque_quantum, torque_range [N m] and encoder [rad].

    Raises:
        DeviceError: An unknown setting or mode, or a setting that is not a positive number.
    """
    mode = request.robot.settings.get("mode", _MODES[0])
    if mode not in _MODES:
        raise DeviceError(f'the simulated leg has no mode "{mode}"', f"write {' or '.join(_MODES)}")
    _check_lengths(request)
    geometry = request.descriptor.geometry_of(request.robot)
    legs = len(request.descriptor.contacts)
    memory = np.zeros(GEOMETRY + legs * _LEG)
    memory[:GEOMETRY] = geometry[:GEOMETRY]
    for number in range(legs):
        first = GEOMETRY + number * _LEG
        beside = np.array([0.0, -geometry[HIP_WIDTH] * number, 0.0])
        write_person(memory[first : first + ARM_LENGTH], request, number, beside)
        _write_leg(memory[first + _MACHINE : first + _LEG], request, number, geometry, mode)
    return DevicePlugin(
        "simulated_leg" if len(request.descriptor.contacts) == 1 else "simulated_legs",
        read_legs,
        write_legs,
        memory,
        **leg_dynamics(request.robot, request.rate),
        follows="velocity" if mode == "motion" else "torque",
        simulated=True,
    )


def _check_lengths(request: DeviceRequest) -> None:
    for name in LENGTHS:
        value = request.robot.settings.get(name, LENGTHS[name])
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < 2.0:
            raise DeviceError(f'the length "{name}" of the leg is {value!r}', "give metres between 0 and 2")
