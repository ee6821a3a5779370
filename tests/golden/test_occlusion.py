"""Occlusion culling in the picture: not one pixel is another, and most of the city is not drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mimics_app.maths.mat import look_at
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import box, icosphere, plane
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.gltf_maker import GltfMaker, glb
from tests.verification.test_solids import house

SETTINGS = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, shading="plain")


def make_town(seed: int) -> World:
    """Houses of loose plates with solid roofs along streets, balls and glass among them; names say nothing."""
    rng = np.random.default_rng(seed)
    world = World()
    for k in range(8):
        colour = (*rng.uniform(0.1, 1.0, 3).tolist(), 1.0)
        world.set_material(Material(f"{k}", base_colour=colour, double_sided=k == 3))
    world.set_material(Material("pane", "glass", (0.3, 0.6, 0.9, 0.3)))
    world.set_material(Material("veil", base_colour=(0.9, 0.4, 0.1, 0.5), alpha_mode="blend"))
    for k in range(5):
        walls = house(rng, cells=3 + k)
        top = walls.bounds[1]
        world.meshes[f"a{k}"] = walls
        roof = box(2.0 * float(top[0]) + 0.5, 0.4, 2.0 * float(top[2]) + 0.5)
        world.meshes[f"b{k}"] = replace(roof, positions=roof.positions + np.float32([0.0, float(top[1]) + 0.2, 0.0]))
    world.meshes["c"], world.meshes["d"] = icosphere(0.7, 2), plane(400.0, 400.0)
    world.root.create_child().create_entity("d", "0")
    for x in range(-3, 4):
        for z in range(-5, 6):
            kind, turn = rng.integers(5), (0.0, float(rng.normal()), 0.0, 1.0)
            place = (24.0 * x + rng.uniform(-2, 2), 0.0, 20.0 * z + rng.uniform(-1, 1))
            node = world.root.create_child("", place, turn, (1.0, float(rng.uniform(0.8, 1.4)), 1.0))
            node.show([(f"a{kind}", f"{rng.integers(8)}"), (f"b{kind}", f"{rng.integers(8)}")])
            ball = world.root.create_child("", (place[0] + 11.0, 1.0, place[2] + rng.uniform(-8, 8)))
            ball.create_entity("c", str(rng.choice(["pane", "veil", "1", "2"])))
    world.update()
    return world


def views(rng, count, size):
    """From the streets, low and high, rolled, off-axis, with near planes of several distances."""
    for k in range(count):
        height = (1.7, rng.uniform(0.3, 4.0), rng.uniform(5.0, 25.0))[k % 3]
        eye = np.array([24.0 * rng.integers(-3, 4) + 12.0 + rng.uniform(-3, 3), height, rng.uniform(-110, 110)])
        ahead = np.array([rng.normal(), 0.2 * rng.normal() - (0.3 if k % 3 == 2 else 0.0), rng.normal()])
        side, shift = 0.5 * size[0] / size[1], 0.2 * rng.normal()
        up = (0.2 * rng.normal(), 1.0, 0.2 * rng.normal())
        tangents = (-side + shift, side + shift, -0.5, 0.5)
        yield View(look_at(eye, eye + ahead, up), tangents, (0, 0, *size), float(rng.choice([0.02, 0.1, 0.4])), 800.0)


@pytest.mark.parametrize(("seed", "size", "msaa"), [(1, (650, 366), 0), (2, (64, 36), 0), (3, (350, 197), 4)])
def test_not_one_pixel_is_another(seed, size, msaa):
    world, rng = make_town(seed), np.random.default_rng(seed)
    settings = replace(SETTINGS, msaa=msaa)
    hidden = 0
    with create_surface("egl", size) as surface:
        with_it, without = (
            Renderer(surface, world, settings),
            Renderer(surface, world, replace(settings, occlusion="off")),
        )
        for view in views(rng, 12, size):
            stats = with_it.draw([view])
            ours = read_pixels(surface)
            whole = without.draw([view])
            assert np.array_equal(ours, read_pixels(surface)), f"from {view.eye_world}"
            assert stats.items == whole.items and stats.culled == whole.culled and whole.hidden == 0
            assert stats.triangles <= whole.triangles
            hidden += stats.hidden
    assert hidden > 12 * 20, "in a town most things are behind something"


def test_two_views_side_by_side_are_two_pictures():
    """Each eye has its own hidden things: what one sees is not what the other does."""
    world, rng = make_town(4), np.random.default_rng(4)
    with create_surface("egl", (240, 90)) as surface:
        one, other = list(views(rng, 2, (120, 90)))
        pair = [replace(one, rectangle=(0, 0, 120, 90)), replace(other, rectangle=(120, 0, 120, 90))]
        renderer = Renderer(surface, world, SETTINGS)
        renderer.draw(pair)
        ours = read_pixels(surface)
        Renderer(surface, world, replace(SETTINGS, occlusion="off")).draw(pair)
        assert np.array_equal(ours, read_pixels(surface))


def test_what_can_be_seen_through_hides_nothing():
    """Walls made of glass, of a blend and of a mask: everything behind them is drawn."""
    world = World()
    world.meshes["wall"], world.meshes["ball"] = box(40.0, 40.0, 1.0), icosphere(1.0, 1)
    kinds = {
        "glass": Material("glass", "glass"),
        "blend": Material("blend", base_colour=(1, 1, 1, 0.5), alpha_mode="blend"),
        "mask": Material("mask", base_colour=(1, 1, 1, 0.2), alpha_mode="mask"),
        "solid": Material("solid"),
    }
    wall = world.root.create_child("wall", (0.0, 0.0, -5.0)).create_entity("wall")
    for k in range(80):
        world.root.create_child("", (0.05 * k - 2.0, 0.0, -20.0)).create_entity("ball")
    view = View(np.eye(4), (-1.0, 1.0, -0.5, 0.5), (0, 0, 64, 36), 0.1, 100.0)
    with create_surface("egl", (64, 36)) as surface:
        for name, material in kinds.items():
            world.set_material(material)
            wall.set_material(name)
            world.update()
            assert Renderer(surface, world, SETTINGS).draw([view]).hidden == (80 if name == "solid" else 0), name


def test_a_mesh_that_is_changed_hides_nothing():
    """It may be open by the next frame, and looking for a box takes longer than one."""
    world = World()
    world.replace_mesh("wall", box(40.0, 40.0, 1.0))
    world.meshes["ball"] = icosphere(1.0, 1)
    world.root.create_child("wall", (0.0, 0.0, -5.0)).create_entity("wall")
    for k in range(80):
        world.root.create_child("", (0.05 * k - 2.0, 0.0, -20.0)).create_entity("ball")
    world.update()
    view = View(np.eye(4), (-1.0, 1.0, -0.5, 0.5), (0, 0, 64, 36), 0.1, 100.0)
    with create_surface("egl", (64, 36)) as surface:
        renderer = Renderer(surface, world, SETTINGS)
        assert renderer.draw([view]).hidden == 80
        world.replace_mesh("wall", box(1.0, 1.0, 1.0))
        world.update()
        assert renderer.draw([view]).hidden == 0


def test_an_authored_box_hides_and_only_where_asked(tmp_path):
    """Written into the model for a wall no box is found in: a single bent sheet of two triangles."""
    maker = GltfMaker()
    sheet = np.float32([[-20, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, -0.02]])
    position, indices = maker.array(sheet), maker.array(np.array([0, 1, 2, 0, 2, 3], np.uint16))
    occluder = {"centre": [0, 0, -0.05], "size": [39, 39, 0.05]}
    nodes = [{"mesh": 0, "translation": [0, 0, -5], "extras": {"mimics": {"occluder": occluder}}}]
    nodes += [{"mesh": 0, "translation": [0.1 * k, 0, -30 - k], "scale": [0.1, 0.1, 1]} for k in range(80)]
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": list(range(81))}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": indices}]}],
    }
    file = tmp_path / "sheet.glb"
    file.write_bytes(glb(maker.document()))
    world = load_model_world(file)
    view = View(np.eye(4), (-1.0, 1.0, -0.5, 0.5), (0, 0, 64, 36), 0.1, 200.0)
    with create_surface("egl", (64, 36)) as surface:
        for wanted, hidden in (("all", 80), ("authored", 80), ("derived", 0), ("off", 0)):
            renderer = Renderer(surface, world, replace(SETTINGS, occlusion=wanted))
            assert renderer.draw([view]).hidden == hidden, wanted
    assert isinstance(world.meshes[next(iter(world.meshes))], MeshData)
