"""Billboards and particles in the picture: how they turn, how they mix with what is translucent, what they show."""

from __future__ import annotations

import math
from dataclasses import replace

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.effects.sprites import outline_of
from mimics_app.rendering.visual.kernels.particles import SPRITE
from mimics_app.rendering.visual.kernels.sprites import MAX_PIECES, SPRITE_VERTEX, write_sprites
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.components.effects import Billboard, Particles, Projector
from mimics_app.world.content.environment import Fog, Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.materials.sprite_pictures import sprite_picture
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen

F8 = NDArray[np.float64]
SIZE = (96, 64)
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
BLACK = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
UPRIGHT = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
CODE = 1.0


def encode(linear: float) -> float:
    """IEC 61966-2-1, to 0-255."""
    return 255.0 * (12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1.0 / 2.4) - 0.055)


def make_world(sky: Sky = BLACK) -> World:
    world = World()
    world.environment = sky
    white = np.full((4, 4, 4), 255, np.uint8)
    world.textures["white"] = TextureData(white, wrap=("clamp", "clamp"))
    return world


def put(world: World, name: str, place: tuple[float, float, float], **fields: object) -> None:
    spec = Billboard(texture="white", **fields)
    world.effects.add(world.root.create_child(name, place).index, spec)
    world.update()


