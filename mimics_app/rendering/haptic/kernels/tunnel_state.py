"""State of one ball in one tunnel: its tracking from tick to tick, and the results of a tick."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import TunnelStateRecord

__all__ = ["TUNNEL_STATE", "TunnelStatus", "restart_tracking"]


class TunnelStatus(IntEnum):
    """Outcome of the last call of `tunnel_force`; the force is zero unless FOLLOWING."""

    NO_TUNNEL = 0
    FOLLOWING = 1
    NOT_FINITE = 2


TUNNEL_STATE = np.dtype(
    [
        # input, optional
        ("ball_radius_rate", "f8"),  # r_k' [m/s]; the caller sets it where the ball changes size, else 0
        # tracking: zeros are the initial state (see restart_tracking)
        ("tracking", "i8"),  # 0: the next call searches the whole tunnel
        ("s", "f8"),  # tunnel parameter of the closest bisector point [pieces], warm start of the next call
        ("distance", "f8"),  # of the ball centre from the bisector [m]
        ("tracked", "f8", (3,)),  # ball centre of the last call, world [m]
        ("ticks", "i8"),  # calls since the last full search
        ("restarts", "i8"),  # full searches since the state was zeroed
        # outputs
        ("status", "i8"),  # TunnelStatus
        ("progress", "f8"),  # share of the arc length, 0-1
        ("offset_n", "f8"),  # of the ball centre along n [m]
        ("offset_b", "f8"),  # of the ball centre along b [m]
        ("radius", "f8"),  # tunnel radius at s, scaled [m]
        ("penetration", "f8"),  # of the ball into wall or end cap, the deeper of the two, >= 0 [m]
        ("approach_speed", "f8"),  # rate of that depth [m/s], > 0: going in
        ("force_world", "f8", (3,)),  # total force of the tunnel on the user [N]
        ("assist_world", "f8", (3,)),  # its assistance [N]
        ("softening", "f8"),  # set by the caller: removed share of the wall's stiffness, 0-1
        ("damping_softening", "f8"),  # likewise of the wall's damping
        ("most_drag", "f8"),  # set by the caller: largest drag [N s/m]; 0: no limit
        ("most_centring", "f8"),  # likewise of the centring [N/m]
        ("share", "f8"),  # set by the caller: rendered share, 1 - softening before rounding
        ("force_tnb", "f8", (3,)),  # total force along t, n, b [N]
        ("wall_force", "f8"),  # magnitude of the force of wall and cap, >= 0 [N]
        ("normal_world", "f8", (3,)),  # out of the touched surface, unit; kept from the last contact
        ("tangent", "f8", (3,)),  # world, unit, towards the end
        ("normal_n", "f8", (3,)),  # n, world, unit
        ("binormal", "f8", (3,)),  # b, world, unit
    ],
    align=True,
)
"""Tracking and results of one ball in one tunnel; zeros are the initial state."""


@kernel
def restart_tracking(state: TunnelStateRecord) -> None:
    """Request a full search at the next call; in a tie it starts at the beginning of the tunnel."""
    state.tracking = 0
    state.s = 0.0
