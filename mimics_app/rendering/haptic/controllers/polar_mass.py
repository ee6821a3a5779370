"""Admittance of a polar device: the virtual mass at its one point of contact, under measured and virtual force."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.rendering.haptic.kernels.admittance import VirtualMass, admit
from mimics_app.rendering.haptic.kernels.kinematics import robot_to_tool

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlInputRecord, ControlOutputRecord, ControlWorkRecord

__all__ = ["admit_at_tool", "refuse_unless_polar"]


@kernel
def admit_at_tool(form: int, now: ControlInputRecord, work: ControlWorkRecord, out: ControlOutputRecord) -> None:
    """Advance the virtual mass by one tick in a form (AdmittanceForm), and write its motion to `out`."""
    robot_to_tool(now.q, now.f_user, work.forces)
    for i in range(3):
        work.forces[i] += now.f_meas[i]
    admit(
        form,
        now.q,
        work.forces,
        VirtualMass(now.virtual_mass, now.virtual_damping, now.max_acceleration, now.max_velocity),
        now.geometry[0],
        now.dt,
        work.side[:3],
        out.v[:3],
        out.dq,
    )
    out.points_given = 1


def refuse_unless_polar(descriptor: DeviceDescriptor) -> str:
    """Return why a device cannot have a controller in polar joints; "" where it can."""
    return "" if descriptor.polar else "needs the joints radial, angle, vertical and one point of contact"