def view_from(place: tuple[float, float, float], at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> View:
    return View(compose_look_at(place, at), compute_tangents(0.8, SIZE), (0, 0, *SIZE))


def axes_of(facing: int, place: F8, eye: F8, right: F8) -> F8:
    """Half of width and height as vectors: from the lower left corner to the others."""
    sprites, out = np.zeros(1, SPRITE), np.zeros((1, 4), SPRITE_VERTEX)
    sprites["place"], sprites["half"], sprites["turn"], sprites["facing"] = place, 1.0, (1.0, 0.0, 0.0, 0.0), facing
    rows = np.arange(2, dtype=np.int32)
    write_sprites(sprites, rows, 1, rows, eye, right, np.zeros((3, 3)), np.zeros((1, 1, MAX_PIECES + 1, 2)), out)
    corners = out["position"][0].astype(np.float64)
    return 0.5 * (corners[[1, 2]] - corners[0])


def test_a_free_one_faces_the_eye_and_never_rolls():
    """For any eye: at right angles to the line of sight, level, and not upside down; so the head's roll is not seen."""
    random = np.random.default_rng(3)
    for _ in range(200):
        place, eye = random.normal(size=(2, 3)) * 5.0
        right, up = axes_of(0, place, eye, np.array([1.0, 0.0, 0.0]))
        towards = (eye - place) / np.linalg.norm(eye - place)
        assert np.cross(right, up) == pytest.approx(towards, abs=1e-6)
        assert abs(right[1]) < 1e-6 and up[1] > -1e-6
        assert axes_of(1, place, eye, np.array([1.0, 0.0, 0.0]))[1] == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_seen_from_straight_above_or_below_it_takes_the_eyes_right(sign):
    right = np.array([0.6, 0.0, 0.8])
    axes = axes_of(0, np.zeros(3), np.array([0.0, 2.0 * sign, 0.0]), right)
    assert axes[0] == pytest.approx(right)
    assert np.cross(axes[0], axes[1]) == pytest.approx([0.0, sign, 0.0], abs=1e-6)


def test_one_at_the_eye_itself_is_no_fault():
    assert np.isfinite(axes_of(0, np.ones(3), np.ones(3), np.array([1.0, 0.0, 0.0]))).all()


@pytest.mark.parametrize(("pivot", "bottom"), [("centre", -0.3), ("bottom", 0.0)])
@pytest.mark.parametrize("blend", ["alpha", "mask"])
def test_it_covers_the_pixels_its_size_says(pivot, bottom, blend):
    world = make_world()
    put(world, "card", (0.1, 0.0, 0.0), size=(0.8, 0.6), pivot=pivot, blend=blend)
    world.find("card").set_scale((1.0, 1.0, 0.5))
    world.update()
    view = View(compose_look_at((0.1, 0.0, 2.0), (0.1, 0.0, 0.0)), (-0.48, 0.48, -0.32, 0.32), (0, 0, *SIZE))
    seen = draw_offscreen(world, [view], SIZE, PLAIN)[..., 0] == 255
    columns, rows = np.flatnonzero(seen.any(axis=0)), np.flatnonzero(seen.any(axis=1))
    # At 2 m one pixel is 0.02 m; row 0 is the uppermost.
    assert (columns[0], columns[-1] + 1) == (48 - 20, 48 + 20)
    assert (64 - rows[-1] - 1, 64 - rows[0]) == (round(32 + bottom / 0.02), round(32 + (bottom + 0.6) / 0.02))


def test_each_eye_sees_it_as_if_alone():
    world = make_world()
    put(world, "card", (0.0, 0.3, -0.4), size=(0.8, 0.6), colour=(0.2, 0.5, 0.9, 0.7))
    put(world, "tree", (0.5, -0.5, 0.0), size=(0.3, 0.9), facing="upright", pivot="bottom", blend="mask")
    left, right = view_from((-0.4, 0.9, 1.6)), view_from((0.4, 0.9, 1.6))
    wide = (2 * SIZE[0], SIZE[1])
    second = View(right.world_from_eye, right.tangents, (SIZE[0], 0, *SIZE))
    both = draw_offscreen(world, [left, second], wide, PLAIN)
    for half, view in ((both[:, : SIZE[0]], left), (both[:, SIZE[0] :], right)):
        assert (half == draw_offscreen(world, [view], SIZE, PLAIN)).all()
        assert (half[..., :3] > 0).any()


def panes_and_sprites() -> World:
    """Far to near from +z, half opaque: red pane -1, green sprite -0.75, blue pane -0.5, white sprite -0.25."""
    world = make_world()
    for name, colour, depth in (("red", (1.0, 0.0, 0.0, 0.5), -1.0), ("blue", (0.0, 0.0, 1.0, 0.5), -0.5)):
        world.set_material(Material(name, "unlit", colour, alpha_mode="blend", double_sided=True))
        world.meshes["pane"] = plane(4.0, 4.0)
        world.root.create_child(name, (0.0, 0.0, depth), UPRIGHT).create_entity("pane", name)
    put(world, "green", (0.0, 0.0, -0.75), size=(4.0, 4.0), colour=(0.0, 1.0, 0.0, 0.5))
    put(world, "white", (0.0, 0.0, -0.25), size=(4.0, 4.0), colour=(1.0, 1.0, 1.0, 0.5))
    return world


@pytest.mark.parametrize("behind", [False, True])
def test_sprites_and_panes_are_blended_far_to_near_from_either_side(behind):
    layers = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 1.0)]
    expected = np.zeros(3)
    for layer in reversed(layers) if behind else layers:
        expected = 0.5 * expected + 0.5 * np.array(layer)
    place = (0.0, 0.0, -2.25 if behind else 1.0)
    picture = draw_offscreen(panes_and_sprites(), [view_from(place, (0.0, 0.0, -0.6))], SIZE, PLAIN)
    assert picture[32, 48, :3] == pytest.approx(255.0 * expected, abs=2.0 * CODE)


def test_what_adds_light_adds_its_display_values_whatever_the_order():
    world = make_world()
    for number, red in enumerate((0.2, 0.05)):
        put(
            world, f"glow{number}", (0.0, 0.0, -0.3 * number), size=(4.0, 4.0), colour=(red, 0.0, 0.0, 0.5), blend="add"
        )
    expected = 0.5 * encode(0.2) + 0.5 * encode(0.05)
    for place in ((0.0, 0.0, 1.0), (0.0, 0.0, -2.0)):
        picture = draw_offscreen(world, [view_from(place, (0.0, 0.0, -0.1))], SIZE, PLAIN)
        assert picture[32, 48, 0] == pytest.approx(expected, abs=CODE)


