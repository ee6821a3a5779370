"""Pictures of which only parts are drawn again: the same pixels as drawn as a whole, whatever changed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software.kept_board import KeptBoard
from mimics_app.rendering.visual.software.screen_places import cover_of, screen_bounds
from mimics_app.rendering.visual.stages.world_stage import ViewDraws, WorldStage
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import Rect, View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.components.effects import Billboard, Projector
from mimics_app.world.components.pictures import Inset, Mirror, Screen
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.live_pictures import show_mirror, show_screen
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.materials.technique import PassSpec, TechniqueSpec
from mimics_app.world.content.meshes.primitives import box, icosphere, plane
from mimics_app.world.content.world import World

pytestmark = pytest.mark.software

SIZE = (320, 192)
PLAIN = RenderSettings(msaa=0, shadow_size=256)


def make_world() -> World:
    """Twelve boxes on a floor, one of glass, a ball, a sprite, a small sheet, what is drawn over them, and lights."""
    world = World()
    world.set_material(Material("glass", "glass", (0.4, 0.6, 0.8, 0.3), alpha_mode="blend"))
    world.set_material(Material("red", base_colour=(0.8, 0.1, 0.1, 1.0)))
    world.meshes |= {"floor": plane(9.0, 9.0), "box": box(0.3, 0.5, 0.3), "ball": icosphere(0.12, 2)}
    world.meshes["sheet"] = plane(0.4, 0.4, segments=2)
    world.root.create_child("floor").create_entity("floor", "default").subentities[0].casts_shadow = False
    for number in range(12):
        place = (0.9 * (number % 4 - 1.5), 0.25, 0.9 * (number // 4 - 1))
        world.root.create_child(f"box{number}", place).create_entity("box", "glass" if number == 5 else "default")
    world.root.create_child("ball", (0.0, 0.9, 0.3)).create_entity("ball", "default")
    world.root.create_child("sheet", (1.3, 0.7, 0.4)).create_entity("sheet", "red")
    world.effects.add(world.root.create_child("word", (-1.4, 0.8, 0.2)).index, Billboard(size=(0.3, 0.2)))
    overlay(world)
    sun = world.root.create_child("sun", (0.5, 2.0, 0.7))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", casts_shadow=1)
    world.root.create_child("lamp", (-1.0, 1.5, 1.0)).create_light("point", intensity=0.4)
    world.update()
    return world


def overlay(world: World) -> None:
    """A mark on the floor, a slide that shines on it, and a cord."""
    down = np.array([-(0.5**0.5), 0.0, 0.0, 0.5**0.5])
    mark, slide = Projector(size=(0.4, 0.4)), Projector(kind="slide", fov=0.3, depth=3.0, blend="light")
    world.effects.add(world.root.create_child("mark", (0.5, 0.0, 0.5), down).index, mark)
    world.effects.add(world.root.create_child("slide", (-0.9, 2.0, 0.0), down).index, slide)
    world.cords["cord"] = Cord(np.array([[-1.6, 0.9, -0.2], [-0.8, 0.9, -0.2]]), 1.0)


def view(x: float = 0.0) -> View:
    return View(compose_look_at((x, 2.4, 3.4), (x, 0.2, 0.0)), (-0.65, 0.65, -0.39, 0.39), (0, 0, *SIZE))


def lift_sheet(world: World) -> None:
    buffer = world.open_mesh("sheet")
    buffer.positions[4, 1] += 0.1
    buffer.update()


def dress(world: World, name: str, material: str) -> None:
    body = world.find(name).entity
    assert body is not None
    body.set_material(material)


def draw_whole(steady: Renderer, seen: View) -> np.ndarray:
    """Draw the frame of a renderer with another one that knows no frame before; return the pixels."""
    surface = steady._surface
    fresh = Renderer(surface, steady.world, steady.settings)
    fresh.hud = steady.hud
    # Where boxes about the casters are may depend on the frames before.
    fresh._shadows._box, fresh._shadows._cascades = steady._shadows._box, steady._shadows._cascades
    fresh.draw([seen])
    fresh.release()
    return read_pixels(surface)


CHANGES: dict[int, Callable[[World], object]] = {
    5: lambda world: world.find("box2").set_position((0.9, 0.3, -0.9)),
    7: lambda world: setattr(world.find("box7"), "visible", False),
    9: lambda world: setattr(world.find("box7"), "visible", True),
    10: lambda world: dress(world, "box8", "red"),
    11: lambda world: world.find("word").set_position((-1.2, 0.9, 0.2)),
    6: lambda world: world.find("mark").set_position((0.6, 0.0, 0.6)),
    8: lambda world: setattr(world.find("slide"), "visible", False),
    13: lambda world: setattr(world.cords["cord"], "length", 1.3),
    16: lambda world: world.cords["cord"].tap(0.4, 0.5, world.effects.time, 0.01),
    18: lambda world: setattr(world.cords["cord"], "visible", False),
    12: lambda world: world.find("lamp").set_position((-0.8, 1.5, 1.0)),
    14: lambda world: world.set_material(Material("red", base_colour=(0.1, 0.1, 0.8, 1.0))),
    15: lambda world: world.find("sun").look_at((0.3, 0.0, 0.1)),
    17: lambda world: lift_sheet(world),
    19: lambda world: world.root.create_child("more", (1.0, 0.25, 1.2)).create_entity("box", "default"),
    21: lambda world: world.effects.add(world.find("box0").index, Billboard(size=(0.2, 0.2))),
}
"""What happens to the world before which frame; a ball moves all the time."""

WHOLE = {12, 14, 15, 19, 21, 24}
"""Frames of which all pixels may be others: light, a material's own look, bodies that came, another view."""


