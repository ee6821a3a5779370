"""What the renderer is told of the methods that were chosen for a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, get_args

from mimics_app.rendering.visual.settings import Occlusion, RenderSettings

__all__ = ["with_methods"]


def with_methods(settings: RenderSettings, methods: Mapping[str, str]) -> RenderSettings:
    """Settings in which each group's method is the one that was chosen.

    Args:
        settings: What the scene asks for.
        methods: Method by group of the laboratory; groups of something else than the picture are passed over.
    """
    changes: dict[str, Any] = {}
    if "anti aliasing" in methods:
        changes |= _edges(methods["anti aliasing"])
    if "sun shadows" in methods:
        changes |= _shadows(methods["sun shadows"])
    if methods.get("ambient occlusion") == "none":
        changes["ambient_occlusion"] = 0.0
    if methods.get("bloom") == "none":
        changes["bloom"] = 0.0
    if methods.get("occlusion") in get_args(Occlusion):
        changes["occlusion"] = methods["occlusion"]
    if "level of detail" in methods:
        changes["detail"] = _detail(methods["level of detail"])
    return replace(settings, **changes)


def _edges(method: str) -> dict[str, Any]:
    """From "none", "filter", "4 samples" or "4 samples, filter"."""
    samples = method.split()[0]
    return {"msaa": int(samples) if samples.isdigit() else 0, "fxaa": method.endswith("filter")}


def _shadows(method: str) -> dict[str, Any]:
    """From "map 512", "cascades 2048" or "stencil additive"; whether maps darken the picture is the scene's to say."""
    kind, how = method.split()
    return {"shadows": f"stencil_{how}"} if kind == "stencil" else {"shadow_size": int(how)}


def _detail(method: str) -> float:
    """From "as authored" or "2 times as far"."""
    return 1.0 if method == "as authored" else float(method.split()[0])
