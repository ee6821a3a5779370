"""Impedance control: the device renders the virtual force with its drives, and nothing is added to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.device_descriptor import Kin

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    """Add nothing: forces and torques are zero on entry."""


CONTROLLER = controller_port.ControllerPlugin("impedance", _compute, Lead.PERSON, CommandKind.FORCE)
