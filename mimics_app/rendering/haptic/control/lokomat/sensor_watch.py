"""Dead and stuck rod sensors of a leg, noticed by the noise that they lack.

A force sensor that works never reads the same for long, a leg at rest included: with a noise of 0.5 N and steps of
0.2 N one reading in nine repeats the one before, and 50 in a row do so once in 1e47. One that reads zero, or keeps its
value, repeats for ever. A line that loses frames repeats readings, too, but stops the loop after 20 ms.

The device sends torques, force times lever: a stuck sensor of a leg that moves repeats its force, one whose torque is
stuck behind the lever that torque; either is watched.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.lokomat.linkage import lever

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import LegFrameRecord, SensorWatchRecord

__all__ = ["SENSOR_WATCH", "sensor_is_frozen"]

SENSOR_WATCH = np.dtype(
    [
        ("torque", np.float64, 2),  # last readings of hip and knee [N m]
        ("force", np.float64, 2),  # the same in the rods [N]
        ("repeated", np.float64, 2),  # time since which they are the same [s]
    ],
    align=True,
)
"""Of one leg; zeros are the initial state."""


_SAME = 1e-3
"""Largest difference of two readings of a rod that are the same, by the rounding of their torques [N]."""


@kernel
def sensor_is_frozen(
    watch: SensorWatchRecord, leg: LegFrameRecord, q: Vec, torque: Vec, longest: float, dt: float
) -> bool:
    """Whether a rod sensor of a leg has repeated its reading for longer than a noisy one ever does.

    Args:
        watch: SENSOR_WATCH record, advanced.
        leg: LEG_FRAME record.
        q: Measured hip and knee [rad], shape [2].
        torque: Measured torques of the leg on its drives [N m], shape [2].
        longest: Longest time of the same reading [s]; 0: for ever, of a sensor without noise.
        dt: Tick [s].
    """
    frozen = False
    for joint in range(2):
        force = torque[joint] / lever(leg.links[joint], q[joint])
        same = torque[joint] == watch.torque[joint] or abs(force - watch.force[joint]) < _SAME
        watch.repeated[joint] = watch.repeated[joint] + dt if same else 0.0
        watch.torque[joint], watch.force[joint] = torque[joint], force
        frozen = frozen or 0.0 < longest < watch.repeated[joint]
    return frozen
