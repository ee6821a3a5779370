"""Mirrors, screens and insets: what they show is what the same view shows drawn on its own."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View, tilt_near_plane
from mimics_app.rendering.visual.view_matrices import compose_clip_from_view, compose_look_at
from mimics_app.world.components.pictures import Inset, Mirror, Screen
from mimics_app.world.content.live_pictures import show_mirror, show_screen
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_world
from tests.golden.material_world import make_room

SIZE = (192, 108)
PLAIN = RenderSettings(msaa=0, shadow_size=256, fog_density=0.0)
UPRIGHT = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
"""A sheet in the xz plane that faces +y, turned to face +z."""
AWAY = (-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
"""The same turned to face -z."""
U1 = NDArray[np.uint8]


def make_mirrored_room(width: float = 6.0, height: float = 4.0) -> World:
    """The room with a mirror behind the eye's usual place, facing the bodies."""
    world = make_room()
    world.meshes["mirror"] = plane(width, height)
    node = world.root.create_child("mirror", (0.0, 1.0, 2.0), AWAY)
    node.create_entity("mirror", "default").subentities[0].casts_shadow = False
    show_mirror(world, node, Mirror())
    world.update()
    return world


def eye_before_the_mirror(rectangle: tuple[int, int, int, int] = (0, 0, *SIZE), x: float = 0.3) -> View:
    """Looks at the mirror from between it and the bodies, slightly aslant; off-axis."""
    pose = compose_look_at((x, 1.2, 1.0), (x + 0.1, 1.0, 2.0))
    return View(pose, (-0.55, 0.45, -0.3, 0.28), rectangle)


def reflected(view: View, z: float) -> View:
    """The eye behind a mirror in the plane z = `z`, computed by hand: what is at x, y stays, z is turned over.

    Its picture is turned over too, so that it is to be flipped; the mirror itself is not in its way.
    """
    pose = np.diag([1.0, 1.0, -1.0, 1.0]) @ view.world_from_eye @ np.diag([-1.0, 1.0, 1.0, 1.0])
    pose[2, 3] += 2.0 * z
    left, right, bottom, top = view.tangents
    return View(pose, (-right, -left, bottom, top), view.rectangle, near=0.99, far=view.far)


def draw(world: World, views: list[View], settings: RenderSettings = PLAIN, size=SIZE, backend: str = "egl") -> U1:
    with create_surface(backend, size) as surface:
        return draw_world(surface, world, views, settings)[..., :3]


@pytest.mark.parametrize("changes", [{}, {"msaa": 4}, {"scale": 0.5}, {"bloom": 1e-9}])
def test_a_mirror_shows_the_picture_of_the_reflected_eye(changes, assert_same):
    """The mirror fills the picture; 1/255 because depth is counted otherwise, and rounding differs at edges.

    Scaling rounds to one side, which is another one in the mirror.
    """
    view, settings = eye_before_the_mirror(), replace(PLAIN, **changes)
    ours = draw(make_mirrored_room(), [view], settings)
    theirs = draw(make_room(), [reflected(view, 2.0)], settings)[:, ::-1]
    assert np.ptp(ours) > 150, "there is something to be seen"
    assert_same(ours, theirs, "mirror against the reflected eye", level=3 if "scale" in changes else 1, wanted=0.998)


def test_a_mirror_of_half_the_resolution_is_a_softer_one():
    """As the governor leaves it: the same but for edges."""
    view = eye_before_the_mirror()
    sharp, soft = (draw(make_mirrored_room(), [view], replace(PLAIN, mirror_scale=s)).astype(int) for s in (1.0, 0.5))
    away = np.abs(sharp - soft)
    assert 0.3 < away.mean() < 9.0
    assert np.median(away) <= 1.0


