"""Input vector of the objects in one tick: motion, forces and grasp of the person's hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_fields import MAX_CONTACTS

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import StateRecord, Table

__all__ = [
    "HAND_FORCE_MEASURED",
    "HAND_FORCE_USER",
    "HAND_GRASP",
    "HAND_LENGTH",
    "HAND_POSITION",
    "HAND_TIME",
    "HAND_VELOCITY",
    "write_hand",
]

HAND_POSITION = 0
"""Positions of the points of contact, world [m], x y z concatenated; the first is the haptic interaction point."""
HAND_VELOCITY = HAND_POSITION + 3 * MAX_CONTACTS
"""Their velocities, world [m/s]."""
HAND_FORCE_MEASURED = HAND_VELOCITY + 3 * MAX_CONTACTS
"""Measured force of the user on the first point, world [N]."""
HAND_FORCE_USER = HAND_FORCE_MEASURED + 3
"""Force on the user there in the last tick, world [N]."""
HAND_GRASP = HAND_FORCE_USER + 3
"""Grasp force [N]."""
HAND_TIME = HAND_GRASP + 1
"""Session time [s]."""
HAND_LENGTH = HAND_TIME + 1
"""Length of the vector."""


@kernel
def write_hand(states: Table[StateRecord], contacts: int, dt: float, hand: NDArray[np.float64]) -> None:
    """Fill the vector, shape [HAND_LENGTH], from the STATE records of the points of contact."""
    for c in range(contacts):
        for i in range(3):
            hand[HAND_POSITION + 3 * c + i] = states[c].hip_world[i]
            hand[HAND_VELOCITY + 3 * c + i] = states[c].v_world[i]
    state = states[0]
    for i in range(3):
        hand[HAND_FORCE_MEASURED + i] = state.f_meas_world[i]
        hand[HAND_FORCE_USER + i] = state.f_user_world[i]
    hand[HAND_GRASP] = state.grasp
    hand[HAND_TIME] = state.tick * dt
