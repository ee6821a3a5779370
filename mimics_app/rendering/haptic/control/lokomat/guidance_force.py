"""Guidance of a leg along its reference: impedance around it, or a window that moves along its path.

    impedance   tau = share (K (q_r - q) + B (q_r' - q'))
    window      tau = share (K e + B e'),  e from the leg to the nearest place of the path within the window, less the
                free width: no torque within that distance

The guidance force of D2.1 4.3.6 is a share of 0 to 100 % for each joint and leg. The window is the path control of
patient-cooperative training: the leg may lead or lag in time, and a torque only returns it to the path. The path is the
parabola of the reference's velocity and acceleration: within a tenth of a second it is that of a slow walk within a
degree, it needs no table, and where the reference stands it is the reference.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import GuidanceSettingsRecord

__all__ = ["GUIDANCE_SETTINGS", "guide_joints", "nearest_time"]

GUIDANCE_SETTINGS = np.dtype(
    [
        ("stiffness", np.float64, 2),  # K of hip and knee [N m/rad]
        ("damping", np.float64, 2),  # B [N m s/rad]
        ("window", np.float64),  # half length of the window [s]; 0: impedance around the reference
        ("width", np.float64),  # distance from the path without torque [rad]
    ],
    align=True,
)

_STEPS = 4
"""Steps of Gauss and Newton towards the nearest place: their error is below a hundredth of a degree."""

_SLOW = 0.05
"""Speed of the reference below which its path is a place [rad/s]."""


@kernel
def _guide_at_once(
    settings: GuidanceSettingsRecord, share: Vec, q: Vec, dq: Vec, wish: Vec, wish_rate: Vec, tau: Vec
) -> None:
    """Set the torques of the impedance around the reference at its time."""
    for i in range(2):
        pull = settings.stiffness[i] * (wish[i] - q[i]) + settings.damping[i] * (wish_rate[i] - dq[i])
        tau[i] = share[i] * pull


@kernel
def nearest_time(q: Vec, wish: Vec, wish_rate: Vec, wish_change: Vec, window: float) -> float:
    """Time from now at which the path of the reference is nearest to a pose [s], within a window.

    Args:
        q: Pose [rad], shape [2] like all below.
        wish: q_r [rad].
        wish_rate: q_r' [rad/s].
        wish_change: q_r'' [rad/s^2].
        window: Half length of the window [s].
    """
    t = 0.0
    for _ in range(_STEPS):
        along, square = 0.0, _SLOW * _SLOW
        for i in range(2):
            rate = wish_rate[i] + t * wish_change[i]
            along += rate * (wish[i] + t * (wish_rate[i] + 0.5 * t * wish_change[i]) - q[i])
            square += rate * rate
        t = min(window, max(-window, t - along / square))
    return t


@kernel
def _guide_in_window(
    settings: GuidanceSettingsRecord,
    share: Vec,
    q: Vec,
    dq: Vec,
    wish: Vec,
    wish_rate: Vec,
    wish_change: Vec,
    tau: Vec,
) -> None:
    """Set the torques that return a leg to its path."""
    t = nearest_time(q, wish, wish_rate, wish_change, settings.window)
    for i in range(2):
        tau[i] = wish[i] + t * (wish_rate[i] + 0.5 * t * wish_change[i]) - q[i]
    hip, knee = tau[0], tau[1]
    distance = math.sqrt(hip * hip + knee * knee)
    outside = max(0.0, 1.0 - settings.width / distance) if distance > 0.0 else 0.0
    away = (hip * dq[0] + knee * dq[1]) / (distance * distance) if outside > 0.0 else 0.0  # speed back along the error
    for i in range(2):
        tau[i] *= share[i] * (settings.stiffness[i] * outside - settings.damping[i] * away)


@kernel
def guide_joints(
    settings: GuidanceSettingsRecord,
    share: Vec,
    q: Vec,
    dq: Vec,
    wish: Vec,
    wish_rate: Vec,
    wish_change: Vec,
    tau: Vec,
) -> None:
    """Set the torques of the guidance of hip and knee.

    Args:
        settings: GUIDANCE_SETTINGS record.
        share: Guidance of each joint 0-1, shape [2] like all below.
        q: Pose [rad].
        dq: Its velocity [rad/s].
        wish: q_r [rad].
        wish_rate: q_r' [rad/s].
        wish_change: q_r'' [rad/s^2], for the window.
        tau: Out: torques [N m].
    """
    if settings.window > 0.0:
        _guide_in_window(settings, share, q, dq, wish, wish_rate, wish_change, tau)
    else:
        _guide_at_once(settings, share, q, dq, wish, wish_rate, tau)
