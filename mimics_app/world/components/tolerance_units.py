"""Units of the errors that the fields of `systems.tolerances` bound."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["FIELD_OF_UNIT", "UNIT_OF_FIELD"]

UNIT_OF_FIELD: Mapping[str, str] = {
    "force_N": "N",
    "position_m": "m",
    "angle_rad": "rad",
    "restitution": "restitution",
    "itd_us": "us of interaural delay",
    "frame_ms": "ms",
    "edge_px": "px",
    "shadow_m": "m of a shadow's edge",
    "pixel_share": "share of pixels",
    "colour_levels": "levels of 255",
    "effect_share": "of the effect",
}
"""The unit of each tolerance."""

FIELD_OF_UNIT: Mapping[str, str] = {unit: name for name, unit in UNIT_OF_FIELD.items()}
"""Which tolerance bounds an error, by the unit of the error in the table of methods."""
