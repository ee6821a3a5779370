"""Boxes of shapes hold what is drawn, and prisms of shadows hold where these fall, in a fraction of the space."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.drawing.skinning import SkinnedMeshes
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software.kernels.shadow_prisms import FIGURES, cut_prisms, slice_casters
from mimics_app.rendering.visual.software.placed_shapes import PlacedShapes, place_items
from mimics_app.rendering.visual.software.shape_boxes import ShapeBoxes
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import box, icosphere, plane, torus
from mimics_app.world.content.motion.posing import posed_positions
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.gltf_maker import write_gltf
from tests.support.skin_maker import add_clip, bar, turn

pytestmark = pytest.mark.software

CHANCE = np.random.default_rng(5)


def _outside(points: np.ndarray, boxes: np.ndarray) -> int:
    """Return how many points are in none of some boxes."""
    within = (points[:, None] >= boxes[None, :, 0] - 1e-7) & (points[:, None] <= boxes[None, :, 1] + 1e-7)
    return int((~within.all(axis=2).any(axis=1)).sum())


def _scattered(mesh: MeshData, count: int) -> np.ndarray:
    """Return random points of random triangles, [count, 3]."""
    triangles = mesh.indices.reshape(-1, 3)[CHANCE.integers(0, mesh.triangle_count, count)]
    shares = CHANCE.dirichlet((1.0, 1.0, 1.0), count)
    return np.einsum("ij,ijk->ik", shares, mesh.positions[triangles].astype(np.float64))


@pytest.mark.parametrize(
    ("mesh", "share"),
    [(icosphere(0.4, 3), 0.6), (torus(1.0, 0.1), 0.45), (box(0.3, 1.0, 0.2), 1.0), (plane(3.0, 2.0), 0.0)],
    ids=["ball", "ring", "box", "sheet"],
)
def test_boxes_of_a_mesh_hold_its_triangles_in_less_space_than_one(mesh: MeshData, share: float):
    world = World()
    world.meshes["mesh"] = mesh
    boxes = ShapeBoxes(world, SkinnedMeshes()).of(["mesh"])
    assert boxes is not None
    assert _outside(_scattered(mesh, 4000), boxes) == 0
    volume = np.prod(mesh.bounds[1] - mesh.bounds[0])
    assert np.prod(boxes[:, 1] - boxes[:, 0], axis=1).sum() <= share * volume + 1e-9


def test_what_is_written_beyond_the_bounds_of_a_mesh_counts_to_the_border_of_its_grid():
    world = World()
    mesh = world.meshes["mesh"] = box(0.3, 1.0, 0.2)
    assert mesh.bounds[0].max() < 0.0, "they are kept"
    mesh.positions[::3] *= 40.0
    boxes = ShapeBoxes(world, SkinnedMeshes()).of(["mesh"])
    assert boxes is not None
    assert _outside(mesh.positions.astype(np.float64), boxes) == 0


def _bent_bar(folder: Path, skinning: str, at: float) -> World:
    maker = bar(6)
    turns = [(2, "z", 60), (3, "x", -80), (4, "y", 120), (5, "z", 70)]
    channels = [
        (node, "rotation", [0.0, 1.0], [turn(axis, 0), turn(axis, degrees)], "LINEAR") for node, axis, degrees in turns
    ]
    add_clip(maker, "bend", channels)
    world = load_model_world(write_gltf(folder / "bar.gltf", maker.document()))
    (body,) = world.motion.bodies.values()
    body.skinning = skinning
    (animator,) = world.motion.animators.values()
    animator.play("bend", at=at, speed=0.0)
    world.update()
    return world


@pytest.mark.parametrize("skinning", ["linear", "dual"])
@pytest.mark.parametrize("at", [0.0, 0.4, 1.0])
def test_boxes_of_a_bent_body_hold_its_triangles(at, skinning, tmp_path):
    world = _bent_bar(tmp_path, skinning, at)
    (body,) = world.motion.bodies.values()
    shapes = ShapeBoxes(world, SkinnedMeshes())
    boxes = shapes.of(list(body.meshes))
    assert boxes is not None
    for mesh in body.meshes.values():
        assert _outside(_scattered(replace(mesh, positions=posed_positions(mesh, body)), 2000), boxes) == 0
    before = boxes.copy()
    (animator,) = world.motion.animators.values()
    animator.play("bend", at=0.5 * at + 0.1, speed=0.0)
    world.update()
    shapes.bend(body, list(body.meshes), boxes)
    assert not np.array_equal(boxes, before)
    for mesh in body.meshes.values():
        assert _outside(posed_positions(mesh, body), boxes) == 0


def test_boxes_of_a_body_that_left_its_world_are_dropped(tmp_path):
    world = _bent_bar(tmp_path, "linear", 0.4)
    (body,) = world.motion.bodies.values()
    shapes = ShapeBoxes(world, SkinnedMeshes())
    assert shapes.of(list(body.meshes)) is not None
    gone = weakref.ref(body)
    world.motion.remove([body.entity])
    del body
    gc.collect()
    assert gone() is None


def test_boxes_of_a_person_hold_all_levels_and_morphs_in_a_third_of_the_space():
    world = load_model_world(root() / "assets" / "models" / "avatars" / "player_white.glb")
    for body in world.motion.bodies.values():
        body.skinning = "dual"
        body._morphs[:] = 1.0
    (animator,) = world.motion.animators.values()
    animator.play("kick", at=0.6, speed=0.0)
    world.update()
    shapes = ShapeBoxes(world, SkinnedMeshes())
    for body in world.motion.bodies.values():
        boxes = shapes.of(list(body.meshes))
        assert boxes is not None
        for mesh in body.meshes.values():
            assert _outside(posed_positions(mesh, body), boxes) == 0
        least, greatest = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        if greatest[1] - least[1] > 1.0:  # not the head
            assert _outside(CHANCE.uniform(least, greatest, (4000, 3)), boxes) > 0.66 * 4000


def test_where_a_shadow_falls_is_in_one_of_the_prisms():
    chance = np.random.default_rng(7)  # one that puts enough into the shade, whatever other tests drew
    sun = np.array([0.4, 0.8, 0.2]) / np.linalg.norm([0.4, 0.8, 0.2])
    across = np.cross(sun, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    rays = np.stack([across, np.cross(sun, across), sun])
    nodes = np.tile(np.eye(4), (12, 1, 1))
    nodes[:, :3, :3] += chance.normal(0.0, 0.4, (12, 3, 3))
    nodes[:, :3, 3] = chance.uniform(-1.0, 1.0, (12, 3)) * [1.0, 0.3, 1.0]
    half = chance.uniform(0.0, 0.3, (12, 3)) * [1.0, 0.2, 1.0]
    receivers = np.stack([-half, half], axis=1)
    casting = (
        chance.uniform(-0.6, 0.6, (6, 1, 3))
        + [[[0.4, 1.2, 0.2]]]
        + np.array([[[-1.0]], [[1.0]]]).reshape(1, 2, 1) * chance.uniform(0.02, 0.15, (6, 1, 3))
    )
    corners = np.stack([casting[:, (k & 1, k >> 1 & 1, k >> 2), (0, 1, 2)] for k in range(8)], axis=1)
    starts = np.array([0, 2, 6], np.int32)
    casters, casts = np.empty((2 * 3, FIGURES)), np.ones(2, np.bool_)
    assert slice_casters(corners, starts, casts, rays, np.zeros(3), 0.0, 3, casters) == 6
    prisms, fallen = np.empty((4096, 8, 3)), np.zeros(12, np.uint8)
    numbers = np.arange(12, dtype=np.int32)
    count = cut_prisms(casters, rays, 0.0, receivers, numbers, nodes, prisms, fallen)
    held = np.einsum("ij,nkj->nki", rays, prisms[:count])
    boxes = np.stack([held.min(axis=1), held.max(axis=1)], axis=1)
    shaded = 0
    for number in range(12):
        points = chance.uniform(-1.0, 1.0, (3000, 3)) * half[number] @ nodes[number, :3, :3].T + nodes[number, :3, 3]
        along = (casting[:, :, None] - points) / sun
        enter, leave = along.min(axis=1).max(axis=2), along.max(axis=1).min(axis=2)
        under = ((enter <= leave) & (leave > 0.0)).any(axis=0)
        shaded += int(under.sum())
        assert _outside(points[under] @ rays.T, boxes) == 0
        assert fallen[number] or not under.any()
    assert shaded > 500
    assert not fallen.all()
    few = np.empty((3, 8, 3))
    assert cut_prisms(casters, rays, 0.0, receivers, numbers, nodes, few, fallen) == count > 3
    assert slice_casters(corners, starts, ~casts, rays, np.zeros(3), 0.0, 3, casters) == 0, "they cast no shadow"
    assert slice_casters(corners, starts, casts, rays, np.full(3, 99.0), 0.01, 3, casters) == 2, "slices are not seen"


def test_a_shape_that_changes_is_where_it_was_and_where_it_is():
    world, hulls = World(), np.empty((999, 8, 3))
    world.meshes["ring"] = torus(1.0, 0.1)
    ring, still = (world.root.create_child(name) for name in ("ring", "still"))
    for node in (ring, still):
        node.create_entity("ring", "default")
    world.update()
    view = View(compose_look_at((0.0, 2.0, 3.0), (0.0, 0.0, 0.0)), (-1.0, 1.0, -1.0, 1.0), (0, 0, 64, 64))
    with create_surface("egl", (64, 64)) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=0, shadow_size=0))
        renderer.draw([view])
        listed = renderer._list
        shapes = PlacedShapes(listed.items, ShapeBoxes(world, SkinnedMeshes()))
        known = ShapeBoxes(world, SkinnedMeshes()).of(["ring"])
        assert known is not None
        fine = len(known)

        def place(room: np.ndarray = hulls) -> tuple[int, ...] | None:
            """Return how many hulls there are below and above the plane x = 10, before and after another frame."""
            before = place_items(listed, listed.shown_in(view, (64, 64), 0))
            world.update()
            renderer.draw([view])
            after = place_items(listed, listed.shown_in(view, (64, 64), 0))
            changed = listed.moved | (before.shown != after.shown)
            found = shapes.place(before, after, changed, room)
            shapes.compute_missed(after.shown)
            if found is None:
                return None
            assert len(found.casting) == len(found.starts) - 1 == bool(len(found.corners))
            side = found.corners[:, 0, 0] > 10.0
            return int((~side).sum()), int(side.sum())

        assert place() == (0, 0), "nothing moved"
        ring.set_position((20.0, 0.0, 0.0))
        assert place() == (1, 1), "its boxes are not known yet"
        ring.set_position((0.0, 0.0, 0.0))
        assert place() == (fine, 1), "where it was one box holds it, since it was not placed there"
        assert place() == (0, 0)
        ring.set_position((20.0, 0.0, 0.0))
        assert place() == (fine, fine), "it was placed there two frames ago"
        ring.visible = False
        assert place() == (0, fine)
        ring.set_position((0.0, 0.0, 0.0))
        assert place() == (0, 0), "nobody sees it"
        ring.visible = True
        assert place() == (fine, 0)
        ring.set_position((20.0, 0.0, 0.0))
        assert place(hulls[: fine + 1]) is None
        ring.set_position((0.0, 0.0, 0.0))
        assert place() == (fine, 1), "where too many were found they count as one again"
        renderer.release()


def test_boxes_of_a_body_are_those_of_its_drawn_levels():
    world = load_model_world(root() / "assets" / "models" / "avatars" / "player_white.glb")
    (animator,) = world.motion.animators.values()
    view = View(compose_look_at((0.0, 2.0, 3.0), (0.0, 0.0, 0.0)), (-1.0, 1.0, -1.0, 1.0), (0, 0, 64, 64))
    with create_surface("egl", (64, 64)) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=0, shadow_size=0))
        renderer.draw([view])
        listed, sizes = renderer._list, []
        items, shapes = listed.items, PlacedShapes(listed.items, ShapeBoxes(world, SkinnedMeshes()))
        levels = [items.levels == 0, items.levels == 1]
        assert levels[1].any()
        for step in range(8):
            before, shown = place_items(listed, levels[(step - 1) // 2 % 2]), levels[step // 2 % 2]
            animator.play("kick", at=0.1 + 0.1 * step, speed=0.0)
            world.update()
            renderer.draw([view])
            after = place_items(listed, shown)
            shapes.follow(shown, listed.rewritten)
            found = shapes.place(before, after, before.shown | shown, np.empty((9999, 8, 3)))
            assert found is not None
            boxes = np.stack([found.corners.min(axis=1) - 1e-6, found.corners.max(axis=1) + 1e-6], axis=1)
            for item in np.flatnonzero(shown).tolist():
                name, pose = items.mesh_names[items.meshes[item]], after.world[items.rows[item]]
                points = posed_positions(world.meshes[name], world.motion.body_of[name]) @ pose[:3, :3].T + pose[:3, 3]
                assert _outside(points, boxes) == 0
            shapes.compute_missed(shown)
            sizes.append(len(shapes.boxes))
        assert 0 < sizes[0] == sizes[1] < sizes[2] == sizes[7], "those of each level are kept"
        assert len(found.corners) > 100, "not the items' own boxes"
