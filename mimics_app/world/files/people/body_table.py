"""Bodies of the shipped people under their clothes, and the measures that are asked of a person.

Measures are those of C. C. Gordon et al., 2012 Anthropometric Survey of U.S. Army Personnel, Natick TR-15/007, by the
names of `LENGTHS` and `GIRTHS`; all in metres.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.resources import root
from mimics_app.contracts.system.table_file import read_table_file

__all__ = ["FOLDER", "GIRTHS", "LENGTHS", "Body", "Sex", "read_bodies", "tape"]

Sex = Literal["f", "m"]

LENGTHS = ("acromial_height", "shoulders", "upper_arm", "forearm", "hand", "hip_height", "knee_height", "foot")
"""Heights over the ground of acromion, trochanter and kneecap; breadth between the acromia; lengths of limbs."""
GIRTHS = ("neck", "chest", "waist", "hip", "thigh", "calf", "ankle", "biceps", "wrist")
"""By a tape drawn tight, so over the hollows."""

FOLDER = "assets/models/avatars"
"""Folder of the shipped people, below the root of the shipped files."""


class Body(msgspec.Struct, frozen=True):
    """Body of one of the shipped people at rest, +y up, +z ahead, +x its left.

    Attributes:
        sex: "f" or "m".
        age: Age that the person looks [years].
        mass: Of a body of this volume, in kilograms.
        lengths: By name, with "stature" [m].
        rings: Points of the skin around which the tape of each girth lies; of limbs, the left one [m].
    """

    sex: Sex
    age: float
    mass: float
    lengths: dict[str, float]
    rings: dict[str, list[tuple[float, float, float]]]

    @property
    def stature(self) -> float:
        """Height without shoes [m]."""
        return self.lengths["stature"]

    def ring(self, name: str) -> F8:
        """Return the points of a girth [m], float64 [n, 3]."""
        return np.array(self.rings[name], np.float64)

    def girth(self, name: str) -> float:
        """Return a girth [m]."""
        return tape(self.ring(name))


def read_bodies() -> dict[str, Body]:
    """Return the bodies of all shipped people by name."""
    return read_table_file(Path(root()) / FOLDER / "bodies.json", dict[str, Body])


def tape(ring: F8) -> float:
    """Return the length of a tape drawn tight around points [n, 3], in the plane that fits them best [m]."""
    from scipy.spatial import ConvexHull

    middle = ring.mean(axis=0)
    axes = np.linalg.svd(ring - middle)[2][:2]
    return float(ConvexHull((ring - middle) @ axes.T).area)  # of a hull in a plane: its length
