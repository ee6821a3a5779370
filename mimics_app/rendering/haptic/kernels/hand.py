"""Virtual hand of a pointing device: makes 60 Hz steps of a cursor into a smooth, limited force on the handle.

The virtual hand follows the cursor as a critically damped mass and pulls the handle by a spring and damper, whose force
vector is limited in magnitude. So the farther a person pulls the cursor into a wall, the harder the robot presses, up
to that limit.
"""

from __future__ import annotations

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.vectors import clamp_norm, copy, fill

__all__ = [
    "FOLLOW_RATE",
    "HAND_DAMPING",
    "HAND_FORCE",
    "HAND_LENGTH",
    "HAND_LIMIT",
    "HAND_STIFFNESS",
    "step_hand",
]


HAND_POSITION = 0  # position 0:3 [m] and velocity 3:6 [m/s], robot frame
HELD = 6  # 1: the pointer was active in the last tick
HAND_FORCE = 7  # on the handle 7:10 [N], robot frame
FOLLOW_RATE = 10  # natural frequency of the following [rad/s]
HAND_STIFFNESS = 11  # [N/m]
HAND_DAMPING = 12  # [N s/m]
HAND_LIMIT = 13  # [N]
HAND_LENGTH = 14


@kernel
def step_hand(hand: Vec, handle: Vec, target: Vec, active: bool, dt: float) -> None:
    """Advance the virtual hand by one tick and write its force to hand[HAND_FORCE:HAND_FORCE + 3].

    Args:
        hand: Hand memory, shape [HAND_LENGTH].
        handle: Position [m] and velocity [m/s] of the handle, robot frame, shape [6].
        target: Position of the cursor, robot frame [m].
        active: False while the pointer is released: no force.
        dt: Tick [s].
    """
    force = hand[HAND_FORCE : HAND_FORCE + 3]
    if not active:
        hand[HELD] = 0.0
        fill(force, 0.0)
        return
    if hand[HELD] == 0.0:
        hand[HELD] = 1.0
        copy(handle[0:3], hand[HAND_POSITION : HAND_POSITION + 3])
        fill(hand[HAND_POSITION + 3 : HAND_POSITION + 6], 0.0)
    w = hand[FOLLOW_RATE]
    for i in range(3):
        x = hand[HAND_POSITION + i]
        v = hand[HAND_POSITION + 3 + i]
        v += dt * (w * w * (target[i] - x) - 2.0 * w * v)
        x += dt * v
        hand[HAND_POSITION + i] = x
        hand[HAND_POSITION + 3 + i] = v
        force[i] = hand[HAND_STIFFNESS] * (x - handle[i]) + hand[HAND_DAMPING] * (v - handle[3 + i])
    clamp_norm(force, hand[HAND_LIMIT])
