"""Admittance in joint space with guidance: the virtual masses are drawn along the reference of the joints.

    q'' = q''_admittance + g a,     a = q_r'' + k (q_r - q) + d (q_r' - q')

g is the guidance of a joint, 0 to 1. The pull a is an acceleration, so that it acts like a spring of k and a damper of
d times the virtual inertia: a person feels the same mass with more or less of a spring around the reference. It is
limited to `most`, which a large distance at the begin of a movement reaches; all limits of the loop act behind it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop import controller_port
from mimics_app.contracts.loop.controller_port import ControllerParameter, places_of
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.rendering.haptic.control.joint_admittance import admit_joints

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["CONTROLLER"]

_PARAMETERS = (
    ControllerParameter("stiffness", 625.0, 0.0, 1e4, "1/s^2"),
    ControllerParameter("damping", 50.0, 0.0, 400.0, "1/s"),
    ControllerParameter("most", 100.0, 0.0, 1e3, "unit/s^2"),
)
"""k and d: critically damped, with a time constant of 40 ms; at 1 kHz d is stable up to 2000."""

_STIFFNESS, _DAMPING, _MOST = places_of(_PARAMETERS)


@typed_kernel(controller_port.CONTROLLER)
def _compute(
    kin: Kin, now: ControlInputRecord, parameters: Vec, memory: Vec, work: ControlWorkRecord, out: ControlOutputRecord
) -> None:
    """Advance the masses by one tick, then by the pull; the loop derives the points from the joints."""
    for j in range(now.joints):
        memory[j] = out.dq[j]
    admit_joints(kin, now, work, out.dq)
    stiffness, damping, most = parameters[_STIFFNESS], parameters[_DAMPING], parameters[_MOST]
    for j in range(now.joints):
        pull = now.ddq_reference[j] + stiffness * (now.q_reference[j] - now.q[j])
        pull += damping * (now.dq_reference[j] - memory[j])
        out.dq[j] += now.dt * now.guidance[j] * min(most, max(-most, pull))


CONTROLLER = controller_port.ControllerPlugin("guided_joints", _compute, Lead.PERSON, CommandKind.VELOCITY, _PARAMETERS)
