"""PD control of the points of contact as printed in D2.1 4.2.6: inverse kinematics, then joint PD."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead, TargetKind
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.rendering.haptic.control.world_pd import world_pd_through_joints
from mimics_app.rendering.haptic.controllers.gains import GAINS, KD, KP

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    world_pd_through_joints(kin, now, parameters[KP], parameters[KD], work, out.dq)


CONTROLLER = controller_port.ControllerPlugin(
    "world_pd_joints", _compute, Lead.TARGET, CommandKind.VELOCITY, GAINS, TargetKind.POINTS
)
