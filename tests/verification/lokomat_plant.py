"""The simulated gait orthosis for tests: its memory, without noise, and runs of some ticks."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    COMMAND_TORQUE,
    DATA_LENGTH,
    INBOX_LENGTH,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT, read_lokomat, write_lokomat
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis
from mimics_app.world.components.robot import Patient, Robot

__all__ = ["FRICTIONLESS", "drive_of", "leg_of", "plant_of", "play", "released"]

FRICTIONLESS = {
    "static_friction": 0.0,
    "coulomb_friction": 0.0,
    "viscous_friction": 0.0,
    "bearing_damping": 0.0,
    "rod_noise": 0.0,
    "encoder": 0.0,
}


def plant_of(**settings: object) -> np.ndarray:
    """Memory of `orthosis` of the simulated Lokomat with these settings and a person who does nothing."""
    robot = Robot(device="lokomat", delay_ticks=0, settings={"rod_noise": 0.0, "encoder": 0.0, **settings})
    return build_device(robot, Patient(intent=False)).memory[PLANT]


def leg_of(plant: np.ndarray, number: int) -> np.ndarray:
    """Record of a leg."""
    return plant[orthosis.LEGS + number * orthosis.LEG :][: orthosis.LEG]


def drive_of(plant: np.ndarray, leg: int, joint: int) -> np.ndarray:
    """Record of a drive."""
    first = orthosis.DRIVES + joint * linear_drive.DRIVE
    return leg_of(plant, leg)[first : first + linear_drive.DRIVE]


def released(**settings: object) -> np.ndarray:
    """Legs without drives, stops and friction: the rods are taken out, the spindles stay where they are."""
    plant = plant_of(**{**FRICTIONLESS, **settings})
    for number in range(2):
        leg = leg_of(plant, number)
        leg[orthosis.STOP_MIN : orthosis.STOP_MIN + 2], leg[orthosis.STOP_MAX : orthosis.STOP_MAX + 2] = -9.0, 9.0
        for joint in range(2):
            drive = drive_of(plant, number, joint)
            drive[linear_drive.ROD_STIFFNESS] = drive[linear_drive.ROD_DAMPING] = 0.0
    return plant


@kernel
def _play(memory, inbox, data, commands, rows):
    for k in range(commands.shape[0]):
        read_lokomat(memory, inbox, data, k)
        rows[k] = data
        write_lokomat(memory, commands[k], k)


def play(
    torques, ticks: int, *, enabled=True, patient=None, seed: int = 0, delay: int = 1, inbox=(), **settings: object
):
    """Run the device with joint torques [N m], shape [4] or [ticks, 4]; return its memory and its data, [ticks, n]."""
    robot = Robot(device="lokomat", delay_ticks=delay, settings=settings)
    plugin = build_device(robot, patient or Patient(intent=False), seed=seed)
    commands = np.zeros((ticks, COMMAND_LENGTH))
    commands[:, COMMAND_TORQUE : COMMAND_TORQUE + 4] = torques
    commands[:, COMMAND_ENABLED] = enabled
    rows, told = np.zeros((ticks, DATA_LENGTH)), np.zeros(INBOX_LENGTH)
    for place, value in dict(inbox).items():
        told[place] = value
    _play(plugin.memory, told, np.zeros(DATA_LENGTH), commands, rows)
    return plugin.memory, rows
