"""Presets of the simulated person in the gait orthosis: strength, spasticity, tissue and gait of both limbs.

What a source says is named beside it; every other number is a setting of a plausible size, and not verified. Strengths
are per weight of the person [N m/kg].
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import require_choice
from mimics_app.rendering.haptic.kernels.lokomat import gait_person
from mimics_app.rendering.haptic.kernels.noise import seed_noise

__all__ = ["BY_IMPAIRMENT", "PERSONS", "Limb", "Person", "write_person_in"]

_HIP = (0.2036, 0.3480, -0.0576, -0.0461, -0.0447, -0.0079, 0.0186, 0.0, 0.0)
_KNEE = (0.3785, -0.0447, -0.3267, -0.2482, 0.1270, -0.0046, 0.0842, -0.0014, 0.0071)
"""Own gait of hip and knee [rad]: the usual shape of both curves over a stride, drawn by hand; not the reference."""

_EVER = 10.0
"""Angle that no joint reaches [rad]: no contracture."""


@dataclass(frozen=True, slots=True)
class Limb:
    """One limb.

    Attributes:
        share: Share of the strength that is left.
        strength: Largest voluntary torque of a healthy limb [N m/kg]: hip flexing, extending, knee flexing, extending.
            Knee: men, mid-range, 1.15-1.62 flexing and 2.92-3.45 extending (Sarabon, Kozinc and Perman 2021, pooled
            confidence intervals).
        spasticity: Of the stretch reflex [N m s/rad]: against hip flexing, extending, knee flexing, extending.
        threshold: Speed from which on a stretch is answered [rad/s].
        clonus: Greatest torque of a beat [N m]; 0: none.
        clonus_hz: Its frequency: 3 to 7 Hz (Rack, Ross and Thilmann 1984, of the ankle).
        contracture: Smallest and greatest angle of hip and knee that tissue lets be [rad].
        tissue: Passive stiffness of hip and knee [N m/rad].
        viscosity: Passive damping of hip and knee [N m s/rad]; with the healthy knee's the pendulum test shows the
            relaxation index of healthy adults, 1.678 +- 0.090 (Kim et al. 1996), and with its stiffness the angle at
            rest of 56 to 72 degrees (Bohannon et al. 2009, sides that a stroke left unaffected).
    """

    share: float = 1.0
    strength: tuple[float, float, float, float] = (1.8, 2.6, 1.40, 3.20)
    spasticity: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    threshold: float = 1.0
    clonus: float = 0.0
    clonus_hz: float = 5.0
    contracture: tuple[tuple[float, float], tuple[float, float]] = ((-_EVER, _EVER), (-_EVER, _EVER))
    tissue: tuple[float, float] = (6.0, 5.0)
    viscosity: tuple[float, float] = (1.0, 0.55)


@dataclass(frozen=True, slots=True)
class Person:
    """A person in the orthosis.

    Attributes:
        left: Left limb.
        right: Right limb.
        stride: Mean duration of an own stride [s].
        variation: Its coefficient of variation [-].
        amplitude: Size of the own gait as a share of the usual one.
        fatigue: Strength lost by full effort, and won back [1/s].
        fear: Co-contraction, 0-1.
    """

    left: Limb = field(default_factory=Limb)
    right: Limb = field(default_factory=Limb)
    stride: float = 1.3
    variation: float = 0.02
    amplitude: float = 1.0
    fatigue: tuple[float, float] = (0.002, 0.004)
    fear: float = 0.0


_HEALTHY = Limb()
_PARETIC = Limb(
    share=0.90 / 3.20,
    spasticity=(1.0, 0.5, 1.5, 1.0),
    threshold=0.6,
    tissue=(8.0, 5.5),
)
"""Knee extension 0.90 N m/kg on the paretic side (Watanabe et al. 2015, 238 people after a stroke)."""

_OTHER_SIDE = replace(_HEALTHY, share=1.24 / 3.20)
"""And 1.24 N m/kg on the other (the same)."""

_INCOMPLETE = Limb(
    share=0.35,
    spasticity=(1.0, 0.5, 1.2, 1.0),
    threshold=0.8,
    clonus=4.0,
    tissue=(8.0, 6.0),
)
_SPASTIC = Limb(
    share=0.6,
    spasticity=(3.0, 2.0, 5.5, 3.0),
    threshold=0.4,
    clonus=10.0,
    clonus_hz=6.0,
    contracture=((-0.10, _EVER), (0.15, 1.40)),
    tissue=(9.0, 6.5),
)

PERSONS = {
    "healthy": Person(),
    "hemiparetic_left": Person(left=_PARETIC, right=_OTHER_SIDE, stride=1.8, variation=0.05, amplitude=0.75),
    "hemiparetic_right": Person(left=_OTHER_SIDE, right=_PARETIC, stride=1.8, variation=0.05, amplitude=0.75),
    "sci_incomplete": Person(
        left=_INCOMPLETE,
        right=replace(_INCOMPLETE, share=0.25),
        stride=2.4,
        variation=0.08,
        amplitude=0.6,
        fatigue=(0.010, 0.003),
        fear=0.2,
    ),
    "spastic": Person(
        left=_SPASTIC, right=_SPASTIC, stride=1.9, variation=0.06, amplitude=0.6, fatigue=(0.005, 0.004), fear=0.3
    ),
}
"""Healthy; weak on one side after a stroke; an incomplete injury of the spinal cord; spastic in both legs."""

BY_IMPAIRMENT = {"healthy": "healthy", "moderate": "hemiparetic_left", "severe": "sci_incomplete"}
"""Who walks for a patient's impairment (`patients.PRESETS`)."""

