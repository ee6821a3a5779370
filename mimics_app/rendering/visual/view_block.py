"""The uniform block shared by all shaders of a view; layout of shaders/common/view.glsl."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.lighting import MAX_LIGHTS, Lighting
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shadows.cascades import MAX_CASCADES
from mimics_app.rendering.visual.shadows.shadow_maps import (
    MAX_SPOT_MAPS,
    ShadowMap,
    ShadowPlan,
    texture_from_world,
)
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Fog, FogKind

if TYPE_CHECKING:
    import moderngl

__all__ = ["VIEW_BLOCK", "ViewBlock"]


VIEW_BLOCK = np.dtype(
    [
        ("clip_from_eyes", "f4", (2, 4, 4)),
        ("sun_right", "f4", (4,)),
        ("sun_up", "f4", (4,)),
        ("sun_map", "f4", (MAX_CASCADES, 4)),
        ("spot_from_eye", "f4", (MAX_SPOT_MAPS, 4, 4)),
        ("spot_tile", "f4", (MAX_SPOT_MAPS, 4)),
        ("tangents", "f4", (4,)),
        ("axis_right", "f4", (4,)),
        ("axis_up", "f4", (4,)),
        ("axis_back", "f4", (4,)),
        ("sun_direction", "f4", (4,)),
        ("sun_colour", "f4", (4,)),
        ("sky_zenith", "f4", (4,)),
        ("sky_horizon", "f4", (4,)),
        ("sky_ground", "f4", (4,)),
        ("sky_light", "f4", (3, 4)),
        ("ambient", "f4", (4,)),
        ("shadow", "f4", (4,)),
        ("fog_colour", "f4", (4,)),
        ("fog_figures", "f4", (4,)),
        ("light_position", "f4", (MAX_LIGHTS, 4)),
        ("light_colour", "f4", (MAX_LIGHTS, 4)),
        ("light_direction", "f4", (MAX_LIGHTS, 4)),
        ("light_shadow", "f4", (MAX_LIGHTS, 4)),
        ("eye_places", "f4", (2, 4)),
    ]
)
"""std140: vec4 and mat4 only, so that it has no padding. Matrices are column-major."""

_BINDING = 0
_FILTER_MARGIN = 2.0
"""Texels along a map's edge that are not sampled, since the filter reaches over them."""
_FILTER_TURNS = 2.0
"""Turns of the filter's loop, see shaders/common/shadow.glsl."""
_OUTSIDE = 1e9
"""Place of a map that covers nothing [texel]."""
_FOG_KINDS: tuple[FogKind, ...] = ("squared", "exponential", "linear")
"""Kinds of fog in the order of their numbers in shaders/common/output.glsl."""


