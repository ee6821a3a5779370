"""A scene in high contrast: targets, paths and the hand's marker in light colours on dark ground.

The scene says by `systems.contrast` what its materials are, and what is left out that is only seen. Each gets one
colour without light or texture, so that the ratio of two of them is known: at least 7:1 between any of a target, a path
and the hand, and the ground (WCAG 2.1, 1.4.11 asks for 3:1).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from mimics_app.world.components.systems import Role

__all__ = ["contrasted"]

_COLOURS: Mapping[Role, tuple[float, float, float, float]] = {
    "target": (1.0, 0.85, 0.0, 1.0),
    "path": (1.0, 1.0, 1.0, 1.0),
    "hand": (0.25, 0.75, 1.0, 1.0),
    "ground": (0.004, 0.004, 0.006, 1.0),
}
"""Colour by role, linear."""
_DARK = [0.004, 0.004, 0.006]
_DIM = 0.25
"""Light of the surroundings on what has a material of its own."""


def contrasted(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a resolved scene in high contrast; one without `systems.contrast` as it is."""
    result: dict[str, Any] = copy.deepcopy(dict(document))
    contrast = (result.get("systems") or {}).get("contrast")
    if contrast is None:
        return result
    materials = result.get("materials", {})
    for name, role in contrast.get("materials", {}).items():
        if name in materials:
            materials[name] = {"technique": "unlit", "base_colour": list(_COLOURS[role])}
    left_out = contrast.get("left_out", ())
    for entity in result["entities"]:
        if entity["id"] in left_out:
            entity["components"].pop("mesh", None)
        surroundings = entity["components"].get("environment")
        if surroundings is not None:
            surroundings |= {"zenith": _DARK, "horizon": _DARK, "ground": _DARK, "ambient": _DIM}
    return result
