"""Largest errors a run accepts: what its scene says, and what its profile says where the scene is silent."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from mimics_app.app.settings import Profile
from mimics_app.world.components.systems import Tolerances
from mimics_app.world.scene.scene import Scene

__all__ = ["BY_PROFILE", "FIELD_OF_UNIT", "tolerances_of"]

BY_PROFILE: Mapping[Profile, Mapping[str, float]] = {
    "draft": {
        "force_N": 0.5,
        "position_m": 1e-3,
        "angle_rad": 2e-2,
        "restitution": 0.03,
        "itd_us": 700.0,
        "frame_ms": 34.0,
        "edge_px": 0.5,
        "shadow_m": 1e-3,
        "pixel_share": 0.1,
        "colour_levels": 40.0,
        "effect_share": 1.0,
    },
    "training": {
        "force_N": 0.05,
        "position_m": 1e-6,
        "angle_rad": 1e-3,
        "restitution": 0.02,
        "itd_us": 40.0,
        "frame_ms": 17.0,
        "edge_px": 0.1,
        "shadow_m": 2e-4,
        "pixel_share": 0.03,
        "colour_levels": 2.0,
        "effect_share": 0.1,
    },
    "study": {
        "force_N": 1e-3,
        "position_m": 1e-8,
        "angle_rad": 1e-4,
        "restitution": 0.02,
        "itd_us": 30.0,
        "frame_ms": 17.0,
        "edge_px": 0.1,
        "shadow_m": 1.5e-4,
        "pixel_share": 0.005,
        "colour_levels": 1.0,
        "effect_share": 0.05,
    },
}
"""By profile and field of `systems.tolerances`.

draft       what a hand does not notice while a scene is made: 0.5 N, 1 mm, one degree; a bounce is right to a thirtieth
            of the speed, which no stricter profile can better by much at 1 kHz; sounds need no direction
            (700 us is the whole width of a head); every second refresh of a 60 Hz screen; edges fall as they fall,
            surfaces are lit by their corners, and bloom and ambient occlusion may be missing altogether
training    a tenth of what a hand or the robot's encoder (10 um) distinguishes; sounds come from where they are; edges
            of bodies to a tenth of a pixel, those of shadows to a fifth of a millimetre
study       what cannot be seen in the analysis of a recording: a thousandth of the training's, or rounding; far bodies
            keep their forms for longer
"""

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
    "of the effect": "effect_share",
    "levels of 255": "colour_levels",
}
"""Which tolerance bounds an error, by the unit of the error in the table of methods."""


def tolerances_of(scene: Scene, profile: Profile) -> dict[str, float]:
    """Largest accepted error by field of `systems.tolerances`; units in the names."""
    stated = scene.systems.get("tolerances")
    given = msgspec.structs.asdict(stated) if isinstance(stated, Tolerances) else {}
    return {**BY_PROFILE[profile], **{name: value for name, value in given.items() if value is not None}}
