"""Draws cords: one static index buffer, a uniform block per cord, the geometry in the vertex shader."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, U4
from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.rendering.visual.passes.eye_passes import EyePass
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.cords import MAX_TAPS, Cord

if TYPE_CHECKING:
    import moderngl

__all__ = ["CORD_BLOCK", "CordPass", "fill_cord_block"]


CORD_BLOCK = np.dtype(
    [
        ("start", "f4", (4,)),
        ("along", "f4", (4,)),
        ("up", "f4", (4,)),
        ("form", "f4", (4,)),
        ("waves", "f4", (4,)),
        ("colour_roughness", "f4", (4,)),
        ("ball", "f4", (4,)),
        ("ball_light", "f4", (4,)),
        ("tap", "f4", (MAX_TAPS, 4)),
    ]
)
"""std140, the layout of shaders/cord/cord.vert."""

_BINDING = 7
RINGS, SIDES = 128, 24
"""Vertices along and facets around: 3,200 vertices. The drawn polyline is at most 2e-5 shorter (chart "cord")."""
_SOFTNESS = 0.25
"""Radius of the shadow's penumbra over the gap below the ball, as under a window's light."""


class CordPass:
    """Draws all cords of a view.

    Args:
        ctx: Context of the pass.
        shaders: Shader library.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx, self._shaders = ctx, shaders
        self._data = np.zeros((), CORD_BLOCK)
        self._block: moderngl.Buffer | None = None
        self._indices: moderngl.Buffer | None = None
        self._arrays = VertexArrays(self._vertex_array)

    def draw(
        self,
        cords: Mapping[str, Cord],
        view: View,
        lighting: Lighting,
        lights: frozenset[str],
        time_s: float,
        eyes: EyePass,
    ) -> int:
        """Draw into the framebuffer in use with depth test and write; the view's block is bound.

        Args:
            cords: Cords of the world.
            view: The view.
            lighting: Light of the frame.
            lights: Shader features that the frame's light needs.
            time_s: Time of the world, for the ripples [s].
            eyes: Eyes to draw.

        Returns:
            Draw calls made.
        """
        import moderngl

        shown = [cord for cord in cords.values() if cord.visible]
        if not shown:
            return 0
        shader = self._shaders.program("cord/cord.vert", "cord/cord.frag", (*sorted(lights), *eyes.defines))
        array = self._arrays.of(shader)
        self._ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._ctx.front_face = "ccw"
        self._ctx.cull_face = "back"
        self._block = self._block or self._ctx.buffer(reserve=CORD_BLOCK.itemsize)
        self._block.bind_to_uniform_block(_BINDING)
        for cord in shown:
            fill_cord_block(self._data, cord, view.eye_world, lighting.sun_direction, time_s)
            self._block.orphan()
            self._block.write(self._data.tobytes())
            array.render(moderngl.TRIANGLES, instances=eyes.instances)
        return len(shown)

    def release(self) -> None:
        """Free everything."""
        self._arrays.release()
        for part in (self._indices, self._block):
            if part is not None:
                part.release()
        self._indices = self._block = None

    def _vertex_array(self, shader: ShaderProgram) -> moderngl.VertexArray:
        self._indices = self._indices or self._ctx.buffer(grid_indices(RINGS, SIDES).tobytes())
        return self._ctx.vertex_array(shader.program, [], self._indices, index_element_size=4)


def fill_cord_block(data: NDArray[np.void], cord: Cord, eye: F8, sun: F8, time_s: float) -> None:
    """Write one cord's uniforms; positions are made relative to the camera in float64.

    Args:
        data: A CORD_BLOCK.
        cord: The cord.
        eye: Position of the camera, world [m], float64 [3].
        sun: Unit vector towards the light that casts the ball's shadow, float64 [3].
        time_s: Time of the world [s].
    """
    curve, waves, radius = cord.curve, cord.waves, cord.shown_radius
    ripples = cord.ripples(time_s)
    data["start"] = (*(curve.start - eye), curve.length)
    data["along"] = (*curve.along, curve.a)
    data["up"] = (*curve.up, curve.q)
    data["form"] = (radius, RINGS, SIDES, len(ripples))
    data["waves"] = (waves.speed, 2.0 * math.pi / waves.wavelength, waves.width**-2, waves.along)
    data["colour_roughness"] = (*cord.colour, cord.roughness)
    data["ball"] = (*(cord.ball[:3] - eye), cord.ball[3])
    data["ball_light"] = (*sun, _SOFTNESS)
    for number, ripple in enumerate(ripples):
        height = ripple.height * math.exp(-waves.over_time * ripple.age)
        data["tap"][number] = (ripple.s, ripple.theta, ripple.age, height)


def grid_indices(rings: int, sides: int) -> U4:
    """Return the triangles of a tube of `rings` by `sides` + 1 vertices, counter-clockwise from outside."""
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    corner = (i * (sides + 1) + j).ravel()
    quads = np.stack(
        [corner, corner + 1, corner + sides + 1, corner + 1, corner + sides + 2, corner + sides + 1], axis=1
    )
    return quads.astype(np.uint32)
