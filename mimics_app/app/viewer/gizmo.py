"""Gizmo of three arrows at the selected object: dragging one moves the object along that axis."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.figures.hud import Colour
from mimics_app.rendering.visual.overlay.layers import Arrow
from mimics_app.rendering.visual.view import View

__all__ = ["axis_under", "gizmo_arrows"]


_LENGTH = 0.34
"""Length of an arrow, in half heights of the picture at its depth."""
_FROM = 0.2
"""Share of an arrow from its base that cannot be grabbed, because all three meet there."""
_REACH_PX = 9.0
"""Distance from an arrow within which the pointer grabs it [px]."""
_TINTS: tuple[Colour, ...] = ((0.95, 0.30, 0.28, 1.0), (0.40, 0.85, 0.35, 1.0), (0.36, 0.58, 1.0, 1.0))
_FAINT = 0.35


def gizmo_arrows(place: F8, view: View, axis: int | None) -> list[Arrow]:
    """Return the arrows along x, y and z, of the same length on the screen at any distance.

    Args:
        place: Base of the arrows, world [m], [3].
        view: View of the camera.
        axis: 0, 1 or 2: movement is limited to this axis, and the others are faint; None: no limit.
    """
    vectors = _length(place, view) * np.eye(3)
    strength = [1.0 if axis in (None, number) else _FAINT for number in range(3)]
    return [
        Arrow(place, vector, (*tint[:3], share)) for vector, tint, share in zip(vectors, _TINTS, strength, strict=True)
    ]


def axis_under(place: F8, ray: tuple[F8, F8], view: View) -> int | None:
    """Return the axis of the arrow under the pointer, None where there is none.

    Args:
        place: Base of the arrows, world [m], [3].
        ray: Ray through the pointer.
        view: View of the camera.
    """
    origin, direction = ray[0], ray[1] / np.linalg.norm(ray[1])
    length = _length(place, view)
    shares = np.linspace(_FROM, 1.0, 24)
    points = place + length * shares[None, :, None] * np.eye(3)[:, None, :]
    along = np.maximum((points - origin) @ direction, 1e-9)
    across = np.linalg.norm(points - origin - along[..., None] * direction, axis=-1)
    _, _, bottom, top = view.tangents
    pixels = across / along / ((top - bottom) / view.rectangle[3])
    nearest = pixels.min(axis=1)
    return int(np.argmin(nearest)) if nearest.min() <= _REACH_PX else None


def _length(place: F8, view: View) -> float:
    depth = float((view.eye_world - place) @ view.world_from_eye[:3, 2])
    return _LENGTH * max(depth, view.near) * 0.5 * (view.tangents[3] - view.tangents[2])
