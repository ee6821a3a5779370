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
def _window(speed: EncoderSpeedRecord, newest: int, step: float) -> int:
    """Ticks since which all readings lie within a step of the line through the first and last; 1 at least.

    Each reading between bounds the slope of that line, so that a reading is looked at once, whatever the window.
    """
    last, longest = speed.past[newest % _RING], min(newest, _WINDOW)
    least, most = -math.inf, math.inf
    for n in range(1, longest):
        way = last - speed.past[(newest - n) % _RING]
        least, most = max(least, (way - _NEAR * step) / n), min(most, (way + _NEAR * step) / n)
        if not least <= (last - speed.past[(newest - n - 1) % _RING]) / (n + 1) <= most:
            return n
    return longest


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
    n = _window(speed, newest, step)
    total = 0.0
    for k in range(n + 1):
        total += (0.5 * n - k) * speed.past[(newest - k) % _RING]
    slope = _SLOPE * total / (n * (n + 1.0) * (n + 2.0) * dt)
    return math.copysign(max(0.0, abs(slope) - _REST * step / (_WINDOW * dt)), slope)
