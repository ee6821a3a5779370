"""Settings of the stages: what stands under `systems` in a scene file."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.world.components.bounds import Extent, Factor, Length
from mimics_app.world.components.registry import Component, register_system

__all__ = ["AudioSettings", "DisplaySettings", "HapticSettings", "Tolerances", "VisualSettings"]


class HapticSettings(Component, frozen=True):
    """The haptic loop."""

    projection: Annotated[
        Literal["auto", "newton one step", "newton warm", "golden section", "brute force"],
        Meta(description="How the closest point of a tunnel's bisector is found; auto: the planner (mimics explain)"),
    ] = "auto"


class VisualSettings(Component, frozen=True):
    """The picture."""

    anti_aliasing: Annotated[
        Literal["auto", "none", "samples", "filter", "both"],
        Meta(
            description="Smooth edges: several `samples` a pixel, a filter of the finished picture, or both; "
            "auto: `samples` where they are given, else the planner (mimics explain)"
        ),
    ] = "auto"
    samples: Annotated[
        Literal["auto", 0, 2, 4, 8],
        Meta(description="Of multisample anti-aliasing; 0: none; auto: 4 where `anti_aliasing` requests them"),
    ] = "auto"
    skinning: Annotated[
        Literal["auto", "processor", "feedback"],
        Meta(description="Who bends bodies that follow joints: the processor or a shader; auto: the planner"),
    ] = "auto"
    shading: Annotated[
        Literal["auto", "full", "matt", "plain"],
        Meta(
            description="How opaque surfaces are lit: full; matt: by sun and sky, without what they mirror; plain: "
            "by its corners, without shadows; auto: the planner (mimics explain)"
        ),
    ] = "auto"
    exposure: Annotated[float, Meta(gt=0, le=64, description="Factor on all light before the tone map")] = 1.0
    tone_map: Annotated[
        Literal["neutral", "none"],
        Meta(
            description="neutral: base colours stay what they are, what dazzles keeps its hue; none: cut off at white"
        ),
    ] = "neutral"
    ambient_occlusion: Annotated[
        float, Meta(ge=0, le=4, description="How much near surfaces take off each other's light from the sky; 0: none")
    ] = 0.0
    ambient_radius: Annotated[Length, Meta(description="Within which surfaces do so [m]")] = 0.3
    bloom: Annotated[float, Meta(ge=0, le=1, description="Share of the light that spreads around it; 0: none")] = 0.0
    shadow_size: Annotated[
        Annotated[int, Meta(ge=0, le=8192)] | Literal["auto"],
        Meta(description="Side of the shadow map [pixels]; 0: no shadows; auto: the planner (mimics explain)"),
    ] = "auto"
    shadows: Annotated[
        Literal["auto", "texture_additive", "texture_modulative", "stencil_additive", "stencil_modulative"],
        Meta(
            description="How the sun's shadows are made: maps or volumes, light left out or the picture darkened; "
            "auto: maps where their size or distance is given, else the planner, which leaves light out"
        ),
    ] = "auto"
    shadow_distance: Annotated[
        Extent | Literal["auto"],
        Meta(
            description="How far from the eye shadows are seen [m], in `cascades`; 0: one map of it all; "
            "auto: one map where bodies are within 8 m, else as far as they are spread, 100 m at most"
        ),
    ] = "auto"
    cascades: Annotated[int, Meta(ge=1, le=4, description="Maps of the sun, one in another")] = 3
    fog_density: Annotated[Factor, Meta(description="Haze of the horizon's colour with distance [1/m]")] = 0.12


class DisplaySettings(Component, frozen=True):
    """Where the picture is shown, unless --display says so."""

    kind: Annotated[
        Literal[
            "desktop",
            "sbs",
            "sbs-half",
            "tb",
            "interleaved",
            "anaglyph",
            "quad",
            "wall",
            "cave",
            "hmd",
            "openxr",
            "sim-hmd",
        ],
        Meta(description="As --display takes it"),
    ] = "desktop"
    file: Annotated[
        str, Meta(max_length=400, description="Of walls or of a headset, beside the scene; '' for none")
    ] = ""
    ipd: Annotated[float, Meta(ge=0.0, le=0.1, description="Between the eyes, of a stereo screen [m]")] = 0.063
    screen_distance: Annotated[
        float, Meta(ge=0.1, le=100.0, description="Where a stereo screen's two pictures agree [m]")
    ] = 2.0
    passes: Annotated[
        Literal["auto", "two_pass", "viewports", "clip_distance"],
        Meta(
            description="How two eyes are drawn: one after the other; or together, each into a viewport or into its "
            "half of one; auto: the planner"
        ),
    ] = "auto"
    swap_eyes: Annotated[bool, Meta(description="True: left and right of a stereo screen exchanged")] = False


class AudioSettings(Component, frozen=True):
    """The sound."""

    enabled: Annotated[bool, Meta(description="False: no audio process at all")] = True
    hrtf: Annotated[
        bool | Literal["auto"],
        Meta(description="Place sounds about the head (headphones); auto: as systems.tolerances.itd_us asks"),
    ] = "auto"
    mixer: Annotated[
        Literal["auto", "openal", "spectral"],
        Meta(
            description="Which one mixes; spectral is exact between the ears; auto: as systems.tolerances.itd_us asks"
        ),
    ] = "auto"
    speakers: Annotated[
        Literal["stereo", "5.1", "7.1", "ambisonic"],
        Meta(description="Loudspeakers where hrtf is false; beyond stereo the spectral mixer; ambisonic: third order"),
    ] = "stereo"
    sofa: Annotated[
        str | None, Meta(description="Of the scene's `assets`, a .sofa file: the person's own head (spectral)")
    ] = None
    head_width: Annotated[
        float, Meta(ge=0.1, le=0.25, description="Between the ears of the computed head [m] (spectral)")
    ] = 0.152
    voices: Annotated[int, Meta(ge=1, le=4096, description="Most sounds at once; openal has 200 at most")] = 64
    gain: Annotated[float, Meta(ge=0, le=4, description="Of everything, linear")] = 1.0


_Limit = Annotated[float, Meta(gt=0, le=1e9)]


class Tolerances(Component, frozen=True):
    """Largest errors the scene accepts. What is left out is the profile's (draft, training, study)."""

    force_N: Annotated[_Limit | None, Meta(description="Of a force on the hand [N]")] = None  # noqa: N815  the unit
    position_m: Annotated[_Limit | None, Meta(description="Of a point that is touched, or its path [m]")] = None
    angle_rad: Annotated[_Limit | None, Meta(description="Of a direction or frame [rad]")] = None
    restitution: Annotated[
        _Limit | None, Meta(description="Of the share of its speed that a body keeps when it bounces")
    ] = None
    itd_us: Annotated[_Limit | None, Meta(description="Of the delay of a sound between the ears [us]")] = None
    frame_ms: Annotated[_Limit | None, Meta(description="Longest a frame of the picture may take [ms]")] = None
    edge_px: Annotated[_Limit | None, Meta(description="Of the share of a pixel that an edge covers [px]")] = None
    shadow_m: Annotated[_Limit | None, Meta(description="Of the place of a shadow's edge [m]")] = None
    pixel_share: Annotated[
        _Limit | None, Meta(description="Pixels that may differ by what is left out or coarser, of all of them")
    ] = None
    colour_levels: Annotated[
        _Limit | None, Meta(description="By which simpler shading may differ, root mean square, of 255")
    ] = None
    effect_share: Annotated[
        _Limit | None, Meta(description="What may be missing of bloom or ambient occlusion, of all of it; 1: both")
    ] = None


register_system("tolerances", Tolerances)
register_system("haptic", HapticSettings)
register_system("visual", VisualSettings)
register_system("display", DisplaySettings)
register_system("audio", AudioSettings)
