"""Hanging cord in closed form: the catenary by arc length, its frame, and ripples on its surface. float64.

The catenary through two points is planar, so that its binormal is constant and a frame along it has no twist. A swing
rotates its plane about the line through both ends without a change of shape and length. shaders/cord/cord.vert
evaluates the same equations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.contracts.arrays import F8
from mimics_app.maths.poses import rotation_from_vector

__all__ = ["Catenary", "Ripple", "Ripples", "hang"]


_TAUT = 1e-9
"""Excess of a cord's length over its chord below which it is straight [-]."""

_LEAST_SPAN = 1e-3
"""Smallest horizontal distance of the ends, relative to the length [-]: with ends above each other a cord is a fold."""

_NEWTON = 60
"""Largest number of Newton steps."""

_STRAIGHT_A = 1e7
"""Parameter a of a straight cord [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Catenary:
    """A cord between two points.

    Attributes:
        start: First end [m], float64 [3].
        along: Horizontal axis of its plane, unit, rotated by the swing; float64 [3].
        up: Vertical axis of its plane, unit, rotated by the swing; float64 [3].
        a: Parameter of the catenary [m]: the radius of curvature at the lowest point.
        q: Slope at the start, sinh of the parameter u there [-].
        length: Arc length [m].
    """

    start: F8
    along: F8
    up: F8
    a: float
    q: float
    length: float

    @property
    def binormal(self) -> F8:
        """Unit normal of its plane, the same everywhere; float64 [3]."""
        return np.cross(self.along, self.up)

    @property
    def bend(self) -> float:
        """Largest curvature [1/m]."""
        p = self.q + self.length / self.a
        steepest = 0.0 if self.q * p <= 0.0 else min(abs(self.q), abs(p))
        return 1.0 / (self.a * (1.0 + steepest**2))

    def point(self, s: ArrayLike) -> F8:
        """Points at arc lengths from the start [m], shape [n, 3], without cancellation in a taut cord."""
        w = np.atleast_1d(np.asarray(s, np.float64)) / self.a
        p, q = self.q + w, self.q
        root_p, root_q = np.sqrt(1.0 + p * p), math.sqrt(1.0 + q * q)
        # asinh p - asinh q = asinh(p root_q - q root_p); for p and q of one sign that difference as a fraction.
        with np.errstate(invalid="ignore", divide="ignore"):
            same = w * (p + q) / (p * root_q + q * root_p)
        apart = np.where(p * q > 0.0, same, p * root_q - q * root_p)
        x = self.a * np.arcsinh(apart)
        y = self.a * w * (p + q) / (root_p + root_q)
        return np.asarray(self.start + x[:, None] * self.along + y[:, None] * self.up)

    def tangent(self, s: ArrayLike) -> F8:
        """Unit tangents, shape [n, 3]."""
        p = self.q + np.atleast_1d(np.asarray(s, np.float64)) / self.a
        root = np.sqrt(1.0 + p * p)[:, None]
        return np.asarray((self.along + p[:, None] * self.up) / root)

    def normal(self, s: ArrayLike) -> F8:
        """Unit normals in its plane towards the centre of curvature, shape [n, 3]."""
        p = self.q + np.atleast_1d(np.asarray(s, np.float64)) / self.a
        root = np.sqrt(1.0 + p * p)[:, None]
        return np.asarray((self.up - p[:, None] * self.along) / root)

    def curvature(self, s: ArrayLike) -> F8:
        """Curvature [1/m], shape [n]."""
        p = self.q + np.atleast_1d(np.asarray(s, np.float64)) / self.a
        return np.asarray(1.0 / (self.a * (1.0 + p * p)))


def hang(start: ArrayLike, end: ArrayLike, length: float, swing: float = 0.0) -> Catenary:
    """Cord of a given length between two points.

    A cord shorter than the distance of the points is stretched to a straight line of that length.

    Args:
        start: First end [m], shape [3].
        end: Second end [m], shape [3].
        length: Arc length [m], > 0.
        swing: Rotation of its plane about the line through both ends [rad]; 0: it hangs down.
    """
    first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
    chord = last - first
    rise, flat = float(chord[1]), np.array([chord[0], 0.0, chord[2]])
    across = float(np.linalg.norm(flat))
    whole = float(np.linalg.norm(chord))
    along = flat / across if across > 0.0 else np.array([1.0, 0.0, 0.0])
    across = max(across, _LEAST_SPAN * length)
    reach = math.sqrt(max(length * length - rise * rise, 0.0))
    if length <= whole * (1.0 + _TAUT) or reach <= across:  # the latter: taut, with its ends above each other
        return _straight(first, chord, whole)
    x = _sag(reach / across)
    a = across / (2.0 * x)
    # The mean of u over the cord follows from rise / length; the shader starts from sinh of its lower end.
    middle = math.atanh(min(max(rise / length, -1.0 + 1e-15), 1.0 - 1e-15))
    up = np.array([0.0, 1.0, 0.0])
    if swing and whole > 0.0:
        turn = rotation_from_vector(swing * chord / whole)
        along, up = turn @ along, turn @ up
    return Catenary(first, along, up, a, math.sinh(middle - x), length)


def _straight(first: F8, chord: F8, whole: float) -> Catenary:
    """Straight cord along the chord, of its length `whole` [m]."""
    along = chord / whole if whole > 0.0 else np.array([1.0, 0.0, 0.0])
    side = np.array([0.0, 1.0, 0.0]) if abs(along[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    up = side - along * float(side @ along)
    return Catenary(first, along, up / np.linalg.norm(up), _STRAIGHT_A, 0.0, max(whole, 1e-9))


def _sag(ratio: float) -> float:
    """Root x > 0 of sinh(x) / x = ratio, by Newton's method from above."""
    x = math.sqrt(6.0 * (ratio - 1.0)) if ratio < 3.0 else math.log(2.0 * ratio) + math.log(math.log(2.0 * ratio))
    if x < 1e-3:  # the series x^2 / 6 + x^4 / 120: sinh(x) / x - 1 would cancel
        excess = ratio - 1.0
        return math.sqrt(6.0 * excess * (1.0 - 0.3 * excess))
    for _ in range(_NEWTON):
        step = (math.sinh(x) / x - ratio) * x * x / (math.cosh(x) * x - math.sinh(x))
        x -= step
        if abs(step) < 1e-16 * x:
            break
    return x


