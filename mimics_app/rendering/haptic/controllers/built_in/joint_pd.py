"""PD control of the joints (D2.1 4.2.5): drives to SCENE.target in joints, and holds them there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.controllers.gains import GAINS, KD, KP

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    joint_pd(now.q, now.dq, now.target, parameters[KP], parameters[KD], out.dq)


CONTROLLER = controller_port.ControllerPlugin("joint_pd", _compute, Lead.TARGET, CommandKind.VELOCITY, GAINS)