def test_a_mask_hides_what_is_behind_and_shows_through_its_holes():
    world = make_world()
    cut = np.full((1, 4, 4), 255, np.uint8)
    cut[0, :, 3] = (255, 100, 150, 0)
    world.textures["cut"] = TextureData(cut, filter="nearest", wrap=("clamp", "clamp"))
    card = Billboard(texture="cut", size=(2.0, 2.0), blend="mask", cutoff=0.5)
    world.effects.add(world.root.create_child("card").index, card)
    put(world, "behind", (0.0, 0.0, -0.5), size=(4.0, 4.0), colour=(1.0, 0.0, 0.0, 1.0))
    eye = View(compose_look_at((0.0, 0.0, 2.0), (0.0, 0.0, 0.0)), (-0.5, 0.5, -0.5, 0.5), (0, 0, 64, 64))
    row = draw_offscreen(world, [eye], (64, 64), PLAIN)[32]
    assert [row[x, 1] for x in (8, 24, 40, 56)] == [255, 0, 255, 0]
    assert [row[x, 0] for x in (8, 24, 40, 56)] == [255, 255, 255, 255]


def test_bodies_hide_sprites_and_sprites_hide_no_bodies():
    world = make_world()
    world.set_material(Material("red", "unlit", (1.0, 0.0, 0.0, 1.0), double_sided=True))
    world.meshes["pane"] = plane(4.0, 4.0)
    world.root.create_child("pane", (0.0, 0.0, 0.0), UPRIGHT).create_entity("pane", "red")
    put(world, "glow", (0.0, 0.0, -0.5), size=(4.0, 4.0))
    front = draw_offscreen(world, [view_from((0.0, 0.0, 1.0))], SIZE, PLAIN)[32, 48, :3]
    assert front.tolist() == [255, 0, 0]
    back = draw_offscreen(world, [view_from((0.0, 0.0, -2.0))], SIZE, PLAIN)[32, 48, :3]
    assert back.tolist() == [255, 255, 255]


@pytest.mark.parametrize("particle_light", ["pixel", "vertex"])
@pytest.mark.parametrize("lean", [0.0, 0.6, 1.2])
def test_lit_paper_follows_lambert(lean, particle_light):
    """One piece, lying flat, under a sun that leans: albedo times cosine."""
    world = make_world()
    flight = Particles(shape="paper", trigger="start", count=1, speed=(0.0, 0.0), gravity=(0.0, -9.81, 0.0), floor=-0.1)
    look = {
        "size": (2.0, 2.0),
        "colours": ((0.6, 0.3, 0.1, 1.0),),
        "blend": "mask",
        "lit": True,
        "lifetime": (9.0, 9.0),
    }
    spec = msgspec.structs.replace(flight, **look)
    world.effects.add(world.root.create_child("paper").index, spec)
    sun = world.root.create_child("sun", (3.0 * math.sin(lean), 3.0 * math.cos(lean), 0.0))
    sun.look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    sun.create_light("directional", intensity=0.9)
    world.update()
    world.effects.trigger("start")
    world.effects.time = 2.0
    view = View(
        compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), compute_tangents(0.5, SIZE), (0, 0, *SIZE)
    )
    picture = draw_offscreen(world, [view], SIZE, replace(PLAIN, particle_light=particle_light))[32, 48, :3]
    assert picture == pytest.approx([encode(0.9 * math.cos(lean) * albedo) for albedo in (0.6, 0.3, 0.1)], abs=CODE)


def test_light_at_the_vertices_of_smoke_is_near_that_of_its_pixels():
    """In haze, and in the light of a lamp that is farther away than the smoke is wide."""
    world = make_world(Sky((0.2, 0.3, 0.4), (0.2,) * 3, (0.1,) * 3, 0.5, Fog("exponential", 0.2, 0.0, (0.3, 0.3, 0.3))))
    smoke = Particles(shape="puff", rate=20.0, lifetime=(2.0, 2.0), size=(0.6, 0.9), box=(1.0, 0.5, 1.0), lit=True)
    world.effects.add(world.root.create_child("smoke").index, smoke)
    world.root.create_child("lamp", (0.0, 0.5, 4.0)).create_light("point", colour=(1.0, 0.5, 0.2), intensity=8.0)
    world.effects.time = 3.0
    world.update()
    toned = replace(PLAIN, tone_map="neutral")
    seen = [view_from((0.0, 0.2, 3.0))]
    pixel, vertex = (
        draw_offscreen(world, seen, SIZE, replace(toned, particle_light=each))[..., :3].astype(int)
        for each in ("pixel", "vertex")
    )
    assert 0 < np.abs(pixel - vertex).max() <= 6.0 * CODE and pixel.max() > 100


