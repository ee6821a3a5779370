"""Culling without a driver: no vertex inside is lost, both ways find the same, one test takes a subtree along."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.groups.culling import make_probe
from mimics_app.maths.mat import compose, look_at
from mimics_app.rendering.visual.drawing.culling import FlatCuller, TreeCuller, make_culler
from mimics_app.rendering.visual.kernels.bounds import update_bounds
from mimics_app.rendering.visual.kernels.frustum import find_planes
from mimics_app.rendering.visual.kernels.order import Sorted, make_keys, sort_by_key
from mimics_app.rendering.visual.view import View, compute_frustum_planes
from tests.support.boxes import as_items


def random_view(rng):
    left, bottom = rng.uniform(-1.2, 0.2, 2)
    tangents = (left, left + rng.uniform(0.3, 1.5), bottom, bottom + rng.uniform(0.3, 1.5))
    return View(
        look_at(8 * rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)), tangents, (0, 0, 64, 36), 0.1, 60.0
    )


def sheared(rng, count):
    """Places, turns and uneven scales, some mirrored; every second one under another such node: sheared."""

    def one():
        return compose(
            6 * rng.normal(size=3), rng.normal(size=4), rng.uniform(0.2, 3.0, 3) * rng.choice([-1.0, 1.0], 3)
        )

    return np.array([one() @ one() if k % 2 else one() for k in range(count)])


def bounds_of(items, world):
    count = len(items.rows)
    centres, radii, mirrored = np.zeros((count, 3)), np.zeros(count), np.zeros(count, np.uint8)
    moved = np.ones(len(world), np.uint8)
    update_bounds(items.rows, world, moved, True, items.local, centres, radii, mirrored)
    return centres, radii, mirrored


def test_every_corner_lies_in_its_sphere_under_any_matrix():
    rng = np.random.default_rng(1)
    half = rng.uniform(0.1, 2.0, (500, 3))
    world, items = sheared(rng, 500), as_items(half)
    centres, radii, mirrored = bounds_of(items, world)
    signs = np.array([[(k >> axis & 1) * 2.0 - 1.0 for axis in range(3)] for k in range(8)])
    corners = np.einsum("nij,nkj->nki", world[:, :3, :3], half[:, None] * signs) + world[:, None, :3, 3]
    away = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    assert (away <= radii * (1 + 1e-12)).all()
    largest = np.linalg.norm(world[:, :3, :3], 2, axis=(1, 2)) * np.linalg.norm(half, axis=1)
    straight = np.arange(500) % 2 == 0
    assert np.allclose(radii[straight], largest[straight], rtol=1e-12), "exact where axes are at right angles"
    assert (radii <= np.sqrt(3.0) * largest * (1 + 1e-12)).all()
    assert np.array_equal(mirrored.astype(bool), np.linalg.det(world[:, :3, :3]) < 0.0)


def test_with_a_far_plane_at_infinity_nothing_is_too_far():
    """The projection of Lengyel's limit: third row (0, 0, -1, -2 near)."""
    projection = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, -1.0, -0.2], [0, 0, -1.0, 0]])
    planes = np.zeros((6, 4))
    find_planes(projection, planes)
    assert np.isfinite(planes).all()
    far_away = np.array([0.0, 0.0, -1e12, 1.0])
    assert (planes @ far_away > 0.0).all() and not (planes @ np.array([0.0, 0.0, 1.0, 1.0]) > 0.0).all()


