"""The uniform block every shader of a view shares; the layout of shaders/common/view.glsl."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.lighting import MAX_LIGHTS, Lighting
from mimics_app.rendering.visual.settings import RenderSettings
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
    ]
)
"""std140: vec4 and mat4 only, so that it has no holes. Matrices are stored column after column."""

_BINDING = 0
_FOG_KINDS: tuple[FogKind, ...] = ("squared", "exponential", "linear")
"""In the order of their numbers in shaders/common/output.glsl."""


class ViewBlock:
    """The block of one view on the GPU."""

    def __init__(self, ctx: moderngl.Context, settings: RenderSettings) -> None:
        self._settings = settings
        self._data = np.zeros((), VIEW_BLOCK)
        self._buffer = ctx.buffer(reserve=VIEW_BLOCK.itemsize)

    def fill(self, view: View, lighting: Lighting) -> None:
        """Upload one view's numbers; everything world-sized is made eye-relative in float64 first."""
        data, eye = self._data, view.eye_world
        data["clip_from_eye"] = view.clip_from_eye.T
        data["tangents"] = view.tangents
        for axis, name in enumerate(("axis_right", "axis_up", "axis_back")):
            data[name][:3] = view.world_from_eye[:3, axis]
            data[name][3] = eye[axis]
        self._fill_sky(lighting)
        self._fill_sun(lighting, eye)
        lighting.fill_places(data, eye)
        self._buffer.write(data.tobytes())

    def bind(self) -> None:
        """Make it the block the shaders read."""
        self._buffer.bind_to_uniform_block(_BINDING)

    def release(self) -> None:
        """Free the buffer."""
        self._buffer.release()

    def _fill_sky(self, lighting: Lighting) -> None:
        data, settings = self._data, self._settings
        data["sky_zenith"] = (*lighting.zenith, settings.exposure)
        data["sky_horizon"] = (*lighting.horizon, 0.0)
        data["sky_ground"] = (*lighting.ground, 1.0 if settings.tone_map == "neutral" else 0.0)
        data["ambient"] = (*lighting.ambient, lighting.place_count)
        fog = lighting.fog or Fog(density=settings.fog_density)
        data["fog_colour"] = (*(lighting.horizon if fog.colour is None else fog.colour), 0.0)
        data["fog_figures"] = (fog.density, fog.start, _FOG_KINDS.index(fog.kind), 0.0)

    def _fill_sun(self, lighting: Lighting, eye: F8) -> None:
        data, frustum = self._data, lighting.shadow
        data["sun_direction"] = (*lighting.sun_direction, 1.0 if frustum else 0.0)
        data["sun_colour"] = (*lighting.sun_colour, 0.0)
        if frustum is None:
            return
        world_from_eye = np.eye(4)
        world_from_eye[:3, 3] = eye
        data["shadow_from_eye"] = (frustum.texture_from_world @ world_from_eye).T
        data["shadow"] = (1.0 / frustum.size, frustum.texel, 0.0, 0.0)
