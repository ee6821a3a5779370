"""What is done to a finished picture: anti-aliasing, bloom; both off unless requested, and kept inside each view."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.bloom import BloomPass
from mimics_app.rendering.visual.quality_steps import quality_steps
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import plane, sphere
from mimics_app.world.content.world import World
from tests.golden.demo_world import make_tunnel_world
from tests.golden.drawing import draw_world, lay_out
from tests.golden.material_world import make_room

SIZE = (192, 108)
PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0)
FAINT = 1e-9
"""A bloom that takes the way through half floats and adds nothing that could be seen."""
F8 = NDArray[np.float64]


def draw(world: World, settings: RenderSettings, views: list[View] | None = None, backend: str = "egl") -> F8:
    """RGB of the picture, 0-255."""
    with create_surface(backend, SIZE) as surface:
        picture = draw_world(surface, world, views or desktop_views(world.cameras[0], SIZE), settings)
    return picture[..., :3].astype(float)


def make_card(angle: float = 0.0, light: float = 0.7, ground: float = 0.05) -> World:
    """A large card of one colour whose edge runs through the middle of the picture at an angle, before one colour."""
    world = World()
    world.environment = Sky((ground,) * 3, (ground,) * 3, (ground,) * 3, 0.0)
    world.set_material(Material("card", "unlit", (light, light, light, 1.0), double_sided=True))
    world.meshes["card"] = plane(40.0, 40.0)
    # The sheet's edge along the line at this angle through the origin, the sheet to its left; it faces the eye on +z.
    node = world.root.create_child("turn", orientation=(0.0, 0.0, np.sin(0.5 * angle), np.cos(0.5 * angle)))
    upright = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    node.create_child("card", (0.0, 20.0, 0.0), upright).create_entity("card", "card")
    world.update()
    return world


def card_view(size: tuple[int, int] = SIZE) -> View:
    """One metre is the width of the picture."""
    side = 0.5
    return View(
        np.array(compose_look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))),
        (-side, side, -side * size[1] / size[0], side * size[1] / size[0]),
        (0, 0, *size),
    )


def coverage(angle: float) -> F8:
    """Share of each pixel, row 0 at the top, that the card covers: exact to 1/64 by 64 points each way."""
    width, height = SIZE
    at = (np.arange(64) + 0.5) / 64
    x = (np.arange(width)[:, None] + at).ravel() / width - 0.5
    y = (0.5 * height - (np.arange(height)[:, None] + at).ravel()) / width
    inside = y[:, None] * np.cos(angle) - x * np.sin(angle) > 0.0
    return inside.reshape(height, 64, width, 64).mean(axis=(1, 3))


def edge_error(angle: float, settings: RenderSettings) -> float:
    """Root mean square of covered minus shown, in shares of a pixel, over the pixels that the edge cuts."""
    picture = draw(make_card(angle), settings, [card_view()])[..., 0]
    shown = (picture - picture.min()) / np.ptp(picture)
    wanted = coverage(angle)
    cut = (wanted > 0.0) & (wanted < 1.0)
    return float(np.sqrt(np.mean((shown - wanted)[cut] ** 2)))


@pytest.mark.parametrize("angle", [0.05, 0.3, 1.52])
def test_the_filter_halves_the_error_of_edges(angle):
    """Without it a cut pixel is all or nothing: coverage spread evenly gives sqrt(1/12) = 0.289, less where aslant."""
    bare, filtered = edge_error(angle, PLAIN), edge_error(angle, replace(PLAIN, fxaa=True))
    assert 0.24 < bare < 0.30
    assert filtered < 0.6 * bare


def test_the_filter_leaves_alone_what_has_no_steps():
    """An edge between two rows of pixels, and one colour, stay what they are to the last bit."""
    for angle in (0.0, np.pi):
        assert np.array_equal(
            draw(make_card(angle), PLAIN, [card_view()]),
            draw(make_card(angle), replace(PLAIN, fxaa=True), [card_view()]),
        )


@pytest.mark.parametrize(
    "settings", [PLAIN, replace(PLAIN, msaa=4), replace(PLAIN, scale=0.5), replace(PLAIN, tone_map="none")]
)
def test_the_way_through_half_floats_changes_nothing(settings):
    """Tone map undone and done again: 1/255 where one thing is drawn, 2/255 where glass was mixed in 8 bits twice."""
    world = make_room()
    ours, theirs = (draw(world, replace(settings, bloom=bloom)) for bloom in (FAINT, 0.0))
    assert np.abs(ours - theirs).max() <= 2.0
    assert (np.abs(ours - theirs) > 1.0).any(axis=-1).mean() < 2e-3


def test_bloom_of_one_colour_is_that_colour():
    picture = draw(
        make_card(),
        replace(PLAIN, bloom=0.5),
        [View(card_view().world_from_eye, (-0.1, 0.1, 0.01, 0.1), (0, 0, *SIZE))],
    )
    assert np.ptp(picture) == 0.0
    assert np.array_equal(
        picture, draw(make_card(), PLAIN, [View(card_view().world_from_eye, (-0.1, 0.1, 0.01, 0.1), (0, 0, *SIZE))])
    )


def make_lamp(strength: float) -> World:
    """A small lamp in the dark."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("lamp", "unlit", (strength, strength, strength, 1.0)))
    world.meshes["lamp"] = sphere(0.03, 32)
    world.root.create_child("lamp").create_entity("lamp", "lamp")
    world.update()
    return world


