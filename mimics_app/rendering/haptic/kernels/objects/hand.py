"""What the objects see of the person in one tick: one vector, the only input from outside."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel

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
"""Haptic interaction point, world [m]."""
HAND_VELOCITY = 3
"""Its velocity, world [m/s]."""
HAND_FORCE_MEASURED = 6
"""Force of the user on the handle, world [N]."""
HAND_FORCE_USER = 9
"""What the user felt in the last tick, world [N]."""
HAND_GRASP = 12
"""Grasp force [N]."""
HAND_TIME = 13
"""Session time [s]."""
HAND_LENGTH = 14


@kernel
def write_hand(state: Any, dt: float, hand: NDArray[np.float64]) -> None:
    """Fill the vector, shape [HAND_LENGTH], from the STATE record."""
    for i in range(3):
        hand[HAND_POSITION + i] = state.hip_world[i]
        hand[HAND_VELOCITY + i] = state.v_world[i]
        hand[HAND_FORCE_MEASURED + i] = state.f_meas_world[i]
        hand[HAND_FORCE_USER + i] = state.f_user_world[i]
    hand[HAND_GRASP] = state.grasp
    hand[HAND_TIME] = state.tick * dt
