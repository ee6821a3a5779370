"""Settings of the renderer, by the methods chosen for a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from mimics_app.contracts.ports.methods import Settings
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
    "vertex light": ("vertex_light",),
    "particle light": ("particle_light",),
    "stereo": ("stereo",),
}
"""Fields of the renderer's settings that the methods of a group set; the placement of cascades is the scene's."""

PICTURE_GROUPS: tuple[str, ...] = tuple(_FIELDS)
"""Groups of methods that a picture uses."""


def with_methods(settings: RenderSettings, methods: Mapping[str, Settings]) -> RenderSettings:
    """Return the settings with the chosen methods.

    Args:
        settings: Settings requested by the scene.
        methods: Settings of the chosen method by group; other groups than those of the picture are ignored, and a field
            that a method does not set is that of the scene.
    """
    changes: dict[str, Any] = {
        field: methods[group][field]
        for group, fields in _FIELDS.items()
        for field in fields
        if field in methods.get(group, {})
    }
    return replace(settings, **changes)
