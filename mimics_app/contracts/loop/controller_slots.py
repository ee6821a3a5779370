"""Places of a session's controllers, and the closed set of properties by which the loop knows one.

A session has up to MAX_CONTROLLERS controllers, each in a slot of the parameter block (SCENE); SCENE.controller selects
one. The loop compares properties of the selected one, never its name.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from mimics_app.contracts.arrays import Records

__all__ = [
    "CONTROLLER_NAME",
    "CONTROLLER_PARAMETERS",
    "MAX_CONTROLLERS",
    "MAX_OBSTACLES",
    "CommandKind",
    "Lead",
    "Slot",
    "TargetKind",
    "name_bytes",
    "names_in",
]

MAX_CONTROLLERS = 6
"""Number of slots of a session."""

CONTROLLER_PARAMETERS = 96
"""Number of parameters of a controller; those it does not use are 0."""

MAX_OBSTACLES = 16
"""Largest number of obstacles of a controller that a person may call by name."""

CONTROLLER_NAME = 32
"""Longest name of a controller, ASCII characters."""


class Slot(IntEnum):
    """Slots that a task selects; those behind are free for others."""

    OFF = 0  # no controller: the command decays to zero
    HOLD = 1  # holds the joints of SCENE.target
    START = 2  # drives to the start of a trial
    PERSON = 3  # while the person moves the robot


class Lead(IntEnum):
    """Who moves the robot under a controller."""

    NOBODY = 0  # an empty slot
    TARGET = 1  # the controller drives it to SCENE.target; no virtual force acts
    PERSON = 2  # the person; virtual forces act


class CommandKind(IntEnum):
    """Physical quantity that a controller commands."""

    VELOCITY = 0  # of the joints; a device that takes forces is drawn along a reference with this velocity
    FORCE = 1  # at the points of contact, beside the virtual force
    TORQUE = 2  # at the joints, beside that of the virtual force


class TargetKind(IntEnum):
    """Meaning of SCENE.target for a controller that drives to it."""

    JOINTS = 0  # joints [m, rad]
    POINTS = 1  # points of contact, robot frame [m]


def name_bytes(name: str) -> Records:
    """Return a controller's name as the bytes of SCENE.controller_names, shape [CONTROLLER_NAME]; "": an empty slot."""
    row = np.zeros(CONTROLLER_NAME, np.uint8)
    row[: len(name)] = np.frombuffer(name.encode("ascii"), np.uint8)
    return row


def names_in(rows: Records) -> tuple[str, ...]:
    """Return the names in SCENE.controller_names, by slot; "" for an empty one."""
    return tuple(bytes(row).rstrip(b"\0").decode("ascii") for row in np.asarray(rows, np.uint8))
