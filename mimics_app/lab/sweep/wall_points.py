"""Simulated points of the experiment `wall_stability`, see `stability.wall_loop`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.stability.growth import LENGTHEN, QUARTERS, decay_sign
from mimics_app.lab.stability.wall_loop import press_wall

__all__ = ["decide"]


_SHORTEST, _LONGEST = 2_000, 128_000
"""Lengths of the first and of the last run [ticks]."""


@kernel
def _decide(k: Vec, B: Vec, m: Vec, b: Vec, dt: Vec, delay: NDArray[np.int64], stable: NDArray[np.uint8]) -> None:
    """Whether the motion of each point dies away, as `growth.dies_away`."""
    line = np.zeros(np.max(delay) + 1)
    peaks = np.zeros(QUARTERS)
    for i in range(k.shape[0]):
        ticks, sign = _SHORTEST, 0
        while sign == 0:
            press_wall(k[i], B[i], m[i], b[i], dt[i], delay[i], ticks, line, peaks)
            sign = decay_sign(peaks, ticks >= _LONGEST)
            ticks *= LENGTHEN
        stable[i] = 1 if sign > 0 else 0


def decide(
    stiffness: Sequence[Any],
    wall_damping: Sequence[Any],
    mass: Sequence[Any],
    device_damping: Sequence[Any],
    period: Sequence[Any],
    delay_ticks: Sequence[Any],
) -> list[bool]:
    """Return for each point whether the wall is stable [N/m, N s/m, kg, N s/m, s, ticks]."""
    delay = np.array(delay_ticks, np.int64)
    stable = np.zeros(len(delay), np.uint8)
    k, B, m, b, dt = (np.array(each, np.float64) for each in (stiffness, wall_damping, mass, device_damping, period))
    _decide(k, B, m, b, dt, delay, stable)
    return stable.astype(bool).tolist()