@dataclass(frozen=True, slots=True)
class Ripple:
    """Ripple of one tap.

    Attributes:
        s: Position of the tap along the cord [m].
        theta: Angle of the tap around the cord [rad].
        age: Time since the tap [s].
        height: Height of the first crest [m].
    """

    s: float
    theta: float
    age: float
    height: float


@dataclass(frozen=True, slots=True)
class Ripples:
    """Wave law of ripples: h = A exp(-alpha d - beta t) cos(k x) exp(-(x / w)^2), x = d - c t, over the distance d.

    Attributes:
        speed: Speed c of the crest [m/s].
        wavelength: Wavelength 2 pi / k [m].
        width: Width w of the wave group [m].
        along: Damping alpha by distance [1/m].
        over_time: Damping beta by time [1/s].
    """

    speed: float = 0.5
    wavelength: float = 0.05
    width: float = 0.035
    along: float = 1.5
    over_time: float = 1.2

    def height(self, ripple: Ripple, radius: float, s: ArrayLike, theta: ArrayLike) -> tuple[F8, F8, F8]:
        """Height of the surface, and its slopes.

        The distance is the geodesic one on a straight cord.

        Args:
            ripple: The ripple.
            radius: Radius of the cord [m].
            s: Positions along the cord [m].
            theta: Angles around the cord [rad].

        Returns:
            h [m], dh/ds [-], dh/dtheta [m/rad], each of the broadcast shape of s and theta.
        """
        ds = np.asarray(s, np.float64) - ripple.s
        dt = np.remainder(np.asarray(theta, np.float64) - ripple.theta + np.pi, 2.0 * np.pi) - np.pi
        d = np.sqrt(ds * ds + (radius * dt) ** 2)
        x, k = d - self.speed * ripple.age, 2.0 * np.pi / self.wavelength
        envelope = ripple.height * np.exp(-self.along * d - self.over_time * ripple.age - (x / self.width) ** 2)
        h = envelope * np.cos(k * x)
        slope = -envelope * (k * np.sin(k * x) + (self.along + 2.0 * x / self.width**2) * np.cos(k * x))
        safe = np.maximum(d, 1e-6)
        return h, slope * ds / safe, slope * radius * radius * dt / safe

    def surface(self, cord: Catenary, radius: float, ripples: list[Ripple], s: F8, theta: F8) -> tuple[F8, F8]:
        """Points of the rippled surface [m] and its unit normals, shape [n, 3] each."""
        parts = [self.height(each, radius, s, theta) for each in ripples]
        h, hs, ht = (sum((part[i] for part in parts), np.zeros_like(s)) for i in range(3))
        tangent, normal, binormal = cord.tangent(s), cord.normal(s), cord.binormal
        cos, sin = np.cos(theta)[:, None], np.sin(theta)[:, None]
        out, around = cos * normal + sin * binormal, cos * binormal - sin * normal
        r = radius + h
        stretch = 1.0 - cord.curvature(s) * r * np.cos(theta)
        direction = out - (hs / stretch)[:, None] * tangent - (ht / r)[:, None] * around
        return cord.point(s) + r[:, None] * out, direction / np.linalg.norm(direction, axis=1, keepdims=True)
