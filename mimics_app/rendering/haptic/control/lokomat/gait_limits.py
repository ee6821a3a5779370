"""Limits of a leg by gait state: force, its rise, power and stiffness of what a controller may do to it.

A leg that walks may feel soft objects only; hard ones, and the stiffness they need, belong to a leg that stands. The
numbers are those of this table and of the machine: no parameter of a scene, a task or a plug-in names them. A scene
narrows them by its own limits (`safety`), which hold behind these for all points of contact.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.maths.vec import fill, scale
from mimics_app.rendering.haptic.kernels.limiter import limit_torques

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import LegLimitsRecord, SequenceRecord

__all__ = ["LEG_LIMITS", "LegRole", "limit_leg", "role_of", "set_limits"]


class LegRole(IntEnum):
    """What a leg does in the present gait state."""

    WALKING = 0
    EXPLORING = 1  # free, beside a leg that stands
    HELD = 2  # stands, or is moved slowly by the drives
    BRAKED = 3  # no current


LEG_LIMITS = np.dtype(
    [
        ("force", np.float64),  # at the foot [N]
        ("rise", np.float64),  # [N/s]
        ("power", np.float64),  # of the torques on the leg [W]
        ("stiffness", np.float64),  # of objects [N/m]
    ],
    align=True,
)

_WALKING_FORCE, _WALKING_RISE, _WALKING_POWER, _WALKING_STIFFNESS = 150.0, 4000.0, 150.0, 1500.0
_EXPLORING_FORCE, _EXPLORING_RISE, _EXPLORING_POWER, _EXPLORING_STIFFNESS = 120.0, 20_000.0, 100.0, 50_000.0
_HELD_FORCE, _HELD_RISE, _HELD_POWER, _HELD_STIFFNESS = 250.0, 4000.0, 60.0, 0.0
"""Settings of a plausible size, not verified by a source: an exploring foot feels a hard edge quickly and weakly."""


@kernel
def role_of(sequence: SequenceRecord, leg: int) -> int:
    """Return the LegRole of a leg, 0 left, 1 right."""
    if sequence.braked == 1:
        return LegRole.BRAKED
    state = sequence.state
    if state == GaitState.WALKING or state == GaitState.OBSTACLE_ENABLED or state == GaitState.RESUMING:
        return LegRole.WALKING
    if GaitState.COLLISION_ENABLED <= state <= GaitState.EXPLORING and leg == sequence.free_leg:
        return LegRole.EXPLORING
    return LegRole.HELD


@kernel
def set_limits(role: int, limits: LegLimitsRecord) -> None:
    """Set the limits of a leg in a role."""
    limits.force = limits.rise = limits.power = limits.stiffness = 0.0
    if role == LegRole.WALKING:
        limits.force, limits.rise = _WALKING_FORCE, _WALKING_RISE
        limits.power, limits.stiffness = _WALKING_POWER, _WALKING_STIFFNESS
    elif role == LegRole.EXPLORING:
        limits.force, limits.rise = _EXPLORING_FORCE, _EXPLORING_RISE
        limits.power, limits.stiffness = _EXPLORING_POWER, _EXPLORING_STIFFNESS
    elif role == LegRole.HELD:
        limits.force, limits.rise = _HELD_FORCE, _HELD_RISE
        limits.power, limits.stiffness = _HELD_POWER, _HELD_STIFFNESS


@kernel
def limit_leg(limits: LegLimitsRecord, jacobian: Vec, dq: Vec, dt: float, wanted: Vec, tau: Vec) -> None:
    """Move the torques of a leg towards the wanted ones within its limits.

    Args:
        limits: LEG_LIMITS record.
        jacobian: Of the foot, (x, z) by (hip, knee), row by row [m/rad], shape [4].
        dq: Joint velocities [rad/s], shape [2].
        dt: Tick [s].
        wanted: Torques [N m], shape [2].
        tau: On entry the torques of the last tick, on exit those of this one, shape [2].
    """
    if limits.force == 0.0:
        fill(tau, 0.0)
        return
    limit_torques(wanted, jacobian, 2, limits.force, limits.rise * dt, tau)
    power = abs(tau[0] * dq[0] + tau[1] * dq[1])
    if power > limits.power:
        scale(tau, limits.power / power)