@pytest.fixture
def drawn_parts(monkeypatch: pytest.MonkeyPatch) -> list[list[Rect | None]]:
    """What was drawn in parts, frame by frame."""
    drawn: list[list[Rect | None]] = []
    before = WorldStage.draw_parts

    def draw_parts(stage, target, samples, scene, parts: list[ViewDraws]) -> int:
        drawn.append([each.part and each.part.rectangle for each in parts])
        return before(stage, target, samples, scene, parts)

    monkeypatch.setattr(WorldStage, "draw_parts", draw_parts)
    return drawn


def test_where_hundreds_of_sprites_move_nothing_is_looked_for(drawn_parts):
    world = make_world()
    dots = [world.root.create_child(f"dot{number}", (0.0, 0.5, 0.0)) for number in range(320)]
    for dot in dots:
        world.effects.add(dot.index, Billboard(size=(0.02, 0.02)))
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        for frame in range(6):
            for number, dot in enumerate(dots):
                dot.set_position((0.005 * number - 0.8, 0.5 + 0.01 * frame, 0.0))
            world.update()
            renderer.draw([view()])
        assert drawn_parts == []
        for frame in range(6):
            dots[0].set_position((0.0, 0.6 + 0.01 * frame, 0.0))
            world.update()
            renderer.draw([view()])
    assert drawn_parts, "where one of them moves, only its part is drawn again"


