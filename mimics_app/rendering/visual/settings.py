"""What a person or a governor may trade for speed in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypedDict

from mimics_app.contracts.errors import UsageError
from mimics_app.world.materials.technique import Profile

__all__ = [
    "BendBy",
    "Culling",
    "Occlusion",
    "QualityChanges",
    "RenderSettings",
    "Shading",
    "ShadowKind",
    "StereoPasses",
]

Shading = Literal["full", "matt", "plain"]
"""Which techniques draw opaque surfaces: each material's own; or, of those that are lit, one further down its chain of
fallbacks: without what they mirror and without lamps, or the cheapest, lit per vertex in display values."""


BendBy = Literal["processor", "feedback"]
"""Who bends what follows joints: compiled loops, or the driver by a shader whose vertices are fed back."""

Culling = Literal["auto", "flat", "tree"]
"""How the items in a view are found: each tested on its own, groups of the scene graph first, or by their number."""

StereoPasses = Literal["two_pass", "viewports", "clip_distance"]
"""How the two eyes before a picture are drawn: one after the other; or together, every second instance for the other
eye, into a viewport of its own, or into its half of one, cut off at the middle."""

Occlusion = Literal["off", "derived", "authored", "all"]
"""Which boxes may hide what is behind them: none, those found inside meshes, those written into models, or both."""


ShadowKind = Literal["texture_additive", "texture_modulative", "stencil_additive", "stencil_modulative"]
"""How the sun's shadows are made: depth maps or volumes; and whether its light is left out where it does not arrive,
or the finished picture darkened there."""


@dataclass(frozen=True, slots=True)
class RenderSettings:
    """Quality of the picture.

    Attributes:
        msaa: Samples per pixel: 0 (off), 2 or 4; more than the driver offers becomes what it offers.
        fxaa: True smooths edges in the finished picture.
        shadow_size: Width of the sun's shadow map [texel]; 0 leaves shadows out.
        shadows: How the sun's shadows are made.
        shadow_tone: What modulative shadows leave of the picture's display values, 0-1.
        shadow_distance: How far from the eyes the sun's shadows are seen [m], in `cascades` maps one inside another;
            0: everywhere, in one map about all casters.
        cascades: Maps of the sun, 1 to 4.
        shadow_reach: Casters of a bounding radius beyond this [m] receive shadows but do not widen the map.
        tone_map: "neutral" (Khronos PBR neutral with a softer toe: base colours stay what they are) or "none"
            (clamped, for tests).
        exposure: Factor on all light before the tone map.
        ambient_occlusion: How much near surfaces take off each other's skylight, 1: as they do; 0 leaves it out.
        ambient_radius: Within which surfaces do so [m].
        bloom: Share of the light that is spread about, 0 to 1; 0 leaves it out.
        fog_density: Share of the horizon's colour mixed in per metre of distance [1/m]; 0 leaves fog out.
        hud_depth: Distance of the heads-up display from the eyes [m].
        scale: Width and height of the world's picture as drawn over those shown, 0.25 to 1; figures stay sharp.
        detail: Distances at which bodies go over to coarser forms, over those that their authors gave: 0.25 to 4.
        mirror_scale: Width and height of what mirrors show over those of the picture, 0.1 to 1.
        shading: Which techniques draw opaque surfaces, see `Shading`.
        profile: What it is drawn for; techniques that are not for it give way to their fallbacks.
        occlusion: Which boxes may hide what is behind them; the picture is the same with any found ones and none.
        culling: How the items in a view are found; the picture is the same.
        skinning: Who bends what follows joints; the picture is the same.
        stereo: How two eyes are drawn, see `StereoPasses`; where it cannot be, in two passes.
        timer: True asks the driver how long it drew, where it can say.
    """

    msaa: int = 4
    fxaa: bool = False
    shadow_size: int = 512
    shadows: ShadowKind = "texture_additive"
    shadow_tone: float = 0.55
    shadow_distance: float = 0.0
    cascades: int = 3
    shadow_reach: float = 2.0
    tone_map: Literal["neutral", "none"] = "neutral"
    exposure: float = 1.0
    ambient_occlusion: float = 0.0
    ambient_radius: float = 0.3
    bloom: float = 0.0
    fog_density: float = 0.12
    hud_depth: float = 1.0
    scale: float = 1.0
    detail: float = 1.0
    mirror_scale: float = 1.0
    shading: Shading = "full"
    profile: Profile = "training"
    occlusion: Occlusion = "all"
    culling: Culling = "auto"
    skinning: BendBy = "processor"
    stereo: StereoPasses = "clip_distance"
    timer: bool = False

    def __post_init__(self) -> None:
        if self.msaa not in (0, 2, 4, 8):
            raise UsageError(f"{self.msaa} samples per pixel cannot be", "give 0, 2, 4 or 8")
        if not 0.25 <= self.scale <= 1.0:
            raise UsageError(f"a picture drawn at {self.scale} of its size cannot be", "give 0.25 to 1")
        if not 0.25 <= self.detail <= 4.0:
            raise UsageError(f"levels of detail {self.detail} times as far away cannot be", "give 0.25 to 4")
        if not 0.1 <= self.mirror_scale <= 1.0:
            raise UsageError(f"mirrors drawn at {self.mirror_scale} of their size cannot be", "give 0.1 to 1")
        if not 0.0 <= self.ambient_occlusion <= 4.0 or not self.ambient_radius > 0.0:
            what = f"ambient occlusion of {self.ambient_occlusion} within {self.ambient_radius} m cannot be"
            raise UsageError(what, "give 0 to 4, and a radius beyond 0 m")
        if not 0.0 <= self.bloom <= 1.0:
            raise UsageError(f"a bloom of {self.bloom} of the light cannot be", "give 0 to 1")
        if not 1 <= self.cascades <= 4:
            raise UsageError(f"{self.cascades} shadow maps of the sun cannot be", "give 1 to 4")
        if not 0 <= self.shadow_size <= 8192:
            raise UsageError(f"a shadow map of {self.shadow_size} texels cannot be", "give 0 to 8192")


class QualityChanges(TypedDict, total=False):
    """What of `RenderSettings` a governor may change between two frames; only `shading` needs something compiled."""

    shadow_size: int
    scale: float
    msaa: int
    fxaa: bool
    bloom: float
    mirror_scale: float
    ambient_occlusion: float
    detail: float
    shading: Shading
