"""Units of the errors that the fields of `systems.tolerances` bound."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["FIELD_OF_UNIT"]

FIELD_OF_UNIT: Mapping[str, str] = {
    "N": "force_N",
    "m": "position_m",
    "rad": "angle_rad",
    "restitution": "restitution",
    "us of interaural delay": "itd_us",
    "ms": "frame_ms",
    "px": "edge_px",
    "m of a shadow's edge": "shadow_m",
    "share of pixels": "pixel_share",
    "levels of 255": "colour_levels",
    "of the effect": "effect_share",
}
"""Which tolerance bounds an error, by the unit of the error in the table of methods."""
