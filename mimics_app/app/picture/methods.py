"""Settings of the renderer, by the methods chosen for a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from mimics_app.contracts.methods import Settings
from mimics_app.rendering.visual.settings import RenderSettings

__all__ = ["PICTURE_GROUPS", "with_methods"]

_FIELDS: Mapping[str, tuple[str, ...]] = {
    "anti aliasing": ("msaa", "fxaa"),
    "sun shadows": ("shadows", "shadow_size"),
    "ambient occlusion": ("ambient_occlusion",),
    "bloom": ("bloom",),
    "occlusion": ("occlusion",),
    "level of detail": ("detail",),
    "skinning": ("skinning",),
    "shading": ("shading",),
    "stereo": ("stereo",),
}
"""Fields of the renderer's settings that the methods of a group may set; how cascades are placed is the scene's."""

PICTURE_GROUPS: tuple[str, ...] = tuple(_FIELDS)
"""Groups of methods that a picture runs."""


def with_methods(settings: RenderSettings, methods: Mapping[str, Settings]) -> RenderSettings:
    """Settings in which each group's method is the one that was chosen.

    Args:
        settings: What the scene requests.
        methods: Settings of the chosen method by group of the laboratory; groups of something else than the picture are
            passed over, and a method that says nothing of a field leaves it to the scene.
    """
    changes: dict[str, Any] = {
        field: methods[group][field]
        for group, fields in _FIELDS.items()
        for field in fields
        if field in methods.get(group, {})
    }
    return replace(settings, **changes)
