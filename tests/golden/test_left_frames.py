"""Frames that are finished when the next one is prepared: the same pixels as finished at once, each shown once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.fence import Fence
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.components.pictures import Inset
from mimics_app.world.world import World
from tests.golden.test_still_picture import SIZE, make_world, view

PLAIN = RenderSettings(msaa=0, shadow_size=256)
FRAMES = 14


def move(world: World, step: int) -> None:
    """Move the ball, from frame 8 on two boxes, too."""
    world.find("ball").set_position((0.05 * step, 0.9, 0.3))
    if step >= 8:
        world.find("box2").set_position((0.9, 0.02 * step, -0.9))
        world.find("box6").visible = step % 2 == 0
    world.update()


def draw_all(settings: RenderSettings, *, left: bool, changes: dict[int, Callable[[Renderer], object]]) -> list:
    """Draw frames with a board that counts them, left to the next one or not; return each picture as it is shown."""
    world, pictures = make_world(), []
    world.root.create_child("eye", (0.0, 0.6, 2.0)).create_camera(0.7)
    world.update()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, settings)
        for step in range(FRAMES):
            move(world, step)
            changes.get(step, lambda _: None)(renderer)

            def lay_out(step: int = step) -> None:
                renderer.hud.clear()
                renderer.hud.text(20.0, 60.0, f"frame {step}", 40.0)

            show = lambda begun_ns, drawn_ns: pictures.append(read_pixels(surface))  # noqa: E731  a name of its own says no more
            renderer.draw([view(0.1 if step > 11 else 0.0)], None, lay_out, show if left else None)
            if not left:
                show(0, 0)
        renderer.finish()
        assert surface.ctx.error == "GL_NO_ERROR"
        renderer.release()
    return pictures


@pytest.mark.parametrize(
    "settings",
    [PLAIN, replace(PLAIN, fxaa=True), replace(PLAIN, scale=0.5), replace(PLAIN, msaa=4), replace(PLAIN, bloom=0.4)],
    ids=["plain", "filtered", "small", "sampled", "bloom"],
)
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {6: lambda renderer: renderer.set_quality(scale=0.75), 10: lambda renderer: renderer.set_quality(scale=1.0)},
        {5: lambda renderer: renderer.overlay.toggle("bounds")},
        {4: lambda renderer: renderer.world.insets.update(eye=Inset("eye", (0.7, 0.7, 0.25, 0.25)))},
    ],
    ids=["at rest", "another quality", "overlay", "inset"],
)
def test_a_frame_that_is_left_is_shown_with_the_same_pixels(settings, changes):
    at_once = draw_all(settings, left=False, changes=changes)
    left = draw_all(settings, left=True, changes=changes)
    assert len(left) == len(at_once) == FRAMES
    assert all(np.array_equal(*pair) for pair in zip(at_once, left, strict=True))
    assert not np.array_equal(left[-1], left[0])


def test_a_frame_that_was_left_for_another_size_is_dropped():
    world, shown = make_world(), []
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, replace(PLAIN, fxaa=True))
        for step in range(6):
            move(world, step)
            if step == 4:
                surface.resize((SIZE[0] // 2, SIZE[1] // 2))
            seen = replace(view(), rectangle=(0, 0, *surface.size))
            renderer.draw([seen], None, None, lambda begun_ns, drawn_ns, step=step: shown.append(step))
        renderer.finish()
        ours = read_pixels(surface)
        fresh = Renderer(surface, world, renderer.settings)
        fresh.draw([seen])
        assert np.array_equal(read_pixels(surface), ours)
        assert surface.ctx.error == "GL_NO_ERROR"
    assert shown == [0, 1, 2, 4, 5]


def test_a_fence_is_reached_when_the_driver_has_drawn():
    with create_surface("egl", (512, 512)) as surface:
        fence = Fence(surface.ctx)
        assert fence.reached(), "never set"
        surface.framebuffer.clear(1.0)
        fence.set()
        fence.wait()
        assert fence.reached()
        fence.release()
        assert fence.reached()
