"""One camera: pose, off-axis projection and rectangle on the surface."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import UsageError
from mimics_app.rendering.visual.kernels.frustum import find_planes
from mimics_app.rendering.visual.view_matrices import Tangents, compose_clip_from_view

__all__ = ["Latch", "Rect", "View", "compute_frustum_planes", "tilt_near_plane"]

Rect = tuple[int, int, int, int]


Latch = Callable[[], Sequence["View"]]
"""Returns the newest views, as many as were queued and in the same order."""


@dataclass(frozen=True, eq=False)
class View:
    """One camera; a desktop has one, a CAVE two per wall.

    Attributes:
        world_from_eye: Rigid pose of the camera, which looks along its -z with +y up; float64 [4, 4], metres.
        tangents: Tangents of the frustum's edges: left, right, bottom, top (left < right, bottom < top, of any sign).
        rectangle: Viewport on the surface: x, y of the lower left corner, width, height [px].
        near: Distance of the near plane [m], > 0.
        far: Distance of the far plane [m], > near; may be infinite.
        screen: Number of the physical screen; views of one screen share their heads-up display; -1: without one.
        clip_plane: World plane that replaces the near plane, unit normal and offset, float64 [4]; the camera is behind
            it. None: the near plane.
        part_of: Tangents of the whole picture this view is a part of, for levels of detail; None: it is the whole.
        queued_at: Origin of the frame "eye" [m], float64 [3]: the camera's position when the frame was queued, if the
            head has moved since, or the midpoint of two eyes that share a queue. None: the camera's position.
        pair: Two views of one number are a stereo pair and are queued together; -1: a single view.
    """

    world_from_eye: F8
    tangents: Tangents
    rectangle: Rect
    near: float = 0.05
    far: float = 100.0
    screen: int = 0
    clip_plane: F8 | None = None
    part_of: Tangents | None = None
    queued_at: F8 | None = None
    pair: int = -1

    def __post_init__(self) -> None:
        left, right, bottom, top = self.tangents
        if not (left < right and bottom < top and 0.0 < self.near < self.far):
            raise UsageError(
                f"a frustum of tangents {self.tangents} from {self.near} m to {self.far} m is empty",
                "give left < right, bottom < top and 0 < near < far",
            )
        if np.shape(self.world_from_eye) != (4, 4) or not math.isfinite(self.world_from_eye.sum()):
            raise UsageError("the pose of a view is not a matrix of 4 x 4 finite numbers", "correct the view's pose")

    @property
    def eye_world(self) -> F8:
        """Origin of the frame "eye" [m], float64 [3]: `queued_at`, or the camera's position."""
        return self.world_from_eye[:3, 3] if self.queued_at is None else self.queued_at

    @property
    def window(self) -> float:
        """Area of the whole picture at distance 1."""
        left, right, bottom, top = self.part_of or self.tangents
        return (right - left) * (top - bottom)

    @property
    def parts(self) -> float:
        """Area of the whole picture over that of this part of it."""
        left, right, bottom, top = self.tangents
        return self.window / ((right - left) * (top - bottom))

    @cached_property
    def figures(self) -> tuple[object, ...]:
        """Every value that the picture depends on, to be compared with that of another view."""
        arrays = (self.world_from_eye, self.clip_plane, self.queued_at)
        return (*(None if each is None else each.tobytes() for each in arrays), self.tangents, self.near, self.far)

    @cached_property
    def clip_from_eye(self) -> F8:
        """Projection from the frame "eye": world axes, origin `eye_world` (float64 [4, 4]).

        Only differences of positions enter it, so that float32 is precise near the person however far the scene is
        from the world's origin.
        """
        view_from_eye = np.eye(4)
        view_from_eye[:3, :3] = self.world_from_eye[:3, :3].T
        if self.queued_at is not None:
            view_from_eye[:3, 3] = view_from_eye[:3, :3] @ (self.queued_at - self.world_from_eye[:3, 3])
        clip_from_eye = compose_clip_from_view(self.tangents, self.near, self.far) @ view_from_eye
        if self.clip_plane is None:
            return clip_from_eye
        offset = self.clip_plane[:3] @ self.eye_world + self.clip_plane[3]
        return tilt_near_plane(clip_from_eye, np.array([*self.clip_plane[:3], offset]))

    @cached_property
    def clip_from_world(self) -> F8:
        """Projection from the world (float64 [4, 4]), for culling and tests."""
        eye_from_world = np.eye(4)
        eye_from_world[:3, 3] = -self.eye_world
        return self.clip_from_eye @ eye_from_world

    @cached_property
    def frustum_planes(self) -> F8:
        """Planes of the frustum in the world (float64 [6, 4]); see `compute_frustum_planes`."""
        return compute_frustum_planes(self.clip_from_world)

    def latched(self, newer: View) -> View:
        """Return this queued view with the pose and tangents of a newer one; rectangle and planes stay."""
        return replace(
            self,
            world_from_eye=newer.world_from_eye,
            tangents=newer.tangents,
            queued_at=self.eye_world,
        )

    def through(self, part: Rect, size: tuple[int, int]) -> View:
        """Return the view of a part [px] of this view's picture, whose size is given [px]."""
        left, far_right, bottom, top = self.tangents
        across, up = (far_right - left) / size[0], (top - bottom) / size[1]
        x, y, width, height = part
        edges = (left + x * across, left + (x + width) * across, bottom + y * up, bottom + (y + height) * up)
        seen = replace(self, tangents=edges, rectangle=part, part_of=self.part_of or self.tangents)
        # The whole picture's projection, cropped: composing it anew takes several times as long.
        crop = np.diag([size[0] / width, size[1] / height, 1.0, 1.0])
        crop[0, 3], crop[1, 3] = (size[0] - 2.0 * x) / width - 1.0, (size[1] - 2.0 * y) / height - 1.0
        vars(seen)["clip_from_world"] = crop @ self.clip_from_world
        return seen

    def ray(self, right: float, up: float) -> tuple[F8, F8]:
        """Return the ray through a point of the picture.

        Args:
            right: Horizontal position in [-1, 1], from the left edge to the right one.
            up: Vertical position in [-1, 1], from the lower edge to the upper one.

        Returns:
            Position of the camera, world [m], and the direction, 1 m deep: float64 [3] each.
        """
        left, far_right, bottom, top = self.tangents
        x = left + 0.5 * (right + 1.0) * (far_right - left)
        y = bottom + 0.5 * (up + 1.0) * (top - bottom)
        return self.world_from_eye[:3, 3], self.world_from_eye[:3, :3] @ np.array([x, y, -1.0])


