"""Volume, centre and inertia of bodies of uniform density."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = [
    "FilledShape",
    "box_integrals",
    "capsule_integrals",
    "combine",
    "cylinder_integrals",
    "sphere_integrals",
]


@dataclass(frozen=True, eq=False)
class FilledShape:
    """One solid shape of density 1 in the frame of its body.

    Attributes:
        volume: Volume [m^3].
        centre: Centre of the volume, body frame [m], shape [3].
        inertia: Inertia about that centre, body axes, for 1 kg/m^3 [m^5], shape [3, 3].
    """

    volume: float
    centre: F8
    inertia: F8

    def placed(self, position: F8, R: F8) -> FilledShape:
        """Return the shape in a frame in which its own frame has this position and rotation."""
        return FilledShape(self.volume, position + R @ self.centre, R @ self.inertia @ R.T)


def box_integrals(size: Sequence[float]) -> FilledShape:
    """Box with these edges [m]: V/12 (b^2 + c^2) about x, and so on."""
    a, b, c = (edge * edge for edge in size)
    volume = float(np.prod(size))
    return FilledShape(volume, np.zeros(3), np.diag([b + c, a + c, a + b]) * (volume / 12.0))


def sphere_integrals(radius: float) -> FilledShape:
    """Sphere: 2/5 V r^2."""
    volume = 4.0 / 3.0 * math.pi * radius**3
    return FilledShape(volume, np.zeros(3), np.eye(3) * (0.4 * volume * radius * radius))


def cylinder_integrals(radius: float, length: float) -> FilledShape:
    """Cylinder about y: V r^2/2 along it, V (3 r^2 + l^2)/12 across."""
    volume = math.pi * radius * radius * length
    across = volume * (3.0 * radius * radius + length * length) / 12.0
    return FilledShape(volume, np.zeros(3), np.diag([across, 0.5 * volume * radius * radius, across]))


def capsule_integrals(radius: float, length: float) -> FilledShape:
    """Capsule about y, `length` between the centres of its half spheres [m].

    A half sphere of volume V has its centre 3/8 r beyond its flat face and 83/320 V r^2 across about it.
    """
    middle = cylinder_integrals(radius, length)
    half = 2.0 / 3.0 * math.pi * radius**3
    out = 0.5 * length + 0.375 * radius
    across = half * radius * radius * 83.0 / 320.0 + half * out * out
    ends = 2.0 * np.diag([across, 0.4 * half * radius * radius, across])
    return FilledShape(middle.volume + 2.0 * half, np.zeros(3), middle.inertia + ends)


def combine(parts: Sequence[FilledShape]) -> FilledShape:
    """Combine shapes (parallel axis theorem); overlaps count twice. At least one must have a positive volume."""
    volume = sum(part.volume for part in parts)
    centre = sum((part.volume * part.centre for part in parts), np.zeros(3)) / volume
    inertia = np.zeros((3, 3))
    for part in parts:
        r = part.centre - centre
        inertia += part.inertia + part.volume * (float(r @ r) * np.eye(3) - np.outer(r, r))
    return FilledShape(volume, centre, inertia)
