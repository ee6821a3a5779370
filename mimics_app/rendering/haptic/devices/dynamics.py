"""Dynamics of the devices for the stability limit, before they are open and after: delay, servo, filter and mass."""

from __future__ import annotations

import math
from types import FunctionType
from typing import TYPE_CHECKING, cast

from mimics_app.contracts.loop.device_descriptor import Dynamics
from mimics_app.contracts.loop.loop_ports import LIGHTEST_DEVICE
from mimics_app.contracts.ports.members import load_member
from mimics_app.rendering.haptic import devices
from mimics_app.rendering.haptic.descriptors.segments import HEIGHT, WEIGHT, segments_of
from mimics_app.rendering.haptic.devices.address import port_and_baud, split_device
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, load_built_in
from mimics_app.rendering.haptic.devices.serial_frames import (
    BITS_PER_BYTE,
    COMMAND_PAYLOAD,
    OVERHEAD,
    STATE_PAYLOAD,
)
from mimics_app.rendering.haptic.kernels import leg_machine, light_robot
from mimics_app.rendering.haptic.kernels import robot as servo_robot
from mimics_app.rendering.haptic.kernels.lokomat import orthosis

if TYPE_CHECKING:
    from mimics_app.contracts.loop.loop_ports import DevicePlugin
    from mimics_app.world.components.robot import Robot

__all__ = [
    "COM_SHARE",
    "ENCODER_QUANTUM",
    "GYRATION_SHARE",
    "LEG_SERVO_HZ",
    "LIGHT_ENCODER",
    "LIGHT_MASS",
    "LOKOMAT_CURRENT_LAG",
    "LOKOMAT_NAME",
    "SHANK_MASS",
    "force_dynamics",
    "known_dynamics",
    "leg_dynamics",
    "lokomat_dynamics",
    "opened_dynamics",
    "serial_dynamics",
    "servo_dynamics",
    "undelayed_dynamics",
]

LIGHT_MASS = 0.2
"""Mass of the simulated light robot at its handle, unless the scene sets one [kg]."""

ENCODER_QUANTUM = 4e-6
"""Resolution of the simulated HapticMaster's position [m]; the vendor says 4-12 um (not verified)."""

LIGHT_ENCODER = 2e-5
"""The same of the simulated light robot, unless the scene sets one [m]."""

COM_SHARE, GYRATION_SHARE = 0.433, 0.32
"""Centre of mass and radius of gyration of a segment of the leg as shares of its length (Winter)."""

_END_SHARE = 1.0 / (1.0 + ((1.0 - COM_SHARE) / GYRATION_SHARE) ** 2)
"""Share of a free segment's mass that is felt at its end: less than that of a shank on its thigh."""

SHANK_MASS, LEG_SERVO_HZ = 5.0, 15.0
"""Shank and foot (0.061 of a person of 75 kg) with their part of the orthosis, and bandwidth of the simulated leg's
servo, unless the scene sets them [kg, Hz]."""

LOKOMAT_NAME, LOKOMAT_CURRENT_LAG = "lokomat", 5e-4
"""Name of the gait orthosis, and time constant of its current control [s]; a setting, not verified."""


def servo_dynamics(robot: Robot, rate: int) -> Dynamics:
    """Return those of the simulated HapticMaster: the delay line and the lag of its velocity servo."""
    servo = 1.0 / (2.0 * math.pi * robot.servo_bandwidth_hz)
    filtering = 1.0 / (2.0 * math.pi * servo_robot.SPEED_FILTER_HZ)
    delay = robot.delay_ticks / rate + servo
    return {"delay": delay, "lag": servo, "filtering": filtering, "quantum": ENCODER_QUANTUM, "mass": 0.0}


def force_dynamics(robot: Robot, rate: int) -> Dynamics:
    """Return those of the simulated light robot, which takes forces."""
    mass, quantum = _setting(robot, "mass", LIGHT_MASS), _setting(robot, "encoder", LIGHT_ENCODER)
    filtering = 1.0 / (2.0 * math.pi * light_robot.SPEED_FILTER_HZ)
    delay = robot.delay_ticks / rate
    return {"delay": delay, "lag": 0.0, "filtering": filtering, "quantum": quantum, "mass": mass}


def leg_dynamics(robot: Robot, rate: int) -> Dynamics:
    """Return those of the simulated legs, which take velocities, or torques."""
    moves = robot.settings.get("mode", "motion") == "motion"
    lag = 1.0 / (2.0 * math.pi * _setting(robot, "servo_bandwidth_hz", LEG_SERVO_HZ)) if moves else 0.0
    mass = 0.0 if moves else _setting(robot, "shank_mass", SHANK_MASS) * _END_SHARE
    filtering = 1.0 / (2.0 * math.pi * leg_machine.SPEED_FILTER_HZ)
    return {"delay": robot.delay_ticks / rate + lag, "lag": lag, "filtering": filtering, "quantum": 0.0, "mass": mass}


def lokomat_dynamics(robot: Robot, rate: int) -> Dynamics:
    """Return those of the simulated gait orthosis, which takes torques; the spindles' masses are not counted on."""
    shank = segments_of(robot.settings.get("height", HEIGHT), robot.settings.get("weight", WEIGHT)).masses[1]
    filtering = 1.0 / (2.0 * math.pi * orthosis.SPEED_FILTER_HZ)
    delay = robot.delay_ticks / rate + LOKOMAT_CURRENT_LAG
    return {"delay": delay, "lag": 0.0, "filtering": filtering, "quantum": 0.0, "mass": shank * _END_SHARE}


def _setting(robot: Robot, name: str, default: float) -> float:
    """Return a setting of the scene's device if it is a positive number."""
    given = robot.settings.get(name, default)
    return float(given) if isinstance(given, int | float) and given > 0.0 else default


def undelayed_dynamics(robot: Robot, rate: int) -> Dynamics:
    """Return those of a real device that takes velocities, whose delay is measured: what it cannot hold without any."""
    del robot, rate
    return {"delay": 0.0, "lag": 0.0, "filtering": 0.0, "quantum": 0.0, "mass": 0.0}


def serial_dynamics(robot: Robot, rate: int) -> Dynamics:
    """Return those of a robot on a serial line: at least the time of a command and of a state on the line."""
    address = split_device(robot.device).address
    _, baud = port_and_baud(address) if address else ("", math.inf)
    delay = BITS_PER_BYTE * (COMMAND_PAYLOAD + STATE_PAYLOAD + 2 * OVERHEAD) / baud
    return {**undelayed_dynamics(robot, rate), "delay": delay}


def opened_dynamics(plugin: DevicePlugin) -> Dynamics | None:
    """Return those that an open device states; None of one that moves nothing."""
    if plugin.follows not in ("velocity", "force", "torque"):
        return None
    mass = 0.0 if plugin.follows == "velocity" else plugin.mass or LIGHTEST_DEVICE
    return {
        "delay": plugin.delay,
        "lag": plugin.lag,
        "filtering": plugin.filtering,
        "quantum": plugin.quantum,
        "mass": mass,
    }


def known_dynamics(robot: Robot, rate: int = 1000) -> Dynamics | None:
    """Return what is known of a scene's robot before it runs; None: nothing, the live limit alone counts."""
    name = split_device(robot.device).name
    if name in BUILT_IN:
        module, _, function = load_built_in(name).dynamics.partition(":")
        if not function:
            return None
        return cast("Dynamics", load_member(devices, module, function, FunctionType)(robot, rate))
    declared = descriptor_of(name).dynamics
    return None if declared is None else declared(robot, rate)
