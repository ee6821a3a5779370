"""Off-axis projection onto a flat rectangle in space, all of it in float64 (Kooima 2008; Pape 1999)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.view_matrices import Tangents

__all__ = ["EDGE_ON_RAD", "NEAREST_EYE", "Rectangle", "Sight", "look_through"]


NEAREST_EYE = 0.01
"""An eye is drawn as if no nearer to a wall's plane than this [m]: in the plane there is no picture."""

EDGE_ON_RAD = 0.035
"""A wall seen under less than two degrees is edge-on: a pixel of it covers a hundred times its width in depth."""


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle:
    """A flat picture in space.

    Attributes:
        lower_left: Corner [m], float64 [3].
        lower_right: Likewise.
        upper_left: Likewise; the two edges meet at a right angle.
    """

    lower_left: F8
    lower_right: F8
    upper_left: F8

    @property
    def width(self) -> float:
        """Of the lower edge [m]."""
        return float(np.linalg.norm(self.lower_right - self.lower_left))

    @property
    def height(self) -> float:
        """Of the left edge [m]."""
        return float(np.linalg.norm(self.upper_left - self.lower_left))

    @property
    def axes(self) -> F8:
        """Right, up and towards the viewer as columns, orthonormal; float64 [3, 3]."""
        right = (self.lower_right - self.lower_left) / self.width
        up = (self.upper_left - self.lower_left) / self.height
        return np.stack([right, up, np.cross(right, up)], axis=1)

    @property
    def corners(self) -> F8:
        """Lower left, lower right, upper left, upper right; float64 [4, 3]."""
        upper_right = self.lower_right + self.upper_left - self.lower_left
        return np.stack([self.lower_left, self.lower_right, self.upper_left, upper_right])


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """An eye looking through a rectangle.

    Attributes:
        pose: Of the eye, its axes those of the rectangle, in the rectangle's frame of reference; float64 [4, 4].
        tangents: Left, right, bottom, top.
        fault: Why the picture is not what it should be, "" where it is.
    """

    pose: F8
    tangents: Tangents
    fault: str = ""


def look_through(rectangle: Rectangle, eye: F8) -> Sight:
    """Frustum of an eye through a rectangle.

    An eye behind the plane or nearer than `NEAREST_EYE` is moved before it, so that the picture never turns over; the
    fault says so.

    Args:
        rectangle: In the same frame as the eye.
        eye: Where it is [m], float64 [3].
    """
    axes = rectangle.axes
    right, up, towards = axes.T
    away = float(towards @ (eye - rectangle.lower_left))
    fault = ""
    if away < NEAREST_EYE:
        fault = "the eye is in the wall's plane" if away > -NEAREST_EYE else "the eye is behind the wall"
        eye = eye + (NEAREST_EYE - away) * towards
        away = NEAREST_EYE
    middle = 0.5 * (rectangle.lower_right + rectangle.upper_left)
    if not fault and away < np.sin(EDGE_ON_RAD) * float(np.linalg.norm(middle - eye)):
        fault = "the wall is seen edge-on"
    from_eye = rectangle.lower_left - eye
    left, bottom = float(right @ from_eye) / away, float(up @ from_eye) / away
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes, eye
    return Sight(pose, (left, left + rectangle.width / away, bottom, bottom + rectangle.height / away), fault)
