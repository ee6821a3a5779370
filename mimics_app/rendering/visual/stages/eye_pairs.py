"""Two eyes before one picture: queued once, from between them, and drawn in one pass or in two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun
from mimics_app.rendering.visual.passes.eye_passes import EyePasses
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities
from mimics_app.rendering.visual.view import Rect, View

__all__ = ["VIEWPORT_EXTENSION", "eye_passes", "group_views", "see_from_between"]

VIEWPORT_EXTENSION = "GL_ARB_shader_viewport_layer_array"
"""Lets a vertex shader choose its viewport."""

_KNOW_EYES = {"common/mesh.vert", "plain/plain.vert"}
"""Vertex shaders that ask common/eyes.glsl; one that a scene brings may not."""


def group_views(views: Sequence[View]) -> list[tuple[int, ...]]:
    """Numbers of the views in their order, the two eyes of a pair together at the place of the first."""
    groups: list[tuple[int, ...]] = []
    for number, view in enumerate(views):
        eyes = tuple(k for k, other in enumerate(views) if other.pair == view.pair) if view.pair >= 0 else ()
        if len(eyes) != 2:
            groups.append((number,))
        elif number == eyes[0]:
            groups.append(eyes)
    return groups


def see_from_between(left: View, right: View) -> list[View]:
    """The two views with one origin, midway, to which everything is relative that is queued for both."""
    middle = 0.5 * (left.eye_world + right.eye_world)
    return [replace(view, queued_at=middle) for view in (left, right)]


def eye_passes(
    settings: RenderSettings, has: Capabilities, runs: Sequence[DrawRun], places: Sequence[Rect]
) -> EyePasses:
    """How two eyes can be drawn: as the settings say, in two passes where that cannot be.

    Eyes beside each other have the halves of one picture in every way, since a place in a half is rounded otherwise
    than in a picture of its own: viewports are for eyes that are elsewhere.

    Args:
        settings: Quality.
        has: What the driver can do.
        runs: Everything queued for both.
        places: The eyes' rectangles [px].
    """
    if not {each.shader.vertex for run in runs for each in run.look.passes} <= _KNOW_EYES:
        return "alone"
    if _side_by_side(*places):
        return "halves_in_turn" if settings.stereo == "two_pass" else "halves"
    if VIEWPORT_EXTENSION not in has.extensions:
        return "alone"
    return "viewports" if settings.stereo == "viewports" else "viewports_in_turn"


def _side_by_side(left: Rect, right: Rect) -> bool:
    return right == (left[0] + left[2], left[1], left[2], left[3])
