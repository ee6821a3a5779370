"""Admittance control in joint space: a virtual mass at each point of contact of any device."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.maths.vec import copy, scale
from mimics_app.rendering.haptic.control.joint_admittance import admit_joints
from mimics_app.rendering.haptic.kernels.joints import share_below, velocities_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    """Advance the masses by one tick, with one factor on all joints where a point would be faster than it may."""
    admit_joints(kin, now, work, out.dq)
    velocities_of(kin, now, now.q, out.dq, work, work.velocities)
    share = share_below(now.contacts, work.velocities, now.max_velocity)
    if share < 1.0:
        scale(out.dq, share)
        velocities_of(kin, now, now.q, out.dq, work, work.velocities)
    copy(work.velocities, out.v)
    out.points_given = 1


CONTROLLER = controller_port.ControllerPlugin("admittance_joints", _compute, Lead.PERSON, CommandKind.VELOCITY)
