"""All tunnels of a scene for one tick: the one that holds the ball, its force, and the outputs of the task's tunnel.

A ball is in one tunnel at a time, as in a tube; only that one exerts force. At first it is the tunnel whose wall the
ball penetrates least (the first of equals). From then on it changes only where the ball touches its wall and lies
without contact in another tunnel, as at a crossing of two tubes: there the force drops and never rises, so the change
generates no energy.

Each point of contact has a ball of its own, which feels the tunnels of that point (TUNNEL.contact) and no others.

Margin, cap and contact are those of the tunnel that holds the ball. Progress, distance, force and depth in the sample
are those of the task's tunnel (SCENE.own_tunnel), of a point without it those of its first tunnel; force and depth are
0 while another one holds the ball.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.maths.vec import copy, fill
from mimics_app.rendering.haptic.kernels.closed_region import stiffness_limit
from mimics_app.rendering.haptic.kernels.stability import spring_share
from mimics_app.rendering.haptic.kernels.tunnel import tunnel_force
from mimics_app.rendering.haptic.kernels.tunnel_state import TunnelStatus, restart_tracking

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        HoldingRecord,
        OwnTunnelRecord,
        RegionRecord,
        SceneRecord,
        StateRecord,
        Table,
        TunnelRecord,
        TunnelStateRecord,
    )

__all__ = ["HOLDING", "OWN_TUNNEL", "follow_tunnels", "reset_tunnel_tracking", "share_in_touch"]


HOLDING = np.dtype(
    [
        ("there", "i8"),  # 1: a tunnel of the scene holds the ball
        ("row", "i8"),  # its row
        ("chosen", "i8"),  # 1: `row` is valid; 0: choose the nearest tunnel
        ("status", "i8"),  # TunnelStatus
        ("s", "f8"),  # tunnel parameter of the closest bisector point [pieces]
        ("penetration", "f8"),  # of the ball into wall or end cap, >= 0 [m]
        ("approach_speed", "f8"),  # rate of that depth [m/s]
        ("wall_force", "f8"),  # magnitude of the force of wall and cap, >= 0 [N]
        ("force_world", "f8", (3,)),  # total force on the user [N]
        ("assist_world", "f8", (3,)),  # its assistance [N]
        ("normal_world", "f8", (3,)),  # out of the touched surface, unit; kept from the last contact
        # of its row
        ("stiffness", "f8"),  # [N/m]
        ("damping", "f8"),  # as rendered [N s/m]
        ("centring", "f8"),  # as rendered [N/m]
    ],
    align=True,
)
"""The tunnel that holds the ball; zeros: none."""

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
"""Outputs of the task's own tunnel."""


@kernel
def share_in_touch(last: float, now: float, touching: bool) -> float:
    """Share that may fall at any time but rises only in free motion: a stiffening contact would generate energy."""
    return min(last, now) if touching else now


@kernel
def reset_tunnel_tracking(tunnels: Table[TunnelStateRecord], states: Table[StateRecord]) -> None:
    """Restart the tracking of every tunnel and the choice of the ones that hold the balls."""
    for c in range(len(states)):
        states[c].tunnel.chosen = 0
    for k in range(len(tunnels)):
        restart_tracking(tunnels[k])


@kernel
def _ease(scene: SceneRecord, tunnel: TunnelRecord, region: RegionRecord, memory: TunnelStateRecord) -> float:
    """Set what is removed of damping, drag and centring so that a stable rest remains; return the wall's damping.

    The damping is lowered to that of the largest stable stiffness where more of it leaves no room for the wall.
    """
    keep = 1.0 + scene.cap_margin
    memory.most_drag = region.most_damping / keep
    memory.most_centring = stiffness_limit(region, 0.0) / keep
    best, damping = region.best_damping, tunnel.damping
    softened = damping > best and stiffness_limit(region, damping) < keep * (tunnel.stiffness + tunnel.centring)
    memory.damping_softening = 1.0 - best / damping if softened else 0.0
    return best if softened else damping


@kernel
def _stable_share(scene: SceneRecord, tunnel: TunnelRecord, state: StateRecord, memory: TunnelStateRecord) -> float:
    """Stable share 0-1 of the wall's stiffness for the measured period and delay; its damping is softened."""
    if scene.cap != 1 or tunnel.pieces <= 0:
        memory.damping_softening, memory.most_drag, memory.most_centring = 0.0, math.inf, math.inf
        return 1.0
    damping = _ease(scene, tunnel, state.region, memory)
    limit = stiffness_limit(state.region, damping)
    helping = min(tunnel.centring, memory.most_centring) * (1.0 + scene.cap_margin)
    return min(spring_share(tunnel.stiffness, limit - helping, scene.cap_margin), state.acting.both_share)


