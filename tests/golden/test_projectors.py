"""Pictures projected onto surfaces: where they lie, what they leave out, and what they do to the light."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.effects.projectors import clip_from_projector
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.components.effects import Projector
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.primitives import box, plane
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen
from tests.golden.test_sprites import encode

F8 = NDArray[np.float64]
SIZE = (160, 160)
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
SKY = Sky((0.5,) * 3, (0.5,) * 3, (0.5,) * 3, 1.0)
DARK = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
ALBEDO = 0.4
DOWN = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
"""Turns the own -z downwards."""


def make_world(sky: Sky = SKY) -> World:
    """A floor under an even sky; pictures: one all white, one with a hole in its right half."""
    world = World()
    world.environment = sky
    world.set_material(Material("floor", base_colour=(ALBEDO, ALBEDO, ALBEDO, 1.0), roughness=1.0))
    world.meshes |= {"floor": plane(8.0, 8.0), "block": box(0.4, 0.4, 0.4)}
    world.root.create_child("floor").create_entity("floor", "floor")
    white, half = np.full((2, 2, 4), 255, np.uint8), np.full((2, 2, 4), 255, np.uint8)
    half[:, 1, 3] = 0
    world.textures |= {"white": TextureData(white), "half": TextureData(half, filter="nearest")}
    world.update()
    return world


def project(world: World, place: tuple[float, float, float] = (0.0, 0.0, 0.0), *, turn: tuple[float, ...] = DOWN,
          texture: str = "white", **fields: object) -> None:  # fmt: skip
    node = world.root.create_child(f"projector{len(world.effects.projectors)}", place, turn)
    world.effects.add(node.index, Projector(texture=texture, **fields))
    world.update()


def from_above(height: float = 2.0, half: float = 0.8) -> View:
    """Pixel x runs over world x, -half to half; pixel rows over z, -half uppermost."""
    pose = compose_look_at((0.0, height, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    side = half / height
    return View(pose, (-side, side, -side, side), (0, 0, *SIZE))


def changed(world: World, views: list[View] | None = None, settings: RenderSettings = PLAIN) -> NDArray[np.bool_]:
    """Where the picture differs from that of a world without projectors."""
    views = views or [from_above()]
    projected = draw_offscreen(world, views, SIZE, settings).astype(int)
    for index in list(world.effects.projectors):
        world.effects.remove([index])
    bare = draw_offscreen(world, views, SIZE, settings).astype(int)
    return np.abs(projected - bare).max(axis=-1) > 0


def extent(mask: NDArray[np.bool_]) -> tuple[float, float, float, float]:
    """Least and greatest world x and z of what is marked [m]."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    return tuple(-0.8 + 0.01 * edge for edge in (columns[0], columns[-1] + 1, rows[0], rows[-1] + 1))  # type: ignore[return-value]


@pytest.mark.parametrize("msaa", [0, 4])
def test_a_decal_fills_its_box_and_nothing_else(msaa):
    world = make_world()
    project(world, (0.1, 0.05, -0.2), size=(0.6, 0.4), depth=0.2, colour=(0.0, 0.0, 0.0, 1.0))
    settings = RenderSettings(msaa=msaa, shadow_size=0, tone_map="none", fog_density=0.0)
    assert extent(changed(world, settings=settings)) == pytest.approx((-0.2, 0.4, -0.4, 0.0), abs=0.5 * 0.01)


def test_beyond_its_depth_it_is_not():
    world = make_world()
    project(world, (0.0, 0.15, 0.0), size=(0.6, 0.4), depth=0.2, colour=(0.0, 0.0, 0.0, 1.0))
    assert not changed(world).any()


def test_a_slide_fills_its_pyramid():
    world = make_world()
    project(
        world,
        (0.0, 1.0, 0.0),
        kind="slide",
        fov=2.0 * math.atan(0.3),
        size=(2.0, 1.0),
        depth=3.0,
        colour=(0.0,) * 3 + (1.0,),
    )
    assert extent(changed(world)) == pytest.approx((-0.6, 0.6, -0.3, 0.3), abs=0.5 * 0.01)


def test_nothing_is_thrown_backwards():
    """Behind a slide the division by w turns the picture over; without a test of w it would be seen there."""
    world = make_world()
    project(world, (0.0, 1.0, 0.0), turn=(math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)), kind="slide", depth=3.0)
    assert not changed(world).any()


