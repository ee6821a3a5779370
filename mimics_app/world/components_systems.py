"""Settings of the stages: what stands under `systems` in a scene file."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.world.registry import Component, register_system

__all__ = ["AudioSettings", "HapticSettings", "VisualSettings"]


class HapticSettings(Component, frozen=True):
    """The haptic loop."""

    projection: Annotated[
        Literal["newton warm", "golden section", "brute force"],
        Meta(description="How the closest point of a tunnel's bisector is found; see mimics explain"),
    ] = "newton warm"


class VisualSettings(Component, frozen=True):
    """The picture."""

    samples: Annotated[Literal[0, 2, 4, 8], Meta(description="Of multisample anti-aliasing; 0: none")] = 4
    shadow_size: Annotated[int, Meta(ge=0, le=8192, description="Side of the shadow map [pixels]; 0: no shadows")] = 512


class AudioSettings(Component, frozen=True):
    """The sound."""

    enabled: Annotated[bool, Meta(description="False: no audio process at all")] = True
    hrtf: Annotated[bool, Meta(description="Place sounds about the head (headphones)")] = True
    gain: Annotated[float, Meta(ge=0, le=4, description="Of everything, linear")] = 1.0


register_system("haptic", HapticSettings)
register_system("visual", VisualSettings)
register_system("audio", AudioSettings)
