"""Triangles that no pixel shows: left out where the processor draws, and no pixel is another for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mimics_app.contracts.system.resources import root
from mimics_app.lab.groups.crowd import load_person
from mimics_app.maths.mat import look_at
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, icosphere, plane, torus
from mimics_app.world.content.world import World

pytestmark = pytest.mark.software

SETTINGS = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, shading="plain")
WHOLE = replace(SETTINGS, occlusion="off")


def make_heap(rng):
    """Turned, stretched and reflected bodies on a ground with walls; some sheets have two sides."""
    world = World()
    for k in range(4):
        world.set_material(Material(f"{k}", base_colour=(*rng.uniform(0.2, 1.0, 3), 1.0), double_sided=k == 3))
    world.meshes["ball"], world.meshes["ring"] = icosphere(1.0, 3), torus(1.0, 0.3, 24)
    world.meshes["sheet"], world.meshes["wall"] = plane(3.0, 3.0, segments=6), box(6.0, 4.0, 0.5)
    world.meshes["ground"] = plane(300.0, 300.0, segments=5)
    world.root.create_child("", (0.0, -3.0, 0.0)).create_entity("ground", "0")
    for k in range(90):
        kind = str(rng.choice(["ball", "ring", "sheet", "wall"]))
        scale = rng.uniform(0.3, 1.5, 3) * rng.choice([-1.0, 1.0], 3)
        node = world.root.create_child("", rng.normal(size=3) * (20.0, 2.0, 20.0), rng.normal(size=4), tuple(scale))
        node.create_entity(kind, f"{k % 4}")
    world.update()
    return world


def view_of(rng, size):
    eye = rng.normal(size=3) * (25.0, 2.0, 25.0)
    side, shift = 0.5 * size[0] / size[1], 0.2 * rng.normal()
    near = float(rng.choice([0.02, 0.1, 0.8]))
    matrix = look_at(eye, rng.normal(size=3) * 5.0, rng.normal(size=3))
    return View(matrix, (-side + shift, side + shift, -0.5, 0.5), (0, 0, *size), near, 600.0)


@pytest.mark.parametrize(("seed", "size", "msaa"), [(1, (650, 366), 0), (2, (64, 36), 0), (3, (350, 197), 4)])
def test_not_one_pixel_is_another(seed, size, msaa):
    rng = np.random.default_rng(seed)
    world, ours, all_of_them = make_heap(rng), 0, 0
    with create_surface("egl", size) as surface:
        some, whole = (Renderer(surface, world, replace(each, msaa=msaa)) for each in (SETTINGS, WHOLE))
        for _ in range(12):
            view = view_of(rng, size)
            ours += some.draw([view]).triangles
            picture = read_pixels(surface)
            all_of_them += whole.draw([view]).triangles
            assert np.array_equal(picture, read_pixels(surface)), f"from {view.eye_world}"
    assert ours < 0.9 * all_of_them, "half of a body with one-sided faces is turned away"


def test_two_sides_are_drawn_and_a_changed_mesh_is_drawn_as_a_whole():
    world = World()
    for name, two_sided in (("one", False), ("two", True)):
        world.set_material(Material(name, double_sided=two_sided))
    world.meshes["ball"] = icosphere(1.0, 2)
    entity = world.root.create_child("", (0.0, 0.0, -4.0)).create_entity("ball", "one")
    view = View(np.eye(4), (-0.5, 0.5, -0.5, 0.5), (0, 0, 90, 90), 0.1, 100.0)
    with create_surface("egl", (90, 90)) as surface:
        renderer = Renderer(surface, world, SETTINGS)
        world.update()
        assert 100 < renderer.draw([view]).triangles < 160 + 20
        entity.subentities[0].material = "two"
        world.update()
        assert renderer.draw([view]).triangles == 320
        entity.subentities[0].material = "one"
        for size in (0.8, 0.9):
            world.replace_mesh("ball", icosphere(size, 2))
        world.update()
        assert renderer.draw([view]).triangles == 320


@pytest.mark.parametrize(
    ("size", "msaa", "skinning"),
    [((240, 135), 0, "processor"), ((150, 87), 4, "processor"), ((64, 36), 0, "processor"), ((64, 36), 0, "feedback")],
)
def test_not_one_pixel_of_people_who_walk_is_another(size, msaa, skinning):
    """Near planes cut one of them, one is a reflection; meshes that the driver skins are drawn as a whole."""
    world, rng, ours, all_of_them = World(), np.random.default_rng(5), 0, 0
    for number, x in enumerate((-0.8, 0.0, 0.9)):
        name = ("man_tom", "woman_anna", "therapist")[number]
        person = world.root.create_child(
            f"{number}", (x, 0.0, -1.5 * number), scale=(-1.0 if number == 1 else 1.0, 1, 1)
        )
        load_person(root() / "assets/models/avatars" / f"{name}.glb", full=False).instantiate(world, person)
        world.motion.animators[person.index].play("walk")
    world.update()
    with create_surface("egl", size) as surface:
        settings = [replace(each, msaa=msaa, skinning=skinning, shading="full") for each in (SETTINGS, WHOLE)]
        some, whole = (Renderer(surface, world, each) for each in settings)
        for frame in range(6):
            world.motion.time = 0.1 * frame
            world.update()
            eye = np.array([rng.uniform(-1.5, 1.5), rng.uniform(0.3, 2.0), rng.uniform(0.2, 4.0)])
            side = 0.5 * size[0] / size[1]
            view = View(look_at(eye, (0.0, 1.0, -1.0), (0.0, 1.0, 0.0)), (-side, side, -0.5, 0.5), (0, 0, *size), 0.4)
            ours += some.draw([view]).triangles
            picture = read_pixels(surface)
            all_of_them += whole.draw([view]).triangles
            assert np.array_equal(picture, read_pixels(surface)), f"from {eye}"
    assert ours == all_of_them if skinning == "feedback" else ours < 0.75 * all_of_them
