"""Speed of a joint from its encoder, without the kicks of the encoder's steps.

One step within a tick reads as a speed of step / dt, and the damping of a stiff position control makes 2 N m of it at
the hip of this machine. The speed here is the slope of the line through the last readings, as many as lie within one
step of it: the longest window that the resolution cannot tell from uniform motion (first-order adaptive windowing,
Janabi-Sharifi, Hayward and Chen, IEEE Trans. Control Syst. Technol. 8, 2000). A fast leg gets a short window and little
delay. A slope below that of 1.5 steps in the longest window is none: a reading that flickers between two steps is at
rest, and a torque against it would swing the leg on the elasticity of its drive.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import EncoderSpeedRecord

__all__ = ["ENCODER_SPEED", "encoder_speed"]

_WINDOW = 16
"""Longest window [ticks]; a longer one delays damping until it excites the swing of the leg on its drive (24 Hz)."""

_RING = _WINDOW + 1
"""Readings at both ends of it and between."""

_REST = 1.5
"""Steps in the longest window that are no motion."""

_NEAR = 1.001
"""Distance in steps of readings from a line that may be uniform motion: one step, and rounding."""

_SLOPE = 12.0
"""Of the least squares: the slope of y_0 ... y_n is 12 / (n (n + 1) (n + 2)) times the sum of (k - n/2) y_k."""

ENCODER_SPEED = np.dtype(
    [
        ("count", np.int64),  # readings so far
        ("past", np.float64, _RING),  # the last of them, a ring [rad]
    ],
    align=True,
)
"""Of one joint; zeros are the initial state."""


@kernel
def _is_uniform(speed: EncoderSpeedRecord, newest: int, n: int, step: float) -> bool:
    """Whether all readings since the one n ticks ago lie within a step of the line through the first and last."""
    last, first = speed.past[newest % _RING], speed.past[(newest - n) % _RING]
    slope = (last - first) / n
    for k in range(1, n):
        if abs(last - slope * k - speed.past[(newest - k) % _RING]) > _NEAR * step:
            return False
    return True


@kernel
def encoder_speed(speed: EncoderSpeedRecord, q: float, step: float, dt: float) -> float:
    """Return the speed of a joint [rad/s].

    Args:
        speed: ENCODER_SPEED record, advanced.
        q: Reading of its encoder [rad].
        step: Step of the encoder [rad].
        dt: Tick [s].
    """
    newest = speed.count
    speed.past[newest % _RING] = q
    speed.count += 1
    if newest == 0:
        return 0.0
    n, longest = 1, min(newest, _WINDOW)
    while n < longest and _is_uniform(speed, newest, n + 1, step):
        n += 1
    total = 0.0
    for k in range(n + 1):
        total += (0.5 * n - k) * speed.past[(newest - k) % _RING]
    slope = _SLOPE * total / (n * (n + 1.0) * (n + 2.0) * dt)
    return math.copysign(max(0.0, abs(slope) - _REST * step / (_WINDOW * dt)), slope)
