"""Views of plane mirrors: from the reflected camera, clipped at the mirror's plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.changed_part import ChangedPart
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["Reflection", "plane_of_sheet", "reflect_view"]


_FLAT = 1e-3
"""Largest thickness of a flat mesh over its width."""

_MIN_DISTANCE = 1e-3
"""Minimum distance of the camera from a mirror's plane [m]."""


@dataclass(frozen=True, eq=False)
class Reflection:
    """Reflection of a mirror in a view.

    Attributes:
        view: View of the reflected camera; its picture is flipped horizontally.
        pixels: Rectangle of the mirror in the view's picture, relative to the view's corner [px].
    """

    view: View
    pixels: Rect

    def places(self, parts: Sequence[ChangedPart] | None) -> F8:
        """Return where parts of the reflection are seen in the view's picture [px]: left, right, bottom, top; [n, 4].

        Args:
            parts: The parts; None: all of it.
        """
        x, y, width, height = self.pixels
        drawn = self.view.rectangle
        pieces = [drawn] if parts is None else [piece for part in parts for piece in part.pieces]
        left, bottom, wide, high = np.array(pieces, np.float64).reshape(-1, 4).T
        across, along, end = width / drawn[2], height / drawn[3], x + width
        # Flipped: the left edge of the reflection is the right one of the mirror.
        edges = (end - (left + wide) * across, end - left * across, y + bottom * along, y + (bottom + high) * along)
        return np.stack(edges, axis=1)


def plane_of_sheet(mesh: MeshData) -> F8 | None:
    """Return unit normal and offset of a flat mesh in its own frame, float64 [4]; None where it is not flat.

    The normal is the mean of the mesh's.
    """
    positions = np.asarray(mesh.positions, np.float64)
    normal = np.asarray(mesh.normals, np.float64).mean(axis=0)
    length = float(np.linalg.norm(normal))
    if length < 0.5:
        return None
    normal /= length
    heights = positions @ normal
    if float(np.ptp(heights)) > _FLAT * float(np.ptp(positions, axis=0).max()):
        return None
    return np.array([*normal, -heights.mean()])


def reflect_view(view: View, size: tuple[int, int], plane: F8, corners: F8, resolution: float) -> Reflection | None:
    """Return the view of a mirror, cropped to the pixels it covers; None where it is not visible, as from behind.

    The pose is a proper rotation: the picture is drawn flipped and sampled in reverse.

    Args:
        view: View that sees the mirror.
        size: Size of that view's picture [px].
        plane: Plane of the mirror, world, unit normal towards the reflecting side and offset, [4].
        corners: Corners of the mirror's bounding box, world [m], [8, 3].
        resolution: Ratio of the reflection's resolution to that of the view.
    """
    distance = float(plane[:3] @ view.world_from_eye[:3, 3] + plane[3])
    pixels = _covered(view, size, corners)
    if distance < _MIN_DISTANCE or pixels is None:
        return None
    x, y, width, height = pixels
    left, right, bottom, top = view.tangents
    across, along = (right - left) / size[0], (top - bottom) / size[1]
    # Flipped: left and right tangents change sides.
    tangents = (-(left + (x + width) * across), -(left + x * across), bottom + y * along, bottom + (y + height) * along)
    drawn = (0, 0, max(1, round(width * resolution)), max(1, round(height * resolution)))
    whole = (-right, -left, bottom, top)
    pose = _reflection(plane) @ view.world_from_eye @ np.diag([-1.0, 1.0, 1.0, 1.0])
    return Reflection(View(pose, tangents, drawn, view.near, view.far, clip_plane=plane, part_of=whole), pixels)


def _reflection(plane: F8) -> F8:
    """Return the Householder reflection at a plane (world, [4, 4])."""
    matrix = np.eye(4)
    matrix[:3, :3] -= 2.0 * np.outer(plane[:3], plane[:3])
    matrix[:3, 3] = -2.0 * plane[3] * plane[:3]
    return matrix


def _covered(view: View, size: tuple[int, int], corners: F8) -> Rect | None:
    """Return the pixels that a box may cover, with a margin; None where it is outside the picture."""
    clip = np.c_[corners, np.ones(len(corners))] @ view.clip_from_world.T
    if (clip[:, 3] < view.near).all():
        return None
    if (clip[:, 3] < view.near).any():
        return 0, 0, *size
    share = 0.5 + 0.5 * clip[:, :2] / clip[:, 3:]
    low = np.clip(np.floor(share.min(axis=0) * size) - 1, 0, size).astype(int)
    high = np.clip(np.ceil(share.max(axis=0) * size) + 1, 0, size).astype(int)
    if (high <= low).any():
        return None
    return int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1])
