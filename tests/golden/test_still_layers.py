"""Shadow maps of which a part is kept: the same depths as drawn anew, and only what moves is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.visual.lighting import fit_shadow_frustum
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software.still_layers import QUIET_FRAMES, SteadyBox
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, icosphere, plane
from mimics_app.world.content.world import World

pytestmark = pytest.mark.software

SIZE = (160, 120)
BOX, BALL = 12, 80
"""Triangles of each."""

ONE_MAP = RenderSettings(msaa=0, shadow_size=256)
CASCADES = RenderSettings(msaa=0, shadow_size=256, shadow_distance=4.0, cascades=2)
MAPS = pytest.mark.parametrize(("settings", "spot"), [(ONE_MAP, False), (CASCADES, False), (ONE_MAP, True)])


def make_world(spot: bool) -> World:
    """Nine boxes on a floor, one of them of glass, a ball over them, a sun and perhaps a lamp."""
    world = World()
    world.set_material(Material("glass", "glass", (0.4, 0.6, 0.8, 0.3), alpha_mode="blend"))
    world.meshes |= {"floor": plane(6.0, 6.0), "box": box(0.3, 0.5, 0.3), "ball": icosphere(0.2, 1)}
    world.root.create_child("floor").create_entity("floor", "default").subentities[0].casts_shadow = False
    for number in range(9):
        place = (0.8 * (number % 3 - 1), 0.25, 0.8 * (number // 3 - 1))
        world.root.create_child(f"box{number}", place).create_entity("box", "glass" if number == 4 else "default")
    world.root.create_child("ball", (0.0, 0.9, 0.3)).create_entity("ball", "default")
    sun = world.root.create_child("sun", (0.5, 2.0, 0.7))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", casts_shadow=1)
    if spot:
        lamp = world.root.create_child("lamp", (-1.0, 2.5, 1.0))
        lamp.look_at((0.0, 0.0, 0.0))
        lamp.create_light("spot", intensity=6.0, outer_cone=0.8, casts_shadow=1)
    world.update()
    return world


def view() -> View:
    return View(compose_look_at((0.0, 2.2, 2.6), (0.0, 0.2, 0.0)), (-0.6, 0.6, -0.45, 0.45), (0, 0, *SIZE))


def put_ball(world: World, step: int) -> None:
    world.find("ball").set_position((0.6 * np.sin(0.4 * step), 0.9, 0.3))


@MAPS
def test_a_map_that_was_kept_in_part_is_the_map_drawn_anew(settings, spot):
    """A ball moves; a box jumps, one goes, one comes back; the sun turns; the map is made larger."""
    world = make_world(spot)
    changes = {
        4: lambda: world.find("box2").set_position((0.9, 0.3, -0.9)),
        6: lambda: setattr(world.find("box7"), "visible", False),
        8: lambda: setattr(world.find("box7"), "visible", True),
        10: lambda: world.find("sun").look_at((0.3, 0.0, 0.1)),
        12: lambda: steady.set_quality(shadow_size=128),
    }
    kept = 0
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, settings)
        for step in range(15):
            put_ball(world, step)
            changes.get(step, lambda: None)()
            world.update()
            steady.draw([view()])
            ours = read_pixels(surface)
            kept += sum(work is not None and work.still is None for work in steady._shadows.work)
            fresh = Renderer(surface, world, steady.settings)
            fresh._shadows._box = steady._shadows._box  # where the box is may depend on the frames before
            fresh.draw([view()])
            assert all(work is None or work.still is not None for work in fresh._shadows.work)
            assert np.array_equal(ours, read_pixels(surface)), step
            fresh.release()
    assert kept >= 5
    assert len(np.unique(ours[..., 1])) > 20


def test_only_what_moves_is_drawn_into_a_kept_map():
    """What came to rest is drawn on until it has been quiet for long; then once with all the others, and no more."""
    world = make_world(spot=False)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, ONE_MAP)

        def shadow_triangles() -> int:
            world.update()
            renderer.draw([view()])
            return renderer._shadows.triangles

        assert shadow_triangles() == 9 * BOX + BALL
        assert shadow_triangles() == 0
        drawn = []
        for step in range(1, 6):
            put_ball(world, step)
            drawn.append(shadow_triangles())
        assert drawn == [9 * BOX + BALL, BALL, BALL, BALL, BALL]
        world.find("box0").set_position((-0.8, 0.35, -0.8))
        assert shadow_triangles() == 9 * BOX + BALL
        for step in range(6, 6 + QUIET_FRAMES):
            put_ball(world, step)
            drawn.append(shadow_triangles())
        assert drawn[5:] == [BOX + BALL] * (QUIET_FRAMES - 1) + [9 * BOX + BALL]
        put_ball(world, 7 + QUIET_FRAMES)
        assert shadow_triangles() == BALL


def test_a_box_stays_while_its_casters_are_in_it_and_is_neither_too_wide():
    towards = np.array([0.3, 0.8, 0.2]) / np.linalg.norm([0.3, 0.8, 0.2])
    chance, steady = np.random.default_rng(8), SteadyBox()
    centres, radii = chance.uniform(-1.0, 1.0, (20, 3)), chance.uniform(0.02, 0.1, 20)
    first = steady.fit(towards, centres, radii, 512)
    assert first is not None
    assert first.clip_from_world == pytest.approx(fit_shadow_frustum(towards, centres, radii, 512).clip_from_world)
    boxes = []
    for step in range(200):
        moved = centres.copy()
        moved[0] = 1.2 * np.sin(0.05 * step * np.array([1.0, 1.3, 1.7]))
        box_now = steady.fit(towards, moved, radii, 512)
        assert box_now is not None
        inside = np.abs(moved @ box_now.clip_from_world[:3, :3].T + box_now.clip_from_world[:3, 3])
        margin = radii * np.linalg.norm(box_now.clip_from_world[0, :3])
        assert (inside + margin[:, None]).max() <= 1.0
        assert box_now.texel <= 2.0 ** (3 / 8) * fit_shadow_frustum(towards, moved, radii, 512).texel * (1.0 + 1e-9)
        boxes.append(box_now)
    assert len({id(each) for each in boxes}) <= 8
    small = steady.fit(towards, 0.1 * centres, 0.1 * radii, 512)
    assert small is not None and small.texel < 0.2 * boxes[-1].texel
    assert steady.fit(-towards, 0.1 * centres, 0.1 * radii, 512) is not small
    assert steady.fit(towards, centres[:0], radii[:0], 512) is None
