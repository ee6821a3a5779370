"""The frontal plane in which a flat pointing device moves, and the reach of the hand in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.ports.input_port import Ray
from mimics_app.maths.triples import add_scaled, cross, dot, subtract

__all__ = ["FrontalPlane"]

_GRAZING = 0.02
"""Smallest |cosine| between ray and normal (1.1 degrees off the plane): below it a pixel covers metres."""

_SHORTEST = 1e-9
"""Length below which a direction is undefined."""


@dataclass(frozen=True, slots=True)
class FrontalPlane:
    """A rectangle in the world.

    Attributes:
        centre: Centre [m].
        right: Unit vector to the person's right.
        up: Unit vector, perpendicular to right.
        half_width: Reach to either side [m].
        half_height: Reach up and down [m].
    """

    centre: Vec3
    right: Vec3 = (1.0, 0.0, 0.0)
    up: Vec3 = (0.0, 1.0, 0.0)
    half_width: float = 0.3
    half_height: float = 0.2

    def crossing(self, ray: Ray | None) -> tuple[float, float] | None:
        """Return where a ray crosses the plane, to the right and up of the centre [m].

        None without a crossing in front of the camera, or at a grazing angle.
        """
        if ray is None:
            return None
        origin, direction = ray
        length = math.hypot(*direction)
        if not _SHORTEST <= length < math.inf:
            return None
        normal = cross(self.right, self.up)
        slope = dot(direction, normal) / length
        if not abs(slope) >= _GRAZING:
            return None
        distance = dot(subtract(self.centre, origin), normal) / slope
        if not 0.0 <= distance < math.inf:
            return None
        offset = subtract(add_scaled(origin, direction, distance / length), self.centre)
        return dot(offset, self.right), dot(offset, self.up)

    def meet(self, ray: Ray | None) -> Vec3 | None:
        """Return where a ray crosses the plane, clamped to the rectangle [m]; None where `crossing` has none."""
        here = self.crossing(ray)
        return None if here is None else self.clamp(self.at(*here))

    def clamp(self, point: Vec3) -> Vec3:
        """Return the point of the rectangle nearest to a point [m]."""
        offset = subtract(point, self.centre)
        x = min(max(dot(offset, self.right), -self.half_width), self.half_width)
        y = min(max(dot(offset, self.up), -self.half_height), self.half_height)
        return self.at(x, y)

    def at(self, x: float, y: float) -> Vec3:
        """Return the point x [m] to the right and y [m] above the centre."""
        return add_scaled(add_scaled(self.centre, self.right, x), self.up, y)

    def through(self, point: Vec3) -> FrontalPlane:
        """Return the rectangle moved along its normal to the depth of a point."""
        normal = cross(self.right, self.up)
        return replace(self, centre=add_scaled(self.centre, normal, dot(subtract(point, self.centre), normal)))

    def move(self, point: Vec3, x: float, y: float) -> Vec3:
        """Return a point moved by x [m] to the right and y [m] up, clamped to the rectangle."""
        return self.clamp(add_scaled(add_scaled(point, self.right, x), self.up, y))
