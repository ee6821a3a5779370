"""Levels of detail: read from models, chosen by coverage without flicker, each view for itself."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.rendering.visual.drawing.levels import fewer_pixels
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.meshes.primitives import icosphere
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.gltf_maker import INDICES, POSITIONS, GltfMaker, glb

SETTINGS = RenderSettings(msaa=0, shadow_size=0, shading="plain", occlusion="off")  # all triangles are counted
SIZE = (360, 360)
"""As many pixels as a picture has to have for levels to go by shares of it alone."""


def view_at(distance, rectangle=(0, 0, *SIZE)):
    pose = np.eye(4)
    pose[2, 3] = distance
    return View(pose, (-0.5, 0.5, -0.5, 0.5), rectangle, 0.1, 1000.0)


def make_world(coverages=(0.1, 0.01, 0.001)) -> World:
    """A ball of radius 1 in 1280, 320 and 80 triangles; coverage at distance d is pi / d^2."""
    world = World()
    for level in range(3):
        world.meshes[f"ball{level}"] = icosphere(1.0, 3 - level)
    world.content.add_levels(
        world.root.create_child("ball").index, [[(f"ball{k}", "default")] for k in range(3)], coverages
    )
    world.update()
    return world


def distance_of(coverage):
    return math.sqrt(math.pi / coverage)


def test_the_level_follows_the_coverage():
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        for factor, wanted in ((1.5, 1280), (0.6, 320), (0.06, 80), (0.006, 0)):
            stats = Renderer(surface, world, SETTINGS).draw([view_at(distance_of(0.1 * factor))])
            assert stats.triangles == wanted, factor


@pytest.mark.parametrize("detail", [0.25, 0.5, 2.0, 4.0])
def test_levels_change_so_many_times_as_far_away(detail):
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        for factor, wanted in ((1.05, 1280), (0.95, 320)):
            renderer = Renderer(surface, world, replace(SETTINGS, detail=detail))
            away = distance_of(0.1 * factor) * detail
            assert renderer.draw([view_at(away)]).triangles == wanted, factor


@pytest.mark.parametrize("detail", [0.0, 0.2, 4.5, math.nan])
def test_a_detail_that_cannot_be_is_refused(detail):
    with pytest.raises(UsageError, match="detail"):
        RenderSettings(detail=detail)


def test_near_a_threshold_the_level_stays_what_it_was():
    """Seven per cent to either side of it does not change it, fifteen does."""
    world = make_world()
    factors = (2.0, 1.07, 0.93, 1.07, 0.85, 0.93, 1.07, 1.15, 0.93)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, SETTINGS)
        seen = [renderer.draw([view_at(distance_of(0.1 * factor))]).triangles for factor in factors]
    assert seen == [1280, 1280, 1280, 1280, 320, 320, 320, 1280, 1280]


def test_each_view_has_its_own_level():
    world = make_world()
    pair = [view_at(4.0), view_at(20.0, (SIZE[0], 0, *SIZE))]
    with create_surface("egl", (2 * SIZE[0], SIZE[1])) as surface:
        renderer = Renderer(surface, world, SETTINGS)
        for _ in range(2):
            assert renderer.draw(pair).triangles == 1280 + 80


@pytest.mark.parametrize(("side", "factor"), [(180, 4.0), (64, 31.640625)])
def test_a_smaller_picture_is_wrong_by_as_many_pixels(side, factor):
    """A quarter of the pixels: a level has to cover four times the share. What is too small to be shown stays that."""
    world = make_world(coverages=(1e-3, 1e-4, 1e-5))
    with create_surface("egl", (side, side)) as surface:
        for share, wanted in ((1.1e-3, 1280), (0.9e-3, 320), (1.1e-4, 320), (0.9e-4, 80)):
            view = view_at(distance_of(factor * share), (0, 0, side, side))
            assert Renderer(surface, world, SETTINGS).draw([view]).triangles == wanted, share
        for share, wanted in ((1.1e-5, 80), (0.9e-5, 0)):
            view = view_at(distance_of(share), (0, 0, side, side))
            assert Renderer(surface, world, SETTINGS).draw([view]).triangles == wanted, share


def test_a_part_of_a_picture_has_the_levels_of_the_whole():
    whole = view_at(distance_of(0.3))
    assert fewer_pixels(whole, (180, 180)) == pytest.approx(4.0)
    part = replace(whole, tangents=(-0.25, 0.25, 0.0, 0.5), part_of=whole.tangents)
    assert fewer_pixels(part, (180, 180)) == pytest.approx(1.0)
    assert fewer_pixels(part, (90, 90)) == pytest.approx(4.0)


@pytest.mark.parametrize(("texels", "triangles"), [(64, 80), (2048, 1280)])
def test_a_shadow_map_has_one_level_as_coarse_as_its_texels(texels, triangles):
    """The ball is 57 texels wide, 0.1 % of a picture of 1920 x 1080, or 1,900: more than all of its height."""
    world = make_world()
    sun = world.root.create_child()
    sun.look_at((0.1, -1.0, 0.0))
    sun.create_light("directional", casts_shadow=1)
    world.update()
    with create_surface("egl", SIZE) as surface:
        settings = RenderSettings(msaa=0, shadow_size=texels, occlusion="off")
        assert Renderer(surface, world, settings).draw([view_at(distance_of(0.05))]).triangles == triangles + 320


@pytest.mark.parametrize("coverages", [(0.1, 0.2, 0.0), (0.1, 0.01), ()])
def test_levels_that_do_not_fit_are_refused(coverages):
    with pytest.raises(ValueError, match="levels of detail"):
        make_world(coverages)


def lod_model(coverages, ids=(1,)):
    maker = GltfMaker()
    position, whole = maker.array(POSITIONS), maker.array(INDICES)
    half = maker.array(INDICES[:3])
    fine = {"mesh": 0, "extensions": {"MSFT_lod": {"ids": list(ids)}}, "extras": {"MSFT_screencoverage": coverages}}
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [fine, {"mesh": 1}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": k}]} for k in (whole, half)],
        "extensionsUsed": ["MSFT_lod"],
        "extensionsRequired": ["MSFT_lod"],
    }
    return glb(maker.document())


def test_levels_come_out_of_a_model(tmp_path):
    file = tmp_path / "lod.glb"
    file.write_bytes(lod_model([0.05, 0.0005]))
    world = load_model_world(file)
    with create_surface("egl", SIZE) as surface:
        for distance, wanted in ((3.0, 2), (10.0, 1), (200.0, 0)):
            assert Renderer(surface, world, SETTINGS).draw([view_at(distance)]).triangles == wanted
    file.write_bytes(lod_model([]))
    assert load_model_world(file).content.levels.column("coverages")[0][:2].tolist() == [0.25, 0.0]


@pytest.mark.parametrize(("coverages", "ids"), [([0.1, 0.5], (1,)), ([0.5], (1,)), ([2, 1], (1,)), ([0.5, 0.1], (7,))])
def test_a_model_whose_levels_are_wrong_says_where(tmp_path, coverages, ids):
    file = tmp_path / "lod.glb"
    file.write_bytes(lod_model(coverages, ids))
    with pytest.raises(SceneError) as raised:
        load_model_world(file)
    assert "/nodes/0" in raised.value.issues[0].pointer
