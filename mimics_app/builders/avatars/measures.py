"""Body measures of adults with their percentiles, and their measurement on a modelled body.

Source: C. C. Gordon et al., 2012 Anthropometric Survey of U.S. Army Personnel: Methods and Summary Statistics, Natick
technical report TR-15/007, 2014 (4082 men, 1986 women). Each measure is defined in S. Hotzman et al., Measurer's
Handbook, Natick TR-11/017, 2011, on the page that stands beside it. Lengths are the report's mean and standard
deviation; girths are rounded to 5 mm. The 5th and the 95th percentile are taken as the mean -+ 1.645 deviations: those
that the report counts differ a little where people are not spread evenly about the mean, as in waist and hip. The
pages are those of the definitions, not those of the report's tables.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.builders.avatars.cage import Cage
from mimics_app.builders.avatars.fields import F8
from mimics_app.builders.avatars.person import Person
from mimics_app.builders.avatars.skeleton import Skeleton

__all__ = ["TABLE", "Measure", "measure"]

_SHARE = 1.645
"""Standard deviations from the mean to the 5th and to the 95th percentile of a normal distribution."""


@dataclass(frozen=True)
class Measure:
    """One row: page of the handbook; mean and deviation of women, then of men [m]."""

    page: int
    women: tuple[float, float]
    men: tuple[float, float]

    def band(self, *, woman: bool) -> tuple[float, float]:
        """5th and 95th percentile [m]."""
        mean, deviation = self.women if woman else self.men
        return mean - _SHARE * deviation, mean + _SHARE * deviation


TABLE = {
    "stature": Measure(162, (1.6285, 0.0642), (1.7562, 0.0686)),
    "acromial_height": Measure(88, (1.3351, 0.0581), (1.4407, 0.0633)),
    "shoulders": Measure(95, (0.3653, 0.0183), (0.4157, 0.0192)),
    "upper_arm": Measure(89, (0.3112, 0.0172), (0.3352, 0.0175)),
    "forearm": Measure(154, (0.2413, 0.0152), (0.2679, 0.0154)),
    "hand": Measure(132, (0.1811, 0.0101), (0.1933, 0.0099)),
    "knee_height": Measure(143, (0.4659, 0.0271), (0.4917, 0.0266)),
    "hip_height": Measure(170, (0.8454, 0.0447), (0.9009, 0.0492)),
    "neck": Measure(149, (0.330, 0.020), (0.400, 0.025)),
    "chest": Measure(111, (0.945, 0.085), (1.060, 0.085)),
    "waist": Measure(174, (0.860, 0.100), (0.940, 0.110)),
    "hip": Measure(103, (1.020, 0.075), (1.020, 0.075)),
    "thigh": Measure(165, (0.615, 0.055), (0.625, 0.060)),
    "calf": Measure(108, (0.375, 0.030), (0.390, 0.030)),
    "ankle": Measure(91, (0.215, 0.015), (0.230, 0.015)),
    "wrist": Measure(179, (0.155, 0.010), (0.175, 0.010)),
}
"""By name."""


def measure(person: Person, bones: Skeleton, cage: Cage) -> dict[str, float]:
    """Return measures of a modelled body [m] by the table's names; girths are those of convex hulls of slices."""
    h = person.body.stature
    shoulder, elbow, wrist = (bones.place(f"left{name}") for name in ("UpperArm", "LowerArm", "Hand"))
    side = cage.places[cage.trunk[16][8]]
    trunk = cage.trunk
    found = {
        "stature": h,
        "acromial_height": float(side[1]),
        "shoulders": 2.0 * float(shoulder[0] + 0.024),
        "upper_arm": float(np.linalg.norm(elbow - shoulder)) + 0.030,
        "forearm": float(np.linalg.norm(wrist - elbow)) - 0.004,
        "hand": float(np.linalg.norm(bones.tips["leftMiddleTip"] - wrist)) + 0.002,
        "knee_height": float(bones.place("leftLowerLeg")[1]) - 0.010,
        "hip_height": float(bones.place("leftUpperLeg")[1]) - 0.008,
        "neck": tape(cage.places[trunk[-1]]),
        "chest": max(tape(cage.places[trunk[row]]) for row in (9, 10, 11)),
        "waist": tape(cage.places[trunk[6]]),
        "hip": max(tape(cage.places[trunk[row]]) for row in (1, 2, 3)),
    }
    legs, arms = cage.legs[1], cage.arms[1]
    found |= {
        "thigh": tape(cage.places[legs[2]]),
        "calf": max(tape(cage.places[row]) for row in legs[8:12]),
        "ankle": min(tape(cage.places[row]) for row in legs[-3:]),
        "wrist": min(tape(cage.places[row]) for row in arms[-2:]),
    }
    return found


def tape(ring: F8) -> float:
    """Return the length of a tape drawn tight around a ring of points [m]."""
    middle = ring.mean(axis=0)
    axes = np.linalg.svd(ring - middle)[2][:2]
    flat = (ring - middle) @ axes.T
    order = np.lexsort((flat[:, 1], flat[:, 0]))
    hull: list[F8] = []
    for points in (flat[order], flat[order[::-1]]):
        part: list[F8] = []
        for point in points:
            while len(part) > 1 and _turn(part[-2], part[-1], point) <= 0.0:
                part.pop()
            part.append(point)
        hull += part[:-1]
    closed = np.array([*hull, hull[0]])
    return float(np.linalg.norm(np.diff(closed, axis=0), axis=1).sum())


def _turn(a: F8, b: F8, c: F8) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