@pytest.mark.parametrize(
    "settings",
    [
        PLAIN,
        replace(PLAIN, msaa=4),
        replace(PLAIN, scale=0.5),
        replace(PLAIN, fxaa=True, shadow_distance=4.0, cascades=2),
        replace(PLAIN, shading="plain"),
        replace(PLAIN, bloom=0.5),
    ],
    ids=["plain", "samples", "small", "filtered", "plain light", "bloom"],
)
def test_a_picture_drawn_in_parts_is_the_one_drawn_as_a_whole(settings, drawn_parts):
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, settings)
        for step in range(27):
            world.find("ball").set_position((0.6 * np.sin(0.3 * step), 0.9, 0.3))
            CHANGES.get(step, lambda world: None)(world)
            world.effects.time = step / 60.0
            world.update()
            seen, before = view(0.1 if step >= 24 else 0.0), len(drawn_parts)
            steady.draw([seen])
            ours = read_pixels(surface)
            assert len(drawn_parts) - before <= (step >= 3 and step not in WHOLE), step
            apart = np.abs(ours.astype(int) - draw_whole(steady, seen))
            assert apart.max() <= (3 if settings.scale < 1.0 else 0), step  # scaled as a whole it is rounded otherwise
        assert surface.ctx.error == "GL_NO_ERROR"
    assert len(drawn_parts) >= (15 if settings.scale == 1.0 and not settings.fxaa else 8)
    area = [sum(part[2] * part[3] for part in parts if part) for parts in drawn_parts]
    whole = SIZE[0] * SIZE[1] * settings.scale**2
    assert 0.0 < np.median(area) < 0.5 * whole


@pytest.mark.parametrize(
    "settings", [PLAIN, replace(PLAIN, msaa=4), replace(PLAIN, fxaa=True)], ids=["plain", "samples", "filtered"]
)
def test_pictures_far_apart_are_drawn_in_parts_from_the_second_on(settings, drawn_parts):
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        rare = Renderer(surface, world, settings, sparse=True)
        for step in range(27):
            CHANGES.get(step, lambda world: None)(world)
            for k in range(3):
                world.find("ball").set_position((0.6 * np.sin(0.3 * step + 0.1 * k), 0.9, 0.3))
                world.effects.time = step / 20.0 + k / 60.0
                world.update()
            rare.hud.clear()
            rare.hud.box(40.3 + 17.0 * step, 30.7, 300.0, 80.0, (0.1, 0.1, 0.1, 0.7), radius=9.0)
            rare.hud.text(60.0 + 17.0 * step, 55.2, f"step {step}", 40.0)
            seen, before = view(0.1 if step >= 24 else 0.0), len(drawn_parts)
            rare.draw([seen])
            ours = read_pixels(surface)
            assert len(drawn_parts) - before <= (step >= 1 and step not in WHOLE), step
            assert np.array_equal(ours, draw_whole(rare, seen)), step
    assert len(drawn_parts) >= 15


def lay_board(hud: Hud, step: int) -> None:
    """Two cards, of which one changes and crosses the other; a disc over a box; an image; nothing in some frames."""
    hud.clear()
    if step in (12, 13):
        return
    crossing = step // 3
    cards = [(40.0, f"time {step // 2}"), (420.0 - 25.0 * crossing, "still"), (700.0, "" if step % 7 == 6 else "force")]
    for x, text in cards if step < 20 else reversed(cards):
        hud.box(x, 600.3, 250.0, 80.0, (0.1, 0.1, 0.1, 0.6), radius=12.0)
        hud.text(x + 9.0, 630.0, text, 40.0)
    if step > 8:
        hud.image((20.0, 30.7, 60.0, 90.0), 0, radius=20.0)
    hud.images = IMAGES[step >= 18]


IMAGES = [np.full((1, 2, 2, 4), value, np.uint8) for value in (90, 200)]


def board_pictures(settings: RenderSettings, seen: View) -> list[np.ndarray]:
    """Draw a moving ball under a changing display, one page of another painter and one other view in between."""
    world, pictures = make_world(), []
    with create_surface("egl", SIZE) as surface:
        steady, page = Renderer(surface, world, settings), PageSurface(surface)
        for step in range(30):
            if not 4 < step < 8:
                world.find("ball").set_position((0.6 * np.sin(0.3 * step), 1.5, 0.3))
            world.update()
            lay_board(steady.hud, step)
            if step == 23:
                page.draw()
            steady.draw([seen if step != 26 else view(0.1)])
            pictures.append(read_pixels(surface))
        page.release()
    return pictures


