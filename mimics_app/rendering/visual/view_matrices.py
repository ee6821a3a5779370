"""Camera and projection matrices by pyrr: the one module that depends on its conventions.

pyrr multiplies row vectors from the left, so that its matrices are the transposes of ours; its quaternions rotate in
the opposite sense, and integer arguments give integer results. Here all arguments are float64 and all results are for
column vectors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.contracts.arrays import F8

__all__ = ["TEXTURE_FROM_CLIP", "Tangents", "compose_clip_from_view", "compose_look_at"]

Tangents = tuple[float, float, float, float]

TEXTURE_FROM_CLIP: F8 = np.array(
    [[0.5, 0.0, 0.0, 0.5], [0.0, 0.5, 0.0, 0.5], [0.0, 0.0, 0.5, 0.5], [0.0, 0.0, 0.0, 1.0]]
)
"""From clip space to texture coordinates and depth, all in [0, 1] after the division by w."""

_ENDLESS = 2.0**54
"""Ratio of far to near distance from which the far plane is at infinity, as 1 +- 2^-54 is 1 in float64."""


def compose_look_at(eye: ArrayLike, target: ArrayLike, up: Sequence[float] = (0.0, 1.0, 0.0)) -> F8:
    """Return the pose of a camera that looks at a point.

    Args:
        eye: Position of the camera, world [m], shape [3].
        target: Point it looks at, world [m], shape [3]; neither `eye` nor straight along `up` from it.
        up: Up direction, shape [3].

    Returns:
        world_from_eye, rigid, float64 [4, 4].

    Raises:
        ValueError: `eye` and `target` coincide, or their difference is parallel to `up`.
    """
    place = np.asarray(eye, np.float64)
    towards, upwards = np.asarray(target, np.float64), np.asarray(up, np.float64)
    if not np.cross(towards - place, upwards).any():
        raise ValueError(f"no view from {place} towards {towards} with {upwards} up")
    # As a matrix for row vectors this is eye_from_world; its rotation, read for column vectors, is the pose.
    from pyrr import matrix44

    rows = matrix44.create_look_at(place, towards, upwards, dtype=np.float64)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rows[:3, :3], place
    return pose


def compose_clip_from_view(tangents: Tangents, near: float, far: float) -> F8:
    """Return an off-axis perspective from the view frame (camera along -z) to GL clip space (Kooima 2008).

    Args:
        tangents: Left, right, bottom, top.
        near: Distance of the near plane [m], > 0.
        far: Distance of the far plane [m], > near; infinity is allowed.

    Returns:
        Matrix for column vectors, float64 [4, 4]; depth -1 at `near`, 1 at `far`.
    """
    borders = [near * float(tangent) for tangent in tangents]
    last = min(float(far), near * _ENDLESS)
    from pyrr import matrix44

    rows = matrix44.create_perspective_projection_from_bounds(*borders, near, last, dtype=np.float64)
    return np.ascontiguousarray(rows.T)
