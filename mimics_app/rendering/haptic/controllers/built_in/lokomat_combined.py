"""Combined admittance and impedance control of the gait orthosis (D2.1 4.3.3, 4.3.4): a hard object is rigid."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.rendering.haptic.controllers.orthosis_legs import control_legs, orthosis_plugin

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    control_legs(True, now, parameters, memory, out)


CONTROLLER = orthosis_plugin("lokomat_combined", _compute)
