"""The sun's shadow: its edge against the ray, translucent casters, no self-shadow, and a map that does not crawl."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.rendering.visual.lighting import fit_shadow_frustum
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen

SIZE = (400, 300)
HALF = 0.5
SETTINGS = RenderSettings(msaa=0, shadow_size=512, tone_map="none", fog_density=0.0)


def make_world(towards_sun: tuple[float, float, float], technique: str = "lit") -> World:
    """A white floor, and a thin square plate 0.3 m above it, whose right edge lies at x = 0."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("floor", base_colour=(0.9, 0.9, 0.9, 1.0), roughness=1.0))
    world.set_material(Material("plate", technique, (0.0, 0.0, 0.0, 0.0)))
    world.meshes["floor"] = plane(20.0, 20.0)
    world.meshes["plate"] = box(0.3, 0.001, 0.3)
    world.root.create_child("floor").create_entity("floor", "floor").subentities[0].casts_shadow = False
    world.root.create_child("plate", (-0.15, 0.3, 0.0)).create_entity("plate", "plate")
    sun = world.root.create_child("sun", towards_sun)
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0, casts_shadow=1)
    world.update()
    return world


def top_view() -> View:
    """Straight down from 2 m: the floor's x runs over the picture from -HALF to HALF."""
    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    side = HALF / 2.0
    return View(pose, (-side, side, -0.75 * side, 0.75 * side), (0, 0, *SIZE))


def floor_light(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Linear light along the picture's middle row, 1 at its right end, where the sun is whole."""
    code = picture[150, :, 0] / 255.0
    linear = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    return linear / linear[-1]


@pytest.mark.parametrize("slope", [0.45, 0.3, -0.3, -0.45])
def test_the_edge_lies_where_the_ray_meets_the_floor(slope):
    """The ray past the plate's edge at x0 meets the floor at x0 - 0.3 slope; wanted within one texel of the map.

    To the right the plate's right edge is seen, x0 = 0, to the left its left one, x0 = -0.3: a bias that moves
    shadows would pass one of them, one that swells them neither.
    """
    towards = np.array([slope, 1.0, 0.0]) / np.hypot(slope, 1.0)
    light = floor_light(draw_offscreen(make_world((4.0 * slope, 4.0, 0.0)), [top_view()], SIZE, SETTINGS))
    centre, radius = np.array([[-0.15, 0.3, 0.0]]), np.array([np.hypot(0.15, 0.15)])
    frustum = fit_shadow_frustum(towards, centre, radius, 512)
    # On the floor a texel is longer by the sun's slant.
    texel = frustum.texel / towards[1]
    x = -HALF + (np.arange(SIZE[0]) + 0.5) / SIZE[0] * 2.0 * HALF
    # The outermost crossing of one half on the side the shadow falls to, interpolated between pixels.
    step = -1 if slope > 0.0 else 1
    last = np.flatnonzero(light < 0.5)[0 if slope > 0.0 else -1]
    share = (0.5 - light[last]) / (light[last + step] - light[last])
    edge = x[last] + step * share * (x[1] - x[0])
    expected = (-0.3 if slope > 0.0 else 0.0) - 0.3 * slope
    assert edge == pytest.approx(expected, abs=texel + 0.5 * (x[1] - x[0]))


def test_a_translucent_plate_takes_a_quarter_without_a_pattern():
    light = floor_light(draw_offscreen(make_world((-1.8, 4.0, 0.0), "glass"), [top_view()], SIZE, SETTINGS))
    # From 10 px right of the plate's own edge to 5 px before its shadow's, at x = 0.3 * 0.45.
    shaded = light[210:249]
    # One code value of 255 at this brightness is 0.9 % of the light.
    assert shaded == pytest.approx(np.full(39, 0.75), abs=0.009)
    assert shaded.max() == shaded.min(), "the dither must not show"


@pytest.mark.parametrize("size", [256, 512, 2048])
def test_no_surface_shades_itself(size):
    """A ball turned to the sun: wherever the cosine is above 0.2 the light is as without a map."""
    world = make_world((1.0, 3.0, 2.0))
    world.set_material(Material("plate", "lit", (0.9, 0.9, 0.9, 1.0), roughness=1.0))
    world.replace_mesh("plate", sphere(0.25, 96))
    view = top_view()
    settings = RenderSettings(msaa=0, shadow_size=size, tone_map="none", fog_density=0.0)
    with_map = draw_offscreen(world, [view], SIZE, settings)
    without = draw_offscreen(world, [view], SIZE, RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0))
    # The ball covers a disc about its projected centre; inside 60 % of it all normals face this sun by 0.2 and more.
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    inside = np.hypot(columns - 200 + 0.15 / 1.7 * 2.0 / HALF * 200, rows - 150) < 0.6 * 0.25 / 1.7 * 2.0 / HALF * 200
    assert inside.sum() > 500
    assert np.abs(with_map[inside].astype(int) - without[inside]).max() <= 1


def test_the_map_moves_in_whole_texels():
    """A caster that moves a little keeps the map's raster: its centre moves by whole texels across the sun."""
    towards = np.array([0.3, 0.8, 0.2]) / np.linalg.norm([0.3, 0.8, 0.2])
    rng = np.random.default_rng(5)
    base = fit_shadow_frustum(towards, np.zeros((1, 3)), np.array([0.3]), 512)
    axes = base.clip_from_world[:2, :3] * (0.5 * 512 * base.texel)
    for _ in range(50):
        moved = fit_shadow_frustum(towards, rng.uniform(-0.2, 0.2, (1, 3)), np.array([0.3]), 512)
        assert moved.texel == base.texel
        steps = axes @ (moved.centre - base.centre) / base.texel
        assert np.abs(steps - np.round(steps)).max() < 1e-6


def test_the_map_holds_all_its_casters():
    rng = np.random.default_rng(6)
    for _ in range(50):
        centres, radii = rng.uniform(-2.0, 2.0, (7, 3)), rng.uniform(0.01, 0.8, 7)
        towards = rng.normal(size=3)
        towards /= np.linalg.norm(towards)
        frustum = fit_shadow_frustum(towards, centres, radii, 256)
        at = np.c_[centres, np.ones(7)] @ frustum.clip_from_world.T
        margin = radii * np.linalg.norm(frustum.clip_from_world[0, :3])
        assert (np.abs(at[:, :3]) + margin[:, None]).max() <= 1.0 + 1e-12


def test_nothing_casts_nothing():
    assert fit_shadow_frustum(np.array([0.0, 1.0, 0.0]), np.zeros((0, 3)), np.zeros(0), 512) is None