def test_the_corners_of_a_frustum_lie_on_three_of_its_planes_each():
    rng = np.random.default_rng(2)
    for _ in range(50):
        view = random_view(rng)
        inverse = np.linalg.inv(view.clip_from_world)
        planes = compute_frustum_planes(view.clip_from_world)
        clip = np.array([[x, y, z, 1.0] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) @ inverse.T
        corners = clip[:, :3] / clip[:, 3:]
        depths = corners @ planes[:, :3].T + planes[:, 3]
        on = np.sort(np.abs(depths), axis=1)[:, :3]
        assert on.max() < 1e-8 * 60.0 / 0.1
        assert depths.min() > -1e-6


@pytest.mark.parametrize("seed", range(4))
def test_no_node_with_a_corner_inside_is_lost_and_both_ways_agree(seed):
    rng = np.random.default_rng(seed)
    count = 400
    half = rng.uniform(0.1, 1.5, (count, 3))
    world, items = sheared(rng, count), as_items(half)
    centres, radii, _ = bounds_of(items, world)
    parents = np.array([-1, *(rng.integers(0, k) for k in range(1, count))], np.int32)
    flat, tree = FlatCuller(items), TreeCuller(items, parents, world[:, :3, 3])
    signs = np.array([[(k >> axis & 1) * 2.0 - 1.0 for axis in range(3)] for k in range(8)])
    corners = np.einsum("nij,nkj->nki", world[:, :3, :3], half[:, None] * signs) + world[:, None, :3, 3]
    shown = (rng.uniform(size=count) < 0.9).astype(np.uint8)
    for _ in range(20):
        planes = compute_frustum_planes(random_view(rng).clip_from_world)
        found = []
        for culler in (flat, tree):
            out = np.zeros(count, np.int32)
            culler.moved(count, centres, radii)
            found.append(set(out[: culler.cull(planes, shown, world, centres, radii, out)].tolist()))
        inside = (corners @ planes[:, :3].T + planes[:, 3] >= 0.0).all(axis=2).any(axis=1)
        assert found[0] == found[1]
        assert set(np.flatnonzero(inside & (shown > 0)).tolist()) <= found[0]
        assert len(found[0]) < count


def test_a_rejected_node_takes_all_below_it_along_by_one_test():
    """A deep chain and a wide crowd, both behind the eye; then in front, where no item is tested either."""
    for parents in (np.arange(-1, 999), np.array([-1, *[0] * 999])):
        items = as_items(np.full((1000, 3), 0.1))
        world = np.tile(np.eye(4), (1000, 1, 1))
        world[:, :3, 3] = np.random.default_rng(0).uniform(-1, 1, (1000, 3))
        tree = TreeCuller(items, parents.astype(np.int32), world[:, :3, 3])
        for z, found in ((20.0, 0), (-20.0, 1000)):
            centres = world[:, :3, 3] + [0, 0, z]
            planes = compute_frustum_planes(View(np.eye(4), (-1, 1, -1, 1), (0, 0, 9, 9), 0.1, 100.0).clip_from_world)
            out = np.zeros(1000, np.int32)
            tree.moved(1000, centres, np.full(1000, 0.2))
            moved = world.copy()
            moved[:, :3, 3] = centres
            assert tree.cull(planes, np.ones(1000, np.uint8), moved, centres, np.full(1000, 0.2), out) == found
            assert tree.tests == 1


def test_what_did_not_move_is_not_fitted_again_and_what_did_is():
    probe = make_probe(400)
    tree = TreeCuller(probe.items, probe.parents, probe.world[:, :3, 3])
    first = probe.run(tree)
    away = probe.centres + [0.0, 1000.0, 0.0]
    out, shown = np.zeros(400, np.int32), np.ones(400, np.uint8)
    tree.moved(400, away, probe.radii)
    assert tree.cull(probe.planes, shown, probe.world, away, probe.radii, out) == 0
    tree.moved(400, probe.centres, probe.radii)
    assert tree.cull(probe.planes, shown, probe.world, probe.centres, probe.radii, out) == len(first) > 0
    assert isinstance(make_culler("auto", probe.items, probe.parents, probe.world[:, :3, 3]), FlatCuller)


@pytest.mark.parametrize("layered", [False, True])
@pytest.mark.parametrize("count", [0, 1, 300, 6000])
def test_draw_order_is_layer_then_state_then_distance_then_mesh(count, layered):
    """Against a plain sort; of many items a quarter of an octave of distance shares a place."""
    rng = np.random.default_rng(count)
    centres, radii = 50 * rng.normal(size=(count, 3)), rng.uniform(0.1, 3.0, count)
    states, meshes = rng.integers(0, 5, count).astype(np.int32), rng.integers(0, 9, count).astype(np.int32)
    mirrored = rng.integers(0, 2, count).astype(np.uint8)
    picked, keys = np.arange(count, dtype=np.int32), np.zeros(count, np.uint64)
    scratch = np.zeros(count, np.float32)
    make_keys(picked, count, np.zeros(3), Sorted(centres, radii, states, mirrored, meshes), layered, scratch, keys)
    wanted = keys.copy()
    sort_by_key(
        keys, picked, count, np.zeros(count, np.uint64), np.zeros(count, np.int32), np.zeros((8, 256), np.int32)
    )
    assert np.array_equal(picked, np.argsort(wanted, kind="stable"))
    away = np.linalg.norm(centres, axis=1)
    away = np.where(away > radii, away, away + radii)[picked].astype(np.float32)
    mantissa, octave = np.frexp(np.minimum(away, 64.0))
    layer = (4 * octave + np.floor(8.0 * mantissa)) * layered
    state = (2 * states + mirrored)[picked]
    places = list(zip(layer.tolist(), state.tolist(), strict=True))
    assert places == sorted(places)
    slack = 2.0**-12 if count <= 4096 else 0.25
    for one in dict.fromkeys(places):
        row = away[[place == one for place in places]]
        assert (row[1:] >= row[:-1] / (1.0 + slack) - 1e-9).all()
