"""Properties of the controller that acts: the loop asks for these, never for its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.function_pointers import FUNCTION_WORDS
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.controller_port import CONTROL_INPUT, CONTROL_OUTPUT, CONTROLLER_MEMORY
from mimics_app.contracts.loop.controller_slots import MAX_CONTROLLERS, CommandKind, Lead

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord

__all__ = ["CONTROL", "drives_to_target", "moves_mass", "person_leads", "renders_force"]

CONTROL = np.dtype(
    [
        ("functions", "i8", (MAX_CONTROLLERS, FUNCTION_WORDS)),  # addresses of the controllers, by slot
        ("slot", "i8"),  # of the controller that acted in the last tick, 0: none
        ("now", CONTROL_INPUT),
        ("out", CONTROL_OUTPUT),
        ("memory", "f8", (CONTROLLER_MEMORY,)),  # of the controller in `slot`
        ("added_force", "f8", CONTROL_OUTPUT["force"].shape),  # its force as limited, robot frame [N]
        ("added_torque", "f8", CONTROL_OUTPUT["torque"].shape),  # its torque as limited [N, N m]
    ],
    align=True,
)
"""What the controllers of one device read and write; zeros are the initial state."""


@kernel
def drives_to_target(scene: SceneRecord) -> bool:
    """Whether the controller drives the robot to SCENE.target: no virtual force acts."""
    return scene.leads[scene.controller] == Lead.TARGET


@kernel
def person_leads(scene: SceneRecord) -> bool:
    """Whether the person moves the robot: virtual forces act."""
    return scene.leads[scene.controller] == Lead.PERSON


@kernel
def moves_mass(scene: SceneRecord) -> bool:
    """Whether forces act on a simulated mass that the robot follows: admittance."""
    return person_leads(scene) and scene.commands[scene.controller] == CommandKind.VELOCITY


@kernel
def renders_force(scene: SceneRecord) -> bool:
    """Whether the device renders the virtual force with its drives: impedance."""
    return person_leads(scene) and scene.commands[scene.controller] != CommandKind.VELOCITY