@pytest.mark.parametrize("facing", ["free", "upright"])
def test_what_is_cut_off_along_the_outline_is_nothing(facing):
    """A dagger, narrow below, wide in the middle, from near, aside and above; a study cuts nothing."""
    shape = np.zeros((64, 64, 4), np.uint8)
    shape[..., :3] = (250, 120, 60)
    shape[24:60, 28:36, 3] = shape[30:36, 8:56, 3] = 255
    world = make_world()
    world.textures["dagger"] = TextureData(shape, wrap=("clamp", "clamp"))
    spec = Billboard(texture="dagger", size=(1.0, 1.2), facing=facing, lit=True)
    world.effects.add(world.root.create_child("dagger").index, spec)
    world.root.create_child("lamp", (0.5, 0.5, 1.0)).create_light("point")
    world.update()
    size, drawn = (320, 240), []
    for place in ((0.0, 0.0, 1.2), (0.7, 0.2, 1.0), (0.1, 0.9, 1.0)):
        for profile in ("training", "study"):
            view = View(compose_look_at(place, (0.0, 0.0, 0.0)), compute_tangents(0.8, size), (0, 0, *size))
            with create_surface("egl", size) as surface:
                renderer = Renderer(surface, world, replace(PLAIN, profile=profile))
                drawn.append((renderer.draw([view]).triangles, read_pixels(surface).astype(int)))
                renderer.release()
    assert [triangles for triangles, _ in drawn] == [2 * MAX_PIECES, 2] * 3
    for (_, cut), (_, whole) in zip(drawn[::2], drawn[1::2], strict=True):
        assert np.abs(cut - whole).max() <= 2.0 * CODE and whole.max() > 100


def test_an_outline_holds_its_shape_and_a_full_picture_has_none():
    shape = np.zeros((64, 32, 4), np.uint8)
    shape[40:, 12:20, 3] = 1
    outline = outline_of(TextureData(shape, wrap=("clamp", "clamp")))
    assert outline is not None
    assert (outline[:3, 0] <= -0.25).all() and (outline[:3, 1] >= 0.25).all(), "the lower 24 rows, at 12 to 20 of 32"
    assert np.ptp(outline[5:], axis=1).max() == 0.0
    assert outline_of(TextureData(shape)) is None, "it repeats"
    shape[..., 3] = 1
    assert outline_of(TextureData(shape, wrap=("clamp", "clamp"))) is None


def test_haze_covers_what_covers_and_dims_what_adds():
    sky = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0, Fog("exponential", 0.5, 0.0, (0.3, 0.3, 0.3)))
    seen = math.exp(-0.5 * 2.0)
    for blend, expected in (("mask", 0.3 + seen * (0.8 - 0.3)), ("add", seen * 0.8)):
        world = make_world(sky)
        put(world, "card", (0.0, 0.0, 0.0), size=(0.5, 0.5), colour=(0.8, 0.8, 0.8, 1.0), blend=blend)
        view = View(compose_look_at((0.0, 0.0, 2.0), (0.0, 0.0, 0.0)), compute_tangents(0.5, SIZE), (0, 0, *SIZE))
        assert draw_offscreen(world, [view], SIZE, PLAIN)[32, 48, 0] == pytest.approx(encode(expected), abs=CODE)


def test_every_code_survives_the_way_from_texture_to_picture():
    """sRGB decoded and encoded by the shader: all 256 codes of each channel come out as they went in."""
    codes = np.zeros((16, 16, 4), np.uint8)
    ramp = np.arange(256, dtype=np.uint8).reshape(16, 16)
    codes[..., 0], codes[..., 1], codes[..., 2], codes[..., 3] = ramp, ramp[::-1], ramp[:, ::-1], 255
    world = make_world()
    world.textures["codes"] = TextureData(codes, filter="nearest", wrap=("clamp", "clamp"))
    world.effects.add(world.root.create_child("card").index, Billboard(texture="codes", size=(1.0, 1.0)))
    world.update()
    view = View(compose_look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)), (-0.5, 0.5, -0.5, 0.5), (0, 0, 16, 16))
    assert (draw_offscreen(world, [view], (16, 16), PLAIN)[..., :3] == codes[..., :3]).all()


