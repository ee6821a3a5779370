"""Four kinds of shadows of the sun, cascades, and spot lights: each edge where the ray meets the floor."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.rendering.visual.drawing.shadow_casters import Casters
from mimics_app.rendering.visual.passes.volumes import VolumeSource, extrude
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.shadows.cascades import Cascades
from mimics_app.rendering.visual.shadows.shadow_maps import ShadowMap, lay_out
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World

F8 = NDArray[np.float64]
SIZE = (320, 180)
KINDS = ("texture_additive", "texture_modulative", "stencil_additive", "stencil_modulative")
PLAIN = RenderSettings(msaa=0, shadow_size=1024, tone_map="none", fog_density=0.0)
AROUND = 0.5 * (0.2 + 0.1 * 0.6)
"""Light from all around in `make_world`: half of the sky's and of a tenth of the sun's."""
PLATE_HEIGHT = 0.3


def make_world(slope: float, mesh: str = "plate") -> World:
    """A floor lit by sun and sky, and 0.3 m above it a thin plate from x = -0.3 to 0; the sun `slope` from above."""
    world = World()
    world.environment = Sky((0.2,) * 3, (0.2,) * 3, (0.2,) * 3, 0.5)
    for name, colour in (("floor", 0.8), ("body", 0.4)):
        world.set_material(Material(name, base_colour=(colour, colour, colour, 1.0), roughness=1.0))
    world.meshes |= {"floor": plane(20.0, 20.0), "plate": box(0.3, 0.001, 0.3), "sheet": plane(0.3, 0.3)}
    world.root.create_child("floor").create_entity("floor", "floor").subentities[0].casts_shadow = False
    world.root.create_child("plate", (-0.15, PLATE_HEIGHT, 0.0)).create_entity(mesh, "body")
    sun = world.root.create_child("sun", (4.0 * slope, 4.0, 0.0))
    sun.look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    sun.create_light("directional", intensity=0.6, casts_shadow=1)
    world.update()
    return world


def view_from(height: float = 2.0) -> View:
    """Straight down: the floor's x runs from -0.8 to 0.8 m over the picture."""
    pose = compose_look_at((0.0, height, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    side = 0.8 / height
    return View(pose, (-side, side, -side * 9 / 16, side * 9 / 16), (0, 0, *SIZE))


def draw(world: World, settings: RenderSettings, views: list[View] | None = None, backend: str = "egl") -> F8:
    """Red of the picture, 0-255."""
    with create_surface(backend, SIZE) as surface:
        renderer = Renderer(surface, world, settings)
        for _ in range(2):
            renderer.draw(views or [view_from()])
        assert surface.ctx.error == "GL_NO_ERROR"
        picture = read_pixels(surface)[..., 0].astype(float)
        renderer.release()
        assert surface.ctx.error == "GL_NO_ERROR"
    return picture


def edge_of(row: F8, slope: float) -> float:
    """Where a row of the picture is halfway between shadow and light, on the side the shadow falls to [m]."""
    half = 0.5 * (row.min() + row.max())
    step = -1 if slope > 0.0 else 1
    last = np.flatnonzero(row < half)[0 if slope > 0.0 else -1]
    share = (half - row[last]) / (row[last + step] - row[last])
    return float(-0.8 + (last + 0.5 + step * share) * 1.6 / SIZE[0])


@pytest.mark.parametrize("slope", [0.45, -0.45])
@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_has_its_edge_where_the_ray_meets_the_floor(kind, slope):
    """Within one texel of the map (1.2 mm at most), or half a pixel (2.5 mm) for volumes, which have no texels."""
    row = draw(make_world(slope), replace(PLAIN, shadows=kind))[90]
    expected = (-0.3 if slope > 0.0 else 0.0) - PLATE_HEIGHT * slope
    pixel = 1.6 / SIZE[0]
    texel = 0.5 * pixel if kind.startswith("stencil") else 2.0 * 0.25 / 1024 / np.cos(np.arctan(slope))
    assert edge_of(row, slope) == pytest.approx(expected, abs=texel + 0.5 * pixel)


def test_additive_kinds_agree_and_leave_the_sky_light():
    """In the shadow the floor has the light from all around alone: a tenth of the sun's is in it."""
    ambient = 255.0 * (1.055 * (0.8 * AROUND) ** (1.0 / 2.4) - 0.055)
    for kind in ("texture_additive", "stencil_additive"):
        row = draw(make_world(0.45), replace(PLAIN, shadows=kind))[90]
        # Between the shadow's left edge, -0.435, and the plate's, seen from above at -0.353: x = -0.40.
        assert row[80] == pytest.approx(ambient, abs=1.0), kind
        # The plate faces the sun: 0.4 (around + 0.6 cos), and nothing of its own shadow on it.
        lit = 0.4 * (AROUND + 0.6 * np.cos(np.arctan(0.45)))
        assert row[120] == pytest.approx(255.0 * (1.055 * lit ** (1.0 / 2.4) - 0.055), abs=1.0), kind


@pytest.mark.parametrize("kind", ["texture_modulative", "stencil_modulative"])
def test_modulative_kinds_leave_a_share_of_the_display_values(kind):
    row = draw(make_world(0.45), replace(PLAIN, shadows=kind, shadow_tone=0.4))[90]
    assert row[80] == pytest.approx(0.4 * row[10], abs=1.0)


@pytest.mark.parametrize("kind", KINDS)
def test_an_open_sheet_casts_from_either_side(kind):
    if kind == "texture_additive":
        world = make_world(0.45, "sheet")
        world.set_material(replace(world.materials["body"], double_sided=True))
    else:
        world = make_world(0.45, "sheet")
    world.find("plate").set_orientation((0.0, 0.0, 1.0, 0.0))
    world.update()
    row = draw(world, replace(PLAIN, shadows=kind))[90]
    assert row[80] < 0.8 * row[10]


@pytest.mark.parametrize("samples", [0, 4])
def test_the_eye_inside_a_volume_sees_the_same_shadow(samples):
    """Depth-fail counting: from under the plate all that is seen of the floor is in shadow."""
    world = make_world(0.0)
    pose = compose_look_at((-0.15, 0.1, 0.0), (-0.15, 0.0, 0.0), (0.0, 0.0, -1.0))
    view = View(pose, (-0.5, 0.5, -0.3, 0.3), (0, 0, *SIZE), near=0.01)
    picture = draw(world, replace(PLAIN, shadows="stencil_additive", msaa=samples), [view])
    ambient = 255.0 * (1.055 * (0.8 * AROUND) ** (1.0 / 2.4) - 0.055)
    assert np.abs(picture - ambient).max() <= 1.0


def test_stencil_shadows_are_the_same_under_osmesa():
    """In a process of its own would be the same; a context of each kind can live in one process in turn."""
    try:
        create_surface("osmesa", (8, 8)).close()
    except DeviceError as error:
        pytest.skip(str(error))
    for kind in ("stencil_additive", "stencil_modulative"):
        settings = replace(PLAIN, shadows=kind)
        here, there = (draw(make_world(0.45), settings, backend=backend) for backend in ("egl", "osmesa"))
        assert (np.abs(here - there) <= 1.0).mean() > 0.999


def test_volumes_are_closed_and_cover_what_is_behind():
    """Every directed edge of a volume has its counterpart, for closed and open meshes, from any side."""
    rng = np.random.default_rng(2)
    for mesh in (box(0.4, 0.2, 0.3), sphere(0.3, 16), plane(0.5, 0.4)):
        source = VolumeSource(mesh)
        for _ in range(5):
            towards = rng.normal(size=3)
            corners = extrude(source, towards / np.linalg.norm(towards))
            points, number = np.unique(np.round(corners, 5), axis=0, return_inverse=True)
            triangles = number.reshape(-1, 3)
            edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
            balance = np.zeros((len(points), len(points)), int)
            np.add.at(balance, (edges[:, 0], edges[:, 1]), 1)
            assert np.array_equal(balance, balance.T)


@pytest.mark.parametrize("slope", [0.45, -0.3])
def test_cascades_put_the_edge_where_one_map_does(slope):
    """The innermost of three boxes to 30 m holds it: 30 / 1.6 / 3.5^2 x 8/7 m about a point before the eye."""
    settings = replace(PLAIN, shadow_distance=30.0, cascades=3)
    row = draw(make_world(slope), settings)[90]
    radius = 30.0 / 1.6 / 3.5**2 * 8 / 7
    texel = 2.0 * radius / 512 / np.cos(np.arctan(slope))
    expected = (-0.3 if slope > 0.0 else 0.0) - PLATE_HEIGHT * slope
    assert edge_of(row, slope) == pytest.approx(expected, abs=texel + 0.8 / SIZE[0])


@pytest.mark.parametrize("cascades", [1, 2, 3, 4])
@pytest.mark.parametrize("slope", [0.45, -0.31])
def test_a_floor_far_below_the_inner_boxes_has_its_shadow(cascades, slope):
    """Straight down from 2 m the plate lies below the innermost of four boxes; it must not drop out of it."""
    settings = replace(PLAIN, shadow_size=4096, shadow_distance=30.0, cascades=cascades)
    row = draw(make_world(slope), settings)[SIZE[1] // 2]
    expected = (-0.3 if slope > 0.0 else 0.0) - slope * PLATE_HEIGHT
    # The outermost box has a radius of 30 / 1.6 x 8/7 m, one map 4096 texels, four of them 2048 each.
    texel = 2.0 * 30.0 / 1.6 * 8.0 / 7.0 / 4096 if cascades == 1 else 0.006
    assert edge_of(row, slope) == pytest.approx(expected, abs=1.1 * texel + 0.5 * 1.6 / SIZE[0])


def test_boxes_lie_in_one_another_and_hold_their_casters():
    rng = np.random.default_rng(4)
    towards = np.array([0.3, 0.8, 0.5]) / np.linalg.norm([0.3, 0.8, 0.5])
    centres, radii = rng.uniform(-60.0, 60.0, (300, 3)), rng.uniform(0.1, 4.0, 300)
    casters = Casters(np.arange(300, dtype=np.int32), centres, radii)
    view = View(compose_look_at((1.0, 2.0, 3.0), (5.0, 2.0, 0.0)), (-1.0, 1.0, -1.0, 1.0), (0, 0, 8, 8))
    maps = Cascades().fit(towards, [view], casters, 40.0, 3, 512)
    for inner, outer in itertools.pairwise(maps):
        assert outer.texel == pytest.approx(3.5 * inner.texel)
        assert set(inner.casters.items.tolist()) <= set(outer.casters.items.tolist())
    for shadow in maps:
        placed = np.c_[centres, np.ones(300)] @ shadow.clip_from_world.T
        margin = radii * np.linalg.norm(shadow.clip_from_world[2, :3])
        # What is inside the box across and not behind it must be drawn, and not be cut off towards the sun.
        across = np.abs(placed[:, :2]).max(axis=1) < 1.0
        needed = across & (placed[:, 2] - margin < 1.0)
        assert set(np.flatnonzero(needed)) <= set(shadow.casters.items.tolist())
        assert (placed[needed, 2] - margin[needed]).min(initial=0.0) >= -1.0 - 1e-9
    eye = np.array([1.0, 2.0, 3.0, 1.0])
    assert all(np.abs(shadow.clip_from_world @ eye)[:2].max() < 1.0 for shadow in maps)


def test_a_walk_moves_the_boxes_in_whole_texels():
    towards = np.array([0.3, 0.8, 0.5]) / np.linalg.norm([0.3, 0.8, 0.5])
    casters = Casters(np.zeros(1, np.int32), np.zeros((1, 3)), np.ones(1))
    fixed = np.array([0.2, 0.1, -0.4, 1.0])
    places = []
    for step in range(20):
        eye = (0.037 * step, 1.7, 0.1 * step)
        view = View(compose_look_at(eye, (eye[0] + 3.0, 1.5, eye[2] - 1.0)), (-1.0, 1.0, -1.0, 1.0), (0, 0, 8, 8))
        shadow = Cascades().fit(towards, [view], casters, 20.0, 2, 256)[0]
        places.append((shadow.clip_from_world @ fixed)[:2] * 128)
    moved = np.diff(np.array(places), axis=0)
    assert np.abs(moved - np.round(moved)).max() < 1e-6
    assert np.abs(moved).max() >= 1.0


def test_of_the_boxes_at_most_one_moves_in_a_frame_and_none_stays_behind():
    """A walk at 1.4 m/s that looks about at 90 degrees a second; and a leap, after which all must be elsewhere."""
    towards = np.array([0.3, 0.8, 0.5]) / np.linalg.norm([0.3, 0.8, 0.5])
    casters = Casters(np.zeros(1, np.int32), np.zeros((1, 3)), np.ones(1))

    def fit(place: float, yaw: float, cascades: Cascades) -> list[ShadowMap]:
        eye = np.array([0.0, 1.7, -place])
        world_from_eye = compose_look_at(eye, eye + np.array([np.sin(yaw), 0.0, -np.cos(yaw)]))
        view = View(world_from_eye, (-1.0, 1.0, -1.0, 1.0), (0, 0, 8, 8))
        return cascades.fit(towards, [view], casters, 90.0, 3, 512)

    def moved(now: list[ShadowMap], before: list[ShadowMap]) -> int:
        pairs = zip(now, before, strict=True)
        return sum(not np.array_equal(a.clip_from_world, b.clip_from_world) for a, b in pairs)

    walking = Cascades()
    maps, moves = fit(0.0, 0.0, walking), []
    for frame in range(1, 200):
        place, yaw = 1.4 / 60.0 * frame, np.sin(frame * np.pi / 120.0)
        before, maps = maps, fit(place, yaw, walking)
        moves.append(moved(maps, before))
        for kept, fresh in zip(maps, fit(place, yaw, Cascades()), strict=True):
            off = (kept.clip_from_world @ [*fresh.origin, 1.0])[:2]
            assert np.abs(off).max() <= 0.25
    assert max(moves) == 1
    assert 10 < sum(moves) < 100
    assert moved(fit(500.0, 0.0, walking), maps) == 3


@pytest.mark.parametrize(("lamp_x", "side", "expected"), [(-0.15, -1, 0.05), (0.0, 0, -0.4)])
def test_a_spot_light_casts_a_shadow_of_its_own(lamp_x, side, expected):
    """A lamp 1.2 m up casts what is 0.3 m up 4/3 as far; the plate hides the shadow from -0.353 to 0 m."""
    world = make_world(0.0)
    world.find("sun").light.intensity = 0.0
    lamp = world.root.create_child("lamp", (lamp_x, 1.2, 0.0))
    lamp.look_at((lamp_x, 0.0, 0.0), (0.0, 0.0, -1.0))
    lamp.create_light("spot", intensity=1.0, inner_cone=0.5, outer_cone=0.6, casts_shadow=1)
    world.update()
    shaded, clear = draw(world, PLAIN)[90], draw(world, replace(PLAIN, shadow_size=0))[90]
    inside = np.flatnonzero(clear > shaded + 20.0)
    edge = -0.8 + (inside[side] + (1 if side else 0)) * 1.6 / SIZE[0]
    texel = 2.0 * 1.2 * np.tan(0.6) / 512
    assert edge == pytest.approx(expected, abs=2.0 * texel + 1.6 / SIZE[0])


@pytest.mark.parametrize(("suns", "spots"), [(1, 0), (2, 1), (3, 0), (3, 4), (4, 4)])
def test_maps_of_the_sun_lie_where_the_shader_computes_their_centres(suns, spots):
    none = Casters(np.zeros(0, np.int32), np.zeros((0, 3)), np.zeros(0))
    maps = [ShadowMap(np.eye(4), np.zeros(3), 1.0, none) for _ in range(suns + spots)]
    plan = lay_out(maps[:suns], dict(enumerate(maps[suns:])))
    assert [each.tile for each in plan.sun] == [(k & 1, k >> 1) for k in range(suns)]
    tiles = {each.tile for each in plan.maps}
    assert len(tiles) == suns + spots
    assert max(max(tile) for tile in tiles) < plan.grid


def test_a_number_of_maps_that_cannot_be_is_refused():
    with pytest.raises(UsageError):
        RenderSettings(cascades=5)


def test_a_map_is_drawn_again_only_when_something_in_it_changed():
    """Draw calls into the maps: all at first, none while nothing moves, all when a caster moves, and the new shadow."""
    world = make_world(0.45)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, replace(PLAIN, shadow_distance=30.0))
        first = renderer.draw([view_from()]).draws
        still = renderer.draw([view_from()]).draws
        assert first - still >= 3
        world.update()
        assert renderer.draw([view_from()]).draws == still
        world.find("plate").translate((0.2, 0.0, 0.0))
        world.update()
        assert renderer.draw([view_from()]).draws == first
        moved = read_pixels(surface)[..., 0].astype(float)
        world.find("plate").entity.visible = False
        world.update()
        renderer.draw([view_from()])
        empty = read_pixels(surface)[..., 0].astype(float)
        renderer.release()
    assert np.ptp(empty) == 0.0
    fresh = make_world(0.45)
    fresh.find("plate").translate((0.2, 0.0, 0.0))
    fresh.update()
    assert np.array_equal(moved, draw(fresh, replace(PLAIN, shadow_distance=30.0)))


@pytest.mark.parametrize("samples", [0, 4])
@pytest.mark.parametrize("kind", KINDS[2:])
def test_stencil_shadows_outlive_every_change_of_size(kind, samples):
    """A driver gives freed names again: a target of another size must not be taken for the one that had the name."""
    world, settings = make_world(0.45), replace(PLAIN, shadows=kind, msaa=samples)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, settings)

        def picture() -> NDArray[np.uint8]:
            renderer.draw([view_from()])
            assert surface.ctx.error == "GL_NO_ERROR"
            return read_pixels(surface)

        full = picture().astype(int)
        for scale in (0.5, 1.0, 0.75, 1.0, 0.5, 0.75):
            renderer.set_quality(scale=scale)
            # Only along edges does a smaller picture differ; without its shadow by 30 levels in a tenth of it.
            assert np.abs(picture() - full).mean() < 1.0, f"scale {scale}"
        surface.resize((160, 90))
        surface.resize(SIZE)
        renderer.set_quality(scale=1.0)
        assert np.array_equal(picture(), full)
        renderer.release()
