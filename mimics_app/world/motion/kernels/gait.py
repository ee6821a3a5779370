"""Walking worked out foot by foot: the foot that stands moves at exactly the pace backwards, the other one swings."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel

__all__ = ["foot_path"]

F8 = NDArray[np.float64]

_FLAT_FROM, _ROLLS_FROM = 0.2, 0.55
"""Shares of the stance at which the sole is down flat, and at which the heel leaves the ground."""

_ROLLS_TIME = 0.45
"""Share of the stance in which it rolls off over the ball."""

_CLEARANCE = 0.004
"""Of toe and heel over the ground in the middle of the swing, at least [m]."""

_PATH = 5
"""Numbers of a foot's path, see `foot_path`."""


@kernel
def _ease(x: float) -> float:
    """From 0 to 1 without a kink at either end."""
    return x * x * x * (10.0 + x * (6.0 * x - 15.0))


@kernel
def foot_path(phase: float, stance: float, stride: float, shape: F8, out: F8) -> None:
    """Where the ankle of a foot is, how the foot is pitched, and which point of the sole stands, relative to the body.

    The sole touches with the heel, rolls down flat, and rolls off over the ball. The point that stands moves backwards
    by the stride in a cycle, whatever the foot does about it; the ankle follows from it and the pitch.

    Args:
        phase: Of the foot, 0: its heel touches; 0 to 1.
        stance: Share of the cycle in which it stands.
        stride: Way of the body in a cycle [m].
        shape: Ankle above the sole [m], heel behind the ankle [m], ball before it [m], height of the swing [m],
            greatest pitch of the heel's touch and of the push-off [rad]; [6].
        out: Ankle ahead of the hip [m], ankle above the ground [m], pitch of the foot (toes up) [rad], point of
            contact ahead of the hip [m], 1 while it stands; written, [5].
    """
    ankle, heel, ball = shape[0], -shape[1], shape[2]
    reach = 0.5 * stance * stride
    if phase < stance:
        x = phase / stance
        # Where the ankle of a flat foot would stand: it goes back at an even pace.
        base = reach - stride * phase
        pitch, pivot = 0.0, 0.0
        if x < _FLAT_FROM:
            pitch, pivot = shape[4] * (1.0 - _ease(x / _FLAT_FROM)), heel
        elif x > _ROLLS_FROM:
            pitch, pivot = -shape[5] * _ease((x - _ROLLS_FROM) / _ROLLS_TIME), ball
        _place(base, pivot, pitch, ankle, out)
        out[3], out[4] = base + pivot, 1.0
        return
    x = (phase - stance) / (1.0 - stance)
    lift, touch = np.empty(_PATH), np.empty(_PATH)
    _place(reach - stride * stance, ball, -shape[5], ankle, lift)
    _place(reach, heel, shape[4], ankle, touch)
    # Both ends are left at the pace of the ground, so that the foot neither kicks nor brakes.
    slope = -stride * (1.0 - stance)
    h00, h10 = 2 * x**3 - 3 * x**2 + 1, x**3 - 2 * x**2 + x
    h01, h11 = 3 * x**2 - 2 * x**3, x**3 - x**2
    out[0] = h00 * lift[0] + h10 * slope + h01 * touch[0] + h11 * slope
    share = _ease(x)
    out[1] = (1.0 - share) * lift[1] + share * touch[1] + shape[3] * math.sin(math.pi * x) ** 2
    out[2] = (1.0 - share) * -shape[5] + share * shape[4]
    # Toe and heel never dip into the ground, however the foot is pitched.
    low = min(_below(heel, out[2], ankle), _below(ball, out[2], ankle))
    out[1] = max(out[1], -low + _CLEARANCE * math.sin(math.pi * x))
    out[3], out[4] = out[0], 0.0


@kernel
def _below(along: float, pitch: float, ankle: float) -> float:
    """Height of a point of the sole over the ankle, for a foot of a pitch."""
    return along * math.sin(pitch) - ankle * math.cos(pitch)


@kernel
def _place(base: float, pivot: float, pitch: float, ankle: float, out: F8) -> None:
    """The ankle of a foot whose sole touches the ground at a point of its own, pitched about it."""
    out[0] = base + pivot - pivot * math.cos(pitch) - ankle * math.sin(pitch)
    out[1] = -pivot * math.sin(pitch) + ankle * math.cos(pitch)
    out[2] = pitch
