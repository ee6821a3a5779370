"""Fences: what was drawn before one is there once it was waited for."""

from __future__ import annotations

from mimics_app.rendering.visual.software.batched_feed import Fence
from mimics_app.rendering.visual.surfaces.contexts import create_surface


def test_a_fence_is_waited_for_again_and_again():
    with create_surface("egl", (64, 64)) as surface:
        fence = Fence(surface.ctx)
        fence.wait()
        for level in (0.0, 1.0):
            surface.framebuffer.use()
            surface.framebuffer.clear(level)
            fence.set()
            fence.wait()
            assert surface.framebuffer.read(components=1)[0] == round(255 * level)
        fence.release()
        fence.wait()
        assert surface.ctx.error == "GL_NO_ERROR"
