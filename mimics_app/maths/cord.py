"""A hanging cord in closed form: the catenary by arc length, its frame, and ripples on its surface. float64.

The catenary through two points is planar, so that its binormal is constant and a frame along it has no twist at all.
Swinging turns its plane about the line through both ends: shape and length stay. What shaders/cord/cord.vert evaluates
is this, with the numbers of `Catenary.figures`.
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
"""Share by which a cord must be longer than its chord to hang at all."""
_PLUMB = 1e-3
"""Share of the length that the ends are apart sideways at least: exactly above each other a cord is a fold."""
_NEWTON = 60
_STRAIGHT_A = 1e7
"""Parameter a [m] of a cord that is straight for all purposes."""


@dataclass(frozen=True, slots=True, eq=False)
class Catenary:
    """A cord between two points.

    Attributes:
        start: Where it begins [m], float64 [3].
        along: Horizontal axis of its plane, unit, turned with the swing; float64 [3].
        up: The axis it sags against, unit, likewise; float64 [3].
        a: Parameter [m]: the radius of curvature at the lowest point.
        q: sinh of u at the start, u the slope's parameter: tan of the slope there.
        length: [m].
    """

    start: F8
    along: F8
    up: F8
    a: float
    q: float
    length: float

    @property
    def binormal(self) -> F8:
        """Across its plane, the same everywhere; float64 [3]."""
        return np.cross(self.along, self.up)

    @property
    def bend(self) -> float:
        """Its greatest curvature [1/m]."""
        p = self.q + self.length / self.a
        steepest = 0.0 if self.q * p <= 0.0 else min(abs(self.q), abs(p))
        return 1.0 / (self.a * (1.0 + steepest**2))

    def point(self, s: ArrayLike) -> F8:
        """Places at arc lengths from the start [m], shape [n, 3]; differences never cancel, however taut it is."""
        w = np.atleast_1d(np.asarray(s, np.float64)) / self.a
        p, q = self.q + w, self.q
        root_p, root_q = np.sqrt(1.0 + p * p), math.sqrt(1.0 + q * q)
        # asinh p - asinh q = asinh(p root_q - q root_p): of one sign, that difference is taken as a fraction.
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
        """Unit normals in its plane, to the inside of its bend, shape [n, 3]."""
        p = self.q + np.atleast_1d(np.asarray(s, np.float64)) / self.a
        root = np.sqrt(1.0 + p * p)[:, None]
        return np.asarray((self.up - p[:, None] * self.along) / root)

    def curvature(self, s: ArrayLike) -> F8:
        """[1/m], shape [n]."""
        p = self.q + np.atleast_1d(np.asarray(s, np.float64)) / self.a
        return np.asarray(1.0 / (self.a * (1.0 + p * p)))


def hang(start: ArrayLike, end: ArrayLike, length: float, swing: float = 0.0) -> Catenary:
    """The cord of a length between two points.

    Shorter than the distance between them it is stretched straight, and its length is that way.

    Args:
        start: [m], shape [3].
        end: [m], shape [3].
        length: [m], > 0.
        swing: How far its plane is turned about the line through both ends [rad]; 0: it hangs down.
    """
    first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
    chord = last - first
    rise, flat = float(chord[1]), np.array([chord[0], 0.0, chord[2]])
    across = float(np.linalg.norm(flat))
    whole = float(np.linalg.norm(chord))
    if length <= whole * (1.0 + _TAUT):
        return _straight(first, chord, whole)
    along = flat / across if across > 0.0 else np.array([1.0, 0.0, 0.0])
    across = max(across, _PLUMB * length)
    x = _sag(math.sqrt(length * length - rise * rise) / across)
    a = across / (2.0 * x)
    # The middle of u is where the rise over the length says; sinh of its lower end is what the shader begins with.
    middle = math.atanh(min(max(rise / length, -1.0 + 1e-15), 1.0 - 1e-15))
    up = np.array([0.0, 1.0, 0.0])
    if swing and whole > 0.0:
        turn = rotation_from_vector(swing * chord / whole)
        along, up = turn @ along, turn @ up
    return Catenary(first, along, up, a, math.sinh(middle - x), length)


def _straight(first: F8, chord: F8, whole: float) -> Catenary:
    along = chord / whole if whole > 0.0 else np.array([1.0, 0.0, 0.0])
    side = np.array([0.0, 1.0, 0.0]) if abs(along[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    up = side - along * float(side @ along)
    return Catenary(first, along, up / np.linalg.norm(up), _STRAIGHT_A, 0.0, max(whole, 1e-9))


def _sag(ratio: float) -> float:
    """The x > 0 with sinh(x) / x = ratio, by Newton from above."""
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
    """What one tap sets off.

    Attributes:
        s: Where it was, along the cord [m].
        theta: And around it [rad].
        age: Since then [s].
        height: Of its first crest [m].
    """

    s: float
    theta: float
    age: float
    height: float


@dataclass(frozen=True, slots=True)
class Ripples:
    """How ripples run: h = A exp(-alpha d - beta t) cos(k x) exp(-(x / w)^2), x = d - c t, over the distance d.

    Attributes:
        speed: Of the crest, c [m/s].
        wavelength: [m].
        width: Of the group, w [m].
        along: Damping by distance, alpha [1/m].
        over_time: Damping by time, beta [1/s].
    """

    speed: float = 0.5
    wavelength: float = 0.05
    width: float = 0.035
    along: float = 1.5
    over_time: float = 1.2

    def height(self, ripple: Ripple, radius: float, s: ArrayLike, theta: ArrayLike) -> tuple[F8, F8, F8]:
        """Height of the surface, and its slopes.

        The distance is the geodesic one of a straight cord: along it, and around it at its radius, the shorter way.

        Args:
            ripple: Which.
            radius: Of the cord [m].
            s: Along [m].
            theta: Around [rad].

        Returns:
            h [m], dh/ds [-], dh/dtheta [m/rad], each of the shape of s and theta together.
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
        """Places of the rippled surface [m] and its unit normals, shape [n, 3] each."""
        parts = [self.height(each, radius, s, theta) for each in ripples]
        h, hs, ht = (sum((part[i] for part in parts), np.zeros_like(s)) for i in range(3))
        tangent, normal, binormal = cord.tangent(s), cord.normal(s), cord.binormal
        cos, sin = np.cos(theta)[:, None], np.sin(theta)[:, None]
        out, around = cos * normal + sin * binormal, cos * binormal - sin * normal
        r = radius + h
        stretch = 1.0 - cord.curvature(s) * r * np.cos(theta)
        direction = out - (hs / stretch)[:, None] * tangent - (ht / r)[:, None] * around
        return cord.point(s) + r[:, None] * out, direction / np.linalg.norm(direction, axis=1, keepdims=True)
