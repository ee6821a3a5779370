"""Lengths and masses of the segments of a leg by height and weight (Winter, Biomechanics, table 4.1, after Dempster).

Masses, centres of mass and radii of gyration, rows "Thigh" (greater trochanter to femoral condyles) and "Foot and leg"
(femoral condyles to medial malleolus), were read in two copies of the table that agree: the sheet "Dempster's Body
Segment Parameter Data for 2-D Studies", which names the second edition of 1990, and `data/BSP_DempsterWinter.txt` of
BMClab/BMC, which names that of 2009.
"""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.errors import DeviceError

__all__ = ["HEIGHT", "WEIGHT", "Segments", "segments_of"]

HEIGHT, WEIGHT = 1.75, 75.0
"""Person that a scene does not describe [m, kg]."""

_SHORTEST, _TALLEST = 1.0, 2.2
_LIGHTEST, _HEAVIEST = 20.0, 160.0

_THIGH, _SHANK, _ANKLE = 0.245, 0.246, 0.039
"""Lengths of thigh and shank, and height of the ankle, as shares of the height."""

_BALL, _HEEL = 0.085, -0.03
"""Places of ball of the foot and heel before the ankle, as shares of the height; a setting, not verified."""

_HIPS = 0.114
"""Distance between the hips as a share of the height; a setting, not verified."""

_THIGH_MASS, _SHANK_MASS = 0.100, 0.061
"""Masses of a thigh, and of a shank with its foot, as shares of the weight."""

_THIGH_COM, _SHANK_COM = 0.433, 0.606
"""Centres of mass from the upper joint, as shares of the length."""

_THIGH_GYRATION, _SHANK_GYRATION = 0.323, 0.416
"""Radii of gyration about the centre of mass, as shares of the length."""


@dataclass(frozen=True, slots=True)
class Segments:
    """Segments of a leg.

    Attributes:
        thigh: Length [m].
        shank: Length from knee to ankle [m].
        ankle: Height of the ankle above the sole [m].
        ball: Distance of the ball of the foot before the ankle [m].
        heel: The same of the heel [m], negative.
        hips: Distance between the hips [m].
        masses: Thigh, and shank with foot [kg].
        coms: Their centres of mass below hip and knee [m].
        inertias: About these [kg m^2].
        weight: Of the whole person [kg].
    """

    thigh: float
    shank: float
    ankle: float
    ball: float
    heel: float
    hips: float
    masses: tuple[float, float]
    coms: tuple[float, float]
    inertias: tuple[float, float]
    weight: float


def segments_of(height: object, weight: object) -> Segments:
    """Return the segments of a leg of a person.

    Args:
        height: Of the person [m].
        weight: Mass of the person [kg].

    Raises:
        DeviceError: A number out of the range of people.
    """
    tall = _checked("height", height, _SHORTEST, _TALLEST, "metres")
    heavy = _checked("weight", weight, _LIGHTEST, _HEAVIEST, "kilograms")
    lengths = (_THIGH * tall, _SHANK * tall)
    masses = (_THIGH_MASS * heavy, _SHANK_MASS * heavy)
    return Segments(
        thigh=lengths[0],
        shank=lengths[1],
        ankle=_ANKLE * tall,
        ball=_BALL * tall,
        heel=_HEEL * tall,
        hips=_HIPS * tall,
        masses=masses,
        coms=(_THIGH_COM * lengths[0], _SHANK_COM * lengths[1]),
        inertias=(masses[0] * (_THIGH_GYRATION * lengths[0]) ** 2, masses[1] * (_SHANK_GYRATION * lengths[1]) ** 2),
        weight=heavy,
    )


def _checked(name: str, given: object, least: float, most: float, unit: str) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not least <= given <= most:
        raise DeviceError(f'the "{name}" of the person is {given!r}', f"give {unit} between {least:g} and {most:g}")
    return float(given)