SEEN = {"all": view(), "within": replace(view(), rectangle=(20, 10, 290, 180)), "bare": replace(view(), screen=-1)}


@pytest.mark.parametrize("seen", SEEN.values(), ids=SEEN)
@pytest.mark.parametrize(
    "settings",
    [PLAIN, replace(PLAIN, msaa=4), replace(PLAIN, scale=0.5), replace(PLAIN, fxaa=True), replace(PLAIN, bloom=0.5)],
    ids=["plain", "samples", "small", "filtered", "bloom"],
)
def test_a_display_drawn_where_it_or_the_picture_changed_is_the_one_drawn_as_a_whole(settings, seen, monkeypatch):
    drawn, before = [], KeptBoard.draw

    def draw(board, *what):
        drawn.append(before(board, *what))
        return drawn[-1]

    monkeypatch.setattr(KeptBoard, "draw", draw)
    in_parts = board_pictures(settings, seen)
    in_places = [draws for draws in drawn if draws is not None]
    assert len(in_places) == 0 if seen.screen < 0 else len(in_places) >= (0 if settings.bloom else 12)
    monkeypatch.setattr(KeptBoard, "draw", lambda *_: None)
    for step, (ours, whole) in enumerate(zip(in_parts, board_pictures(settings, seen), strict=True)):
        assert np.array_equal(ours, whole), step


def test_of_surfaces_at_equal_depths_a_part_shows_the_one_that_the_whole_picture_shows(drawn_parts):
    """The first one drawn is that of the state with the nearest item, which is not in the part."""
    world = World()
    world.set_material(Material("red", base_colour=(0.8, 0.1, 0.1, 1.0)))
    world.set_material(Material("blue", base_colour=(0.1, 0.1, 0.8, 1.0)))
    world.meshes |= {"box": box(0.3, 0.5, 0.3), "ball": icosphere(0.12, 2)}
    places = {"near": (-0.9, 0.3, 2.0), "red": (0.9, 0.3, 0.0), "blue": (0.9, 0.3, 0.0)}
    for name, place in places.items():
        world.root.create_child(name, place).create_entity("box", "blue" if name == "blue" else "red")
    world.root.create_child("ball", (0.9, 0.3, 0.6)).create_entity("ball", "blue")
    world.update()
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, replace(PLAIN, shadow_size=0))
        for step in range(6):
            world.find("ball").set_position((0.9 + 0.02 * step, 0.3, 0.6))
            world.update()
            steady.draw([view()])
            ours = read_pixels(surface)
            assert np.array_equal(ours, draw_whole(steady, view())), step
    assert len(drawn_parts) >= 3


def add_live_pictures(world: World) -> None:
    """A mirror behind the boxes, a screen that is seen in it too, and an inset."""
    facing = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    world.meshes |= {"glass": plane(4.0, 1.6), "tube": plane(0.8, 0.5)}
    for name, mesh, place in (("mirror", "glass", (0.0, 0.7, -1.7)), ("screen", "tube", (1.5, 0.5, -1.2))):
        node = world.root.create_child(name, place, facing)
        node.create_entity(mesh, "default").subentities[0].casts_shadow = False
    world.find("screen").set_orientation((0.0, math.sqrt(0.5), -math.sqrt(0.5), 0.0))
    world.root.create_child("eye", (-2.0, 1.5, 0.0)).create_camera(0.8, 0.05, 20.0)
    world.find("eye").look_at((0.0, 0.3, 0.3))
    show_mirror(world, world.find("mirror"), Mirror())
    show_screen(world, world.find("screen"), Screen(camera="eye", size=(96, 64)))
    world.insets["eye"] = Inset(camera="eye", rectangle=(0.7, 0.7, 0.25, 0.25))
    world.update()


