"""Control of a leg in the gait orthosis (D2.1 4.3): pure impedance, or admittance and impedance combined."""

from __future__ import annotations

import math

from mimics_app.lab.haptic.leg_runs import SPEEDS, residual_torque
from mimics_app.lab.haptic.lokomat_rig import COMBINED, IMPEDANCE, Rig
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.leg_kinematics import SHANK, THIGH

__all__: list[str] = []

_CALLS = 2000
_LEGS = 2


def _cost_us(kind: int) -> float:
    rig = Rig()
    return shortest_us(lambda: rig.control(kind, _CALLS), _LEGS * _CALLS)


def _residual_force(kind: int) -> float:
    """Return the force at the foot that a person feels in a free swing [N]: hip and knee as if each had its lever."""
    rig = Rig()
    hip, knee = residual_torque(rig, kind, SPEEDS["usual"])
    thigh, shank = (float(rig.settings["frame"]["geometry"][0, place]) for place in (THIGH, SHANK))
    return math.hypot(hip / (thigh + shank), knee / shank)


compare(
    __name__,
    "a person swings the leg freely at 0.6 Hz; error: root mean square force felt at the foot",
    "N",
    [
        Rival(
            "impedance",
            "4.3.2: weight and friction compensated; an object is a spring at the foot",
            "objects of up to 8 kN/m at 1 kHz (S18)",
            {"controller": "lokomat_impedance"},
            (IMPEDANCE,),
        ),
        Rival(
            "combined",
            "4.3.3 and 4.3.4: the forces of the rods move virtual masses; an object is rigid",
            "rigid objects; the virtual masses are felt",
            {"controller": "lokomat_combined"},
            (COMBINED,),
        ),
    ],
    Probes(_cost_us, _residual_force, reference_us),
    default="impedance",
    few="the two of D2.1 4.3; the transparency chart of docs/lokomat.md has their settings",
)
