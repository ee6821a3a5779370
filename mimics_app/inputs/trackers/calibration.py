"""Calibration of a tracker: axes and unit of its frame, and a similarity fitted to points touched in the room."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import UsageError

__all__ = ["UNITS", "Calibration", "axis_map", "fit_room"]


UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254}
"""Metres per unit of a device."""

_LEAST_POINTS = 4
"""Smallest number of points: three lie in a plane, fit exactly and hide every mistake."""

_FLAT = 1e-3
"""Smallest ratio of the points' smallest spread to the largest: below it they lie in a plane."""
_UPSIDE_DOWN = math.cos(math.radians(120.0))
"""Cosine between the tracker's up and the room's below which the tracker is upside down."""


def axis_map(text: str) -> F8:
    """Return the rotation from a device's axes to the room's, e.g. "x,-z,y": room x is its x, y its -z, z its y.

    Returns:
        float64 [3, 3].

    Raises:
        UsageError: An axis is missing, or the three are left-handed: then one sign is wrong.
    """
    names = {"x": 0, "y": 1, "z": 2}
    rows = [part.strip() for part in text.split(",")]
    matrix = np.zeros((3, 3))
    for row, part in enumerate(rows[:3]):
        name = part.lstrip("+-")
        if name in names:
            matrix[row, names[name]] = -1.0 if part.startswith("-") else 1.0
    if len(rows) != 3 or abs(float(np.linalg.det(matrix))) < 0.5:
        raise UsageError(f'"{text}" does not name three axes', 'write them like "x,-z,y"')
    if np.linalg.det(matrix) < 0.0:
        raise UsageError(f'the axes "{text}" are left-handed: they mirror the room', "change the sign of one of them")
    return matrix


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """Similarity from a tracker's frame, with axes and unit already mapped, to the room's.

    Attributes:
        rotation: float64 [3, 3].
        scale: Room metres per tracker metre.
        translation: [m], float64 [3].
        residual_m: Root mean square residual at the points [m].
        worst_m: Largest residual [m].
        fault: Suspected fault of the calibration, "" for none.
    """

    rotation: F8
    scale: float
    translation: F8
    residual_m: float = 0.0
    worst_m: float = 0.0
    fault: str = ""

    @classmethod
    def none(cls) -> Calibration:
        """Return the identity."""
        return cls(np.eye(3), 1.0, np.zeros(3))

    def apply(self, pose: F8) -> F8:
        """Return room_from_sensor of a pose in the tracker's frame, float64 [4, 4]; only the translation is scaled."""
        moved = np.eye(4)
        moved[:3, :3] = self.rotation @ pose[:3, :3]
        moved[:3, 3] = self.scale * (self.rotation @ pose[:3, 3]) + self.translation
        return moved


def fit_room(seen: Sequence[Sequence[float]] | F8, room: Sequence[Sequence[float]] | F8) -> Calibration:
    """Fit the similarity of least squares (Umeyama 1991).

    Args:
        seen: Points as the tracker reports them [m], shape [n, 3], n >= 4.
        room: The same points in the room [m], not in one plane.

    Raises:
        UsageError: Too few points, or all in a plane: a mirror image would fit as well; or the tracker reported the
            same point each time.
    """
    a, b = np.asarray(seen, np.float64).reshape(-1, 3), np.asarray(room, np.float64).reshape(-1, 3)
    if len(a) != len(b) or len(a) < _LEAST_POINTS:
        raise UsageError(f"{min(len(a), len(b))} points are too few to calibrate", f"touch at least {_LEAST_POINTS}")
    centre_a, centre_b = a.mean(axis=0), b.mean(axis=0)
    da, db = a - centre_a, b - centre_b
    spread = np.linalg.svd(db, compute_uv=False)
    if spread[2] <= _FLAT * spread[0]:
        raise UsageError("the points lie in a plane", "touch one well above or below the others")
    if not da.any():
        raise UsageError("the tracker reported the same point each time", "move its sensor into range")
    u, s, vt = np.linalg.svd(db.T @ da / len(a))
    proper = math.copysign(1.0, float(np.linalg.det(u @ vt)))
    found, mirrored = (_fit(a, b, u, s, vt, sign) for sign in (proper, -proper))
    return replace(found, fault=_suspicion(found, mirrored, float(spread[0])))


def _fit(a: F8, b: F8, u: F8, s: F8, vt: F8, sign: float) -> Calibration:
    """Return the best similarity of one handedness, given by the sign of the smallest singular value."""
    signs = np.array([1.0, 1.0, sign])
    rotation = (u * signs) @ vt
    centre_a, centre_b = a.mean(axis=0), b.mean(axis=0)
    scale = float(np.sum(s * signs) / np.mean(np.sum((a - centre_a) ** 2, axis=1)))
    translation = centre_b - scale * rotation @ centre_a
    left = np.linalg.norm(b - (scale * a @ rotation.T + translation), axis=1)
    return Calibration(rotation, scale, translation, float(np.sqrt(np.mean(left**2))), float(left.max()))


def _suspicion(found: Calibration, mirrored: Calibration, extent: float) -> str:
    bad = 0.05 * extent
    if found.residual_m > bad > mirrored.residual_m:
        return "the points fit a mirror image: an axis of the tracker points the wrong way"
    if found.residual_m > bad:
        return "the points do not fit each other: one was probably touched in another order"
    if found.rotation[1, 1] < _UPSIDE_DOWN:
        return "the tracker is upside down: its up points down in the room"
    return ""
