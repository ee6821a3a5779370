"""Treadmill and body-weight support: the belt under the feet, level, and the spring that carries a part of the weight.

A foot presses on the belt with the law of Hunt and Crossley (`contact_law`) and slides with Coulomb friction, which is
regularised below a small speed. The rope of the support only pulls.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley

__all__ = [
    "BELT_LAG",
    "BELT_ORDER",
    "BELT_SPEED",
    "PRETENSION",
    "ROPE_LENGTH",
    "ROPE_MAX",
    "ROPE_STIFFNESS",
    "SOLE_DAMPING",
    "SOLE_FRICTION",
    "SOLE_STIFFNESS",
    "TREADMILL",
    "move_belt",
    "rope_force",
    "sole_load",
]

BELT_ORDER = 0  # wanted speed backwards [m/s]
BELT_LAG = 1  # time constant [s]
BELT_SPEED = 2  # present speed backwards [m/s]
SOLE_STIFFNESS = 3  # of sole and belt [N/m]
SOLE_DAMPING = 4  # [N s/m^2]
SOLE_FRICTION = 5  # coefficient [-]
PRETENSION = 6  # of the rope where the pelvis is at ROPE_LENGTH [N]
ROPE_STIFFNESS = 7  # [N/m]
ROPE_LENGTH = 8  # height of the hips at which the rope has its pre-tension [m]
ROPE_MAX = 9  # largest force of the support [N]
TREADMILL = 10  # numbers in use

_SLIDING = 0.02
"""Speed on the belt from which friction is full [m/s]."""


@kernel
def move_belt(treadmill: Vec, runs: bool, dt: float) -> None:
    """Lead the belt for a tick of dt [s] towards its wanted speed, or where it may not run to rest."""
    wish = treadmill[BELT_ORDER] if runs else 0.0
    treadmill[BELT_SPEED] += (1.0 - math.exp(-dt / treadmill[BELT_LAG])) * (wish - treadmill[BELT_SPEED])


@kernel
def sole_load(treadmill: Vec, depth: float, sinking: float, forwards: float) -> tuple[float, float]:
    """Force of the belt on a point of the sole, along and upwards [N].

    Args:
        treadmill: Record of `TREADMILL` numbers.
        depth: How far the point is below the surface [m]; not positive: no contact.
        sinking: Rate of the depth [m/s].
        forwards: Speed of the point forwards in the room [m/s].
    """
    up = hunt_crossley(depth, sinking, treadmill[SOLE_STIFFNESS], treadmill[SOLE_DAMPING], 1.0)
    slip = forwards + treadmill[BELT_SPEED]
    return -treadmill[SOLE_FRICTION] * up * slip / max(abs(slip), _SLIDING), up


@kernel
def rope_force(treadmill: Vec, height: float) -> float:
    """Force of the body-weight support on the pelvis upwards [N] at a height of the hips [m]."""
    pull = treadmill[PRETENSION] + treadmill[ROPE_STIFFNESS] * (treadmill[ROPE_LENGTH] - height)
    return min(treadmill[ROPE_MAX], max(0.0, pull))
