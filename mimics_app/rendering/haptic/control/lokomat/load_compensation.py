"""Compensation of weight and friction of the orthosis: the zero impedance mode of D2.1 4.3.1.

A drive holds the weight of the leg's part of the orthosis, and pushes along with the motion by a share of its own
friction. Coulomb friction grows linearly up to a speed: a step at standstill would chatter on the encoder's steps. A
share below 1 keeps the leg from running away by itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.lokomat.linkage import lever
from mimics_app.rendering.haptic.kernels.two_link import LINKS, weight

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import LegFrameRecord, LoadSettingsRecord

__all__ = ["LOAD_SETTINGS", "load_torques"]

LOAD_SETTINGS = np.dtype(
    [
        ("links", np.float64, LINKS),  # the orthosis alone (`two_link`)
        ("weight", np.float64),  # share of its weight that the drives carry, 0-1
        ("friction", np.float64),  # share of their friction that they compensate, 0-1
        ("coulomb", np.float64, 2),  # friction of motion of hip and knee drive along the shaft [N]
        ("viscous", np.float64, 2),  # [N s/m]
        ("slow", np.float64),  # shaft speed up to which the Coulomb part grows [m/s] > 0
    ],
    align=True,
)


@kernel
def load_torques(settings: LoadSettingsRecord, leg: LegFrameRecord, q: Vec, dq: Vec, tau: Vec) -> None:
    """Set the torques [N m] that carry weight and friction.

    Args:
        settings: LOAD_SETTINGS record.
        leg: LEG_FRAME record.
        q: Joint angles [rad], shape [2].
        dq: Their velocities [rad/s].
        tau: Out: torques, shape [2].
    """
    tau[0], tau[1] = weight(settings.links, q[0], q[1])
    for i in range(2):
        arm = lever(leg.links[i], q[i])
        speed = arm * dq[i]
        push = settings.coulomb[i] * min(1.0, max(-1.0, speed / settings.slow)) + settings.viscous[i] * speed
        tau[i] = settings.weight * tau[i] + settings.friction * arm * push
