"""Off-axis projection through a rectangle in space, in float64 (Kooima 2008; Pape 1999)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.view_matrices import Tangents

__all__ = ["EyeFrustum", "Rectangle", "frustum_of"]


_NEAREST_EYE = 0.01
"""Minimum distance of an eye from a wall's plane, in which there is no picture [m]."""

_EDGE_ON_RAD = 0.035
"""Angle below which a wall is seen edge-on, two degrees [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle:
    """A flat screen in space.

    Attributes:
        lower_left: Lower left corner [m], float64 [3].
        lower_right: Lower right corner [m], float64 [3].
        upper_left: Upper left corner [m], float64 [3]; the two edges meet at a right angle.
    """

    lower_left: F8
    lower_right: F8
    upper_left: F8

    @property
    def width(self) -> float:
        """Length of the lower edge [m]."""
        return float(np.linalg.norm(self.lower_right - self.lower_left))

    @property
    def height(self) -> float:
        """Length of the left edge [m]."""
        return float(np.linalg.norm(self.upper_left - self.lower_left))

    @property
    def axes(self) -> F8:
        """Right, up and towards the viewer as columns, orthonormal; float64 [3, 3]."""
        right = (self.lower_right - self.lower_left) / self.width
        up = (self.upper_left - self.lower_left) / self.height
        return np.stack([right, up, np.cross(right, up)], axis=1)

    @property
    def corners(self) -> F8:
        """Corners lower left, lower right, upper left, upper right [m]; float64 [4, 3]."""
        upper_right = self.lower_right + self.upper_left - self.lower_left
        return np.stack([self.lower_left, self.lower_right, self.upper_left, upper_right])


@dataclass(frozen=True, slots=True, eq=False)
class EyeFrustum:
    """An eye looking through a rectangle.

    Attributes:
        pose: Pose of the eye with the axes of the rectangle, in the rectangle's frame of reference; float64 [4, 4].
        tangents: Tangents left, right, bottom, top.
        fault: Why the picture is wrong, "" where it is right.
    """

    pose: F8
    tangents: Tangents
    fault: str = ""


def frustum_of(rectangle: Rectangle, eye: F8) -> EyeFrustum:
    """Return the frustum of an eye through a rectangle.

    An eye behind the plane or nearer than `_NEAREST_EYE` is moved in front of it, so that the picture never flips; this
    is reported as a fault.

    Args:
        rectangle: The rectangle, in the same frame as the eye.
        eye: Position of the eye [m], float64 [3].
    """
    axes = rectangle.axes
    right, up, towards = axes.T
    away = float(towards @ (eye - rectangle.lower_left))
    fault = ""
    if away < _NEAREST_EYE:
        fault = "the eye is in the wall's plane" if away > -_NEAREST_EYE else "the eye is behind the wall"
        eye = eye + (_NEAREST_EYE - away) * towards
        away = _NEAREST_EYE
    centre = 0.5 * (rectangle.lower_right + rectangle.upper_left)
    if not fault and away < np.sin(_EDGE_ON_RAD) * float(np.linalg.norm(centre - eye)):
        fault = "the wall is seen edge-on"
    from_eye = rectangle.lower_left - eye
    left, bottom = float(right @ from_eye) / away, float(up @ from_eye) / away
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes, eye
    return EyeFrustum(pose, (left, left + rectangle.width / away, bottom, bottom + rectangle.height / away), fault)