class ViewBlock:
    """The block of one view on the GPU.

    Attributes:
        settings: Quality of the current frame.
    """

    def __init__(self, ctx: moderngl.Context, settings: RenderSettings) -> None:
        self.settings = settings
        self._data = np.zeros((), VIEW_BLOCK)
        self._buffer = ctx.buffer(reserve=VIEW_BLOCK.itemsize)
        self._made_of: tuple[object, ...] = ()

    def fill(self, view: View, lighting: Lighting, plan: ShadowPlan, other: View, *, sun: bool, eye: int = -1) -> None:
        """Upload the uniforms of a view where any changed; positions are relative to the camera, made so in float64.

        Args:
            view: The view.
            lighting: Light of the frame.
            plan: The frame's shadow maps.
            other: The other eye where both are drawn in one pass, queued at the same origin; else `view` again.
            sun: False leaves the sun out.
            eye: Number of the eye that stereo shaders draw; -1: both.
        """
        made_of = (view.figures, other.figures, lighting.figures, plan.figures, self.settings, sun, eye)
        if made_of == self._made_of:
            return
        self._made_of = made_of
        data, origin = self._data, view.eye_world
        for number, each in enumerate((view, other)):
            data["clip_from_eyes"][number] = each.clip_from_eye.T
            data["eye_places"][number, :3] = each.world_from_eye[:3, 3] - origin
        data["eye_places"][0, 3] = eye
        data["tangents"] = view.tangents
        for axis, name in enumerate(("axis_right", "axis_up", "axis_back")):
            data[name][:3] = view.world_from_eye[:3, axis]
            data[name][3] = origin[axis]
        self._fill_sky(lighting)
        data["sun_direction"] = (*lighting.sun_direction, 0.0)
        data["sun_colour"] = (*(lighting.sun_colour if sun else np.zeros(3)), 0.0)
        self._fill_shadows(plan, origin)
        lighting.fill_places(data, origin)
        self._buffer.write(data.tobytes())

    def bind(self) -> None:
        """Bind the block for the shaders."""
        self._buffer.bind_to_uniform_block(_BINDING)

    def release(self) -> None:
        """Free the buffer."""
        self._buffer.release()

    def _fill_sky(self, lighting: Lighting) -> None:
        data, settings = self._data, self.settings
        data["sky_zenith"] = (*lighting.zenith, settings.exposure)
        data["sky_horizon"] = (*lighting.horizon, 0.0)
        data["sky_ground"] = (*lighting.ground, 1.0 if settings.tone_map == "neutral" else 0.0)
        data["sky_light"][:, :3] = lighting.sky_light()
        data["ambient"] = (*lighting.ambient, 0.0)
        fog = lighting.fog or Fog(density=settings.fog_density)
        data["fog_colour"] = (*(lighting.horizon if fog.colour is None else fog.colour), 0.0)
        data["fog_figures"] = (fog.density, fog.start, _FOG_KINDS.index(fog.kind), 0.0)

    def _fill_shadows(self, plan: ShadowPlan, eye: F8) -> None:
        data, settings = self._data, self.settings
        data["sun_map"][:] = (_OUTSIDE, _OUTSIDE, 0.0, 0.0)
        tile = settings.shadow_size / plan.grid
        for number, shadow in enumerate(plan.sun):
            clip = shadow.clip_from_world
            radius = 1.0 / float(np.linalg.norm(clip[0, :3]))
            scale = 0.5 * tile / radius
            from_eye = -radius * (clip[:2, :3] @ eye + clip[:2, 3])
            middle = tile * (np.array(shadow.tile) + 0.5)
            data["sun_map"][number] = (*(middle - scale * from_eye), scale, 0.0)
        if plan.sun:
            self._fill_sun(plan.sun[0], tile, eye)
        tone = settings.shadow_tone if settings.shadows == "texture_modulative" else 0.0
        data["shadow"] = (tone, 1.0 / max(settings.shadow_size, 1), _FILTER_TURNS, 0.0)
        self._fill_spots(plan, eye)

    def _fill_sun(self, shadow: ShadowMap, tile: float, eye: F8) -> None:
        """Write what all maps of the sun share: their axes and the scale of depth."""
        data, clip = self._data, shadow.clip_from_world
        axes = clip[:2, :3] / np.linalg.norm(clip[:2, :3], axis=1, keepdims=True)
        data["sun_right"] = (*axes[0], 0.5 * tile - _FILTER_MARGIN)
        data["sun_up"] = (*axes[1], tile)
        data["sun_direction"][3] = -0.5 * np.linalg.norm(clip[2, :3])
        data["sun_colour"][3] = 0.5 * (clip[2, :3] @ eye + clip[2, 3]) + 0.5

    def _fill_spots(self, plan: ShadowPlan, eye: F8) -> None:
        data, world_from_eye = self._data, np.eye(4)
        world_from_eye[:3, 3] = eye
        data["light_shadow"][:, 0] = -1.0
        for number, (light, shadow) in enumerate(plan.spots.items()):
            left, bottom, width = plan.tile_of(shadow)
            size = self.settings.shadow_size
            data["spot_from_eye"][number] = (texture_from_world(shadow) @ world_from_eye).T
            data["spot_tile"][number] = (left * size, bottom * size, width * size, shadow.texel)
            data["light_shadow"][light, 0] = number
