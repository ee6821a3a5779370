"""`mimics bench lokomat`: cost of a tick, wall of D2.1 Figure 55, transparency, energy, and the search of the sequence.

`tick_us` is one tick with both legs: device and person simulated, control of both legs in contact. `reference_ns` is
the cost of the reference loop of `bench haptic` in the same run; costs count at a speed where it takes 1.8 us.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.haptic.free_leg import constraint_drift, energy_drift
from mimics_app.lab.haptic.gait_differences import gait_differences
from mimics_app.lab.haptic.leg_runs import (
    COUNTED_FROM,
    PUSH,
    SECONDS,
    SPEEDS,
    foot_on_wall,
    residual_torque,
    wall_rig,
)
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, Person, Rig
from mimics_app.lab.haptic.sequence_search import search_sequence
from mimics_app.lab.haptic_bench import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import SurfaceFriction
from mimics_app.rendering.haptic.kernels.leg_kinematics import FOOT, SHANK, THIGH

__all__ = ["measure_lokomat"]

_BATCH, _REPEATS, _TURNS = 50, 60, 8
"""Ticks of a batch, shorter than a turn of a busy processor, and how many of them are timed at a time, in turn."""

_PRESSED = 1.0
"""Time after which the foot rests on the wall [s]."""


def _penetration(report: Callable[[str], None]) -> dict[str, Any]:
    report("foot on a wall, both controls")
    found: dict[str, Any] = {}
    for kind, name in enumerate(CONTROLS):
        rows, stiffness, _ = foot_on_wall(kind)
        steady = rows["t"] >= COUNTED_FROM
        simulated = float(rows["x_real"][steady].mean())
        found[name] = {"simulated": simulated, "theory": PUSH / stiffness, "stiffness_n_m": stiffness}
    return {"simulated": found["combined"]["simulated"], "theory": found["combined"]["theory"], **found}


def _slip() -> float:
    """Speed [mm/s] at which a foot slides that friction should hold: 60 N on the wall, 10 N along it, mu 0.4."""
    rig, _ = wall_rig()
    rig.settings["surface"]["friction"], rig.settings["surface"]["mu"] = SurfaceFriction.COULOMB, 0.4
    rows = rig.run(COMBINED, Person(force=(PUSH, 10.0)), SECONDS)
    steady = rows["t"] >= COUNTED_FROM
    segments = rig.settings["frame"]["geometry"][0]
    angles = rows["hip_angle"][steady], rows["knee_angle"][steady]
    psi = angles[0] - angles[1]
    height: NDArray[np.float64] = (
        segments[FOOT] * np.sin(psi) - segments[THIGH] * np.cos(angles[0]) - segments[SHANK] * np.cos(psi)
    )
    return float(1e3 * abs(height[-1] - height[0]) / (SECONDS - COUNTED_FROM))


def _costs(report: Callable[[str], None]) -> tuple[float, float]:
    """Return the costs of the reference loop and of a tick [us]: the shortest of batches that are timed in turn."""
    report("cost of a tick")
    rig, _ = wall_rig()
    play = rig.begin(COMBINED, Person(force=(PUSH, 0.0)))
    play.go(_PRESSED)
    reference = whole = alone = math.inf
    for _ in range(_TURNS):
        reference = min(reference, reference_us())
        whole = min(whole, shortest_us(lambda: play.go(1e-3 * _BATCH), _BATCH, _REPEATS))
        alone = min(alone, shortest_us(lambda: rig.control(COMBINED, _BATCH), _BATCH, _REPEATS))
    return reference, whole + 0.5 * alone  # the rig controls one leg, the machine has two


def measure_lokomat(report: Callable[[str], None]) -> dict[str, Any]:
    """Measure; return the object of `mimics bench lokomat --json`."""
    reference, tick = _costs(report)
    figures: dict[str, Any] = {"reference_ns": 1e3 * reference, "tick_us": tick}
    figures["penetration"] = _penetration(report)
    figures["slip_mm_s"] = _slip()
    figures["gait_rms_deg"] = [each._asdict() for each in gait_differences()]
    figures["energy_drift"], figures["constraint_drift_m"] = energy_drift(), constraint_drift()
    report("free swing, both controls")
    rig = Rig()
    torques = {
        name: {
            speed: dict(zip(("hip", "knee"), residual_torque(rig, kind, hz), strict=True))
            for speed, hz in SPEEDS.items()
        }
        for kind, name in enumerate(CONTROLS)
    }
    figures["residual_torque_Nm"] = torques
    report("obstacle sequence")
    found = search_sequence()
    figures["sequence"] = {"states": found.states, "cases": found.cases, "violations": found.violations}
    return figures