@pytest.mark.parametrize("sparse", [False, True], ids=["every frame", "sparse"])
@pytest.mark.parametrize("settings", [PLAIN, replace(PLAIN, msaa=4, mirror_scale=0.5)], ids=["plain", "samples"])
def test_mirrors_screens_and_insets_drawn_in_parts_are_those_drawn_as_a_whole(settings, sparse, drawn_parts):
    world = make_world()
    add_live_pictures(world)
    if settings.msaa:
        world.insets.clear()  # drawn over kept samples an inset would have another border
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, settings, sparse=sparse)
        for step in range(22):
            world.find("ball").set_position((0.6 * np.sin(0.3 * step), 0.9, 0.3))
            CHANGES.get(step, lambda world: None)(world)
            if step >= 18:
                world.find("mirror").set_position((0.05 * (step - 17), 0.7, -1.7))
            world.effects.time = step / 60.0
            world.update()
            steady.draw([view()])
            ours = read_pixels(surface)
            assert np.array_equal(ours, draw_whole(steady, view())), step
        assert surface.ctx.error == "GL_NO_ERROR"
    assert len(drawn_parts) >= 18, "not only of the view"


def test_what_is_drawn_without_depth_is_added_once_beside_what_changed(monkeypatch):
    world, clipped = make_world(), []
    world.techniques["glow"] = TechniqueSpec(passes=(PassSpec(depth="off", blend="add"),))
    world.set_material(Material("glow", "glow", (0.1, 0.1, 0.1, 1.0)))
    world.root.create_child("veil", (0.0, 0.4, 0.0)).create_entity("floor", "glow")
    before = WorldStage.draw_parts

    def draw_parts(stage, target, samples, scene, parts: list[ViewDraws]) -> int:
        clipped.extend(each.part.pieces != [each.part.rectangle] for each in parts if each.part)
        return before(stage, target, samples, scene, parts)

    monkeypatch.setattr(WorldStage, "draw_parts", draw_parts)
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, PLAIN)
        for step in range(6):
            world.find("ball").set_position((0.1 * step, 0.9, 0.3))
            world.update()
            steady.draw([view()])
        ours = read_pixels(surface)
        assert np.array_equal(ours, draw_whole(steady, view()))
    assert any(clipped), "there are pixels that are not drawn"


def test_what_is_translucent_across_two_parts_is_blended_once():
    world, chance = make_world(), np.random.default_rng(1)
    for number in range(12):
        dress(world, f"box{number}", "glass")
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, replace(PLAIN, msaa=2))
        for step in range(9):
            world.find("ball").set_position(chance.uniform((-1.0, 0.3, -1.0), (1.0, 0.9, 1.0)))
            world.update()
            steady.draw([view()])
            ours = read_pixels(surface)
            assert np.array_equal(ours, draw_whole(steady, view())), step


def test_where_nothing_moves_nothing_is_drawn():
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, replace(PLAIN, msaa=4))
        pictures = []
        for _ in range(6):
            world.update()
            stats = renderer.draw([view()])
            pictures.append(read_pixels(surface))
        assert (stats.triangles, stats.draws) == (0, 0)
        assert all(np.array_equal(pictures[0], each) for each in pictures)


@pytest.mark.parametrize(
    "settings",
    [
        replace(PLAIN, msaa=4, ambient_occlusion=1.0, ambient_radius=0.4),
        replace(PLAIN, ambient_occlusion=1.0, bloom=0.5, fxaa=True),
        replace(PLAIN, bloom=0.5, scale=0.5),
        replace(PLAIN, shadows="stencil_additive"),
        replace(PLAIN, shadows="stencil_modulative", fxaa=True),
    ],
    ids=["occlusion", "occlusion and bloom", "bloom, small", "volumes", "volumes, filtered"],
)
def test_what_reaches_beyond_a_change_is_drawn_as_a_whole_and_not_at_all_at_rest(settings, drawn_parts):
    world = make_world()
    reaches = settings.ambient_occlusion > 0.0 or settings.shadows.startswith("stencil")
    with create_surface("egl", SIZE) as surface:
        steady, moved = Renderer(surface, world, settings), np.zeros(0)
        for step in range(20):
            if step % 4 == 0:
                world.find("ball").set_position((0.05 * step, 0.9, 0.3))
            world.update()
            stats, ours = steady.draw([view()]), read_pixels(surface)
            if step % 4 == 0:
                assert not np.array_equal(ours, moved)
                moved = ours
            elif step > 4:
                assert (stats.triangles, stats.draws) == (0, 0), step
            apart = np.abs(ours.astype(int) - moved)
            assert apart.max() <= (3 if settings.scale < 1.0 else 0), step  # scaled to be kept it is rounded otherwise
    assert reaches != any(drawn_parts)


