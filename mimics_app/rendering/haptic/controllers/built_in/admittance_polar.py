"""Admittance control in polar joints with the coupling terms of a point mass (D2.1 4.2.7), for a polar device."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.contracts.loop.haptic import AdmittanceForm
from mimics_app.rendering.haptic.controllers.polar_mass import admit_at_tool, refuse_unless_polar

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    admit_at_tool(AdmittanceForm.POLAR, now, work, out)


CONTROLLER = controller_port.ControllerPlugin(
    "admittance_polar", _compute, Lead.PERSON, CommandKind.VELOCITY, refusal=refuse_unless_polar
)
