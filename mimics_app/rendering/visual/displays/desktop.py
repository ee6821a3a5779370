"""The plain display: one eye behind one flat picture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import Tangents, View
from mimics_app.world.camera import Camera

__all__ = ["compose_look_at", "compute_tangents", "desktop_views"]

F8 = NDArray[np.float64]


def desktop_views(camera: Camera, size: Size) -> list[View]:
    """The one view of a scene's camera filling a surface.

    Args:
        camera: Camera of the world; its node's scale is ignored.
        size: Of the surface [px].
    """
    world_from_eye = _without_scale(camera.node.world_matrix())
    tangents = compute_tangents(camera.vertical_fov, size)
    return [View(world_from_eye, tangents, (0, 0, *size), camera.near, camera.far)]


def compute_tangents(fov: float, size: Size) -> Tangents:
    """Tangents left, right, bottom, top of a symmetric frustum.

    Args:
        fov: Vertical angle of view [rad], between 0 and pi.
        size: Of the picture [px], for the aspect ratio.
    """
    top = math.tan(0.5 * fov)
    right = top * size[0] / size[1]
    return (-right, right, -top, top)


def compose_look_at(eye: Sequence[float], target: Sequence[float], up: Sequence[float] = (0.0, 1.0, 0.0)) -> F8:
    """Pose of an eye that looks at a point.

    Args:
        eye: Where the eye is, world [m], shape [3].
        target: Where it looks, world [m], shape [3]; not at the eye, nor straight along `up`.
        up: What is up, shape [3].

    Returns:
        world_from_eye, float64 [4, 4].
    """
    back = np.asarray(eye, np.float64) - np.asarray(target, np.float64)
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, np.cross(back, right), back, eye
    return pose


def _without_scale(pose: F8) -> F8:
    rigid = np.array(pose, np.float64)
    rigid[:3, :3] /= np.linalg.norm(rigid[:3, :3], axis=0)
    return rigid
