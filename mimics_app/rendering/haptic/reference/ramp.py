"""A parameter that follows its target within a rate limit, smooth up to its acceleration.

A point is led to the target at no more than the rate; two first-order filters of SMOOTHING in a row follow it. Their
responses are positive and have unit area, so the value's rate never exceeds the limit, its acceleration never exceeds
the limit over SMOOTHING and is continuous, and the value does not overshoot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import RampRecord

__all__ = ["RAMP", "SMOOTHING", "follow_target", "set_ramp"]

SMOOTHING = 0.1
"""Time constant of each filter [s]: a tenth of a slow step."""

RAMP = np.dtype(
    [
        ("led", "f8"),  # led to the target at the rate
        ("half", "f8"),  # after the first filter
        ("value", "f8"),  # after the second
        ("rate", "f8"),  # of the value [1/s]
        ("acceleration", "f8"),  # [1/s^2]
    ],
    align=True,
)
"""One parameter on its way; zeros are at rest at 0."""


@kernel
def set_ramp(ramp: RampRecord, value: float) -> None:
    """Be at rest at a value."""
    ramp.led = ramp.half = ramp.value = value
    ramp.rate = ramp.acceleration = 0.0


@kernel
def follow_target(ramp: RampRecord, target: float, limit: float, dt: float) -> None:
    """Advance by one tick.

    Args:
        ramp: RAMP record.
        target: Target of the value, in its unit.
        limit: Largest rate [unit/s].
        dt: Tick [s], shorter than SMOOTHING.
    """
    most = limit * dt
    ramp.led += min(most, max(-most, target - ramp.led))
    first = (ramp.led - ramp.half) / SMOOTHING
    ramp.rate = (ramp.half - ramp.value) / SMOOTHING
    ramp.acceleration = (first - ramp.rate) / SMOOTHING
    ramp.half += dt * first
    ramp.value += dt * ramp.rate
