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
from pathlib import Path

import numpy as np

from assets.builders.avatars.cage import Cage
from assets.builders.avatars.fields import F8
from assets.builders.avatars.person import Person
from assets.builders.avatars.skeleton import Skeleton
from mimics_app.contracts.system.table_file import read_table_file

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


TABLE = read_table_file(Path(__file__).with_suffix(".json"), dict[str, Measure])
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
    from scipy.spatial import ConvexHull

    middle = ring.mean(axis=0)
    axes = np.linalg.svd(ring - middle)[2][:2]
    flat = (ring - middle) @ axes.T
    return float(ConvexHull(flat).area)  # of a hull in a plane: its length
