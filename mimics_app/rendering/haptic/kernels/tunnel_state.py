"""What is remembered of one ball in one tunnel, and what is known of it in a tick."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import TunnelStateRecord

__all__ = ["TUNNEL_STATE", "TunnelStatus", "restart_tracking"]


class TunnelStatus(IntEnum):
    """What the last call of `tunnel_force` could do; the force is zero unless FOLLOWING."""

    NO_TUNNEL = 0
    FOLLOWING = 1
    NOT_FINITE = 2


TUNNEL_STATE = np.dtype(
    [
        # input, optional
        ("ball_radius_rate", "f8"),  # r_k' [m/s]; the caller sets it where the ball changes size, else 0
        # tracking: zero means "start afresh" (see restart_tracking)
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
        ("force_world", "f8", (3,)),  # all of the tunnel on the user [N]
        ("assist_world", "f8", (3,)),  # what of it is assistance [N]
        ("softening", "f8"),  # set by the caller: share of the wall's stiffness that is left out, 0-1
        ("share", "f8"),  # the caller's own: what is rendered of it, 1 - softening before rounding
        ("force_tnb", "f8", (3,)),  # the same along t, n, b [N]
        ("wall_force", "f8"),  # magnitude of wall and cap alone, >= 0 [N]
        ("normal_world", "f8", (3,)),  # out of the touched surface, unit; kept from the last contact
        ("tangent", "f8", (3,)),  # world, unit, towards the end
        ("normal_n", "f8", (3,)),  # n, world, unit
        ("binormal", "f8", (3,)),  # b, world, unit
    ],
    align=True,
)
"""Memory and results of one ball in one tunnel. All zero is a valid start."""


@kernel
def restart_tracking(state: TunnelStateRecord) -> None:
    """Forget the branch: the next call searches the whole tunnel and, in a tie, starts at the beginning."""
    state.tracking = 0
    state.s = 0.0
