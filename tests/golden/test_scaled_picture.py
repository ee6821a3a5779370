"""A picture drawn smaller and enlarged: the world is softer, the figures over it stay as sharp as ever."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.quality_steps import quality_steps, rehearse_steps
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from tests.golden.demo_world import make_tunnel_world
from tests.golden.drawing import SIZE, Picture, draw_offscreen, draw_world, lay_out


def _enlarge(small: Picture, size: tuple[int, int]) -> np.ndarray:
    """Bilinear enlargement with pixel centres at the halves, edges held: what a texture unit does."""
    height, width = small.shape[:2]
    x = np.clip((np.arange(size[0]) + 0.5) * width / size[0] - 0.5, 0, width - 1)
    y = np.clip((np.arange(size[1]) + 0.5) * height / size[1] - 0.5, 0, height - 1)
    left, low = np.floor(x).astype(int), np.floor(y).astype(int)
    right, high = np.minimum(left + 1, width - 1), np.minimum(low + 1, height - 1)
    fx, fy = (x - left)[None, :, None], (y - low)[:, None, None]
    values = small[..., :3].astype(float)
    top = values[low][:, left] * (1 - fx) + values[low][:, right] * fx
    bottom = values[high][:, left] * (1 - fx) + values[high][:, right] * fx
    return top * (1 - fy) + bottom * fy


@pytest.mark.parametrize("msaa", [0, 4])
def test_half_scale_is_the_small_picture_enlarged(msaa: int, assert_same):
    world = make_tunnel_world()
    camera = world.cameras[0]
    ours = draw_offscreen(world, desktop_views(camera, SIZE), settings=RenderSettings(msaa=msaa, scale=0.5))
    small = (SIZE[0] // 2, SIZE[1] // 2)  # 135 is odd: half of 270 is drawn exactly
    reference = draw_offscreen(world, desktop_views(camera, small), small, RenderSettings(msaa=msaa))
    enlarged = np.clip(np.round(_enlarge(reference, SIZE)), 0, 255).astype(np.uint8)
    assert_same(ours, enlarged, f"half scale, {msaa} samples", level=3)


def test_figures_stay_sharp_over_a_soft_world():
    """The difference that the display makes is the same to the last pixel where it hides what is behind it."""
    world = make_tunnel_world()
    pictures = {}
    for scale in (1.0, 0.5):
        for hud in (False, True):
            with create_surface("egl", SIZE) as surface:
                settings = RenderSettings(msaa=0, scale=scale)
                views = desktop_views(world.cameras[0], surface.size)
                pictures[scale, hud] = draw_world(surface, world, views, settings, hud=hud)[..., :3].astype(int)
    figures = np.abs(pictures[1.0, True] - pictures[1.0, False]).max(axis=-1)
    solid = figures > 60
    assert solid.sum() > 150, "figures are to be seen"
    away = np.abs(pictures[1.0, True] - pictures[0.5, True]).max(axis=-1)
    assert np.percentile(away[solid], 95) <= 20, "what is behind shines through a little"
    drawn_smaller = _enlarge(pictures[1.0, True][::2, ::2].astype(np.uint8), SIZE)
    lost = np.abs(drawn_smaller - pictures[1.0, True]).max(axis=-1)
    assert np.percentile(lost[solid], 95) > 60, "a display drawn smaller would fail this test"


def test_quality_changes_while_running_and_comes_back():
    world = make_tunnel_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=0, shadow_size=512))
        lay_out(renderer.hud, surface.size)
        views = desktop_views(world.cameras[0], surface.size)

        def draw() -> Picture:
            renderer.draw(views)
            assert surface.ctx.error == "GL_NO_ERROR"
            return read_pixels(surface)

        full = draw()
        steps = {step.name: step for step in quality_steps(renderer)}
        assert [step.order for step in steps.values()] == sorted(step.order for step in steps.values())
        for step in steps.values():
            for level in range(1, len(step.levels)):
                step.apply(level)
                assert not np.array_equal(draw(), full), f"{step.name} {step.levels[level]} shows"
        assert (renderer.settings.shadow_size, renderer.settings.scale) == (0, 0.5)
        for step in reversed(steps.values()):
            step.apply(0)
        assert np.array_equal(draw(), full)
        surface.resize((320, 180))
        renderer.set_quality(scale=0.75)
        views = desktop_views(world.cameras[0], surface.size)
        assert draw().shape == (180, 320, 4)
        renderer.release()
        assert surface.ctx.error == "GL_NO_ERROR"


def test_steps_that_were_rehearsed_compile_nothing_in_a_session():
    world = make_tunnel_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=4, shadow_size=512))
        views, before = desktop_views(world.cameras[0], surface.size), renderer.settings
        renderer.draw(views)
        programs = renderer._shaders._programs
        least = len(programs)
        rehearse_steps(renderer, views)
        known = len(programs)
        assert renderer.settings == before and known > least
        for step in quality_steps(renderer):
            for level in range(1, len(step.levels)):
                step.apply(level)
                renderer.draw(views)
        assert len(programs) == known
        renderer.release()


def test_a_plain_picture_without_shadows_has_only_its_sharpness_to_give():
    with create_surface("egl", (64, 64)) as surface:
        renderer = Renderer(surface, make_tunnel_world(), RenderSettings(msaa=0, shadow_size=0, shading="plain"))
        assert [step.name for step in quality_steps(renderer)] == ["resolution scale"]
        renderer.release()


def test_two_views_keep_their_places_at_odd_sizes():
    """A surface of 161 px in two halves of 81 and 80 at 0.75: no gap and no overlap between them."""
    world = make_tunnel_world()
    camera = world.cameras[0]
    tangents = desktop_views(camera, (81, 90))[0].tangents
    with create_surface("egl", (161, 90)) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=0, scale=0.75))
        pose = desktop_views(camera, (81, 90))[0].world_from_eye
        views = [View(pose, tangents, (0, 0, 81, 90)), View(pose, tangents, (81, 0, 80, 90), screen=1)]
        renderer.draw(views)
        picture = read_pixels(surface)[..., :3].astype(int)
        renderer.release()
    assert np.abs(picture[:, 82:] - picture[:, 1:80]).mean() < 8.0, "both show the same"
    assert (picture.max(axis=-1) > 0).all(), "no pixel is left out"


@pytest.mark.parametrize("scale", [0.0, 0.2, 1.5])
def test_impossible_scales_are_refused(scale: float):
    with pytest.raises(UsageError, match="resolution scale"):
        RenderSettings(scale=scale)
