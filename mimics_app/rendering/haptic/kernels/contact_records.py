"""Records of a contact: its geometry and its friction, kept from tick to tick."""

from __future__ import annotations

import numpy as np

__all__ = ["CONTACT", "FRICTION"]

CONTACT = np.dtype(
    [
        ("depth", np.float64),  # [m], 0 outside
        ("normal", np.float64, 3),  # unit, outward, object frame
        ("previous", np.float64, 3),  # HIP' of the last call [m]
        ("feature", np.int32),  # cube: +-1, +-2, +-3 for the face; wall, sphere: 1; 0 outside
        ("inside", np.uint8),
        ("known", np.uint8),  # `previous` holds a point
    ],
    align=True,
)
"""Result of one contact test, and its memory until the next tick."""

FRICTION = np.dtype(
    [
        ("anchor", np.float64, 2),  # where the contact sticks [m] (Hayward & Armstrong)
        ("bristle", np.float64, 2),  # mean deflection of the bristles [m] (LuGre)
        ("touching", np.uint8),
        ("sticking", np.uint8),  # the last call held the load
    ],
    align=True,
)
"""Friction state of one contact; zeros are the initial state."""
