"""State of one effect from tick to tick, and its working values in a tick."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE

__all__ = ["EFFECT_MEMORY"]

EFFECT_MEMORY = np.dtype(
    [
        # inputs of this tick: the values of its row plus those of wires
        ("position", "f8", (3,)),  # as EFFECT.position
        ("size", "f8"),  # as EFFECT.force [N]
        ("stiffness", "f8"),  # [N/m] >= 0
        # kept from tick to tick
        ("quarantined", "i8"),  # 1: its field gave a number that is not finite
        ("sticking", "i8"),  # 1 while stick-slip holds
        ("anchor", "f8", (3,)),  # of stick-slip, from its place; in the frame of the body if it has one [m]
        ("path", TUNNEL_STATE),  # closest point of its path
        # of this tick
        ("p", "f8", (3,)),  # position of the hand or of the body acted on, from the place, world [m]
        ("v", "f8", (3,)),  # the same for the velocity [m/s]
        ("arm", "f8", (3,)),  # from the body's centre of mass to the place [m]
        ("force", "f8", (3,)),  # on the hand or on the body acted on, world [N]
        ("damper", "f8", (3,)),  # scratch
        ("held", "i8"),  # 1 while its spring or damper acts: it counts towards the stability limit
    ],
    align=True,
)
"""State of one effect; zeros are the initial state."""
