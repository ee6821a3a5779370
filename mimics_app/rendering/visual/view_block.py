"""The uniform block every shader of a view shares; the layout of shaders/common/view.glsl."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.lighting import MAX_LIGHTS, Lighting
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shadows.shadow_maps import MAX_CASCADES, MAX_SPOT_MAPS, ShadowPlan, texture_from_world
from mimics_app.rendering.visual.view import View
from mimics_app.world.environment import Fog, FogKind

if TYPE_CHECKING:
    import moderngl

__all__ = ["VIEW_BLOCK", "ViewBlock"]

F8 = NDArray[np.float64]

VIEW_BLOCK = np.dtype(
    [
        ("clip_from_eye", "f4", (4, 4)),
        ("shadow_from_eye", "f4", (4, 4)),
        ("shadow_scale", "f4", (MAX_CASCADES, 4)),
        ("shadow_offset", "f4", (MAX_CASCADES, 4)),
        ("shadow_tile", "f4", (MAX_CASCADES, 4)),
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
        ("ambient", "f4", (4,)),
        ("shadow", "f4", (4,)),
        ("fog_colour", "f4", (4,)),
        ("fog_figures", "f4", (4,)),
        ("light_position", "f4", (MAX_LIGHTS, 4)),
        ("light_colour", "f4", (MAX_LIGHTS, 4)),
        ("light_direction", "f4", (MAX_LIGHTS, 4)),
        ("light_shadow", "f4", (MAX_LIGHTS, 4)),
    ]
)
"""std140: vec4 and mat4 only, so that it has no holes. Matrices are stored column after column."""

_BINDING = 0
_NOWHERE = 9.0
"""A place outside every map."""
_FOG_KINDS: tuple[FogKind, ...] = ("squared", "exponential", "linear")
"""In the order of their numbers in shaders/common/output.glsl."""


class ViewBlock:
    """The block of one view on the GPU.

    Attributes:
        settings: Quality of the frame that is drawn.
    """

    def __init__(self, ctx: moderngl.Context, settings: RenderSettings) -> None:
        self.settings = settings
        self._data = np.zeros((), VIEW_BLOCK)
        self._buffer = ctx.buffer(reserve=VIEW_BLOCK.itemsize)

    def fill(self, view: View, lighting: Lighting, plan: ShadowPlan, *, sun: bool = True) -> None:
        """Upload one view's numbers; everything world-sized is made eye-relative in float64 first.

        Args:
            view: Whose.
            lighting: What shines.
            plan: The frame's shadow maps.
            sun: False leaves the sun out.
        """
        data, eye = self._data, view.eye_world
        data["clip_from_eye"] = view.clip_from_eye.T
        data["tangents"] = view.tangents
        for axis, name in enumerate(("axis_right", "axis_up", "axis_back")):
            data[name][:3] = view.world_from_eye[:3, axis]
            data[name][3] = eye[axis]
        self._fill_sky(lighting)
        data["sun_direction"] = (*lighting.sun_direction, 0.0)
        data["sun_colour"] = (*(lighting.sun_colour if sun else np.zeros(3)), 0.0)
        self._fill_shadows(plan, eye)
        lighting.fill_places(data, eye)
        self._buffer.write(data.tobytes())

    def bind(self) -> None:
        """Make it the block the shaders read."""
        self._buffer.bind_to_uniform_block(_BINDING)

    def release(self) -> None:
        """Free the buffer."""
        self._buffer.release()

    def _fill_sky(self, lighting: Lighting) -> None:
        data, settings = self._data, self.settings
        data["sky_zenith"] = (*lighting.zenith, settings.exposure)
        data["sky_horizon"] = (*lighting.horizon, 0.0)
        data["sky_ground"] = (*lighting.ground, 1.0 if settings.tone_map == "neutral" else 0.0)
        data["ambient"] = (*lighting.ambient, lighting.place_count)
        fog = lighting.fog or Fog(density=settings.fog_density)
        data["fog_colour"] = (*(lighting.horizon if fog.colour is None else fog.colour), 0.0)
        data["fog_figures"] = (fog.density, fog.start, _FOG_KINDS.index(fog.kind), 0.0)

    def _fill_shadows(self, plan: ShadowPlan, eye: F8) -> None:
        data, settings = self._data, self.settings
        world_from_eye = np.eye(4)
        world_from_eye[:3, 3] = eye
        tone = settings.shadow_tone if settings.shadows == "texture_modulative" else 0.0
        texel = 1.0 / max(settings.shadow_size, 1)
        data["shadow"] = (texel, tone, 0.0, 0.0)
        data["shadow_tile"] = _NOWHERE
        for number, shadow in enumerate(plan.sun):
            first = texture_from_world(plan.sun[0]) @ world_from_eye
            own = texture_from_world(shadow) @ world_from_eye
            left, bottom, width = plan.tile_of(shadow)
            scale = np.linalg.norm(own[:3, :3], axis=1) / np.linalg.norm(first[:3, :3], axis=1)
            offset = own[:3, 3] - scale * first[:3, 3]
            # Half a texel along the normal: of one size across for all maps, of each one's own along the rays.
            data["shadow"][2] = 0.5 * shadow.texel * scale[0] * width
            depth, most = 0.5 * shadow.texel * scale[2], 0.5 * width - 2.0 * texel
            data["shadow_from_eye"] = first.T
            data["shadow_scale"][number] = (scale[0] * width, scale[2], depth, most)
            data["shadow_offset"][number, :3] = (left + width * offset[0], bottom + width * offset[1], offset[2])
            data["shadow_tile"][number, :2] = (left + 0.5 * width, bottom + 0.5 * width)
        data["light_shadow"][:, 0] = -1.0
        for number, (light, shadow) in enumerate(plan.spots.items()):
            data["spot_from_eye"][number] = (texture_from_world(shadow) @ world_from_eye).T
            data["spot_tile"][number] = (*plan.tile_of(shadow), shadow.texel)
            data["light_shadow"][light, 0] = number