def test_its_picture_lies_as_a_person_behind_it_sees_it():
    world = make_world()
    project(world, texture="half", size=(0.8, 0.8), colour=(0.0, 0.0, 0.0, 1.0))
    # Looking down with -z ahead of the head, right is +x: the right half is the hole.
    assert extent(changed(world)) == pytest.approx((-0.4, 0.0, -0.4, 0.4), abs=0.5 * 0.01)


def test_surfaces_that_lean_too_much_are_left_out():
    world = make_world()
    world.root.create_child("block", (0.3, 0.2, 0.0)).create_entity("block", "floor")
    project(
        world, (0.0, 0.5, 0.0), size=(2.0, 2.0), depth=1.2, colour=(0.0, 0.0, 0.0, 1.0), full_angle=0.5, last_angle=1.0
    )
    side = View(compose_look_at((-2.0, 0.2, 0.0), (0.0, 0.2, 0.0)), compute_tangents(0.3, SIZE), (0, 0, *SIZE))
    marked = changed(world, [side])
    block = slice(80 - 12, 80 + 12)
    assert not marked[block, block].any() and marked[100:].any()


def test_it_falls_only_onto_what_is_named_and_what_hangs_on_it():
    def is_covered(onto: tuple[str, ...]) -> tuple[bool, bool, bool]:
        world = make_world()
        block = world.root.create_child("block", (0.4, 0.0, 0.0))
        block.create_entity("block", "floor")
        block.create_child("upper", (0.0, 0.3, 0.0), scale=(0.5, 0.5, 0.5)).create_entity("block", "floor")
        world.update()
        project(world, (0.0, 0.3, 0.0), size=(3.0, 3.0), depth=1.0, colour=(0.0, 0.0, 0.0, 1.0), onto=onto)
        mask = changed(world)
        return bool(mask[80, 40]), bool(mask[80 + 16, 120 + 16]), bool(mask[80, 122])

    assert is_covered(()) == (True, True, True)
    assert is_covered(("floor",)) == (True, False, False)
    assert is_covered(("block",)) == (False, True, True)
    assert is_covered(("upper",)) == (False, False, True)
    assert is_covered(("nobody",)) == (False, False, False)


@pytest.mark.parametrize("blend", ["paint", "stain", "light"])
def test_light_follows_its_formula(blend):
    """Even sky of 0.5: the floor gives back 0.5 of its albedo; a slide adds albedo times its own light."""
    world = make_world(DARK if blend == "light" else SKY)
    project(world, size=(0.8, 0.8), blend=blend, colour=(0.3, 0.6, 0.9, 0.5))
    picture = draw_offscreen(world, [from_above()], SIZE, PLAIN)[80, 80, :3]
    floor = encode(0.5 * ALBEDO)
    expected = {
        "paint": [0.5 * floor + 0.5 * encode(0.5 * value) for value in (0.3, 0.6, 0.9)],
        "stain": [floor * (0.5 + 0.5 * encode(value) / 255.0) for value in (0.3, 0.6, 0.9)],
        "light": [encode(0.5 * ALBEDO * value) for value in (0.3, 0.6, 0.9)],
    }[blend]
    assert picture == pytest.approx(expected, abs=1.0)


def test_light_shows_the_picture_of_the_surface():
    world = make_world(DARK)
    world.textures["green"] = TextureData(np.full((2, 2, 4), (0, 255, 0, 255), np.uint8))
    world.set_material(Material("floor", base_colour=(0.5, 0.5, 0.5, 1.0), base_texture="green", roughness=1.0))
    project(world, size=(0.8, 0.8), blend="light", colour=(0.6, 0.6, 0.6, 1.0))
    assert draw_offscreen(world, [from_above()], SIZE, PLAIN)[80, 80, :3] == pytest.approx(
        [0.0, encode(0.3), 0.0], abs=1.0
    )


def test_holes_stay_holes_and_what_is_translucent_stays_clean():
    world = make_world()
    world.textures["holes"] = TextureData(
        np.array([[[255, 255, 255, 255], [255, 255, 255, 0]]], np.uint8), filter="nearest"
    )
    cut = Material("cut", "unlit", (1.0, 0.0, 0.0, 1.0), base_texture="holes", alpha_mode="mask", double_sided=True)
    glass = Material("glass", "unlit", (0.0, 0.0, 1.0, 0.5), alpha_mode="blend")
    for number, material in enumerate((cut, glass)):
        world.set_material(material)
        world.meshes["sheet"] = plane(0.4, 0.4)
        world.root.create_child(material.name, (-0.4 + 0.8 * number, 0.5, 0.0)).create_entity("sheet", material.name)
    project(world, (0.0, 0.5, 0.0), size=(3.0, 3.0), depth=0.2, colour=(0.0, 0.0, 0.0, 1.0))
    columns = np.flatnonzero(changed(world).any(axis=0))
    # Seen from 2 m through 1.5 m the sheet's left half runs from x = -0.6 to -0.4 of 1.5 m: pixels 0 to 26.
    assert columns[0] == 0 and columns[-1] == pytest.approx(26, abs=1)


