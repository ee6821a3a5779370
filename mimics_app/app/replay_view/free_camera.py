"""Free camera of a replay: it begins where a view is, and turns around the hand."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.app.picture.active_view import Placed
from mimics_app.app.picture.orbit_camera import OrbitCamera
from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.presenting.presenter import SeenFrom

__all__ = ["around_point", "placed"]

_NEAREST = 0.05
"""Least distance from the point [m]."""


def around_point(camera: SeenFrom, point: F8) -> OrbitCamera:
    """Return an orbit camera at a camera's place that looks at a point.

    Args:
        camera: The camera.
        point: Centre of the orbit, world [m], float64 [3].
    """
    away = camera.world_from_eye[:3, 3] - point
    orbit = OrbitCamera()
    orbit.target, orbit.distance = point.copy(), max(float(np.linalg.norm(away)), _NEAREST)
    orbit.yaw = math.atan2(away[0], away[2])
    orbit.pitch = math.asin(min(1.0, max(-1.0, away[1] / orbit.distance)))
    orbit.fov, orbit.near, orbit.far = camera.vertical_fov, camera.near, camera.far
    return orbit


def placed(orbit: OrbitCamera) -> Placed:
    """Return what an orbit camera sees, for a picture."""
    return Placed(orbit.pose, orbit.fov, orbit.near, orbit.far)