def shown_dot(pixels: int, offset: float = 0.0) -> F8:
    """A white dot so many pixels wide, `offset` of one aside, as it is drawn: shares of white."""
    world = make_world()
    world.effects.add(world.root.create_child("dot").index, Billboard(shape="dot", size=(1.0, 1.0)))
    world.update()
    size, half = (pixels + 2, pixels + 2), 0.5 + 1.0 / pixels
    aside = offset / pixels
    tangents = (-half - aside, half - aside, -half - aside, half - aside)
    view = View(compose_look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)), tangents, (0, 0, *size))
    return draw_offscreen(world, [view], size, PLAIN)[..., 0] / 255.0


def test_a_dot_is_the_formula_of_its_picture():
    """Of the picture's own size it is the picture; a small one has the mean of the dot wherever its pixels lie."""
    picture = sprite_picture("dot").pixels[..., 3] / 255.0
    assert np.abs(shown_dot(64)[1:-1, 1:-1] - picture).max() < 2.0 / 255.0
    for pixels in (1, 2, 4):
        covered = np.mean([shown_dot(pixels, offset).sum() for offset in np.arange(-0.45, 0.5, 0.1)])
        assert covered == pytest.approx(picture.sum() * (pixels / 64) ** 2, rel=0.12)


def test_a_missing_picture_gives_one_line_and_a_picture_all_the_same():
    world = make_world()
    world.effects.add(world.root.create_child("card").index, Billboard(texture="nowhere", shape="paper"))
    world.update()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        for _ in range(3):
            renderer.draw([view_from((0.0, 0.0, 2.0))])
        assert [issue.what for issue in renderer.take_issues()] == ['sprite: no texture "nowhere"; drawn as a paper']
        assert read_pixels(surface)[32, 48, 0] == 255
        renderer.release()


def test_hidden_nodes_hide_their_effects_and_a_world_without_any_has_no_stage():
    world = make_world()
    put(world, "card", (0.0, 0.0, 0.0))
    world.effects.add(world.root.create_child("smoke").index, Particles(rate=500.0))
    world.find("card").visible = world.find("smoke").visible = False
    world.update()
    with create_surface("egl", SIZE) as surface:
        bare = Renderer(surface, make_world(), PLAIN)
        bare.draw([view_from((0.0, 0.0, 2.0))])
        assert bare._effects is None
        renderer = Renderer(surface, world, PLAIN)
        hidden = renderer.draw([view_from((0.0, 0.0, 2.0))])
        assert hidden.triangles == 0 and read_pixels(surface)[..., :3].max() == 0
        world.find("card").visible = True
        world.update()
        assert renderer.draw([view_from((0.0, 0.0, 2.0))]).triangles == 2
        renderer.release(), bare.release()


def test_effects_come_back_with_a_context_that_was_lost():
    world = make_world()
    put(world, "card", (0.0, 0.0, 0.0), colour=(0.2, 0.5, 0.9, 0.7))
    world.effects.add(world.root.create_child("smoke").index, Particles(rate=500.0))
    world.effects.add(world.root.create_child("ring", (0.0, 0.0, -0.2)).index, Projector(size=(0.5, 0.5)))
    world.set_material(Material("grey", "unlit", (0.3, 0.3, 0.3, 1.0), double_sided=True))
    world.meshes["pane"] = plane(4.0, 4.0)
    world.root.create_child("pane", (0.0, 0.0, -0.3), UPRIGHT).create_entity("pane", "grey")
    world.update()
    with create_surface("egl", SIZE) as surface:
        renderer, view = Renderer(surface, world, PLAIN), view_from((0.0, 0.0, 2.0))
        renderer.draw([view])
        before = read_pixels(surface)
        surface.renew()
        renderer.renew()
        renderer.draw([view])
        assert surface.ctx.error == "GL_NO_ERROR"
        assert (read_pixels(surface) == before).all() and len(np.unique(before[..., 2])) > 5
        renderer.release()
