"""Null controller: fills the slots that a session does not use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.device_descriptor import Kin

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["no_controller"]


@typed_kernel(controller_port.CONTROLLER)
def no_controller(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    """Command what was commanded; never selected."""
