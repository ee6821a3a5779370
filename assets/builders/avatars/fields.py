"""Solid shapes as distance fields, blended smoothly: the primitives of the model of a body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["F8", "Ball", "Blend", "Curve", "Field", "Loft", "Mirrored", "Vector", "gradient", "step"]

Vector = Sequence[float] | F8
"""A point or direction of three numbers."""

_PROBE = 4e-4
"""Step of the finite differences of a gradient [m]."""


class Field(Protocol):
    """Distance to a surface [m], negative inside; a good approximation near it."""

    def at(self, places: F8) -> F8:
        """Return distances [n] of points [n, 3]."""
        ...


def step(low: float | F8, high: float | F8, x: F8) -> F8:
    """Return 0 up to `low`, 1 from `high` on, 3t^2 - 2t^3 between; `low` may be the greater."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    smooth: F8 = t * t * (3.0 - 2.0 * t)
    return smooth


class Curve:
    """Monotone cubic interpolation of values over a rising parameter (Fritsch and Butland 1984).

    Args:
        at: Parameters, rising, [n].
        values: One row each, [n, m].
    """

    def __init__(self, at: Sequence[float], values: Sequence[Sequence[float]]) -> None:
        self._at, self._values = np.asarray(at, float), np.asarray(values, float)
        gaps = np.diff(self._at)[:, None]
        slopes = np.diff(self._values, axis=0) / gaps
        before, after = slopes[:-1], slopes[1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = 3.0 / (1.0 / before + 1.0 / after + 1.0 / (0.5 * (before + after)))
        inner = np.where(before * after > 0.0, mean, 0.0)
        self._slopes = np.vstack([slopes[:1], inner, slopes[-1:]])

    def __call__(self, x: F8) -> F8:
        """Values [k, m] at parameters [k], held beyond the ends."""
        x = np.clip(x, self._at[0], self._at[-1])
        i = np.clip(np.searchsorted(self._at, x, "right") - 1, 0, len(self._at) - 2)
        gap = (self._at[i + 1] - self._at[i])[:, None]
        t = (x - self._at[i])[:, None] / gap
        a, b, p, q = self._values[i], self._values[i + 1], self._slopes[i] * gap, self._slopes[i + 1] * gap
        found: F8 = a + t * (p + t * (3.0 * (b - a) - 2.0 * p - q + t * (2.0 * (a - b) + p + q)))
        return found


class Loft:
    """A stem from `foot` to `top` with superelliptic sections.

    Args:
        foot, top: Ends of its axis [m].
        rows: Per section: place along the axis 0 to 1, half width, half depth, shift across, shift forward [m].
        front: Roughly where the depth points.
        power: 2 is an ellipse, more is squarer.
    """

    def __init__(
        self,
        foot: Vector,
        top: Vector,
        rows: Sequence[Sequence[float]],
        front: Vector = (0.0, 0.0, 1.0),
        power: float = 2.0,
    ) -> None:
        self.foot, self.top = np.asarray(foot, float), np.asarray(top, float)
        self.length = float(np.linalg.norm(self.top - self.foot))
        self.along = (self.top - self.foot) / self.length
        ahead = np.asarray(front, float)
        ahead = ahead - (ahead @ self.along) * self.along
        self.ahead = ahead / np.linalg.norm(ahead)
        self.across = np.cross(self.along, self.ahead)
        self._sections = Curve([row[0] for row in rows], [row[1:] for row in rows])
        self._power = power

    def at(self, places: F8) -> F8:
        """As `Field`."""
        offset = places - self.foot
        height = offset @ self.along
        section = self._sections(np.clip(height / self.length, 0.0, 1.0))
        x = offset @ self.across - section[:, 2]
        z = offset @ self.ahead - section[:, 3]
        n = self._power
        share = (np.abs(x / section[:, 0]) ** n + np.abs(z / section[:, 1]) ** n) ** (1.0 / n)
        away = np.sqrt(x * x + z * z)
        small = np.minimum(section[:, 0], section[:, 1])
        beside = np.where(share < 0.2, -0.8 * small, away * (1.0 - 1.0 / np.maximum(share, 0.2)))
        beyond = np.maximum(-height, height - self.length)
        outside = np.sqrt(np.maximum(beside, 0.0) ** 2 + np.maximum(beyond, 0.0) ** 2)
        return np.where(beyond > 0.0, outside, beside)


class Ball:
    """An ellipsoid.

    Args:
        centre: [m].
        radii: Along its axes [m].
        axes: Rows are its axes; none: those of the body.
    """

    def __init__(self, centre: Vector, radii: Vector, axes: F8 | None = None) -> None:
        self._centre, self._radii = np.asarray(centre, float), np.asarray(radii, float)
        self._axes = axes

    def at(self, places: F8) -> F8:
        """As `Field`."""
        offset = places - self._centre
        if self._axes is not None:
            offset = offset @ self._axes.T
        near = np.sqrt(((offset / self._radii) ** 2).sum(axis=1))
        steep = np.sqrt(((offset / self._radii**2) ** 2).sum(axis=1))
        result: F8 = near * (near - 1.0) / np.maximum(steep, 1e-6)
        return result


@dataclass(frozen=True)
class Blend:
    """Union of several fields, rounded over `radius` where they meet [m]."""

    parts: Sequence[Field]
    radius: float

    def at(self, places: F8) -> F8:
        """As `Field`."""
        total = self.parts[0].at(places)
        for part in self.parts[1:]:
            other = part.at(places)
            overlap = np.maximum(self.radius - np.abs(total - other), 0.0) / self.radius
            total = np.minimum(total, other) - overlap * overlap * self.radius * 0.25
        return total


@dataclass(frozen=True)
class Mirrored:
    """Both sides of a body by its left one; the right side is not blended with the left."""

    left: Field

    def at(self, places: F8) -> F8:
        """As `Field`."""
        return self.left.at(np.abs(places) * (1.0, 0.0, 0.0) + places * (0.0, 1.0, 1.0))


def gradient(field: Field, places: F8) -> F8:
    """Return the gradient of a field, [n, 3]: of unit length and outwards near the surface."""
    signs = np.array([[1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]])
    total = np.zeros_like(places)
    for sign in signs:
        total += sign * field.at(places + _PROBE * sign)[:, None]
    return total / (4.0 * _PROBE)
