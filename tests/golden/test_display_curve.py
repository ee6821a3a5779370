"""Display values of linear light, as the shaders find them, against the formula of IEC 61966-2-1."""

from __future__ import annotations

import moderngl
import numpy as np

from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.materials.picture_arrays import encode_srgb
from mimics_app.rendering.visual.surfaces.contexts import create_surface

_TONE = root() / "shaders" / "common" / "tone.glsl"
_COUNT = 4096
_MOST = 0.015 / 255.0
"""The fits are off by 0.009 and 0.013 levels; float32 roots and sums add some millionths."""

_WHOLE = """
#version 430
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.5, 1.0); }
"""
_CURVE = """
#version 430
#include "common/tone.glsl"
out vec4 colour;
void main() {
    float light = 1.02 * pow((gl_FragCoord.x - 0.5) / 4095.0, 2.0) - 0.01;
    colour = vec4(light, encode_srgb(vec3(light)).r, decode_srgb(vec3(light)).r, 1.0);
}
"""


def test_the_curve_and_its_inverse_are_the_displays_within_a_hundredth_of_a_level():
    with create_surface("egl", (16, 16)) as surface:
        ctx = surface.ctx
        text = _CURVE.replace('#include "common/tone.glsl"', _TONE.read_text(encoding="utf-8"))
        target = ctx.framebuffer([ctx.texture((_COUNT, 1), 4, dtype="f4")])
        target.use()
        ctx.vertex_array(ctx.program(_WHOLE, text), []).render(moderngl.TRIANGLES, 3)
        light, shown, back = np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(-1, 4)[:, :3].T
    assert light.min() < 0.0 < 1.0 < light.max()
    np.testing.assert_allclose(shown, encode_srgb(light.astype(np.float64)), atol=_MOST)
    assert (np.diff(shown) >= 0.0).all() and (np.diff(back) >= 0.0).all()
    np.testing.assert_allclose(encode_srgb(back.astype(np.float64)), np.clip(light, 0.0, 1.0), atol=_MOST)
