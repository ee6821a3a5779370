"""Input vector of the objects in one tick: motion, forces and grasp of the person."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import StateRecord, Table

__all__ = [
    "INPUT_FORCE_MEASURED",
    "INPUT_FORCE_USER",
    "INPUT_GRASP",
    "INPUT_LENGTH",
    "INPUT_POSITION",
    "INPUT_TIME",
    "INPUT_VELOCITY",
    "write_object_inputs",
]

INPUT_POSITION = 0
"""Positions of the points of contact, world [m], x y z concatenated; the first is the haptic interaction point."""
INPUT_VELOCITY = INPUT_POSITION + 3 * MAX_CONTACTS
"""Their velocities, world [m/s]."""
INPUT_FORCE_MEASURED = INPUT_VELOCITY + 3 * MAX_CONTACTS
"""Measured force of the user on each point, world [N], in the same layout."""
INPUT_FORCE_USER = INPUT_FORCE_MEASURED + 3 * MAX_CONTACTS
"""Force on the user there in the last tick, world [N]."""
INPUT_GRASP = INPUT_FORCE_USER + 3 * MAX_CONTACTS
"""Grasp force at each point [N]."""
INPUT_TIME = INPUT_GRASP + MAX_CONTACTS
"""Session time [s]."""
INPUT_LENGTH = INPUT_TIME + 1
"""Length of the vector."""


@kernel
def write_object_inputs(states: Table[StateRecord], contacts: int, dt: float, inputs: NDArray[np.float64]) -> None:
    """Fill the vector, shape [INPUT_LENGTH], from the STATE records of the points of contact."""
    for c in range(contacts):
        state = states[c]
        for i in range(3):
            inputs[INPUT_POSITION + 3 * c + i] = state.hip_world[i]
            inputs[INPUT_VELOCITY + 3 * c + i] = state.v_world[i]
            inputs[INPUT_FORCE_MEASURED + 3 * c + i] = state.f_meas_world[i]
            inputs[INPUT_FORCE_USER + 3 * c + i] = state.f_user_world[i]
        inputs[INPUT_GRASP + c] = state.grasp
    inputs[INPUT_TIME] = states[0].tick * dt
