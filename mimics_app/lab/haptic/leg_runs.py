"""Runs of one leg in the simulated orthosis that several figures share: a foot on a wall, and a free swing."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.lab.haptic.lokomat_rig import COMBINED, IMPEDANCE, Person, Rig, Rows
from mimics_app.rendering.haptic.control.lokomat.position_control import foot_stiffness
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import wall_outline

__all__ = ["COUNTED_FROM", "PUSH", "SECONDS", "SPEEDS", "foot_on_wall", "residual_torque", "wall_rig"]

PUSH = 60.0
"""Force of the foot on the wall [N]."""

SPEEDS = {"slow": 0.3, "usual": 0.6, "fast": 0.9}
"""Frequencies of the free swing [Hz]: cycles of a walk at about 0.5, 1.5 and 3 km/h."""

_SWING = (0.35, 0.5)
"""Amplitudes of hip and knee in the free swing [rad]."""

_NO_STICTION: dict[str, Any] = {"static_friction": 0.0, "coulomb_friction": 0.0}
"""Drives for a static force balance: dry friction between motor and rod bears a part of it, of unknown sign."""

_GAP = 0.05
"""Distance of the wall before the foot at the start [m]."""

SECONDS, COUNTED_FROM = 3.0, 2.0
"""Length of a run, and time from which it rests [s]."""

_SWING_S = 6.0


def wall_rig(machine: dict[str, Any] | None = None, rate: int = 1000) -> tuple[Rig, float]:
    """Return a rig with a vertical wall before the foot, and the place of the wall [m]."""
    rig = Rig(machine or {}, rate)
    wall = float(rig.run(IMPEDANCE, Person(), 1.0 / rate)["x_real"][0]) + _GAP
    rig.settings["outline"] = wall_outline((wall, 0.0), (-1.0, 0.0))
    return rig, wall


def foot_on_wall(kind: int, push: float = PUSH, seconds: float = SECONDS) -> tuple[Rows, float, float]:
    """Press the foot on a vertical wall, as in Figure 55.

    Returns:
        Columns of the run, x measured from the wall [m]; stiffness of the wall K_x [N/m]; place of the wall [m].
    """
    rig, wall = wall_rig(_NO_STICTION)
    rig.settings["load"]["friction"] = 0.0
    rows = rig.run(kind, Person(force=(push, 0.0)), seconds)
    stiffness = float(rig.settings["foot"]["stiffness"][0])
    if kind == COMBINED:
        q = np.array([rows["hip_angle"][-1], rows["knee_angle"][-1]])
        stiffness = foot_stiffness(rig.settings["position"][0], rig.settings["frame"][0], q, -1.0, 0.0)
    return rows | {"x_real": rows["x_real"] - wall, "x_des": rows["x_des"] - wall}, stiffness, wall


def residual_torque(rig: Rig, kind: int, hz: float) -> tuple[float, float]:
    """Return the RMS torques of hip and knee [N m] that a person feels in a free swing of a frequency [Hz].

    The residual torque is that in the rods less the weight of the orthosis, which the drives are to carry.
    """
    rows = rig.run(kind, Person(swing=_SWING, swing_hz=hz), _SWING_S, start=(0.15, 0.6))
    counted = rows["t"] >= COUNTED_FROM
    hip, knee = (float(np.sqrt(np.mean(rows[joint][counted] ** 2))) for joint in ("hip", "knee"))
    return hip, knee
