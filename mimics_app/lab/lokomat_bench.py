"""`mimics bench lokomat`: cost of a tick, wall of D2.1 Figure 55, transparency, energy, and the search of the sequence.

`tick_us` is one tick with both legs: device and person simulated, control of both legs in contact. `reference_ns` is
the cost of the reference loop of `bench haptic` in the same run; costs count at a speed where it takes 1.8 us.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.haptic.free_leg import constraint_drift, energy_drift
from mimics_app.lab.haptic.gait_differences import gait_differences
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE, Person, Rig, Rows
from mimics_app.lab.haptic.sequence_search import search_sequence
from mimics_app.lab.haptic_bench import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import SurfaceFriction
from mimics_app.rendering.haptic.control.lokomat.position_control import foot_stiffness
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import wall_outline
from mimics_app.rendering.haptic.kernels.leg_kinematics import FOOT, SHANK, THIGH

__all__ = ["PUSH", "SPEEDS", "SWING", "foot_on_wall", "measure_lokomat", "residual_torque", "wall_rig"]

PUSH = 60.0
"""Force of the foot on the wall [N]."""

SPEEDS = {"slow": 0.3, "usual": 0.6, "fast": 0.9}
"""Frequencies of the free swing [Hz]: cycles of a walk at about 0.5, 1.5 and 3 km/h."""

SWING = (0.35, 0.5)
"""Amplitudes of hip and knee in the free swing [rad]."""

_NO_STICTION: dict[str, Any] = {"static_friction": 0.0, "coulomb_friction": 0.0}
"""Drives for a static force balance: dry friction between motor and rod bears a part of it, of unknown sign."""

_GAP = 0.05
"""Distance of the wall before the foot at the start [m]."""

_SECONDS, _COUNTED_FROM = 3.0, 2.0
_SWING_SECONDS = 6.0
_TICKS = 2000


def wall_rig(machine: dict[str, Any] | None = None, rate: int = 1000) -> tuple[Rig, float]:
    """Return a rig with a vertical wall before the foot, and the place of the wall [m]."""
    rig = Rig(machine or {}, rate)
    wall = float(rig.run(IMPEDANCE, Person(), 1.0 / rate)["x_real"][0]) + _GAP
    rig.settings["outline"] = wall_outline((wall, 0.0), (-1.0, 0.0))
    return rig, wall


def foot_on_wall(kind: int, push: float = PUSH, seconds: float = _SECONDS) -> tuple[Rows, float, float]:
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
    rows = rig.run(kind, Person(swing=SWING, swing_hz=hz), _SWING_SECONDS, start=(0.15, 0.6))
    counted = rows["t"] >= _COUNTED_FROM
    hip, knee = (float(np.sqrt(np.mean(rows[joint][counted] ** 2))) for joint in ("hip", "knee"))
    return hip, knee


def _penetration(report: Callable[[str], None]) -> dict[str, Any]:
    report("foot on a wall, both controls")
    found: dict[str, Any] = {}
    for kind, name in enumerate(CONTROLS):
        rows, stiffness, _ = foot_on_wall(kind)
        steady = rows["t"] >= _COUNTED_FROM
        simulated = float(rows["x_real"][steady].mean())
        found[name] = {"simulated": simulated, "theory": PUSH / stiffness, "stiffness_n_m": stiffness}
    return {"simulated": found["combined"]["simulated"], "theory": found["combined"]["theory"], **found}


def _slip() -> float:
    """Speed [mm/s] at which a foot slides that friction should hold: 60 N on the wall, 10 N along it, mu 0.4."""
    rig, _ = wall_rig()
    rig.settings["surface"]["friction"], rig.settings["surface"]["mu"] = SurfaceFriction.COULOMB, 0.4
    rows = rig.run(COMBINED, Person(force=(PUSH, 10.0)), _SECONDS)
    steady = rows["t"] >= _COUNTED_FROM
    segments = rig.settings["frame"]["geometry"][0]
    angles = rows["hip_angle"][steady], rows["knee_angle"][steady]
    psi = angles[0] - angles[1]
    height: NDArray[np.float64] = (
        segments[FOOT] * np.sin(psi) - segments[THIGH] * np.cos(angles[0]) - segments[SHANK] * np.cos(psi)
    )
    return float(1e3 * abs(height[-1] - height[0]) / (_SECONDS - _COUNTED_FROM))


def _tick_us(report: Callable[[str], None]) -> float:
    report("cost of a tick")
    rig, _ = wall_rig()
    whole = shortest_us(lambda: rig.run(COMBINED, Person(force=(PUSH, 0.0)), 1e-3 * _TICKS), _TICKS)
    alone = shortest_us(lambda: rig.control(COMBINED, _TICKS), _TICKS)
    return whole + 0.5 * alone  # the rig controls one leg, the machine has two


def measure_lokomat(report: Callable[[str], None]) -> dict[str, Any]:
    """Measure; return the object of `mimics bench lokomat --json`."""
    figures: dict[str, Any] = {"reference_ns": 1e3 * reference_us(), "tick_us": _tick_us(report)}
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
