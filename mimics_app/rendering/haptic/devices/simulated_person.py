"""Person on a simulated robot: an arm with the request's impairment and path, or a relaxed arm."""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import (
    DATA_BUTTONS,
    DATA_GRASP,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    INBOX_TRIAL,
)
from mimics_app.maths.vec import all_finite
from mimics_app.rendering.haptic.devices.patients import impairment_of, write_arm
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.kernels import arm
from mimics_app.rendering.haptic.kernels.arm import step_arm
from mimics_app.rendering.haptic.kernels.noise import seed_noise, uniform

__all__ = ["move_person", "write_person"]


_RELAXED_MASS = 1.5
"""Mass of a relaxed arm [kg]."""

_SEEDS_APART = 7919
"""Between the seeds of two limbs of one person: a prime beyond the seeds that are usual."""


@kernel
def move_person(person: Vec, handle: Vec, contact: int, inbox: Vec, data: Vec, dt: float) -> None:
    """Simulate one tick of a limb of the person; write grasp and buttons to `data`.

    With an inbox that is not finite it is idle.

    Args:
        person: Arm memory of the limb, shape [arm.ARM_LENGTH].
        handle: Position [m] and velocity [m/s] of the handle, robot frame, shape [6].
        contact: Number of the point of contact that the limb moves.
        inbox: Inbox vector of the device.
        data: Data vector of the device.
        dt: Tick [s].
    """
    active = all_finite(inbox) and inbox[INBOX_ACTIVE] != 0.0
    target = inbox[INBOX_TARGET + 3 * contact : INBOX_TARGET + 3 * contact + 3]
    grasp = step_arm(person, handle, active, inbox[INBOX_TRIAL], target, inbox[INBOX_GRASP + contact], dt)
    data[DATA_GRASP + contact] = grasp
    data[DATA_BUTTONS] = inbox[INBOX_BUTTONS]


def write_person(memory: Vec, request: DeviceRequest, contact: int = 0, beside: Vec | None = None) -> None:
    """Fill the memory of a limb, shape [arm.ARM_LENGTH], from the request's patient, seed and path.

    Args:
        memory: Receives it.
        request: Of the device.
        contact: Number of the point of contact that the limb moves; each has a random generator of its own.
        beside: From the first point to this one [m], shape [3]: its path is the first one's, as far beside it.
    """
    seed_noise(memory, arm.GENERATOR, 2 * request.seed + 1 + _SEEDS_APART * contact)
    if request.patient is None:
        memory[arm.ARM_MASS] = _RELAXED_MASS
        return
    path = request.path_robot if beside is None else request.path_robot + beside
    write_arm(memory, impairment_of(request.patient), path, request.patient.intent)
    for axis in range(3):
        memory[arm.TREMOR_PHASE + axis] = 2.0 * math.pi * uniform(memory, arm.GENERATOR)
