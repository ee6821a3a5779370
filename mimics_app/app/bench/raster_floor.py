"""Lower bound of the frame time: the driver's time for filling the pixels alone."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.rendering.visual.surfaces.headless import open_offscreen

if TYPE_CHECKING:
    import moderngl

__all__ = ["measure_floor"]

_FRAMES, _WARM_UP = 15, 3

_TRIANGLE = """
#version 430
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.5, 1.0); }
"""
_ONE_COLOUR = """
#version 430
out vec4 colour;
void main() { colour = vec4(0.2, 0.4, 0.6, 1.0); }
"""
_LIT = """
#version 430
out vec4 colour;
void main() {
    // A light and the sRGB curve: the minimum of a lit pixel.
    vec3 n = normalize(vec3(gl_FragCoord.xy - 300.0, 400.0));
    vec3 light = vec3(0.3, 0.5, 0.2) * (0.4 + 0.8 * max(dot(n, vec3(0.36, 0.91, 0.27)), 0.0));
    colour = vec4(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 1.0);
}
"""


def measure_floor(size: tuple[int, int]) -> dict[str, float]:
    """Measure median times of one triangle over all pixels [ms], by shading and samples.

    Args:
        size: Size of the picture [px].
    """
    with open_offscreen("egl", size) as surface:
        ctx = surface.ctx
        one, lit = (ctx.program(_TRIANGLE, shader) for shader in (_ONE_COLOUR, _LIT))
        plain = ctx.framebuffer(ctx.renderbuffer(size), ctx.depth_renderbuffer(size))
        smooth = ctx.framebuffer(ctx.renderbuffer(size, samples=4), ctx.depth_renderbuffer(size, samples=4))
        floor = {
            "one colour": _time(ctx, one, plain),
            "lit": _time(ctx, lit, plain),
            "one colour, 4 samples": _time(ctx, one, smooth, plain),
            "lit, 4 samples": _time(ctx, lit, smooth, plain),
        }
        for part in (plain, smooth, one, lit):
            part.release()
    return floor


def _time(
    ctx: moderngl.Context,
    program: moderngl.Program,
    target: moderngl.Framebuffer,
    shown: moderngl.Framebuffer | None = None,
) -> float:
    """Return the median time of clearing a target, filling it and resolving it to `shown` if given [ms]."""
    clock, array, times = MonotonicClock(), ctx.vertex_array(program, []), []
    for _ in range(_WARM_UP + _FRAMES):
        started = clock.now_ns()
        target.use()
        target.clear(depth=1.0)
        ctx.enable_only(ctx.DEPTH_TEST)
        array.render(ctx.TRIANGLES, 3)
        if shown is not None:
            ctx.copy_framebuffer(shown, target)
        ctx.finish()
        times.append((clock.now_ns() - started) * 1e-6)
    array.release()
    return median(times[_WARM_UP:])
