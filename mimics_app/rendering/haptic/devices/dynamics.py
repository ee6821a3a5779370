"""Dynamics of the simulated robots for the stability limit: delay, servo, velocity filter and mass, from the scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypedDict

from mimics_app.rendering.haptic.kernels import light_robot
from mimics_app.rendering.haptic.kernels import robot as servo_robot

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Robot

__all__ = [
    "ENCODER_QUANTUM",
    "LIGHT_ENCODER",
    "LIGHT_MASS",
    "Dynamics",
    "force_dynamics",
    "servo_dynamics",
    "simulated_dynamics",
]

LIGHT_MASS = 0.2
"""Mass of the simulated light robot at its handle, unless the scene sets one [kg]."""

ENCODER_QUANTUM = 4e-6
"""Resolution of the simulated HapticMaster's position [m]; the vendor says 4-12 um (not verified)."""

LIGHT_ENCODER = 2e-5
"""The same of the simulated light robot, unless the scene sets one [m]."""

_SERVO_DEVICES = ("simulated_hapticmaster", "pointer")
_FORCE_DEVICES = ("simulated_impedance",)


class Dynamics(TypedDict):
    """Fields of a `DevicePlugin`: delay, lag and filtering [s], quantum [m], mass [kg]."""

    delay: float
    lag: float
    filtering: float
    quantum: float
    mass: float


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


def _setting(robot: Robot, name: str, default: float) -> float:
    """Return a setting of the scene's device if it is a positive number."""
    given = robot.settings.get(name, default)
    return float(given) if isinstance(given, int | float) and given > 0.0 else default


def simulated_dynamics(robot: Robot, rate: int = 1000) -> Dynamics | None:
    """Return the dynamics of a scene's robot; None for one that is not simulated, whose delay is measured."""
    if robot.device in _SERVO_DEVICES:
        return servo_dynamics(robot, rate)
    return force_dynamics(robot, rate) if robot.device in _FORCE_DEVICES else None
