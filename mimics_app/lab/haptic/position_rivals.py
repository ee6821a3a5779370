"""Rivals of a leg's position control (D2.1 Figure 54): computed torque and PD, at the numbers of the controllers."""

from __future__ import annotations

import math

from mimics_app.lab.haptic.led_leg import Leg
from mimics_app.lab.haptic.leg_runs import PUSH, wall_rig
from mimics_app.lab.haptic.lokomat_rig import COMBINED, Person
from mimics_app.lab.rivals import Rival

__all__ = ["POSITION_RIVALS", "away", "cost_us", "yielding"]

_STIFFNESS = 2000.0
"""Of PD [N m/rad]."""

_SECONDS, _RESTING = 3.0, 500


def _leg(computed: float) -> Leg:
    return Leg(servo=True, position={"computed": computed, "stiffness": _STIFFNESS})


def cost_us(computed: float) -> float:
    """Return the cost of one leg in a tick [us]; 1: computed torque, 0: PD."""
    return _leg(computed).cost_us()


def away(computed: float) -> float:
    """Return the root mean square deviation of hip and knee from the walk along which they are led [rad]."""
    return _leg(computed).lead().away


def yielding(computed: float) -> float:
    """Return how far a foot that a person presses with 60 N gets into a rigid wall [m]; infinite where it is lost."""
    rig, wall = wall_rig()
    rig.settings["position"]["computed"], rig.settings["position"]["stiffness"] = computed, _STIFFNESS
    rows = rig.run(COMBINED, Person(force=(PUSH, 0.0)), _SECONDS)
    held = bool(rows["touching"][-_RESTING:].all())
    return float(rows["x_real"][-_RESTING:].mean()) - wall if held else math.inf


POSITION_RIVALS = (
    Rival(
        "computed torque",
        "mass, coupling and weight of leg, orthosis and motors cancelled; each joint's error decays alike",
        "legs whose masses are known",
        {"computed_torque": 1.0},
        (1.0,),
    ),
    Rival(
        "PD",
        "a spring and a damper at each joint, uncoupled",
        "any leg; lags under weight and motion",
        {"computed_torque": 0.0},
        (0.0,),
    ),
)
"""The two that D2.1 names."""
