"""The obstacle sequence in the loop: what the machine knows of both legs, and what its state makes of their inputs.

The share of the belt scales the reference towards standing, so that a patient stops and starts without a jump; the
guidance of a leg is that of the reference times its share; a hard object acts on the exploring leg alone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.rendering.haptic.control.lokomat.gait_limits import LEG_LIMITS, limit_leg, role_of, set_limits
from mimics_app.rendering.haptic.control.lokomat.obstacle_sequence import (
    SEQUENCE,
    SEQUENCE_FACTS,
    SEQUENCE_SETTINGS,
    SequenceCommand,
    begin_sequence,
    step_sequence,
)
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        ControlInputRecord,
        LegInputRecord,
        LegSettingsRecord,
        LegStateRecord,
        WalkRecord,
    )

__all__ = ["WALK", "begin_walk", "freed_leg", "guide_leg", "limit_walking_leg", "step_walk"]

WALK = np.dtype(
    [
        ("sequence", SEQUENCE),
        ("settings", SEQUENCE_SETTINGS),
        ("facts", SEQUENCE_FACTS),
        ("limits", LEG_LIMITS),
        ("walked", np.float64),  # time in `walking` [s]
        ("x", np.float64, 2),  # place of each foot, forward [m]
        ("distance", np.float64, 2),  # of each foot from the hard object [m]
        ("away", np.float64, (2, 2)),  # of each leg's reference from where the gait state leads it: hip, knee [rad]
        ("jacobian", np.float64, 4),  # scratch
        ("last", np.float64, (2, 2)),  # limited torques of each leg in the last tick [N m]
        ("called", np.int64),  # number of the street's obstacle that was called last
    ],
    align=True,
)
"""Gait state of both legs."""

_LONGEST = (0.0, 10.0, 10.0, 5.0, 5.0, 0.0, 10.0, 10.0, 20.0, 0.0)
"""Time limit of each state [s], 0: none; that of an exploration is a parameter."""

_GUIDANCE_TIME, _BELT_TIME, _SHOWN = 1.0, 1.5, 0.5
"""Times in which guidance and belt change from 0 to 1, and for which an obstacle is announced [s]."""

_STILL = 0.15
"""Largest joint speed of a leg that stands [rad/s]."""

_STUMBLES = 0.8
"""Joint speed from which one that stood does no longer [rad/s]."""

_STRAIGHT = 0.35
"""Largest knee flexion of an extended leg [rad]."""

_STANDING_HIP, _STANDING_KNEE = 0.0, 0.05
"""Standing pose, the start of the walk [rad]."""

_NEAR = 0.12
"""Largest distance of a joint from the start pose [rad]."""

_RETURN = 0.3
"""Speed at which the reference of a joint comes back from where its leg was taken up [rad/s]."""

_BEYOND = 0.05
"""Distance by which a foot oversteps [m]."""


@kernel
def begin_walk(walk: WalkRecord, exploration: float, dt: float) -> None:
    """Begin on the brakes, with the time limit of an exploration [s], and times in ticks of dt [s]."""
    begin_sequence(walk.sequence)
    settings = walk.settings
    settings.guidance[0] = settings.guidance[1] = 1.0
    settings.guidance_step, settings.belt_step = dt / _GUIDANCE_TIME, dt / _BELT_TIME
    settings.shown = int(_SHOWN / dt)
    for state in range(len(_LONGEST)):
        settings.longest[state] = int(_LONGEST[state] / dt)
    settings.longest[GaitState.EXPLORING] = int(exploration / dt)
    walk.walked = 0.0


@kernel
def _is_still(now: ControlInputRecord, leg: int, limit: float) -> bool:
    return abs(now.dq[2 * leg]) < limit and abs(now.dq[2 * leg + 1]) < limit


@kernel
def _at_start(now: ControlInputRecord, leg: int) -> bool:
    hip, knee = now.q[2 * leg] - _STANDING_HIP, now.q[2 * leg + 1] - _STANDING_KNEE
    return abs(hip) < _NEAR and abs(knee) < _NEAR


@kernel
def step_walk(walk: WalkRecord, now: ControlInputRecord, leg: int, called: bool, after: float, beyond: float) -> None:
    """Advance the sequence by one tick.

    Args:
        walk: WALK record.
        now: CONTROL_INPUT record.
        leg: Leg that is to explore, 0 left, 1 right.
        called: Whether a person calls the obstacle in this tick.
        after: Time of walking after which the obstacle appears [s]; 0: never.
        beyond: Place of the far side of the obstacle [m].
    """
    sequence, facts = walk.sequence, walk.facts
    free, released = sequence.free_leg, GaitState.LEG_RELEASED <= sequence.state <= GaitState.EXPLORING
    facts.command, facts.leg, facts.fault = SequenceCommand.NONE, leg, 0
    if sequence.state == GaitState.STANDING and sequence.cause == 0:
        facts.command = SequenceCommand.CONFIRM  # a person has started the session, or reset the stop
    walk.walked = walk.walked + now.dt if sequence.state == GaitState.WALKING else 0.0
    if called or 0.0 < after < walk.walked:
        facts.command = SequenceCommand.OBSTACLE
    limit = _STUMBLES if facts.standing == 1 else _STILL
    still = _is_still(now, 1 - free, limit) and (released or _is_still(now, free, limit))
    facts.standing = 1 if sequence.belt == 0.0 and still else 0
    facts.at_obstacle = 1
    facts.clear = 1 if walk.distance[0] > 0.0 and walk.distance[1] > 0.0 else 0
    facts.overstepped = 1 if walk.x[free] > beyond + _BEYOND else 0
    facts.at_start = 1 if _at_start(now, 0) and _at_start(now, 1) else 0
    for side in range(2):
        facts.extended[side] = 1 if now.q[2 * side + 1] < _STRAIGHT else 0
    step_sequence(sequence, walk.settings, facts)


@kernel
def freed_leg(walk: WalkRecord) -> int:
    """Return the leg that an obstacle frees, from its announcement on: 1 left, 2 right, 0 none."""
    state = walk.sequence.state
    if GaitState.OBSTACLE_ENABLED <= state <= GaitState.GUIDANCE_RESTORED:
        return 1 + int(walk.sequence.free_leg)
    return 0


@kernel
def guide_leg(walk: WalkRecord, leg: int, own: LegInputRecord) -> None:
    """Scale reference and guidance of a leg by the gait state, and say whether the hard object acts on it.

    A leg that brakes hold, or that nothing leads, is taken up where it is, and led back slowly.
    """
    sequence, step = walk.sequence, _RETURN * own.dt
    loose = sequence.braked == 1 or sequence.guidance[leg] == 0.0
    for joint in range(2):
        rest = _STANDING_HIP if joint == 0 else _STANDING_KNEE
        led = rest + sequence.belt * (own.q_ref[joint] - rest)
        away = walk.away[leg, joint]
        left = own.q[joint] - led if loose else min(away + step, max(away - step, 0.0))
        own.q_ref[joint] = led + left
        own.dq_ref[joint] *= sequence.belt
        own.ddq_ref[joint] *= sequence.belt
        if not loose:
            own.dq_ref[joint] += (left - away) / own.dt
        walk.away[leg, joint] = left
        own.guidance[joint] *= sequence.guidance[leg]
    own.hard = 1 if sequence.hard == 1 and leg == sequence.free_leg else 0


@kernel
def limit_walking_leg(
    walk: WalkRecord, leg: int, settings: LegSettingsRecord, own: LegInputRecord, state: LegStateRecord
) -> None:
    """Limit state.tau by the leg's role, and note where its foot is."""
    x1, x2, z1, z2 = leg_jacobian(settings.frame.geometry, own.q)
    walk.jacobian[0], walk.jacobian[1], walk.jacobian[2], walk.jacobian[3] = x1, x2, z1, z2
    set_limits(role_of(walk.sequence, leg), walk.limits)
    limit_leg(walk.limits, walk.jacobian, own.dq, own.dt, state.tau, walk.last[leg])
    for joint in range(2):
        state.tau[joint] = walk.last[leg, joint]
    walk.x[leg] = state.x_real[0]
    walk.distance[leg] = state.surface.distance if settings.outline.count > 0 else math.inf
