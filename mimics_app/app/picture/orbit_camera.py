"""Orbit camera: it orbits a point, zooms, pans, or flies; of the viewer and of a replay in a window."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.displays.desktop import compute_window_tangents
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.extent import Extent
from mimics_app.world.graph.camera import Camera

__all__ = ["OrbitCamera"]


_STEEPEST = math.radians(89.0)
_FOV = math.radians(40.0)
_WHOLE_TURN_PX = 1200.0
"""Travel of the pointer for a full rotation [px]."""
_PER_STEP = 0.87
"""Factor on the distance for one step of the wheel."""
_NEAREST, _FARTHEST = 1e-5, 1e7
"""Range of the distance [m]."""
_MARGIN = 1.08
"""Factor on the distance at which a framed box fits the picture exactly."""
_LONGEST_RADIUS = 12.0
"""Largest orbit radius of a scene's camera [m]."""
_FIRST_PITCH, _FIRST_YAW = math.radians(20.0), math.radians(32.0)
"""Direction of the first view of a model [rad]."""


class OrbitCamera:
    """Camera that looks at a target from a distance; +y is up.

    Attributes:
        target: Centre of the orbit, world [m], float64 [3].
        distance: Distance from the target to the camera [m].
        yaw: Rotation about +y [rad]; at 0 the camera looks along -z.
        pitch: Elevation of the camera as seen from the target [rad].
        fov: Vertical field of view in a window of at least 4:3 [rad].
        reach: Radius of the scene about the target [m].
        near, far: Near and far plane of a camera of the scene [m]; 0: derived from distance and reach.
    """

    def __init__(self) -> None:
        self.target: F8 = np.zeros(3)
        self.distance, self.reach = 3.0, 10.0
        self.yaw, self.pitch, self.fov = _FIRST_YAW, _FIRST_PITCH, _FOV
        self.near = self.far = 0.0

    @property
    def backward(self) -> F8:
        """Unit vector from the target to the camera, [3]."""
        level = math.cos(self.pitch)
        return np.array([level * math.sin(self.yaw), math.sin(self.pitch), level * math.cos(self.yaw)])

    @property
    def position(self) -> F8:
        """Position of the camera, world [m], [3]."""
        return self.target + self.distance * self.backward

    @property
    def pose(self) -> F8:
        """world_from_eye, float64 [4, 4]."""
        return compose_look_at(self.position, self.target)

    def view(self, size: Size) -> View:
        """Return the camera's view on a surface of a size [px]."""
        near = self.near or max(0.004 * min(self.distance, self.reach), 1e-6)
        far = self.far or 40.0 * (self.distance + self.reach)
        return View(self.pose, compute_window_tangents(self.fov, size), (0, 0, *size), near, far)

    def frame(self, extent: Extent, size: Size, *, turn: bool = True) -> None:
        """Move so that a box fits into the picture.

        Args:
            extent: The box, lowest and highest corner [m].
            size: Size of the surface [px].
            turn: True for the direction of the first view; False keeps the present one.
        """
        least, greatest = extent
        radius = max(0.5 * float(np.linalg.norm(greatest - least)), _NEAREST)
        if turn:
            self.yaw, self.pitch = _FIRST_YAW, _FIRST_PITCH
        self.target = 0.5 * (least + greatest)
        _, right, _, top = compute_window_tangents(self.fov, size)
        narrow = math.atan(min(right, top))
        self.distance, self.reach = _MARGIN * radius / math.sin(narrow), radius

    def stand_at(self, camera: Camera, reach: float) -> None:
        """Take position, direction, field of view and planes of a camera of the scene, without its roll."""
        pose = camera.world_from_eye
        backward = pose[:3, 2]
        self.fov, self.reach = camera.vertical_fov, max(reach, _NEAREST)
        self.near, self.far = camera.near, camera.far if math.isfinite(camera.far) else 0.0
        self.yaw = math.atan2(backward[0], backward[2])
        self.pitch = min(max(math.asin(min(max(backward[1], -1.0), 1.0)), -_STEEPEST), _STEEPEST)
        self.distance = min(0.2 * self.reach, _LONGEST_RADIUS)
        self.target = pose[:3, 3] - self.distance * self.backward

    def orbit(self, right_px: float, up_px: float) -> None:
        """Orbit the target with the movement of the pointer [px]."""
        self.yaw -= 2.0 * math.pi * right_px / _WHOLE_TURN_PX
        self._tilt(-up_px)

    def rotate_in_place(self, right_px: float, up_px: float) -> None:
        """Rotate the camera at its position with the movement of the pointer [px]."""
        here = self.position
        self.yaw -= math.pi * right_px / _WHOLE_TURN_PX
        self._tilt(-0.5 * up_px)
        self.target = here - self.distance * self.backward

    def pan(self, right_px: float, up_px: float, size: Size) -> None:
        """Move camera and target so that the target follows the pointer, in a picture of a size [px]."""
        per_px = 2.0 * self.distance * compute_window_tangents(self.fov, size)[3] / size[1]
        axes = self.pose[:3, :3]
        self.target = self.target - per_px * (right_px * axes[:, 0] + up_px * axes[:, 1])

    def zoom(self, steps: float) -> None:
        """Approach the target by steps of the wheel."""
        self.distance = min(max(self.distance * _PER_STEP**steps, _NEAREST), _FARTHEST)

    def fly(self, right: float, up: float, forward: float) -> None:
        """Move camera and target along the camera's axes [m], `up` along +y."""
        axes = self.pose[:3, :3]
        self.target = self.target + right * axes[:, 0] - forward * axes[:, 2] + np.array([0.0, up, 0.0])

    def _tilt(self, up_px: float) -> None:
        pitch = self.pitch + 2.0 * math.pi * up_px / _WHOLE_TURN_PX
        self.pitch = min(max(pitch, -_STEEPEST), _STEEPEST)
