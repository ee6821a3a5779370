"""People whose triangles are small are lit at their vertices: how far that is from light at each pixel, and when."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.quality_steps import rehearse_steps
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software.kernels.sides import Spheres, StatesBySize, choose_states, measure_sides
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import load_model_world
from mimics_app.world.files.scene.technique_library import built_in_techniques
from tests.golden.drawing import Picture, draw_offscreen

pytestmark = pytest.mark.software

SIZE = (320, 320)
LIMIT = 8.0
FAR, NEAR = 5.0, 1.2
"""Distances [m] at which the triangles of a person are small and large for the limit, in pictures of this size."""
SETTINGS = RenderSettings(msaa=0, shadow_size=1024, fog_density=0.05)


@cache
def person() -> World:
    world = load_model_world(root() / "assets/models/avatars/woman_anna.glb")
    sun = world.root.create_child("sun", (2.0, 4.0, 3.0))
    sun.look_at((0.0, 1.0, 0.0))
    sun.create_light("directional", casts_shadow=True)
    lamp = world.root.create_child("lamp", (-1.0, 2.0, 1.5))
    lamp.create_light("point", colour=(1.0, 0.6, 0.3), intensity=0.6)
    world.update()
    return world


def view_at(distance: float, **more: object) -> View:
    pose = compose_look_at((0.3, 1.2, distance), (0.0, 1.0, 0.0))
    return View(pose, (-0.3, 0.3, -0.3, 0.3), (0, 0, *SIZE), **more)


def show(distance: float, limit: float, world: World | None = None) -> Picture:
    settings = replace(SETTINGS, vertex_light=limit)
    return draw_offscreen(world or person(), [view_at(distance)], SIZE, settings)[..., :3].astype(int)


def test_a_far_person_lit_at_vertices_looks_like_one_lit_at_pixels():
    """In the laboratory's picture of eight people the changed pixels differ by 4 levels in the mean square."""
    apart = np.abs(show(FAR, LIMIT) - show(FAR, 0.0)).max(axis=-1)
    changed = apart[apart > 0]
    assert changed.size > 3_000, "the person is lit at vertices"
    assert (changed > 8).mean() < 0.1
    assert math.sqrt(np.mean(changed**2)) < 6.0


def test_a_near_person_is_lit_at_each_pixel():
    assert np.array_equal(show(NEAR, LIMIT), show(NEAR, 0.0))
    assert not np.array_equal(show(NEAR, 100.0), show(NEAR, 0.0)), "with a larger limit it is not"


def test_a_scenes_own_way_to_draw_is_not_replaced():
    world = load_model_world(root() / "assets/models/avatars/woman_anna.glb")
    world.update()
    ours = show(FAR, LIMIT, world)
    for name in ("pbr", "lit"):
        world.techniques[name] = replace_passes(name)
    assert not np.array_equal(show(FAR, LIMIT, world), ours)
    assert np.array_equal(show(FAR, LIMIT, world), show(FAR, 0.0, world))


def replace_passes(name):
    """The technique with its passes drawn from a file of the same content but no optional features."""
    import msgspec

    spec = built_in_techniques()[name]
    return msgspec.structs.replace(
        spec, passes=tuple(msgspec.structs.replace(each, features=("COLOURED",)) for each in spec.passes)
    )


@pytest.mark.parametrize("passes", ["clip_distance", "viewports"])
def test_both_eyes_in_one_pass_see_what_each_sees_alone(passes):
    pictures = []
    for stereo in ("two_pass", passes):
        views = []
        for number, side in enumerate((-0.03, 0.03)):
            pose = compose_look_at((side, 1.2, FAR), (side, 1.0, 0.0))
            views.append(View(pose, (-0.3, 0.3, -0.3, 0.3), (160 * number, 0, 160, 320), pair=0))
        settings = replace(SETTINGS, vertex_light=LIMIT, stereo=stereo)
        pictures.append(draw_offscreen(person(), views, SIZE, settings)[..., :3].astype(int))
    assert (np.abs(pictures[1] - pictures[0]).max(axis=-1) > 1).mean() < 1e-3
    assert pictures[0].std() > 10.0


def test_a_session_compiles_nothing_when_a_person_comes_near():
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, person(), replace(SETTINGS, vertex_light=LIMIT))
        views = [view_at(NEAR)]
        rehearse_steps(renderer, views)
        assert renderer.settings.vertex_light == LIMIT
        known = len(renderer._shaders._programs)
        for distance in (FAR, NEAR, FAR):
            renderer.draw([view_at(distance)])
            assert len(renderer._shaders._programs) == known
        renderer.release()


def test_a_redrawn_part_has_the_pixels_of_the_whole():
    """A person who moves before a fixed camera is redrawn in part, with the same choice as in a new picture."""
    world = load_model_world(root() / "assets/models/avatars/woman_anna.glb")
    world.update()
    settings = replace(SETTINGS, vertex_light=LIMIT)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, settings)
        for step in range(4):
            world.root.children[0].set_position((0.02 * step, 0.0, 0.0))
            world.update()
            renderer.draw([view_at(FAR)])
        kept = read_pixels(surface)
        renderer.release()
    assert np.array_equal(kept, draw_offscreen(world, [view_at(FAR)], SIZE, settings))


@pytest.mark.parametrize("limit", [-1.0, math.nan])
def test_a_limit_that_cannot_be_is_refused(limit):
    with pytest.raises(UsageError, match="vert"):
        RenderSettings(vertex_light=limit)


def test_the_sides_of_a_mesh_are_those_that_cover_most_of_it():
    """An equilateral triangle of side 2 beside one of side 1: the mean weighted by areas is (4 * 2 + 1) / 5."""
    high = math.sqrt(3.0)
    corners = [(0, 0, 0), (2, 0, 0), (1, high, 0), (5, 0, 0), (6, 0, 0), (5.5, high / 2, 0)]
    positions, indices = np.array(corners, np.float32), np.arange(6, dtype=np.uint32)
    assert measure_sides(positions, indices) == pytest.approx(1.8, rel=1e-6)
    assert measure_sides(positions, np.zeros(6, np.uint32)) == 0.0


def test_near_the_limit_the_state_stays_what_it_was():
    """Sides of 1 m, small up to 0.1 at distance 1: from 10 m on, with five per cent to either side."""
    small, chosen = np.zeros(1, np.uint8), np.zeros(1, np.int32)
    seen = []
    for distance in (9.0, 10.2, 10.6, 9.8, 9.6, 9.5, 10.2, math.inf):
        centres = np.array([[0.0, 0.0, distance]])
        spheres = Spheres(centres, np.ones(1), np.ones((1, 4)))
        states = StatesBySize(np.ones(1), np.array([3], np.int32), np.array([7], np.int32))
        choose_states(np.zeros(1, np.int32), spheres, states, np.zeros(3), 0.1, small, chosen)
        seen.append(int(chosen[0]))
    assert seen == [3, 3, 7, 7, 7, 3, 3, 7]
