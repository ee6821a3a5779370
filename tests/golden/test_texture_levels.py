"""Levels of textures: the driver's own, texel by texel, and nothing else changes."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.texture_levels import TextureLevels
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8

_SHOW = """
#version 430
layout(binding = 0) uniform SAMPLER picture;
uniform float level;
out vec4 colour;
void main() {
    ivec2 size = textureSize(picture, int(level)).xy;
    ivec2 at = min(ivec2(gl_FragCoord.xy), size - 1);
    colour = texelFetch(picture, PLACE, int(level));
}
"""
_COVER = """
#version 430
void main() {
    gl_Position = vec4(vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0), 0.0, 1.0);
}
"""


def _levels(ctx: moderngl.Context, texture: moderngl.Texture | moderngl.TextureArray, count: int) -> list[bytes]:
    """Return what a sampler sees in each level of the last layer, as float32."""
    layered = isinstance(texture, moderngl.TextureArray)
    place = f"ivec3(at, {texture.layers - 1})" if layered else "at"
    source = _SHOW.replace("SAMPLER", "sampler2DArray" if layered else "sampler2D").replace("PLACE", place)
    program = ctx.program(_COVER, source)
    target = ctx.framebuffer([ctx.texture(texture.size[:2], 4, dtype="f4")])
    target.use()
    texture.use(0)
    ctx.enable_only(moderngl.NOTHING)
    found = []
    for level in range(count):
        program["level"].value = float(level)  # type: ignore[union-attr]
        ctx.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
        found.append(target.read(components=4, dtype="f4"))
    return found


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize("layers", [0, 3])
def test_levels_are_those_of_the_driver(srgb: bool, layers: int) -> None:
    if srgb and layers:
        pytest.skip("texture arrays hold display values that no sampler decodes")
    size, random = (64, 32), np.random.default_rng(3)
    pixels = random.integers(0, 256, (max(1, layers), size[1], size[0], 4), np.uint8)
    with open_offscreen("egl", (64, 36)) as surface:
        ctx = surface.ctx
        inner = SRGB8_ALPHA8 if srgb else None
        ours, theirs = (
            ctx.texture_array((*size, layers), 4, pixels.tobytes())
            if layers
            else ctx.texture(size, 4, pixels.tobytes(), internal_format=inner)
            for _ in range(2)
        )
        TextureLevels(ctx, ShaderLibrary(ctx)).make(ours, srgb=srgb)
        theirs.build_mipmaps()
        ours.filter = theirs.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        assert _levels(ctx, ours, 7) == _levels(ctx, theirs, 7)


def test_drawing_goes_on_as_before() -> None:
    """Levels are made in the middle of a frame: target, viewport, scissor and blending stay."""
    with open_offscreen("egl", (64, 36)) as surface:
        ctx = surface.ctx
        surface.framebuffer.use()
        surface.framebuffer.clear(0.0, 0.0, 0.0, 1.0)
        surface.framebuffer.scissor = (8, 0, 16, 36)
        ctx.enable_only(moderngl.BLEND)
        ctx.blend_func = moderngl.ONE, moderngl.ONE
        program = ctx.program(_COVER, "#version 430\nout vec4 c; void main() { c = vec4(0.25); }")
        TextureLevels(ctx, ShaderLibrary(ctx)).make(ctx.texture((8, 8), 4, bytes(256)), srgb=True)
        for _ in range(2):
            ctx.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
        surface.framebuffer.scissor = None  # type: ignore[assignment]
        seen = np.frombuffer(surface.framebuffer.read(components=1), np.uint8).reshape(36, 64)
        assert set(seen[:, 8:24].ravel().tolist()) == {128} and not seen[:, :8].any() and not seen[:, 24:].any()
