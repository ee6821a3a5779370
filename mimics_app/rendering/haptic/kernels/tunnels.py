"""All tunnels of a scene for one tick: which of them holds the ball, what it does, and what the sample holds.

A ball is in one tunnel at a time, as in a tube: that one alone pushes, drags and assists. It is the nearest when the
ball is put anywhere (the one whose wall is pressed least, the first of equals). From then on the ball stays in it
until its wall is pressed where another tunnel has room for the ball: then it is in that one, as where two tubes cross.
The force falls there and never rises, so handing over gives nobody energy.

Margin, cap and contact are those of the tunnel that holds the ball. Progress, distance and the like are of the
tunnel that the task is about (SCENE.own_tunnel), wherever the ball is; force and depth too, 0 while another holds it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.stability import spring_share, stiffness_limit
from mimics_app.rendering.haptic.kernels.tunnel import tunnel_force
from mimics_app.rendering.haptic.kernels.tunnel_state import TunnelStatus, restart_tracking

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        HoldingRecord,
        OwnTunnelRecord,
        SceneRecord,
        StateRecord,
        Table,
        TunnelRecord,
        TunnelStateRecord,
    )

__all__ = ["HOLDING", "OWN_TUNNEL", "follow_tunnels", "forget_tunnels", "share_in_touch"]


HOLDING = np.dtype(
    [
        ("there", "i8"),  # 1: a tunnel of the scene holds the ball
        ("row", "i8"),  # which
        ("chosen", "i8"),  # 1: the ball is in `row` until it gets into another; 0: find the nearest
        ("status", "i8"),  # TunnelStatus
        ("s", "f8"),  # tunnel parameter of the closest bisector point [pieces]
        ("penetration", "f8"),  # of the ball into wall or end cap, >= 0 [m]
        ("approach_speed", "f8"),  # rate of that depth [m/s]
        ("wall_force", "f8"),  # of wall and cap alone, >= 0 [N]
        ("force_world", "f8", (3,)),  # all of it on the user [N]
        ("assist_world", "f8", (3,)),  # what of it is assistance [N]
        ("normal_world", "f8", (3,)),  # out of the touched surface, unit; kept from the last contact
        # of its row
        ("stiffness", "f8"),  # [N/m]
        ("damping", "f8"),  # [N s/m]
        ("centring", "f8"),  # [N/m]
    ],
    align=True,
)
"""The tunnel that holds the ball; zeros are none."""

OWN_TUNNEL = np.dtype(
    [
        ("force_tnb", "f8", (3,)),  # of the task's own tunnel on the user, in its t, n, b [N]
        ("s", "f8"),  # [pieces]
        ("progress", "f8"),  # share of the arc length, 0-1
        ("distance", "f8"),  # of the ball from the bisector [m]
        ("offset_n", "f8"),  # along its n [m]
        ("offset_b", "f8"),  # along its b [m]
        ("penetration", "f8"),  # of the ball in its wall [m]
        ("radius", "f8"),  # at s, scaled [m]
    ],
    align=True,
)
"""What the sample holds of the task's own tunnel."""


@kernel
def share_in_touch(last: float, now: float, touching: bool) -> float:
    """A share that may fall at any time but rises only in free motion: a stiffening contact would make energy."""
    return min(last, now) if touching else now


@kernel
def forget_tunnels(tunnels: Table[TunnelStateRecord], state: StateRecord) -> None:
    """Search every tunnel anew, and find out anew which of them holds the ball."""
    state.tunnel.chosen = 0
    for k in range(len(tunnels)):
        restart_tracking(tunnels[k])


@kernel
def _stable_share(
    scene: SceneRecord, tunnel: TunnelRecord, state: StateRecord, own: float, delay: float, period: float
) -> float:
    """How much of the wall's stiffness is stable, 0-1, for the measured period and delay."""
    if scene.cap != 1 or tunnel.pieces <= 0:
        return 1.0
    limit = stiffness_limit(own + tunnel.damping, period, delay)
    helping = tunnel.centring * (1.0 + scene.cap_margin)
    return min(spring_share(tunnel.stiffness, limit - helping, scene.cap_margin), state.acting.both_share)