def test_a_square_is_spread_round_about_and_no_light_is_lost():
    """Light in the copies is that of the square: 1 % for half floats, and for what comes back at the border."""
    with create_surface("egl", (256, 256)) as surface:
        bloom = BloomPass(surface.ctx, ShaderLibrary(surface.ctx), RenderSettings(bloom=0.5, tone_map="none"))
        pixels = np.zeros((256, 256, 4), np.float16)
        pixels[120:136, 120:136] = 1.0
        square = surface.ctx.texture((256, 256), 4, pixels.tobytes(), dtype="f2")
        whole = [(0, 0, 256, 256)]
        bloom.draw(square, surface.framebuffer, whole, whole)
        shown = linear(read_pixels(surface)[..., 0].astype(float))
        bloom.settings = replace(bloom.settings, bloom=1.0)
        target = surface.ctx.framebuffer([surface.ctx.texture((256, 256), 4, dtype="f4")])
        bloom.draw(square, target, whole, whole)
        light = linear(255.0 * np.frombuffer(target.read(components=1, dtype="f4"), np.float32).astype(float))
        bloom.release()
    assert light.sum() == pytest.approx(256.0, rel=0.01)
    light = light.reshape(256, 256)
    assert np.abs(light - light[:, ::-1]).max() < 1e-3
    assert (np.diff(light[128, 128:]) < 0.0).all(), "falls off to the border"
    # Half of each pixel's own light stays where it was.
    assert shown[128, 128] == pytest.approx(0.5 + 0.5 * light[128, 128], abs=0.01)


def test_what_dazzles_spreads_farther_than_what_is_white():
    far = [
        draw(make_lamp(strength), replace(PLAIN, bloom=0.1), [card_view()])[54, 96 + 14, 0] for strength in (1.0, 20.0)
    ]
    assert far[1] > far[0] + 12.0


def linear(display: F8) -> F8:
    """Light of display values 0-255 (IEC 61966-2-1)."""
    share = display / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_views_beside_each_other_do_not_mix(scale):
    """Each half is what it is alone, to the last bit: a bright view beside a dark one."""
    settings = replace(PLAIN, fxaa=True, bloom=0.3, scale=scale)
    half = (SIZE[0] // 2, SIZE[1])
    world = make_lamp(20.0)
    eyes = [np.array(compose_look_at((x, 0.0, 0.3), (x, 0.0, 0.0))) for x in (0.12, -0.1)]
    views = [
        View(eye, (-0.5, 0.5, -0.5, 0.5), (place * half[0], 0, *half), screen=place) for place, eye in enumerate(eyes)
    ]
    both = draw(world, settings, views)
    for place, eye in enumerate(eyes):
        with create_surface("egl", half) as surface:
            alone = draw_world(surface, world, [View(eye, (-0.5, 0.5, -0.5, 0.5), (0, 0, *half))], settings)[..., :3]
        assert np.array_equal(both[:, place * half[0] : (place + 1) * half[0]], alone)
        assert np.ptp(alone) > 100


def test_what_no_view_covers_is_black_and_not_an_older_frame():
    world = make_room()
    whole = desktop_views(world.cameras[0], SIZE)[0]
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, replace(PLAIN, fxaa=True))
        renderer.draw([whole])
        renderer.draw([replace(whole, rectangle=(0, 0, 96, 108))])
        picture = read_pixels(surface)
        renderer.release()
    assert picture[:, :96, :3].max() > 100
    assert picture[:, 96:, :3].max() == 0


def test_effects_are_the_same_under_osmesa():
    try:
        create_surface("osmesa", (8, 8)).close()
    except DeviceError as error:
        pytest.skip(str(error))
    settings = RenderSettings(msaa=4, shadow_size=256, bloom=0.2, fxaa=True)
    here, there = (draw(make_room(), settings, backend=backend) for backend in ("egl", "osmesa"))
    assert (np.abs(here - there) <= 1.0).mean() > 0.999


def test_effects_are_given_up_before_sharpness_and_come_back():
    world = make_tunnel_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=4, fxaa=True, bloom=0.2, shadow_size=64))
        lay_out(renderer.hud, surface.size)
        views = desktop_views(world.cameras[0], surface.size)
        renderer.draw(views)
        full = surface.framebuffer.read()
        steps = quality_steps(renderer)
        names = [step.name for step in steps]
        assert names == ["bloom", "shadow size", "anti-aliasing", "resolution scale", "shadows", "shading"]
        for step in steps:
            for level in range(1, len(step.levels)):
                before = surface.framebuffer.read()
                step.apply(level)
                renderer.draw(views)
                assert surface.ctx.error == "GL_NO_ERROR"
                assert surface.framebuffer.read() != before, (step.name, level)
        assert (renderer.settings.msaa, renderer.settings.fxaa, renderer.settings.bloom) == (0, False, 0.0)
        for step in reversed(steps):
            step.apply(0)
        renderer.draw(views)
        assert surface.framebuffer.read() == full
        renderer.release()
        assert surface.ctx.error == "GL_NO_ERROR"


def test_a_bloom_that_cannot_be_is_refused():
    with pytest.raises(UsageError):
        RenderSettings(bloom=1.5)
