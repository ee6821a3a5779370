"""Guidance of a leg along its reference: impedance around it, or a moving window with free way inside.

    impedance   tau = share (K (q_r - q) + B (q_r' - q'))
    window      as the impedance, with q_r the nearest place of the reference within a window of its phase, and no
                force within a distance of it

The guidance force of D2.1 4.3.6 is a share of 0 to 100 % for each joint and leg. The window is the path control of
patient-cooperative training: the leg may lead or lag in time, and a torque only returns it to the path.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import GuidanceSettingsRecord

__all__ = ["GUIDANCE_SETTINGS", "guide_in_window", "guide_joint", "nearest_phase"]

GUIDANCE_SETTINGS = np.dtype(
    [
        ("stiffness", np.float64, 2),  # K of hip and knee [N m/rad]
        ("damping", np.float64, 2),  # B [N m s/rad]
        ("window", np.float64),  # half length of the window [share of a cycle]
        ("width", np.float64),  # distance from the path without force [rad]
    ],
    align=True,
)


@kernel
def guide_joint(share: float, stiffness: float, damping: float, error: float, rate: float) -> float:
    """Torque [N m] of the impedance of one joint around its reference.

    Args:
        share: Guidance 0-1.
        stiffness: K [N m/rad].
        damping: B [N m s/rad].
        error: q_r - q [rad].
        rate: q_r' - q' [rad/s].
    """
    return share * (stiffness * error + damping * rate)


@kernel
def nearest_phase(path: Mat, phase: float, window: float, q: Vec) -> int:
    """Place of a closed path nearest to a pose, within a window around a phase.

    Args:
        path: Hip and knee over a cycle at even phases [rad], shape [places, 2].
        phase: Phase of the reference [cycles].
        window: Half length of the window [cycles].
        q: Pose [rad], shape [2].
    """
    places = path.shape[0]
    middle, reach = round(phase * places), math.ceil(window * places)
    nearest, best = middle % places, math.inf
    for step in range(-reach, reach + 1):
        place = (middle + step) % places
        square = (path[place, 0] - q[0]) ** 2 + (path[place, 1] - q[1]) ** 2
        if square < best:
            nearest, best = place, square
    return nearest


@kernel
def guide_in_window(
    settings: GuidanceSettingsRecord, share: float, path: Mat, phase: float, q: Vec, dq: Vec, tau: Vec
) -> None:
    """Set the torques [N m], shape [2], that return a leg to its path, none within the free width.

    Args:
        settings: GUIDANCE_SETTINGS record.
        share: Guidance 0-1.
        path: See `nearest_phase`.
        phase: Phase of the reference [cycles].
        q: Pose [rad], shape [2].
        dq: Its velocity [rad/s].
        tau: Out: torques.
    """
    place = nearest_phase(path, phase, settings.window, q)
    hip, knee = path[place, 0] - q[0], path[place, 1] - q[1]
    distance = math.sqrt(hip * hip + knee * knee)
    outside = max(0.0, 1.0 - settings.width / distance) if distance > 0.0 else 0.0
    away = (hip * dq[0] + knee * dq[1]) / (distance * distance) if outside > 0.0 else 0.0  # speed back along the error
    for i in range(2):
        error = path[place, i] - q[i]
        tau[i] = guide_joint(share, settings.stiffness[i], settings.damping[i], outside * error, -away * error)
