"""Largest errors that a run accepts: those of its scene, and those of its profile where the scene states none."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from mimics_app.app.settings import PROFILES, Profile
from mimics_app.world.components.systems import Tolerances
from mimics_app.world.files.scene.scene import Scene

__all__ = ["BY_PROFILE", "tolerances_of"]

_BOUNDS: Mapping[str, tuple[float, float, float]] = {
    "force_N": (0.5, 0.05, 1e-3),
    "position_m": (1e-3, 1e-6, 1e-8),
    "angle_rad": (2e-2, 1e-3, 1e-4),
    "restitution": (0.03, 0.02, 0.02),
    "itd_us": (700.0, 40.0, 30.0),
    "frame_ms": (34.0, 17.0, 17.0),
    "edge_px": (0.5, 0.1, 0.1),
    "shadow_m": (1e-3, 2e-4, 1.5e-4),
    "pixel_share": (0.1, 0.03, 0.005),
    "colour_levels": (40.0, 2.0, 1.0),
    "effect_share": (1.0, 0.1, 0.05),
}
"""Value of each tolerance in a draft, a training and a study."""

BY_PROFILE: Mapping[Profile, Mapping[str, float]] = {
    profile: {name: bounds[k] for name, bounds in _BOUNDS.items()} for k, profile in enumerate(PROFILES)
}
"""Tolerances by profile and field of `systems.tolerances`.

draft       errors that a hand does not notice while a scene is made: 0.5 N, 1 mm, one degree; restitution to 3 % of the
            speed, which stricter profiles can hardly improve at 1 kHz; sounds without direction (700 us is the
            interaural delay of a whole head); every second refresh of a 60 Hz screen; edges without anti-aliasing,
            light per vertex, and neither bloom nor ambient occlusion
training    a tenth of the smallest error that a hand or the robot's encoder (10 um) resolves; sounds with direction;
            edges of objects to a tenth of a pixel, those of shadows to a fifth of a millimetre
study       errors that the analysis of a recording cannot resolve: a thousandth of the training's, or rounding; levels
            of detail change at larger distances
"""


def tolerances_of(scene: Scene, profile: Profile) -> dict[str, float]:
    """Return the largest accepted error by field of `systems.tolerances`; the units are in the names."""
    given = msgspec.structs.asdict(scene.system(Tolerances) or Tolerances())
    return {**BY_PROFILE[profile], **{name: value for name, value in given.items() if value is not None}}