def test_culling_in_a_mirror_loses_no_pixel():
    """A hundred boxes, most of them behind a wall that stands before the mirror: hidden ones are left out exactly."""
    world = make_mirrored_room()
    world.meshes |= {"crate": box(0.2, 0.2, 0.2), "screen": box(5.0, 2.0, 0.2)}
    world.root.create_child("screen", (0.0, 1.0, -1.6)).create_entity("screen", "matt")
    world.root.create_child("cut", (1.6, 0.6, 2.0)).create_entity("screen", "matt")
    for k in range(100):
        world.root.create_child("", (-2.0 + 0.4 * (k % 10), 0.2, -2.0 - 0.3 * (k // 10))).create_entity(
            "crate", "shiny"
        )
    world.update()
    pictures, hidden = {}, {}
    for occlusion in ("off", "all"):
        with create_surface("egl", SIZE) as surface:
            renderer = Renderer(surface, world, replace(PLAIN, shadow_size=0, occlusion=occlusion))
            for _ in range(2):
                hidden[occlusion] = renderer.draw([eye_before_the_mirror()]).hidden
            pictures[occlusion] = read_pixels(surface)
            renderer.release()
    assert np.array_equal(pictures["off"], pictures["all"])
    assert (hidden["off"], hidden["all"] > 30) == (0, True)


def test_nothing_behind_a_mirror_is_seen_in_it():
    """A wall of the same size right behind the mirror, between it and the reflected eye, changes no pixel."""
    world = make_mirrored_room()
    before = draw(world, [eye_before_the_mirror()])
    world.root.create_child("behind", (0.0, 1.0, 2.3), AWAY).create_entity("mirror", "bricks").subentities[
        0
    ].casts_shadow = False
    world.update()
    assert np.array_equal(draw(world, [eye_before_the_mirror()]), before)


def test_a_small_mirror_shows_the_part_of_the_large_one(assert_same):
    """What is drawn is cut to what the mirror covers: no pixel moves by that."""
    view = eye_before_the_mirror()
    small, large = draw(make_mirrored_room(0.5, 0.4), [view]), draw(make_mirrored_room(), [view])
    assert_same(small[45:65, 145:185], large[45:65, 145:185], "the middle of a small mirror", level=1)
    assert not np.array_equal(small, large)


def test_each_eye_has_its_own_reflection():
    """Two views side by side show what each shows alone, to the last bit."""
    half = (SIZE[0] // 2, SIZE[1])
    world = make_mirrored_room()
    views = [eye_before_the_mirror((k * half[0], 0, *half), x) for k, x in enumerate((0.3, 0.6))]
    both = draw(world, views)
    for k, view in enumerate(views):
        alone = draw(make_mirrored_room(), [replace(view, rectangle=(0, 0, *half))], size=half)
        assert np.array_equal(both[:, k * half[0] : (k + 1) * half[0]], alone)
    assert not np.array_equal(both[:, : half[0]], both[:, half[0] :])


def test_a_mirror_in_a_mirror_shows_the_sky_and_ends_there():
    """Two mirrors face each other: the picture is finished, and what is in the second one has no bodies in it."""
    world = make_mirrored_room()
    node = world.root.create_child("opposite", (0.0, 1.0, -1.0), UPRIGHT)
    node.create_entity("mirror", "default").subentities[0].casts_shadow = False
    show_mirror(world, node, Mirror())
    world.update()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        renderer.draw([eye_before_the_mirror()])
        pictures = [read_pixels(surface)]
        renderer.draw([eye_before_the_mirror()])
        pictures.append(read_pixels(surface))
        renderer.release()
    assert np.array_equal(*pictures), "nothing goes on from frame to frame"


def test_a_mirror_seen_from_behind_or_not_at_all_is_not_drawn():
    world = make_mirrored_room()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        away = View(compose_look_at((0.3, 1.2, 1.0), (0.3, 0.5, -1.0)), (-0.5, 0.5, -0.3, 0.3), (0, 0, *SIZE))
        behind = View(compose_look_at((0.3, 1.2, 4.0), (0.3, 0.9, 0.0)), (-0.5, 0.5, -0.3, 0.3), (0, 0, *SIZE))
        for _ in range(2):
            draws = [renderer.draw([view]).draws for view in (away, behind, eye_before_the_mirror())]
        bare = Renderer(surface, make_room(), PLAIN)
        for _ in range(2):
            without = [bare.draw([view]).draws for view in (away, behind)]
        assert draws[0] == without[0]
        assert draws[1] == without[1] + 1, "the sheet itself is in the way and is tested"
        assert draws[2] > 5
        bare.release()
        renderer.release()


def test_a_tilted_near_plane_moves_no_point_and_cuts_off_nothing_before_it():
    """Random planes before random off-axis eyes: x and y stay; depth is -1 on the plane, below 1 before it."""
    rng = np.random.default_rng(7)
    for _ in range(200):
        left, bottom = -rng.uniform(0.1, 1.5, 2)
        right, top = rng.uniform(0.1, 1.5, 2)
        clip = compose_clip_from_view((left, right, bottom, top), 0.05, 100.0)
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        plane = np.array([*normal, -rng.uniform(0.2, 3.0)])
        tilted = tilt_near_plane(clip, plane)
        depth = rng.uniform(0.05, 99.0, 400)
        across = rng.uniform([left, bottom], [right, top], (400, 2)) * depth[:, None]
        points = np.c_[across, -depth, np.ones(400)]
        before = points @ plane >= 0.0
        if not before.any():
            continue  # a mirror that is seen has something before it
        shown = points @ tilted.T
        assert np.allclose(shown[:, [0, 1, 3]], (points @ clip.T)[:, [0, 1, 3]])
        ndc = shown[:, 2] / shown[:, 3]
        assert (ndc[before] >= -1.0 - 1e-9).all() and (ndc[before] <= 1.0 + 1e-9).all()
        assert (ndc[~before] < -1.0 + 1e-9).all()


def add_second_camera(world: World) -> None:
    eye = world.root.create_child("second", (-1.2, 1.6, 2.2))
    eye.look_at((0.2, 0.3, 0.0))
    eye.create_camera(0.7, 0.05, 60.0)
    world.update()


@pytest.mark.parametrize(("msaa", "mirrored"), [(0, False), (4, False), (0, True)])
def test_an_inset_is_the_picture_drawn_by_itself(msaa, mirrored):
    """0 pixels differ; its frame and the rest of the picture are what they were."""
    settings = replace(PLAIN, msaa=msaa)
    world = make_room()
    add_second_camera(world)
    main = desktop_views(world.cameras[0], SIZE)
    without = draw(world, main, settings)
    world.insets["second"] = Inset(camera="second", rectangle=(0.5, 0.6, 0.4, 0.35), mirrored=mirrored, border=10.0)
    picture = draw(world, main, settings)
    x, y, wide, high = 96, round(0.6 * 108), round(0.4 * 192), round(0.35 * 108)
    top = SIZE[1] - y - high
    inset = picture[top : top + high, x : x + wide]
    del world.insets["second"]
    alone = draw(world, desktop_views(world.find("second").camera, (wide, high)), settings, (wide, high))
    assert np.array_equal(inset[:, ::-1] if mirrored else inset, alone)
    margin = 3  # 10 lines of 720 are 1.5 pixels here
    outside = np.ones(SIZE[::-1], bool)
    outside[top - margin : top + high + margin, x - margin : x + wide + margin] = False
    assert np.array_equal(picture[outside], without[outside])
    assert (picture[top - 1, x : x + wide] < 40).all(), "a dark frame"


def test_an_inset_is_sharp_over_a_picture_drawn_smaller():
    world = make_room()
    add_second_camera(world)
    main = desktop_views(world.cameras[0], SIZE)
    world.insets["second"] = Inset(camera="second", rectangle=(0.5, 0.5, 0.5, 0.5))
    full, half = (draw(world, main, replace(PLAIN, scale=scale))[:54, 96:] for scale in (1.0, 0.5))
    assert np.array_equal(full, half)


@pytest.mark.parametrize(("wanted", "depth"), [(3.2, 3.2), (0.8, 1.28)])
def test_two_eyes_see_an_inset_at_the_depth_of_the_figures(wanted, depth):
    """Eyes 64 mm apart: it lies 0.064 / depth of a tangent farther left for the right eye; never too near for two."""
    world = make_room()
    add_second_camera(world)
    half = (SIZE[0] // 2, SIZE[1])
    pose = desktop_views(world.cameras[0], half)[0].world_from_eye
    views = []
    for k, side in enumerate((-0.032, 0.032)):
        eye = pose.copy()
        eye[:3, 3] += side * pose[:3, 0]
        views.append(View(eye, (-0.4, 0.4, -0.45, 0.45), (k * half[0], 0, *half)))
    world.insets["second"] = Inset(camera="second", rectangle=(0.3, 0.5, 0.4, 0.3), border=20.0)
    picture = draw(world, views, replace(PLAIN, hud_depth=wanted))
    row = picture[SIZE[1] - round(0.65 * SIZE[1])].max(axis=-1) < 25
    left, right = (int(np.argmax(row[k * half[0] : (k + 1) * half[0]])) for k in range(2))
    assert left - right == pytest.approx(0.064 / depth / 0.8 * half[0], abs=1.0)


def make_screen_room(shines: bool = True, every: int = 1) -> World:
    world = make_room()
    add_second_camera(world)
    world.meshes["screen"] = plane(1.6, 0.9)
    node = world.root.create_child("screen", (0.0, 3.2, 1.0), UPRIGHT)
    node.create_entity("screen", "default").subentities[0].casts_shadow = False
    shows = "light" if shines else "paint"
    show_screen(world, node, Screen(camera="second", size=(192, 108), every=every, shows=shows))
    world.update()
    return world


def screen_view() -> View:
    """The screen fills the picture exactly."""
    return View(compose_look_at((0.0, 3.2, 2.0), (0.0, 3.2, 1.0)), (-0.8, 0.8, -0.45, 0.45), (0, 0, *SIZE))


def test_a_screen_shows_what_its_camera_sees_the_right_way_up(assert_same):
    """Light is stored without a tone map, clipped at white, in 8 bits: two steps of them, but in what dazzles."""
    world, bare = make_screen_room(), make_room()
    for each in (world, bare):
        each.find("body3").visible = False  # glass is mixed in display values, which are not those of the light kept
        each.update()
    ours, alone = draw(world, [screen_view()]), draw(bare, desktop_views(world.find("second").camera, SIZE))
    assert np.ptp(ours) > 150
    assert_same(ours, alone, "screen against its camera's own picture", level=3, wanted=0.995)


def test_a_screen_that_its_camera_sees_shows_the_picture_before():
    """Feedback goes one frame deeper with each frame, and settles where it is too small to see."""
    world = make_screen_room()
    world.find("second").look_at((0.0, 3.2, 1.0))
    world.update()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        pictures = []
        for _ in range(9):
            renderer.draw([screen_view()])
            assert surface.ctx.error == "GL_NO_ERROR"
            pictures.append(read_pixels(surface)[..., :3].astype(int))
        renderer.release()
    changed = [int((np.abs(a - b) > 2).any(axis=-1).sum()) for a, b in itertools.pairwise(pictures)]
    assert changed[0] > 100
    assert changed == sorted(changed, reverse=True)
    assert changed[-1] < 0.1 * changed[0]


def test_a_screen_is_drawn_when_it_is_seen_and_as_often_as_it_asks():
    world = make_screen_room(every=3)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        away = View(compose_look_at((0.0, 3.2, 2.0), (0.0, 3.2, 3.0)), (-0.8, 0.8, -0.45, 0.45), (0, 0, *SIZE))
        renderer.draw([away])
        assert renderer.draw([away]).triangles <= 2, "the floor"
        (picture,) = renderer._pictures.pictures.values()
        textures = [picture.texture]
        for _ in range(9):
            renderer.draw([screen_view()])
            textures.append(picture.texture)
        renderer.release()
    # Seen for the first time it is drawn at once; from then on in frames 3, 6, 9 of all.
    drawn = [before is not after for before, after in itertools.pairwise(textures)]
    assert drawn == [True, False, False, True, False, False, True, False, False]


def test_pictures_come_and_go_with_what_shows_them():
    """A mirror taken away is the plain sheet again; put back, it mirrors as before; nothing of the driver's is lost."""
    world, view = make_mirrored_room(), eye_before_the_mirror()
    node = world.find("mirror")
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)

        def picture() -> U1:
            renderer.draw([view])
            assert surface.ctx.error == "GL_NO_ERROR"
            return read_pixels(surface)

        mirrored = picture()
        del world.mirrors["mirror"]
        assert not np.array_equal(picture(), mirrored), "it still wears the picture's place, which has none any more"
        node.entity.set_material("default")
        world.update()
        assert not np.array_equal(picture(), mirrored)
        show_mirror(world, node, Mirror())
        world.update()
        assert np.array_equal(picture(), mirrored)
        renderer.world = make_room()
        picture()
        renderer.world = world
        assert np.array_equal(picture(), mirrored)
        renderer.release()
        assert surface.ctx.error == "GL_NO_ERROR"


def test_a_mirror_that_is_not_flat_is_reported_once_and_shows_the_sky():
    world = make_mirrored_room()
    world.replace_mesh("mirror", sphere(0.4, 16))
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        for _ in range(2):
            renderer.draw([eye_before_the_mirror()])
        reported = [str(issue) for issue in renderer.take_issues()]
        renderer.draw([eye_before_the_mirror()])
        assert renderer.take_issues() == []
        renderer.release()
    assert len(reported) == 1
    assert "not flat" in reported[0]


def test_pictures_in_pictures_are_the_same_under_osmesa():
    try:
        create_surface("osmesa", (8, 8)).close()
    except DeviceError as error:
        pytest.skip(str(error))
    here, there = (draw(make_mirrored_room(), [eye_before_the_mirror()], backend=name) for name in ("egl", "osmesa"))
    assert (np.abs(here.astype(int) - there) <= 1).mean() > 0.999


def test_stencil_shadows_are_in_the_mirror_too():
    kinds = ("texture_additive", "stencil_additive")
    ours, theirs = (
        draw(make_mirrored_room(), [eye_before_the_mirror()], replace(PLAIN, shadows=kind, shadow_size=1024))
        for kind in kinds
    )
    bare = draw(make_mirrored_room(), [eye_before_the_mirror()], replace(PLAIN, shadow_size=0))
    assert (np.abs(ours.astype(int) - theirs) <= 12).mean() > 0.97
    assert (np.abs(bare.astype(int) - theirs) > 12).mean() > 0.02