def test_an_eye_that_moves_keeps_nothing(drawn_parts):
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        for step in range(40):
            world.update()
            renderer.draw([view(0.01 * max(0, step - 4))])
        assert len(drawn_parts) == 2
        assert not renderer._picture.keep


def _apart(a: Rect, b: Rect) -> bool:
    beside = a[0] + a[2] <= b[0] or b[0] + b[2] <= a[0]
    return beside or a[1] + a[3] <= b[1] or b[1] + b[3] <= a[1]


def test_bounds_hold_what_is_projected_and_rectangles_hold_the_bounds():
    chance, eye = np.random.default_rng(3), view()
    centres, axes = chance.uniform(-2.0, 2.0, (300, 3)), chance.normal(0.0, 0.15, (300, 3, 3))
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    corners = centres[:, None] + signs @ axes.transpose(0, 2, 1)
    bounds = screen_bounds(eye, corners, np.full(300, 0.05))
    inside = np.einsum("nij,nkj->nki", axes, chance.uniform(-1.0, 1.0, (300, 50, 3))) + centres[:, None]
    around = chance.normal(size=(300, 50, 3))
    inside += 0.05 * around / np.linalg.norm(around, axis=2, keepdims=True)
    clip = np.concatenate([inside, np.ones((300, 50, 1))], axis=2) @ eye.clip_from_world.T
    assert (clip[..., 3] > eye.near).all()
    shares = 0.5 + 0.5 * clip[..., :2] / clip[..., 3:]
    assert (shares >= bounds[:, None, ::2] - 1e-9).all() and (shares <= bounds[:, None, 1::2] + 1e-9).all()
    changed = cover_of(bounds[:20], SIZE)
    parts = [piece for part in changed for piece in part.pieces]
    assert 2 <= len(changed) <= 4
    for (right, above, _, _), (x, y, wide, high) in itertools.combinations([part.rectangle for part in changed], 2):
        assert x + wide <= right or y + high <= above
    for part in changed:
        x, y, wide, high = part.rectangle
        assert all(x <= a and y <= b and a + c <= x + wide and b + d <= y + high for a, b, c, d in part.pieces)
    pixels = np.clip(bounds[:20], 0.0, 1.0) * [SIZE[0], SIZE[0], SIZE[1], SIZE[1]]
    for left, right, bottom, top in pixels:
        for x, y in chance.uniform((left, bottom), (right, top), (50, 2)) if left < right and bottom < top else ():
            assert sum(px <= x <= px + wide and py <= y <= py + high for px, py, wide, high in parts) >= 1
    assert all(a == b or _apart(a, b) for a in parts for b in parts)
    assert cover_of(bounds[:0], SIZE) == []


def test_what_reaches_behind_the_eye_is_seen_everywhere_it_may_be():
    eye = view()
    back = eye.world_from_eye[:3, 2]
    here = eye.world_from_eye[:3, 3]
    through = np.stack([here - 1.0 * back, here + 1.0 * back + [0.1, 0.0, 0.0]])[None]
    left, right, _, _ = screen_bounds(eye, through, np.zeros(1))[0]
    assert left <= 0.5 and right >= 1.0
    assert len(screen_bounds(eye, through + 3.0 * back, np.zeros(1))) == 0
