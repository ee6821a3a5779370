"""Stereo pairs: two views queued once, from their midpoint, and drawn in one pass or in two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun
from mimics_app.rendering.visual.passes.eye_passes import EyePasses
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["eye_passes", "group_views", "see_from_between"]

_VIEWPORT_EXTENSION = "GL_ARB_shader_viewport_layer_array"
"""Extension by which a vertex shader selects its viewport."""

_STEREO_SHADERS = {"common/mesh.vert", "plain/plain.vert"}
"""Vertex shaders that include common/eyes.glsl; those of a scene need not."""


def group_views(views: Sequence[View]) -> list[tuple[int, ...]]:
    """Group the numbers of views in order; the two of a stereo pair are one group, at the position of the first."""
    groups: list[tuple[int, ...]] = []
    for number, view in enumerate(views):
        eyes = tuple(k for k, other in enumerate(views) if other.pair == view.pair) if view.pair >= 0 else ()
        if len(eyes) != 2:
            groups.append((number,))
        elif number == eyes[0]:
            groups.append(eyes)
    return groups


def see_from_between(left: View, right: View) -> list[View]:
    """Return the two views with their midpoint as common origin of what is queued."""
    midpoint = 0.5 * (left.eye_world + right.eye_world)
    return [replace(view, queued_at=midpoint) for view in (left, right)]


def eye_passes(
    settings: RenderSettings, has: Capabilities, runs: Sequence[DrawRun], places: Sequence[Rect]
) -> EyePasses:
    """Choose the passes of two eyes: as the settings request, else two passes.

    Adjacent eyes always use the halves of one viewport, since positions are rounded differently in a viewport of its
    own; viewports are for eyes that are not adjacent.

    Args:
        settings: Quality.
        has: Capabilities of the driver.
        runs: All runs queued for both.
        places: The eyes' rectangles [px].
    """
    if not {each.shader.vertex for run in runs for each in run.material_instance.passes} <= _STEREO_SHADERS:
        return "alone"
    if _side_by_side(*places):
        return "halves_in_turn" if settings.stereo == "two_pass" else "halves"
    if _VIEWPORT_EXTENSION not in has.extensions:
        return "alone"
    return "viewports" if settings.stereo == "viewports" else "viewports_in_turn"


def _side_by_side(left: Rect, right: Rect) -> bool:
    return right == (left[0] + left[2], left[1], left[2], left[3])
