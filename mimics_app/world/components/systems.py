"""Settings of the stages: the section `systems` of a scene file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from msgspec import Meta, field

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.ports.display_choice import DISPLAY_KINDS, display_names
from mimics_app.world.components.bounds import Extent, Factor, Length, Name, Share
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, register_system
from mimics_app.world.components.visible import CameraComponent

__all__ = ["AudioSettings", "Contrast", "DisplaySettings", "HapticSettings", "Role", "Tolerances", "VisualSettings"]

Role = Literal["target", "path", "hand", "ground"]
"""What a material is of, in high contrast."""


class HapticSettings(Component, frozen=True):
    """Settings of the haptic loop."""

    projection: Annotated[
        Literal["auto", "newton one step", "newton warm", "golden section", "brute force"],
        Meta(description="Search for the closest point of a tunnel's bisector; auto: the planner (mimics explain)"),
    ] = "auto"


class VisualSettings(Component, frozen=True):
    """Settings of the picture."""

    anti_aliasing: Annotated[
        Literal["auto", "none", "samples", "filter", "both"],
        Meta(
            description="Smooth edges: several `samples` a pixel, a filter of the finished picture, or both; "
            "auto: `samples` where they are given, else the planner (mimics explain)"
        ),
    ] = "auto"
    samples: Annotated[
        Literal["auto", 0, 2, 4, 8],
        Meta(description="Samples of multisample anti-aliasing; 0: none; auto: 4 where `anti_aliasing` requests them"),
    ] = "auto"
    skinning: Annotated[
        Literal["auto", "processor", "feedback"],
        Meta(
            description="Skinning on the processor, or on the graphics card with transform feedback; auto: the planner"
        ),
    ] = "auto"
    shading: Annotated[
        Literal["auto", "full", "matt", "plain"],
        Meta(
            description="Shading of opaque surfaces: full; matt: by sun and sky, without reflections; plain: "
            "per vertex, without shadows; auto: the planner (mimics explain)"
        ),
    ] = "auto"
    exposure: Annotated[float, Meta(gt=0, le=64, description="Factor on all light before the tone map")] = 1.0
    tone_map: Annotated[
        Literal["neutral", "none"],
        Meta(description="neutral: base colours are kept, highlights keep their hue; none: clipped at white"),
    ] = "neutral"
    ambient_occlusion: Annotated[
        float, Meta(ge=0, le=4, description="Strength of the darkening of sky light by near surfaces; 0: none")
    ] = 0.0
    ambient_radius: Annotated[Length, Meta(description="Distance within which surfaces occlude [m]")] = 0.3
    bloom: Annotated[Share, Meta(description="Share of the light that spreads around bright areas; 0: none")] = 0.0
    shadow_size: Annotated[
        Annotated[int, Meta(ge=0, le=8192)] | Literal["auto"],
        Meta(description="Side of the shadow map [pixels]; 0: no shadows; auto: the planner (mimics explain)"),
    ] = "auto"
    shadows: Annotated[
        Literal["auto", "texture_additive", "texture_modulative", "stencil_additive", "stencil_modulative"],
        Meta(
            description="Method of the sun's shadows: maps or volumes, additive light or a darkened picture; "
            "auto: maps where their size or distance is given, else the planner, which takes additive light"
        ),
    ] = "auto"
    shadow_distance: Annotated[
        Extent | Literal["auto"],
        Meta(
            description="Distance from the camera up to which shadows are drawn [m], in `cascades`; 0: one map of all; "
            "auto: one map where bodies are within 8 m, else as far as they are spread, 100 m at most"
        ),
    ] = "auto"
    cascades: Annotated[int, Meta(ge=1, le=4, description="Number of nested shadow maps of the sun")] = 3
    fog_density: Annotated[Factor, Meta(description="Density of the fog, in the horizon's colour [1/m]")] = 0.12
    view: Annotated[Name | None, Meta(description="Entity whose camera is shown first; absent: the first camera")] = (
        None
    )
    flight: Annotated[
        float, Meta(ge=0, le=10, description="Duration of the flight from one view to the next [s]; 0: a cut")
    ] = 0.0
    levels_from: Annotated[
        Name | None,
        Meta(description="Entity from which distant models move in coarser steps; absent: the first camera"),
    ] = None


class DisplaySettings(Component, frozen=True):
    """Display of the picture; --display overrides it."""

    kind: Annotated[
        str,
        Meta(max_length=64, examples=[*DISPLAY_KINDS], description="Kind of display, as of --display"),
    ] = "desktop"
    file: Annotated[
        str, Meta(max_length=400, description="File of the walls or the headset, beside the scene; '' for none")
    ] = ""
    ipd: Annotated[float, Meta(ge=0.0, le=0.1, description="Distance between the eyes, for a stereo screen [m]")] = (
        0.063
    )
    screen_distance: Annotated[
        float, Meta(ge=0.1, le=100.0, description="Distance at which a stereo screen has no parallax [m]")
    ] = 2.0
    passes: Annotated[
        Literal["auto", "two_pass", "viewports", "clip_distance"],
        Meta(
            description="Drawing of two eyes: one after the other; or together, each into a viewport or into its "
            "half of one; auto: the planner"
        ),
    ] = "auto"
    swap_eyes: Annotated[bool, Meta(description="True: left and right of a stereo screen exchanged")] = False


class AudioSettings(Component, frozen=True):
    """Settings of the sound."""

    enabled: Annotated[bool, Meta(description="False: no audio process at all")] = True
    hrtf: Annotated[
        bool | Literal["auto"],
        Meta(description="Spatialise sounds by HRTF (headphones); auto: as systems.tolerances.itd_us requires"),
    ] = "auto"
    mixer: Annotated[
        str,
        Meta(
            max_length=64,
            examples=["auto", "openal", "spectral"],
            description="Mixer: openal, spectral, or one of an installed package; auto: spectral for an exact ITD "
            "(systems.tolerances.itd_us), a sofa or head_width, speakers beyond stereo, a sound_room, sound_bus, "
            "distance_model or doppler factor, which openal ignores",
        ),
    ] = "auto"
    speakers: Annotated[
        Literal["stereo", "5.1", "7.1", "ambisonic"],
        Meta(description="Loudspeakers where hrtf is false; beyond stereo the spectral mixer; ambisonic: third order"),
    ] = "stereo"
    sofa: Annotated[
        str | None, Meta(description=".sofa file of the scene's `assets`: the person's own head (spectral)")
    ] = None
    head_width: Annotated[
        float, Meta(ge=0.1, le=0.25, description="Distance between the ears of the computed head [m] (spectral)")
    ] = 0.152
    voices: Annotated[
        int, Meta(ge=1, le=4096, description="Maximum number of sounds at once; openal has 200 at most")
    ] = 64
    gain: Annotated[float, Meta(ge=0, le=4, description="Master gain, linear")] = 1.0
    listener: Annotated[
        Name | None, Meta(description="Entity at whose place the person hears; absent: the first camera")
    ] = None


_Limit = Annotated[float, Meta(gt=0, le=1e9)]


class Tolerances(Component, frozen=True):
    """Largest errors the scene accepts. Absent values are those of the profile (draft, training, study)."""

    force_N: Annotated[_Limit | None, Meta(description="Error of a force on the hand [N]")] = None  # noqa: N815  the unit
    position_m: Annotated[_Limit | None, Meta(description="Error of a point of contact, or its path [m]")] = None
    angle_rad: Annotated[_Limit | None, Meta(description="Error of a direction or frame [rad]")] = None
    restitution: Annotated[_Limit | None, Meta(description="Error of the coefficient of restitution")] = None
    itd_us: Annotated[_Limit | None, Meta(description="Error of the interaural time difference of a sound [us]")] = None
    frame_ms: Annotated[_Limit | None, Meta(description="Maximum time of a frame [ms]")] = None
    edge_px: Annotated[_Limit | None, Meta(description="Error of an edge's coverage of a pixel [px]")] = None
    shadow_m: Annotated[_Limit | None, Meta(description="Error of the position of a shadow's edge [m]")] = None
    pixel_share: Annotated[
        _Limit | None, Meta(description="Share of pixels that may differ by culling and coarser levels")
    ] = None
    colour_levels: Annotated[
        _Limit | None, Meta(description="Difference of simpler shading, root mean square, of 255")
    ] = None
    effect_share: Annotated[
        _Limit | None, Meta(description="Share of bloom or ambient occlusion that may be missing; 1: both")
    ] = None


def _check_display(settings: DisplaySettings, scene: CheckedScene) -> list[Issue]:
    """Return a fault where neither the program nor an installed package has the display."""
    known = DISPLAY_KINDS if settings.kind in DISPLAY_KINDS else display_names()
    return scene.check_names({"/systems/display/kind": settings.kind}, "there is no display", known)


def _check_visual(settings: VisualSettings, scene: CheckedScene) -> list[Issue]:
    """Return the faults of a first view without a camera, and of an unknown eye of levels."""
    issues = scene.check_entity_with(CameraComponent, "/systems/visual/view", settings.view)
    return issues + scene.check_entity("/systems/visual/levels_from", settings.levels_from)


def _check_audio(settings: AudioSettings, scene: CheckedScene) -> list[Issue]:
    """Return the faults of an unknown listener or head, and of loudspeakers that would be ignored."""
    issues = scene.check_asset("/systems/audio/sofa", settings.sofa, "head")
    issues += scene.check_entity("/systems/audio/listener", settings.listener)
    if settings.speakers != "stereo" and settings.hrtf is not False:
        what = f"{settings.speakers} is not played with head-related filters"
        issues.append(scene.issue("/systems/audio/speakers", what, 'add "hrtf": false'))
    return issues


class Contrast(Component, frozen=True):
    """The scene in high contrast (`mimics run --high-contrast`); without it only texts and panels are."""

    materials: Annotated[
        Mapping[Name, Role],
        Meta(max_length=100, description="What materials are of, by name: each role has a colour of its own"),
    ] = field(default_factory=dict)
    left_out: Annotated[
        tuple[Name, ...], Meta(max_length=200, description="Entities whose model is not drawn, as light surroundings")
    ] = ()


def _check_contrast(contrast: Contrast, scene: CheckedScene) -> list[Issue]:
    pointer = "/systems/contrast"
    issues = [each for name in contrast.materials for each in scene.check_material(f"{pointer}/materials", name)]
    left_out = {f"{pointer}/left_out/{number}": name for number, name in enumerate(contrast.left_out)}
    return issues + scene.check_names(left_out, "no entity", scene.by_id)


register_system("contrast", Contrast, _check_contrast)
register_system("tolerances", Tolerances)
register_system("haptic", HapticSettings)
register_system("visual", VisualSettings, _check_visual)
register_system("display", DisplaySettings, _check_display)
register_system("audio", AudioSettings, _check_audio)
