"""Light from everywhere that near surfaces take off each other, against a corner whose answer is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.quality_steps import quality_steps
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_world
from tests.golden.material_world import make_room

SIZE = (192, 108)
RADIUS = 0.3
PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, tone_map="none")
SHADED = replace(PLAIN, ambient_occlusion=1.0, ambient_radius=RADIUS)
F8 = NDArray[np.float64]


def draw(world: World, settings: RenderSettings, views: list[View], size=SIZE, backend: str = "egl") -> F8:
    """Linear light of the picture's red, 0-1."""
    with create_surface(backend, size) as surface:
        picture = draw_world(surface, world, views, settings)
    share = picture[..., 0] / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def make_corner(wall: bool = True) -> World:
    """A floor, and a wall along x on it, under a sky of one colour: what is seen is the share of it that arrives."""
    world = World()
    world.environment = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3, 0.9)
    world.set_material(Material("white", "lit_matt", (1.0,) * 4, roughness=1.0))
    world.meshes |= {"floor": plane(6.0, 6.0), "wall": box(6.0, 3.0, 0.5), "ball": sphere(0.2, 32)}
    world.root.create_child("floor").create_entity("floor", "white")
    if wall:
        world.root.create_child("wall", (0.0, 1.5, -0.25)).create_entity("wall", "white")
    world.update()
    return world


def from_above(z: float = 0.35, half: float = 0.5) -> View:
    """Straight down on the floor: rows of the picture are lines along the wall."""
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = (1, 0, 0), (0, 0, -1), (0, 1, 0), (0.0, 2.0, z)
    high = half * SIZE[1] / SIZE[0]
    return View(pose, (-0.5 * half, 0.5 * half, -0.5 * high, 0.5 * high), (0, 0, *SIZE))


def aslant() -> View:
    """On wall and floor under half a right angle."""
    return View(np.array(compose_look_at((0.0, 1.5, 1.5), (0.0, 0.0, 0.0))), (-0.4, 0.4, -0.225, 0.225), (0, 0, *SIZE))


def test_a_corner_takes_half_and_nothing_beyond_the_radius():
    """At its foot an endless wall covers half of the sky, weighed by the cosine; beyond the radius nothing."""
    picture = draw(make_corner(), SHADED, [aslant()]) / 0.9
    middle = picture[:, 86:106].mean(axis=1)
    crease = int(np.argmin(middle))
    assert abs(crease - 54) <= 2
    assert middle[crease] == pytest.approx(0.5, abs=0.12)
    # A row is 1.5 sqrt(2) x 0.45 / 108 across the view, sqrt(2) as much along floor and wall.
    row = 1.5 * np.sqrt(2.0) * 0.45 / 108 * np.sqrt(2.0)
    far = int(np.ceil(1.15 * RADIUS / row)) + 4
    assert middle[54 + far :].min() > 0.985
    assert middle[: 54 - far].min() > 0.985
    near = middle[56 : 54 + far]
    assert (np.diff(near) > -0.02).all(), "lighter and lighter away from the wall"


def test_a_flat_floor_stays_as_light_as_it_is():
    """Seen straight and aslant; what slopes by rounding is not taken for a neighbour."""
    for view in (from_above(), aslant()):
        bare, shaded = (draw(make_corner(wall=False), settings, [view]) for settings in (PLAIN, SHADED))
        assert np.abs(bare - shaded).max() < 0.012


def test_what_is_far_behind_an_edge_is_not_darkened_by_it():
    """A box a metre before the wall: no dark rim round it, within two pixels of its edge or beyond."""
    world = make_corner()
    world.meshes["box"] = box(0.3, 0.3, 0.05)
    world.root.create_child("box", (0.0, 1.5, 1.0)).create_entity("box", "white")
    world.update()
    view = View(np.array(compose_look_at((0.0, 1.5, 2.2), (0.0, 1.5, 0.0))), (-0.35, 0.35, -0.2, 0.2), (0, 0, *SIZE))
    bare, shaded = (draw(world, settings, [view]) for settings in (PLAIN, SHADED))
    assert (np.abs(bare - shaded) > 0.03).mean() < 0.002


def test_only_light_from_everywhere_is_taken():
    """Under a sun alone, and no sky, nothing changes."""
    world = make_corner()
    world.environment = Sky((1.0,) * 3, (1.0,) * 3, (1.0,) * 3, 0.0)
    sun = world.root.create_child("sun", (0.3, 1.0, 0.7))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=0.8)
    world.update()
    assert np.array_equal(draw(world, PLAIN, [aslant()]), draw(world, SHADED, [aslant()]))


@pytest.mark.parametrize("msaa", [0, 4])
def test_views_beside_each_other_do_not_mix(msaa):
    settings = replace(SHADED, msaa=msaa)
    half = (SIZE[0] // 2, SIZE[1])
    poses = [compose_look_at((x, 1.5, 1.5), (0.0, 0.0, 0.0)) for x in (-0.3, 0.3)]
    views = [View(pose, (-0.4, 0.4, -0.4, 0.4), (k * half[0], 0, *half)) for k, pose in enumerate(poses)]
    both = draw(make_corner(), settings, views)
    for k, view in enumerate(views):
        alone = draw(make_corner(), settings, [replace(view, rectangle=(0, 0, *half))], half)
        assert np.array_equal(both[:, k * half[0] : (k + 1) * half[0]], alone)


def test_it_is_given_up_as_a_step_and_comes_back():
    world = make_room()
    views = desktop_views(world.cameras[0], SIZE)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, replace(PLAIN, ambient_occlusion=1.0))
        renderer.draw(views)
        full = surface.framebuffer.read()
        step = next(step for step in quality_steps(renderer) if step.name == "ambient occlusion")
        step.apply(1)
        without = renderer.draw(views).draws
        assert surface.framebuffer.read() != full
        bare = surface.framebuffer.read()
        step.apply(0)
        assert renderer.draw(views).draws > without + 2
        assert surface.framebuffer.read() == full
        assert surface.ctx.error == "GL_NO_ERROR"
        renderer.release()
        plain = Renderer(surface, world, PLAIN)
        plain.draw(views)
        assert surface.framebuffer.read() == bare, "given up is as if it had never been"
        plain.release()


def test_it_is_the_same_under_osmesa():
    try:
        create_surface("osmesa", (8, 8)).close()
    except DeviceError as error:
        pytest.skip(str(error))
    world = make_room()
    views = desktop_views(world.cameras[0], SIZE)
    here, there = (draw(world, replace(SHADED, msaa=4), views, backend=name) for name in ("egl", "osmesa"))
    assert (np.abs(here - there) < 0.01).mean() > 0.999


def test_figures_that_cannot_be_are_refused():
    for wrong in ({"ambient_occlusion": -1.0}, {"ambient_radius": 0.0}):
        with pytest.raises(UsageError, match="ambient"):
            RenderSettings(**wrong)
