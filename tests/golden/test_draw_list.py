"""Draw lists: what is batched together, what is left out, and that none of it shows."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.app.bench.workload_opening import open_workload
from mimics_app.app.cli import main
from mimics_app.maths.mat import look_at
from mimics_app.rendering.visual.kernels.commands import MAX_TRIANGLES
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software import batched_feed
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.raw_gl import RawGL
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import box, sphere
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen
from tests.support.gltf_maker import glb, square, write_gltf
from tests.support.skin_maker import add_clip, bar, turn

SIZE = (160, 90)
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0, shading="plain")


def view_from(eye, target, size=SIZE):
    up = np.tan(0.5)
    side = up * size[0] / size[1]
    return View(look_at(eye, target), (-side, side, -up, up), (0, 0, *size), 0.1, 500.0)


def make_crowd(count=300, seed=2) -> World:
    """Boxes and balls of many materials all about the origin, some of them mirrored, under turning parents."""
    rng = np.random.default_rng(seed)
    world = World()
    world.environment = Sky((0.2, 0.3, 0.5), (0.2, 0.3, 0.5), (0.2, 0.3, 0.5), 1.0)
    for k in range(12):
        pixels = rng.integers(0, 256, (16 if k % 2 else 8, 8, 4), np.uint8)
        world.textures[f"t{k}"] = TextureData(pixels, wrap=("mirror" if k % 3 == 0 else "repeat", "repeat"))
        texture = f"t{k}" if k % 4 else None
        colour = (*rng.uniform(0.2, 1.0, 3).tolist(), 1.0)
        world.set_material(Material(f"m{k}", base_colour=colour, base_texture=texture, double_sided=k == 5))
    world.meshes["box"], world.meshes["ball"] = box(1.0, 0.7, 0.4), sphere(0.5, 12)
    tinted = world.meshes["box"]
    world.meshes["tinted"] = replace(
        tinted, colours=np.tile(np.float32([0.5, 1.0, 0.2, 1.0]), (len(tinted.positions), 1))
    )
    parents = [world.root.create_child("", rng.normal(size=3), rng.normal(size=4)) for _ in range(6)]
    for _ in range(count):
        scale = rng.uniform(0.3, 2.0, 3) * rng.choice([-1.0, 1.0], 3)
        node = parents[rng.integers(6)].create_child("", 12.0 * rng.normal(size=3), rng.normal(size=4), scale)
        node.create_entity(str(rng.choice(["box", "ball", "tinted"])), f"m{rng.integers(12)}")
    world.update()
    return world


@pytest.mark.software
@pytest.mark.parametrize(("size", "name"), [(SIZE, "FEW_PIXELS_TRIANGLES"), ((640, 360), "MAX_TRIANGLES")])
def test_a_large_frame_is_sent_in_pieces_which_nothing_shows(monkeypatch, size, name):
    """Of one mesh and of many: no pixel says in how many pieces a frame was sent."""
    world = World()
    world.set_material(Material("grey"))
    world.meshes["ball"], world.meshes["box"] = sphere(0.4, 12), box(0.5, 0.5, 0.5)
    each = len(world.meshes["ball"].indices) // 3
    count = 5 * MAX_TRIANGLES // (2 * each)
    for k in range(count):
        where = (k % 20 - 9.5, (k // 20 % 10) - 4.5, -float(k // 200))
        world.root.create_child("", where).create_entity("box" if k % 9 == 0 else "ball", "grey")
    world.update()
    pieces: list[int] = []
    send = RawGL.flush
    monkeypatch.setattr(RawGL, "flush", lambda raw: (pieces.append(1), send(raw)))
    views = [view_from((0, 0, 15), (0, 0, 0), size)]
    with create_surface("egl", size) as surface:
        drawn = Renderer(surface, world, PLAIN).draw(views)
        picture, sent = read_pixels(surface), len(pieces)
        largest = getattr(batched_feed, name)
        monkeypatch.setattr(batched_feed, name, 10 * drawn.triangles)
        pieces.clear()
        Renderer(surface, world, PLAIN).draw(views)
        np.testing.assert_array_equal(read_pixels(surface), picture)
    assert not pieces
    assert drawn.triangles // largest >= sent >= 1


def test_looks_that_differ_in_picture_and_colour_share_draw_calls():
    world = make_crowd()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        plain = renderer.draw([view_from((0, 5, 40), (0, 0, 0))])
        full = Renderer(surface, world, replace(PLAIN, shading="full")).draw([view_from((0, 5, 40), (0, 0, 0))])
    # Picture sizes, ways of repeating, none at all; sides; colours per vertex; mirrored: at most this many states.
    assert plain.draws < full.draws
    assert plain.triangles == full.triangles > 0


def test_the_order_of_the_world_does_not_show():
    """The same things made in another order are drawn in the same order: nearest first."""
    pictures = []
    for flip in (False, True):
        world = World()
        world.meshes["ball"] = sphere(0.5, 16)
        for k in range(3):
            world.set_material(Material(f"m{k}", base_colour=(0.3 * k, 0.5, 0.9 - 0.3 * k, 1.0)))
        places = [(x, y, -2.0 * y) for x in range(-4, 5) for y in range(-2, 3)]
        for place in reversed(places) if flip else places:
            world.root.create_child("", np.array(place, float)).create_entity("ball", f"m{(place[0] + place[1]) % 3}")
        world.update()
        pictures.append(draw_offscreen(world, [view_from((0.3, 1.0, 9.0), (0, 0, 0))], SIZE, PLAIN))
    assert np.array_equal(*pictures)


def test_a_mesh_too_large_for_short_indices_looks_the_same():
    """Split in two below the limit and whole above it, one surface is one picture."""
    across = 300
    x, z = np.meshgrid(np.linspace(-5, 5, across), np.linspace(-5, 5, across))
    positions = np.stack([x, 0.3 * np.sin(3 * x) * np.cos(2 * z), z], -1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(across - 1)[:, None] * across + np.arange(across - 1)).reshape(-1, 1)
    indices = (corner + np.array([0, across, 1, 1, across, across + 1])).astype(np.uint32)
    normals = np.tile(np.float32([0, 1, 0]), (len(positions), 1))
    assert len(positions) > 65_536
    pictures = []
    for parts in (1, 3):
        world = World()
        for number, rows in enumerate(np.array_split(indices, parts)):
            used, local = np.unique(rows, return_inverse=True)
            mesh = MeshData(positions[used], normals[used], local.reshape(-1).astype(np.uint32)).validated()
            world.meshes[f"m{number}"] = mesh
            world.root.create_child().create_entity(f"m{number}")
        world.update()
        pictures.append(draw_offscreen(world, [view_from((0, 3, 8), (0, 0, 0))], SIZE, PLAIN))
    assert len(np.unique(pictures[0].reshape(-1, 4), axis=0)) > 5, "something is to be seen"
    assert np.array_equal(*pictures)


def test_what_moved_between_two_frames_is_drawn_where_it_is():
    """Also when the world was brought up to date twice, or not at all, since the last frame."""
    world = make_crowd(60)
    view = view_from((0, 5, 40), (0, 0, 0))
    movers = [node for node in world.root.children if node.children]
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        renderer.draw([view])
        movers[0].set_position((3.0, 0.0, 0.0))
        world.update()
        movers[1].set_position((0.0, 2.0, 0.0))
        world.update()
        renderer.draw([view])
        kept = read_pixels(surface)
        renderer.draw([view])
        assert np.array_equal(kept, read_pixels(surface))
    assert np.array_equal(kept, draw_offscreen(world, [view], SIZE, PLAIN))


def test_plain_shading_is_the_closed_form():
    """Picture times (sky + sun times the cosine), in display values; a back side gets the sky alone."""
    world = World()
    world.environment = Sky((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, 1.0), 0.4, scatter=0.0)
    sun = world.root.create_child()
    sun.look_at((0.0, 0.0, -1.0))
    sun.create_light("directional", intensity=0.4)
    world.textures["t"] = TextureData(np.full((4, 4, 4), (200, 100, 50, 255), np.uint8))
    for name, technique in (("lit", "lit"), ("unlit", "unlit")):
        world.set_material(Material(name, technique, (1.0, 1.0, 1.0, 1.0), base_texture="t"))
    world.meshes["box"] = box()
    world.root.create_child("a", (-1.0, 0.0, 0.0)).create_entity("box", "lit")
    world.root.create_child("b", (1.0, 0.0, 0.0)).create_entity("box", "unlit")
    world.update()
    picture = draw_offscreen(world, [view_from((0, 0, 8), (0, 0, 0))], SIZE, PLAIN)
    middle = picture[45]
    left, right = middle[80 - 11], middle[80 + 11]
    assert np.abs(left[:3].astype(int) - np.array([160, 80, 40])).max() <= 1
    assert np.abs(right[:3].astype(int) - np.array([200, 100, 50])).max() <= 1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["bench", "render"], "workload"),
        (["bench", "render", "crowd", "--data", "nowhere"], "character.glb"),
        (["bench", "render", "city", "--data", "nowhere"], "city.glb"),
        (["bench", "render", "city", "--data", ".", "--opt", "quick"], "quick"),
    ],
)
def test_what_cannot_be_measured_is_one_line(arguments, says, capsys):
    assert main(arguments) == 2
    assert says in capsys.readouterr().err


def test_a_crowd_walks_each_at_its_own_phase(tmp_path):
    """Of nine people on three lines every one is bent otherwise than the others, and once a frame."""
    maker = bar()
    add_clip(maker, "walk", [(2, "rotation", [0.0, 1.0], [turn("z", 0), turn("z", 60)], "LINEAR")])
    write_gltf(tmp_path / "character.glb", maker.document())
    crowd = open_workload("crowd", tmp_path, 9)
    crowd.update(3)
    bodies = list(crowd.world.motion.bodies.values())
    assert len({body.rows.tobytes() for body in bodies}) == len(bodies) == 9
    before = [body.revision for body in bodies]
    crowd.update(4)
    assert [body.revision for body in bodies] == [revision + 1 for revision in before]


def test_the_bench_prints_its_line(tmp_path, capsys):
    """On a cube of our own: the product's whole way from a glTF file to a finished frame."""
    (tmp_path / "cube.glb").write_bytes(glb(square()))
    shot = tmp_path / "shot.png"
    few = ["--n", "100", "--frames", "2", "--warmup", "1", "--size", "96x54", "--data", str(tmp_path)]
    assert main(["bench", "render", "nodes", *few, "--shot", str(shot)]) == 0
    line = capsys.readouterr().out
    assert line.startswith("RESULT ")
    answer = json.loads(line.removeprefix("RESULT "))
    wanted = ("fps_median", "ms_median", "ms_min", "ms_p95", "ms_update", "ms_render", "ms_cpu", "mean_rgb")
    assert set(wanted) <= answer.keys()
    assert answer["tris_submitted"] > 0
    assert shot.is_file()
    assert main(["bench", "render", "nodes", *few, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["schema"]


def test_particles_are_counted_and_without_ogre_measured_alone(monkeypatch, capsys):
    monkeypatch.setattr("shutil.which", lambda _: None)
    few = ["--n", "200", "--frames", "2", "--warmup", "1", "--size", "96x54", "--json"]
    assert main(["bench", "render", "particles", *few]) == 0
    said = capsys.readouterr()
    answer = json.loads(said.out)
    assert answer["nodes"] == 200 and 2 * 150 < answer["tris_submitted"] <= 2 * 200 and answer["draw_calls"] == 1
    assert "OGRE is not measured" in said.err and "ogre_ms" not in answer
