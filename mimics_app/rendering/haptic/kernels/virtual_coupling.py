"""Virtual coupling of a pointing device: makes 60 Hz steps of a cursor into a smooth, limited force on the handle.

A critically damped second-order filter follows the cursor; a spring and damper from its state to the handle exert a
force that is limited in magnitude. The farther a person moves the cursor into a wall, the harder the robot presses, up
to that limit.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.vectors import clamp_norm, copy, fill

__all__ = [
    "COUPLING_DAMPING",
    "COUPLING_FORCE",
    "COUPLING_LENGTH",
    "COUPLING_LIMIT",
    "COUPLING_STIFFNESS",
    "FOLLOW_RATE",
    "step_coupling",
]


FOLLOWER_POSITION = 0  # of the filtered cursor [m], and velocity 3:6 [m/s], robot frame
HELD = 6  # 1: the pointer was active in the last tick
COUPLING_FORCE = 7  # on the handle 7:10 [N], robot frame
FOLLOW_RATE = 10  # natural frequency of the following [rad/s]
COUPLING_STIFFNESS = 11  # [N/m]
COUPLING_DAMPING = 12  # [N s/m]
COUPLING_LIMIT = 13  # [N]
COUPLING_LENGTH = 14


@kernel
def step_coupling(memory: Vec, handle: Vec, target: Vec, active: bool, dt: float) -> None:
    """Advance the coupling by one tick and write its force to memory[COUPLING_FORCE:COUPLING_FORCE + 3].

    Args:
        memory: State and parameters, shape [COUPLING_LENGTH].
        handle: Position [m] and velocity [m/s] of the handle, robot frame, shape [6].
        target: Position of the cursor, robot frame [m].
        active: False while the pointer is released: no force.
        dt: Tick [s].
    """
    force = memory[COUPLING_FORCE : COUPLING_FORCE + 3]
    if not active:
        memory[HELD] = 0.0
        fill(force, 0.0)
        return
    if memory[HELD] == 0.0:
        memory[HELD] = 1.0
        copy(handle[0:3], memory[FOLLOWER_POSITION : FOLLOWER_POSITION + 3])
        fill(memory[FOLLOWER_POSITION + 3 : FOLLOWER_POSITION + 6], 0.0)
    w = memory[FOLLOW_RATE]
    for i in range(3):
        x = memory[FOLLOWER_POSITION + i]
        v = memory[FOLLOWER_POSITION + 3 + i]
        v += dt * (w * w * (target[i] - x) - 2.0 * w * v)
        x += dt * v
        memory[FOLLOWER_POSITION + i] = x
        memory[FOLLOWER_POSITION + 3 + i] = v
        force[i] = memory[COUPLING_STIFFNESS] * (x - handle[i]) + memory[COUPLING_DAMPING] * (v - handle[3 + i])
    clamp_norm(force, memory[COUPLING_LIMIT])
