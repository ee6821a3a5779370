"""What one effect remembers, and what it works with in a tick."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE

__all__ = ["EFFECT_MEMORY"]

EFFECT_MEMORY = np.dtype(
    [
        # inputs of this tick: the row's own values with what wires add
        ("position", "f8", (3,)),  # as EFFECT.position
        ("size", "f8"),  # as EFFECT.force [N]
        ("stiffness", "f8"),  # [N/m] >= 0
        # kept from tick to tick
        ("quarantined", "i8"),  # 1: its field gave a number that is not finite
        ("sticking", "i8"),  # 1 while stick-slip holds
        ("anchor", "f8", (3,)),  # where it holds, from its place; in the body's frame where it has one [m]
        ("path", TUNNEL_STATE),  # closest point of its path
        # of this tick
        ("p", "f8", (3,)),  # of what feels it, from its place, world [m]
        ("v", "f8", (3,)),  # likewise [m/s]
        ("arm", "f8", (3,)),  # from the body's centre of mass to the place [m]
        ("force", "f8", (3,)),  # on what feels it, world [N]
        ("damper", "f8", (3,)),  # scratch
        ("held", "i8"),  # 1 while its spring is drawn: it counts towards the stability limit
    ],
    align=True,
)
"""One effect. All zero is a fresh one."""
