"""Controller: a heavy mass in the joints, moved by the measured force and braked by its own damper."""

from __future__ import annotations

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_port import CONTROLLER, ControllerParameter, ControllerPlugin
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.rendering.haptic.kernels.kinematics import apply_inverse_jacobian, tool_to_robot

D1 = 0.5 * 0.36 + 0.28  # of the HapticMaster [m]


@typed_kernel(CONTROLLER)
def _compute(kin, now, parameters, memory, work, out):
    """Step v += (F_hand + F_virtual - b v) dt / m, in the robot's frame; then to the joints."""
    if now.started == 1:
        memory[0:3] = now.v[0:3]
    tool_to_robot(now.q, now.f_meas[0:3], work.forces[0:3])
    for i in range(3):
        force = work.forces[i] + now.f_user[i]
        memory[i] = (memory[i] + force * now.dt / parameters[0]) / (1.0 + parameters[1] * now.dt / parameters[0])
    apply_inverse_jacobian(now.q, D1, memory[0:3], work.step[0:3])
    for i in range(3):
        out.dq[i] = work.step[i]


HEAVY_MASS = ControllerPlugin(
    "heavy_mass",
    _compute,
    Lead.PERSON,
    CommandKind.VELOCITY,
    (
        ControllerParameter("mass", 4.0, 1.0, 20.0, "kg"),
        ControllerParameter("damping", 12.0, 0.0, 100.0, "N s/m"),
    ),
    refusal=lambda device: "" if len(device.joints) == 3 else "is for a robot of three joints",
)
