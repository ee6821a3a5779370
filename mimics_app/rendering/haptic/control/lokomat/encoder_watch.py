"""Frozen encoders of a leg, noticed by the rod sensors: a joint whose load changes moves.

Nothing distinguishes an encoder that keeps its value from a leg at rest as long as the load of the drive is the same.
But a torque on the joint that changes by 10 N m moves it: by the stretch of its rod, two steps of the encoder, where
the drive is braked; and by more where it is not, once the leg has had time to accelerate. An encoder that shows no step
for so long after such a change is frozen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import EncoderWatchRecord

__all__ = ["ENCODER_WATCH", "encoder_is_frozen"]

ENCODER_WATCH = np.dtype(
    [
        ("begun", np.int64),
        ("q", np.float64, 2),  # angles since which hip and knee show no step [rad]
        ("least", np.float64, 2),  # smallest and largest torque on their drives since then [N m]
        ("most", np.float64, 2),
        ("waited", np.float64, 2),  # time since they are that far apart [s]
    ],
    align=True,
)
"""Of one leg; zeros are the initial state."""


_WAITS = 0.05
"""Time in which 10 N m move a leg by hundreds of steps of the encoder [s]."""


@kernel
def encoder_is_frozen(watch: EncoderWatchRecord, q: Vec, torque: Vec, limit: float, dt: float) -> bool:
    """Whether an encoder of a leg shows no step although the torque on its drive changed by more than a limit.

    Args:
        watch: ENCODER_WATCH record, advanced.
        q: Measured hip and knee [rad], shape [2].
        torque: Measured torques of the leg on its drives [N m], shape [2].
        limit: Largest change of the torque without a step [N m].
        dt: Tick [s].
    """
    frozen = False
    for joint in range(2):
        if watch.begun == 0 or q[joint] != watch.q[joint]:
            watch.q[joint], watch.waited[joint] = q[joint], 0.0
            watch.least[joint] = watch.most[joint] = torque[joint]
        watch.least[joint] = min(watch.least[joint], torque[joint])
        watch.most[joint] = max(watch.most[joint], torque[joint])
        if watch.most[joint] - watch.least[joint] > limit:
            watch.waited[joint] += dt
        frozen = frozen or watch.waited[joint] > _WAITS
    watch.begun = 1
    return frozen