@kernel
def _follow_one(
    scene: SceneRecord, tunnel: TunnelRecord, memory: TunnelStateRecord, state: StateRecord, holds: bool
) -> None:
    """Compute the force of one tunnel as if it held the ball, its wall no stiffer than stable."""
    share = _stable_share(scene, tunnel, state, memory)
    if holds:
        share = share_in_touch(state.acting.wall_share, share, state.tunnel.penetration > 0.0)
    memory.share = share
    memory.softening = 1.0 - share
    memory.ball_radius_rate = state.ball_radius_rate
    tunnel_force(tunnel, state.hip_world, state.v_world, state.ball_radius, memory)


@kernel
def _holder(
    rows: Table[TunnelRecord], tunnels: Table[TunnelStateRecord], count: int, state: StateRecord, contact: int
) -> int:
    """Row of the tunnel that holds the ball of a point of contact from this tick on; -1: no row is its."""
    row = state.tunnel.row
    stays = state.tunnel.chosen == 1 and row < count and tunnels[row].status == TunnelStatus.FOLLOWING
    stays = stays and rows[row].contact == contact
    if stays and tunnels[row].penetration <= 0.0:
        return row
    best, first = row if stays else -1, -1
    for k in range(count):
        if rows[k].contact != contact:
            continue
        first = k if first < 0 else first
        if tunnels[k].status != TunnelStatus.FOLLOWING:
            continue
        if stays:
            if tunnels[k].penetration <= 0.0:
                return k
        elif best < 0 or tunnels[k].penetration < tunnels[best].penetration:
            best = k
    return best if best >= 0 else first


@kernel
def _hold(tunnel: TunnelRecord, memory: TunnelStateRecord, holding: HoldingRecord) -> None:
    """Copy the results of the tunnel that holds the ball."""
    holding.there = 1 if tunnel.pieces > 0 else 0
    holding.status = memory.status
    holding.s = memory.s
    holding.penetration = memory.penetration
    holding.approach_speed = memory.approach_speed
    holding.wall_force = memory.wall_force
    copy(memory.force_world, holding.force_world)
    copy(memory.assist_world, holding.assist_world)
    copy(memory.normal_world, holding.normal_world)
    holding.stiffness = tunnel.stiffness
    holding.damping = tunnel.damping * (1.0 - memory.damping_softening)
    holding.centring = min(tunnel.centring, memory.most_centring)


@kernel
def _hold_nothing(holding: HoldingRecord) -> None:
    """Clear the results, for a scene without a tunnel."""
    holding.there = 0
    holding.status = 0
    holding.penetration = 0.0
    holding.approach_speed = 0.0
    holding.wall_force = 0.0
    fill(holding.force_world, 0.0)
    fill(holding.assist_world, 0.0)
    holding.stiffness = 0.0
    holding.damping = 0.0
    holding.centring = 0.0


@kernel
def _report_own(memory: TunnelStateRecord, reported: OwnTunnelRecord, holds: bool) -> None:
    """Copy the outputs of the task's own tunnel."""
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
def _own_row(scene: SceneRecord, rows: Table[TunnelRecord], contact: int) -> int:
    """Row of the tunnel that the sample describes for a point of contact that has one: the task's, else its first."""
    if rows[scene.own_tunnel].contact == contact:
        return scene.own_tunnel
    row = 0
    while rows[row].contact != contact:
        row += 1
    return row


@kernel
def follow_tunnels(
    scene: SceneRecord,
    rows: Table[TunnelRecord],
    tunnels: Table[TunnelStateRecord],
    state: StateRecord,
    contact: int,
) -> None:
    """Advance the tunnels of a point of contact; set state.tunnel, the one that holds the ball, and state.own_tunnel.

    Args:
        scene: SCENE record.
        rows: TUNNEL records, written by the main thread.
        tunnels: TUNNEL_STATE records; those of the point's tunnels are advanced by one tick.
        state: STATE record of the point after `size_ball`, with the region of this tick.
        contact: Number of the point.
    """
    count = scene.objects.tunnels
    for k in range(count):
        if rows[k].contact == contact:
            _follow_one(scene, rows[k], tunnels[k], state, k == state.tunnel.row)
    row = _holder(rows, tunnels, count, state, contact)
    if row < 0:
        state.acting.wall_share = 1.0
        _hold_nothing(state.tunnel)
        state.own_tunnel.penetration = 0.0
        fill(state.own_tunnel.force_tnb, 0.0)
        return
    state.tunnel.row = row
    state.tunnel.chosen = 1
    state.acting.wall_share = tunnels[row].share
    _hold(rows[row], tunnels[row], state.tunnel)
    own_row = _own_row(scene, rows, contact)
    _report_own(tunnels[own_row], state.own_tunnel, own_row == row)
