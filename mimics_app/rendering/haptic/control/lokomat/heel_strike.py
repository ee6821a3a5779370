"""Heel strikes of a leg at 1 kHz, from its noisy angles: a foot that moved forwards begins to move backwards.

On a treadmill a heel touches the belt where it is furthest ahead of the pelvis (Zeni, Richards and Higginson 2008).
The ankle's place x ahead of the hip is followed with its velocity v and acceleration a, which a triple pole smooths:

    e = x - x_predicted,     x += (1 - r^3) e,     v += 1.5 (1 - r)^2 (1 + r) e / dt,     a += (1 - r)^3 e / dt^2

with r = exp(-dt / tau). A strike is reported once v - wait a <= 0, that is when v has been backwards for some
milliseconds: a foot that lingers before it turns is not taken for one that has turned.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.leg_kinematics import SHANK, THIGH

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import HeelStrikeRecord

__all__ = ["HEEL_STRIKE", "watch_heel"]

HEEL_STRIKE = np.dtype(
    [
        ("count", np.int64),  # strikes so far
        ("swings", np.int64),  # 1: the foot swings forwards
        ("begun", np.int64),  # 1: it is followed
        ("x", np.float64),  # ankle ahead of the hip, smoothed [m]
        ("v", np.float64),  # its velocity [m/s]
        ("a", np.float64),  # its acceleration [m/s^2]
    ],
    align=True,
)
"""Of one leg; zeros are the initial state, from which it finds the velocity of the foot within a fifth of a second."""

_TAU, _WAIT = 0.020, 0.008
"""Time constant of each pole, and the time for which a foot moves backwards before it is reported [s]. Of five times of
either, on walks with noise of 0.5 and 1 mrad, the pair that finds most strikes within 20 ms: 7 ms late in the mean."""

_TRIPLE = 1.5
"""Coefficient of the velocity's correction for a triple pole."""

_SWINGS = 0.15
"""Speed forwards from which a foot swings [m/s]; a standing one moves backwards, or not at all."""


@kernel
def watch_heel(heel: HeelStrikeRecord, geometry: Vec, q: Vec, runs: bool, dt: float) -> None:
    """Follow a leg for a tick, and count a heel strike in the tick that finds it.

    Args:
        heel: HEEL_STRIKE record, advanced.
        geometry: Of the legs (`leg_kinematics`).
        q: Measured hip and knee [rad], shape [2].
        runs: Whether the belt runs: on one that stands nobody strikes.
        dt: Tick [s].
    """
    place = geometry[THIGH] * math.sin(q[0]) + geometry[SHANK] * math.sin(q[0] - q[1])
    if heel.begun == 0:  # a foot that stands ahead has not swung there
        heel.begun, heel.x = 1, place
    r = math.exp(-dt / _TAU)
    free = 1.0 - r
    ahead = heel.x + dt * (heel.v + 0.5 * dt * heel.a)
    away = place - ahead
    heel.x = ahead + (1.0 - r * r * r) * away
    heel.v += dt * heel.a + _TRIPLE * free * free * (1.0 + r) * away / dt
    heel.a += free * free * free * away / (dt * dt)
    if not runs:
        heel.swings = 0
    elif heel.swings == 0:
        heel.swings = 1 if heel.v > _SWINGS else 0
    elif heel.v - _WAIT * heel.a <= 0.0:
        heel.swings = 0
        heel.count += 1
