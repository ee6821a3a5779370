"""The plain display: one camera, one flat picture."""

from __future__ import annotations

import math

from mimics_app.contracts.ports.display_port import Eye, Viewpoint
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import Tangents
from mimics_app.world.graph.camera import Camera

__all__ = ["DesktopDisplay", "compute_tangents", "compute_window_tangents", "desktop_views"]

_LEAST_ASPECT = 4.0 / 3.0
"""Aspect ratio below which a window widens the view: what scenes show fits into a picture of 4:3."""


def desktop_views(camera: Camera, size: Size) -> list[View]:
    """Return the one view of a scene's camera that fills a surface.

    Args:
        camera: Camera of the world; its node's scale is ignored.
        size: Size of the surface [px].
    """
    tangents = compute_tangents(camera.vertical_fov, size)
    return [View(camera.world_from_eye, tangents, (0, 0, *size), camera.near, camera.far)]


def compute_tangents(fov: float, size: Size) -> Tangents:
    """Return the tangents left, right, bottom, top of a symmetric frustum.

    Args:
        fov: Vertical field of view [rad], between 0 and pi.
        size: Size of the picture [px], for the aspect ratio.
    """
    top = math.tan(0.5 * fov)
    right = top * size[0] / size[1]
    return (-right, right, -top, top)


def compute_window_tangents(fov: float, size: Size) -> Tangents:
    """Return the frustum of a window: one narrower than 4:3 shows as much to the sides as one of 4:3, and more above.

    Args:
        fov: Vertical field of view in a window of at least 4:3 [rad], between 0 and pi.
        size: Size of the window [px].
    """
    left, right, bottom, top = compute_tangents(fov, size)
    wider = max(1.0, _LEAST_ASPECT * size[1] / size[0])
    return (wider * left, wider * right, wider * bottom, wider * top)


class DesktopDisplay(PlainDisplay):
    """A monitor without head tracking: the picture is the camera's."""

    kind = "desktop"

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        tangents = compute_window_tangents(viewpoint.vertical_fov, drawn)
        return [Eye("", viewpoint.world_from_head, tangents, (0, 0, *drawn))]
