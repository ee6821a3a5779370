"""Quality settings of the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, TypedDict, get_args, get_origin, get_type_hints

from mimics_app.contracts.errors import UsageError, require_choice
from mimics_app.world.content.materials.technique import Profile

__all__ = [
    "Culling",
    "Occlusion",
    "ParticleLight",
    "QualityChanges",
    "RenderSettings",
    "Shading",
    "ShadowKind",
    "SkinBy",
    "StereoPasses",
]

Shading = Literal["full", "matt", "plain"]
"""Techniques of opaque surfaces: each material's own; or a fallback of the lit ones: without specular reflection and
without point and spot lights, or the cheapest, lit per vertex in display values."""


SkinBy = Literal["processor", "feedback"]
"""Where skinned meshes are deformed: in compiled loops on the processor, or on the GPU by transform feedback."""

ParticleLight = Literal["pixel", "vertex"]
"""Where the light of lit particles is computed: at each pixel, or at their vertices and interpolated."""

Culling = Literal["auto", "flat", "tree"]
"""Frustum culling: test every item, test groups of the scene graph first, or choose by the number of items."""

StereoPasses = Literal["two_pass", "viewports", "clip_distance"]
"""Stereo rendering: one pass per eye; or both in one pass, every second instance for the other eye, into a viewport of
its own or into one half of a shared viewport, clipped at its centre line."""

Occlusion = Literal["off", "derived", "authored", "all"]
"""Occluder boxes in use: none, those derived from meshes, those authored in models, or both."""


ShadowKind = Literal["texture_additive", "texture_modulative", "stencil_additive", "stencil_modulative"]
"""Shadows of the sun: shadow maps or stencil volumes; additive leaves the sun's light out in the shade, modulative
darkens the finished picture there."""


@dataclass(frozen=True, slots=True)
class RenderSettings:
    """Quality of the picture.

    Attributes:
        msaa: Samples per pixel: 0 (off), 2 or 4; more than the driver offers becomes what it offers.
        fxaa: True filters the edges of the finished picture (FXAA).
        shadow_size: Width of the sun's shadow map [texel]; 0 disables shadows.
        shadows: Kind of the sun's shadows.
        shadow_tone: Factor of modulative shadows on the picture's display values, 0-1.
        shadow_distance: Distance from the camera up to which the sun casts shadows [m], in `cascades` nested maps;
            0: everywhere, in one map around all casters.
        cascades: Number of shadow maps of the sun, 1 to 4.
        shadow_reach: Casters with a larger bounding radius [m] receive shadows but do not widen the map.
        tone_map: "neutral" (Khronos PBR neutral with a softer toe, which preserves base colours) or "none" (clamped,
            for tests).
        exposure: Factor on all light before the tone map.
        ambient_occlusion: Strength of ambient occlusion, 1: physical; 0 disables it.
        ambient_radius: Radius of ambient occlusion [m].
        bloom: Share of the light that bloom spreads, 0 to 1; 0 disables it.
        fog_density: Density of the fog in the horizon's colour [1/m]; 0 disables it.
        hud_depth: Distance of the heads-up display from the eyes [m].
        hud_enlarged: Factor on its size.
        scale: Resolution of the world's picture over that of the surface, 0.25 to 1; heads-up display stays sharp.
        detail: Factor on the distances at which levels of detail change, 0.25 to 4.
        mirror_scale: Resolution of mirrors over that of the picture, 0.1 to 1.
        shading: Techniques of opaque surfaces, see `Shading`.
        vertex_light: Length on the picture [px] up to which the sides of triangles are so short that their light is
            computed at their vertices; 0: at each pixel, whatever their size.
        particle_light: Where the light of lit particles is computed, see `ParticleLight`.
        profile: Purpose of the picture; techniques that exclude it are replaced by their fallbacks.
        occlusion: Occluder boxes in use; the picture is the same with derived ones and without any. Where the processor
            draws, "off" also draws the triangles that no pixel shows.
        culling: Method of frustum culling; the picture is the same.
        skinning: Where skinned meshes are deformed; the picture is the same.
        stereo: Passes of two eyes, see `StereoPasses`; two passes where the driver or a shader allows no other.
        place_threads: True places a software rasteriser's threads on the cores (`RasterThreads`); the picture is the
            same.
        timer: True measures GPU times, where the driver can.
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
    hud_enlarged: float = 1.0
    scale: float = 1.0
    detail: float = 1.0
    mirror_scale: float = 1.0
    shading: Shading = "full"
    vertex_light: float = 0.0
    particle_light: ParticleLight = "pixel"
    profile: Profile = "training"
    occlusion: Occlusion = "all"
    culling: Culling = "auto"
    skinning: SkinBy = "processor"
    stereo: StereoPasses = "clip_distance"
    place_threads: bool = True
    timer: bool = False

    def __post_init__(self) -> None:
        _check_types(self)
        if self.msaa not in (0, 2, 4, 8):
            raise UsageError(f"{self.msaa} samples per pixel are not supported", "give 0, 2, 4 or 8")
        if not 0.25 <= self.scale <= 1.0:
            raise UsageError(f"the resolution scale {self.scale} is out of range", "give 0.25 to 1")
        if not 0.25 <= self.detail <= 4.0:
            raise UsageError(f"the level-of-detail factor {self.detail} is out of range", "give 0.25 to 4")
        if not self.vertex_light >= 0.0:
            raise UsageError(f"light at vertices up to {self.vertex_light} px is out of range", "give 0 px or more")
        if not 0.1 <= self.mirror_scale <= 1.0:
            raise UsageError(f"the mirror scale {self.mirror_scale} is out of range", "give 0.1 to 1")
        if not 0.0 <= self.ambient_occlusion <= 4.0 or not self.ambient_radius > 0.0:
            what = f"ambient occlusion of {self.ambient_occlusion} within {self.ambient_radius} m is out of range"
            raise UsageError(what, "give 0 to 4, and a radius above 0 m")
        if not 0.0 <= self.bloom <= 1.0:
            raise UsageError(f"the bloom {self.bloom} is out of range", "give 0 to 1")
        if not 1 <= self.cascades <= 4:
            raise UsageError(f"{self.cascades} shadow maps of the sun are not supported", "give 1 to 4")
        if not 0 <= self.shadow_size <= 8192:
            raise UsageError(f"a shadow map of {self.shadow_size} texels is not supported", "give 0 to 8192")


def _check_types(settings: RenderSettings) -> None:
    """Refuse words that are no choice of a setting, and NaN."""
    for name, hint in _hints().items():
        value = getattr(settings, name)
        if get_origin(hint) is Literal:
            require_choice(value, get_args(hint), f"setting of {name}")
        elif hint is float and math.isnan(value):
            raise UsageError(f"{name} is not a number", "give a number")


@cache
def _hints() -> dict[str, Any]:
    return get_type_hints(RenderSettings)


class QualityChanges(TypedDict, total=False):
    """Fields of `RenderSettings` that may change between two frames; the last three compile shaders."""

    shadow_size: int
    scale: float
    msaa: int
    fxaa: bool
    bloom: float
    mirror_scale: float
    ambient_occlusion: float
    detail: float
    shading: Shading
    vertex_light: float
    particle_light: ParticleLight