def test_each_eye_sees_it_as_if_alone():
    world = make_world()
    project(world, size=(0.8, 0.6), colour=(0.1, 0.2, 0.7, 0.8))
    project(world, (0.0, 1.0, 0.2), kind="slide", blend="light", depth=3.0)
    left, right = from_above(2.0), from_above(1.5, 0.6)
    wide = (2 * SIZE[0], SIZE[1])
    second = View(right.world_from_eye, right.tangents, (SIZE[0], 0, *SIZE))
    both = draw_offscreen(world, [left, second], wide, PLAIN)
    for half, view in ((both[:, : SIZE[0]], left), (both[:, SIZE[0] :], right)):
        assert (half == draw_offscreen(world, [view], SIZE, PLAIN)).all()


@pytest.mark.parametrize(
    ("shadows", "ambient"),
    [
        ("texture_additive", 0.0),
        ("texture_additive", 1.0),
        ("texture_modulative", 0.0),
        ("stencil_additive", 0.0),
        ("stencil_additive", 1.0),
        ("stencil_modulative", 0.0),
    ],
)
def test_paint_is_lit_as_the_floor_is(shadows, ambient):
    """Paint of the floor's own albedo cannot be seen: lit or in shadow, in corners, whatever makes the shadow."""
    world = make_world()
    world.root.create_child("block", (0.0, 0.2, 0.0)).create_entity("block", "floor")
    sun = world.root.create_child("sun", (3.0, 4.0, 0.0))
    sun.look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    sun.create_light("directional", intensity=0.6, casts_shadow=1)
    world.update()
    project(world, size=(3.0, 3.0), depth=0.2, colour=(ALBEDO, ALBEDO, ALBEDO, 1.0), onto=("floor",))
    settings = replace(PLAIN, shadow_size=512, shadow_reach=9.0, shadows=shadows, ambient_occlusion=ambient)
    aslant = View(compose_look_at((0.0, 1.0, 1.5), (0.0, 0.1, 0.0)), (-0.5, 0.5, -0.5, 0.5), (0, 0, *SIZE))
    # What the test has to see: what darkens corners, else the shadow.
    without = replace(settings, ambient_occlusion=0.0) if ambient else replace(settings, shadow_size=0)
    is_covered = draw_offscreen(world, [aslant], SIZE, settings).astype(int)
    world.effects.remove(list(world.effects.projectors))
    bare, plain = (draw_offscreen(world, [aslant], SIZE, each).astype(int) for each in (settings, without))
    assert np.abs(is_covered - bare).max() <= 1
    assert (np.abs(bare - plain).max(axis=-1) > 2).sum() > 200


@pytest.mark.parametrize(
    ("place", "draws"),
    [((0.0, 3.0, 0.0), 2), ((3.0, 0.0, 0.0), 2), ((0.7, 0.0, 0.0), 3)],
    ids=["above all", "outside the picture", "seen"],
)
def test_only_one_that_is_seen_and_meets_something_costs_a_draw(place, draws):
    world = make_world()
    project(world, place, depth=0.5)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        assert renderer.draw([from_above()]).draws == draws  # two are floor and sky
        renderer.release()


@pytest.mark.parametrize("kind", ["decal", "slide"])
def test_corners_of_the_volume_are_corners_of_the_clip_cube(kind):
    spec = Projector(kind=kind, size=(0.8, 0.4), depth=2.0, near=0.5, fov=1.0)
    if kind == "decal":
        corners = {-1.0: (-0.4, -0.2, 1.0), 1.0: (0.4, 0.2, -1.0)}
    else:
        corners = {
            -1.0: (-2 * 0.5 * math.tan(0.5), -0.5 * math.tan(0.5), -0.5),
            1.0: (4 * math.tan(0.5), 2 * math.tan(0.5), -2.0),
        }
    for at, corner in corners.items():
        clip = clip_from_projector(spec) @ [*corner, 1.0]
        assert clip[:3] / clip[3] == pytest.approx([at, at, at])