def tilt_near_plane(clip_from_eye: F8, plane: F8) -> F8:
    """Return a projection with an oblique near plane; nothing in front of that plane is clipped (Lengyel 2005).

    Screen positions stay; depth starts at the new plane.

    Args:
        clip_from_eye: Perspective, float64 [4, 4].
        plane: In the frame "eye", normal towards the visible side and offset, [4]; the camera is behind it: offset < 0.

    Returns:
        The projection with another row for depth, float64 [4, 4].
    """
    # The frustum's corner farthest in front of the plane stays on the far plane.
    in_clip = np.linalg.solve(clip_from_eye.T, plane)
    corner = np.linalg.solve(clip_from_eye, [np.sign(in_clip[0]), np.sign(in_clip[1]), 1.0, 1.0])
    tilted = clip_from_eye.copy()
    tilted[2] = plane * (2.0 * (clip_from_eye[3] @ corner) / (plane @ corner)) - clip_from_eye[3]
    return tilted


def compute_frustum_planes(clip_from_world: F8) -> F8:
    """Return the six planes of a frustum, normals inwards: left, right, bottom, top, near, far.

    Args:
        clip_from_world: Projection, float64 [4, 4].

    Returns:
        Unit normal and offset per plane, float64 [6, 4]; a point p is inside where normal . p + offset >= 0. The normal
        of a far plane at infinity is 0.
    """
    planes = np.empty((6, 4))
    find_planes(np.ascontiguousarray(clip_from_world), planes)
    return planes