_REFLEX_S = 0.040
"""Delay of a stretch reflex of the knee [s]; a setting, not verified."""

_DRAWN, _HELD_BACK = (180.0, 110.0), (12.0, 6.0)
"""Stiffness and damping with which hip and knee are drawn to the own gait [N m/rad, N m s/rad]."""

_TISSUE_STOP = 400.0
"""Stiffness of a contracture [N m/rad]."""

_RESTING = (0.10, 0.25)
"""Angles at which the tissue of hip and knee rests [rad]."""

_CLONUS_STARTS, _CLONUS_LASTS = 2.0, 0.8
"""Speed of a stretch that starts clonus [rad/s], and time constant of its decay [s]."""


_FIRST_LEG = 0.5
"""Phase at which the own gait begins: with the leg with which a reference of the joints does, its left one being half a
cycle later."""


def write_person_in(memory: NDArray[np.float64], name: str, weight: float, rate: int, seed: int) -> None:
    """Fill the memory of a person, shape [gait_person.WALKER].

    Args:
        memory: Memory of the person.
        name: One of `PERSONS`.
        weight: Mass of the person [kg].
        rate: Ticks per second.
        seed: Seed of the strides.

    Raises:
        UsageError: The preset is unknown.
    """
    require_choice(name, PERSONS, "person in the orthosis")
    person = PERSONS[name]
    memory[gait_person.STRIDE] = memory[gait_person.STRIDE_NOW] = person.stride
    memory[gait_person.PHASE] = _FIRST_LEG
    memory[gait_person.VARIATION] = person.variation
    memory[gait_person.AMPLITUDE] = person.amplitude
    memory[gait_person.GAIT : gait_person.GAIT + 2 * gait_person.SERIES] = (*_HIP, *_KNEE)
    seed_noise(memory, gait_person.GENERATOR, seed)
    for number, limb in enumerate((person.left, person.right)):
        own = gait_person.limb_of(memory, number)
        _write_limb(own, limb, weight, rate)
        own[gait_person.FEAR] = person.fear
        own[gait_person.FATIGUE], own[gait_person.RECOVERY] = person.fatigue


def _write_limb(own: NDArray[np.float64], limb: Limb, weight: float, rate: int) -> None:
    own[gait_person.SHARE] = limb.share
    own[gait_person.STRENGTH : gait_person.STRENGTH + 4] = weight * np.array(limb.strength)
    own[gait_person.STIFFNESS : gait_person.STIFFNESS + 2] = _DRAWN
    own[gait_person.DAMPING : gait_person.DAMPING + 2] = _HELD_BACK
    own[gait_person.SPASTICITY : gait_person.SPASTICITY + 4] = limb.spasticity
    own[gait_person.THRESHOLD] = limb.threshold
    own[gait_person.CLONUS], own[gait_person.CLONUS_HZ] = limb.clonus, limb.clonus_hz
    own[gait_person.CLONUS_SPEED], own[gait_person.CLONUS_TIME] = _CLONUS_STARTS, _CLONUS_LASTS
    for joint, (least, most) in enumerate(limb.contracture):
        own[gait_person.CONTRACTURE_MIN + joint], own[gait_person.CONTRACTURE_MAX + joint] = least, most
    own[gait_person.CONTRACTURE] = _TISSUE_STOP
    own[gait_person.PASSIVE_STIFFNESS : gait_person.PASSIVE_STIFFNESS + 2] = limb.tissue
    own[gait_person.PASSIVE_DAMPING : gait_person.PASSIVE_DAMPING + 2] = limb.viscosity
    own[gait_person.REST : gait_person.REST + 2] = _RESTING
    own[gait_person.REFLEX_TICKS] = round(_REFLEX_S * rate)