@kernel
def _follow_one(
    scene: SceneRecord,
    tunnel: TunnelRecord,
    memory: TunnelStateRecord,
    state: StateRecord,
    own: float,
    delay: float,
    period: float,
    holds: bool,
) -> None:
    """One tunnel as if it held the ball, its wall no stiffer than stable."""
    share = _stable_share(scene, tunnel, state, own, delay, period)
    if holds:
        share = share_in_touch(state.acting.wall_share, share, state.tunnel.penetration > 0.0)
    memory.share = share
    memory.softening = 1.0 - share
    memory.ball_radius_rate = state.ball_radius_rate
    tunnel_force(tunnel, state.hip_world, state.v_world, state.ball_radius, memory)


@kernel
def _holder(tunnels: Table[TunnelStateRecord], count: int, state: StateRecord) -> int:
    """Row of the tunnel that the ball is in from now on."""
    row = state.tunnel.row
    stays = state.tunnel.chosen == 1 and row < count and tunnels[row].status == TunnelStatus.FOLLOWING
    if stays and tunnels[row].penetration <= 0.0:
        return row
    best = row if stays else -1
    for k in range(count):
        if tunnels[k].status != TunnelStatus.FOLLOWING:
            continue
        if stays:
            if tunnels[k].penetration <= 0.0:
                return k
        elif best < 0 or tunnels[k].penetration < tunnels[best].penetration:
            best = k
    return max(best, 0)


@kernel
def _hold(tunnel: TunnelRecord, memory: TunnelStateRecord, holding: HoldingRecord) -> None:
    """What the tunnel that holds the ball does."""
    holding.there = 1 if tunnel.pieces > 0 else 0
    holding.status = memory.status
    holding.s = memory.s
    holding.penetration = memory.penetration
    holding.approach_speed = memory.approach_speed
    holding.wall_force = memory.wall_force
    for i in range(3):
        holding.force_world[i] = memory.force_world[i]
        holding.assist_world[i] = memory.assist_world[i]
        holding.normal_world[i] = memory.normal_world[i]
    holding.stiffness = tunnel.stiffness
    holding.damping = tunnel.damping
    holding.centring = tunnel.centring


@kernel
def _hold_nothing(holding: HoldingRecord) -> None:
    """The scene has no tunnel."""
    holding.there = 0
    holding.status = 0
    holding.penetration = 0.0
    holding.approach_speed = 0.0
    holding.wall_force = 0.0
    for i in range(3):
        holding.force_world[i] = 0.0
        holding.assist_world[i] = 0.0
    holding.stiffness = 0.0
    holding.damping = 0.0
    holding.centring = 0.0


@kernel
def _report_own(memory: TunnelStateRecord, reported: OwnTunnelRecord, holds: bool) -> None:
    """What the sample holds of the task's own tunnel."""
    reported.s = memory.s
    reported.progress = memory.progress
    reported.distance = memory.distance
    reported.offset_n = memory.offset_n
    reported.offset_b = memory.offset_b
    reported.radius = memory.radius
    reported.penetration = memory.penetration if holds else 0.0
    for i in range(3):
        reported.force_tnb[i] = memory.force_tnb[i] if holds else 0.0


@kernel
def follow_tunnels(
    scene: SceneRecord,
    rows: Table[TunnelRecord],
    tunnels: Table[TunnelStateRecord],
    state: StateRecord,
    own: float,
    delay: float,
    period: float,
) -> None:
    """Every tunnel for one tick: state.tunnel holds the ball, state.own_tunnel is the sample's view of the task's own.

    Args:
        scene: SCENE record.
        rows: TUNNEL records, as the main thread wants them.
        tunnels: TUNNEL_STATE records, advanced by one tick.
        state: STATE record after `size_ball`.
        own: Damping that every contact can count on [N s/m].
        delay: Of the device [s].
        period: Measured period [s].
    """
    count = scene.objects.tunnels
    if count < 1:
        state.acting.wall_share = 1.0
        _hold_nothing(state.tunnel)
        state.own_tunnel.penetration = 0.0
        for i in range(3):
            state.own_tunnel.force_tnb[i] = 0.0
        return
    for k in range(count):
        _follow_one(scene, rows[k], tunnels[k], state, own, delay, period, k == state.tunnel.row)
    row = _holder(tunnels, count, state)
    state.tunnel.row = row
    state.tunnel.chosen = 1
    state.acting.wall_share = tunnels[row].share
    _hold(rows[row], tunnels[row], state.tunnel)
    own_row = scene.own_tunnel
    _report_own(tunnels[own_row], state.own_tunnel, own_row == row)
