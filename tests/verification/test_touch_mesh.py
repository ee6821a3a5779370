"""The finger on triangle meshes: against analytic shapes, brute force, and everything a stand-in may fall through."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import (
    ANY_DIRECTION,
    closest_on_triangle,
    closest_triangle,
    first_crossing,
)
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from tests.support.meshes import GROOVE, extruded
from tests.support.touch_play import BLOCK, BLOCK_TRIANGLES, RIM, add_point, at_rest, follow, new_touch_play

K = 2000.0
NEAR = pytest.approx


def ball(radius, n, bump=0.0):
    """(vertices, triangles) of a sphere of n x n patches about y; `bump` makes its radius wave by that share."""
    polar, round_ = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, n + 1), indexing="ij")
    r = radius * (1.0 + bump * np.sin(5 * polar) * np.sin(4 * round_))
    points = (
        np.stack([np.sin(polar) * np.sin(round_), np.cos(polar), np.sin(polar) * np.cos(round_)], -1) * r[..., None]
    )
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    q = (i * (n + 1) + j).ravel()
    triangles = np.concatenate([np.stack([q, q + n + 1, q + 1], 1), np.stack([q + 1, q + n + 1, q + n + 2], 1)])
    return points.reshape(-1, 3), triangles


def one_mesh(mesh, radius=0.0, **fields):
    play = new_touch_play([mesh])
    play.add_shape(ShapeKind.MESH, (), **{"damping": 0.0, **fields})
    add_point(play, radius=radius)
    return play


SLAB = extruded([(0.0, -0.05), (0.0, 0.05), (-0.005, 0.05), (-0.005, -0.05)][::-1])
SHEET = (
    np.array([[-0.05, -0.05, 0.0], [0.05, -0.05, 0.0], [0.05, 0.05, 0.0], [-0.05, 0.05, 0.0]]),
    [[0, 1, 2], [0, 2, 3]],
)


def random_queries(count=300):
    rng = np.random.default_rng(11)
    table = build_mesh_table([ball(0.01, 4), ball(0.02, 15, 0.1)])
    return table, table.rows[1], rng.uniform(-0.03, 0.03, (count, 3)), rng.uniform(-0.03, 0.03, (count, 3))


def test_closest_triangle_is_that_of_all_of_them():
    table, mesh, points, _ = random_queries()
    out = np.zeros(3)
    own = range(int(mesh["first_triangle"]), int(mesh["first_triangle"] + mesh["triangles"]))
    for p in points:
        found = closest_triangle(mesh, table.vertices, table.corners, table.boxes, p, 1.0, ANY_DIRECTION, out)
        assert found in own
        distances = []
        for t in (found, *own):
            closest_on_triangle(table.vertices, table.corners, t, p, out)
            distances.append(np.linalg.norm(p - out))
        assert distances[0] <= min(distances) * (1.0 + 1e-8)
        near = 0.999 * distances[0]
        assert closest_triangle(mesh, table.vertices, table.corners, table.boxes, p, near, ANY_DIRECTION, out) == -1


def test_closest_point_of_a_triangle_is_that_of_a_fine_grid():
    """Every region; the grid of 200 x 200 finds no closer point, and comes within its pitch."""
    rng = np.random.default_rng(2)
    u, v = np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200))
    keep = u + v <= 1.0
    regions = set()
    for _ in range(60):
        corners = rng.normal(size=(3, 3))
        p, out = 3.0 * rng.normal(size=3), np.zeros(3)
        regions.add(closest_on_triangle(corners, np.array([[0, 1, 2]], np.int32), 0, p, out))
        grid = corners[0] + u[keep, None] * (corners[1] - corners[0]) + v[keep, None] * (corners[2] - corners[0])
        least = np.linalg.norm(grid - p, axis=1).min()
        assert least - 0.03 <= np.linalg.norm(out - p) <= least + 1e-12
    assert regions == set(range(7))


def test_first_crossing_is_that_of_all_of_them():
    """Against every triangle by the signs of five determinants."""
    table, mesh, starts, ends = random_queries()
    first, count = int(mesh["first_triangle"]), int(mesh["triangles"])
    hits = 0
    for a, b in zip(starts, ends, strict=True):
        expected, earliest = -1, 2.0
        for t in range(first, first + count):
            x, y, z = table.vertices[table.corners[t]]
            n = np.cross(y - x, z - x)
            before, after = n @ (a - x), n @ (b - x)
            if before < 0.0 or after >= 0.0:
                continue
            q = a + before / (before - after) * (b - a)
            if min(np.cross(w - v, q - v) @ n for v, w in ((x, y), (y, z), (z, x))) >= 0.0:
                share = before / (before - after)
                if share < earliest:
                    expected, earliest = t, share
        assert first_crossing(mesh, table.vertices, table.corners, table.boxes, a, b, np.zeros(3)) == expected
        hits += expected >= 0
    assert hits > 50


def test_block_is_the_box_on_a_path_over_its_top():
    """Pressed in and slid about the top, no nearer to the edges than the point is deep: the same force."""
    play, box = one_mesh((BLOCK, BLOCK_TRIANGLES)), new_touch_play()
    box.add_shape(ShapeKind.BOX, (2 * RIM,) * 3, damping=0.0)
    add_point(box)
    t = np.linspace(0.0, 20.0, 4000)
    path = np.stack([0.014 * np.sin(3 * t), 0.014 * np.cos(2.1 * t), RIM - 2e-3 + 3e-3 * np.cos(0.7 * t)], 1)
    expected = follow(box, path)
    assert np.abs(expected).max() > 5.0
    assert np.abs(follow(play, path) - expected).max() < 1e-9


@pytest.mark.parametrize("n", [16, 48])
def test_fine_ball_comes_to_the_sphere(n):
    """A facet lies r (1 - cos(pi/n)) or less under the sphere, and turns by pi/n or less from it."""
    rng = np.random.default_rng(1)
    mesh = ball(RIM, n)
    error = RIM * (1.0 - np.cos(np.pi / n) ** 2)
    for _ in range(40):
        n_out = rng.normal(size=3)
        n_out /= np.linalg.norm(n_out)
        force = at_rest(one_mesh(mesh), 1.5 * RIM * n_out, (RIM - 3e-3) * n_out)
        assert np.linalg.norm(force) == NEAR(K * 3e-3, abs=K * 1.5 * error)
        assert n_out @ force / np.linalg.norm(force) > np.cos(1.6 * np.pi / n)


def random_path(seed, ticks=4000):
    """Up to 2 mm a tick about the surface of a ball of RIM, seldom deeper than half its radius."""
    rng = np.random.default_rng(seed)
    place, speed, path = np.array([0.03, 0.0, 0.0]), np.zeros(3), np.empty((ticks, 3))
    for i in range(ticks):
        inward = place * (1.0 - 0.97 * RIM / np.linalg.norm(place))
        speed = np.clip(0.98 * speed + rng.normal(0.0, 1.5e-4, 3) - 0.01 * inward, -2e-3, 2e-3)
        place = place + speed
        path[i] = place
    return path


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("bump", [0.0, 0.15])
def test_nothing_falls_through_a_ball(seed, bump):
    """Over and through edges and corners of a smooth and of a bumpy one: whoever is inside is held."""
    path = random_path(seed)
    far = np.linalg.norm(path, axis=1)
    held = follow(one_mesh(ball(RIM, 24, bump)), path).any(axis=1)
    inside = far < 0.98 * (1.0 - bump) * RIM
    assert 300 < np.count_nonzero(inside) < 3700
    assert held[inside].all()
    if bump == 0.0 and far.min() > 0.3 * RIM:
        assert not held[far > RIM].any(), "and whoever is outside is free"


@pytest.mark.parametrize("where", ["edge", "corner", "diagonal"])
def test_through_an_exact_edge_or_corner_it_is_caught(where):
    """The way in passes exactly through an edge or corner that triangles share."""
    n = 8
    vertices, triangles = ball(RIM, n)
    play = one_mesh((vertices, triangles))
    a, b, c = vertices[triangles[37]]
    target = {"edge": 0.5 * (a + b), "corner": a, "diagonal": 0.25 * b + 0.75 * c}[where]
    force = follow(play, [1.2 * target, 0.8 * target], np.zeros(3))[-1]
    assert force @ target > 0.0


def test_corner_slide_pushes_out_of_no_other_side():
    """Figure 27 on a mesh: 3 mm deep along the top to the side: up, without a jump, until it is round the edge."""
    play = one_mesh((BLOCK, BLOCK_TRIANGLES))
    path = [(0.0, 0.003, z) for z in np.linspace(0.021, 0.017, 50)]
    path += [(x, 0.003, 0.017) for x in np.arange(0.0, 0.0199, 4e-6)]
    force = follow(play, path)[50:]
    assert np.abs(np.diff(force, axis=0)).max() < 1e-9
    assert np.abs(force[:, :2]).max() < 1e-9 and force[-1, 2] == NEAR(K * 3e-3)
    assert not at_rest(play, (RIM + 1e-6, 0.003, 0.017)).any()


def test_stand_in_rests_in_the_bottom_of_a_groove():
    """Behind both sides it is pulled to their common edge, along y it slides."""
    play = one_mesh(GROOVE)
    path = [(0.0, 0.0, 0.01), (0.002, 0.0, -0.005), (0.001, 0.01, -0.006), (-0.003, -0.02, -0.006)]
    force = follow(play, path, np.zeros(3))
    for p, f in zip(path[1:], force[1:], strict=True):
        assert f == NEAR(K * np.array([-p[0], 0.0, -p[2]]), abs=1e-9)


def test_out_of_the_groove_only_one_side_is_left():
    play = one_mesh(GROOVE)
    force = at_rest(play, (0.0, 0.0, 0.01), (0.0, 0.0, -0.004), (0.012, 0.0, 0.008))
    assert force == NEAR(K * np.array([-0.002, 0.0, 0.002]), abs=1e-9)


def test_deeper_than_the_object_it_is_still_held():
    """Through a slab of 5 mm and 20 mm beyond: the stand-in stays on the side it came from."""
    play = one_mesh(SLAB)
    force = follow(play, [(0.01, 0.0, z) for z in np.arange(0.01, -0.03, -1e-3)], np.zeros(3))
    assert force[-1] == NEAR(np.array([0.0, 0.0, K * 0.029]), abs=1e-9)
    assert not at_rest(play, (0.06, 0.0, -0.029)).any(), "round the edge it is free"


def test_start_inside_takes_the_nearest_face_of_a_closed_mesh():
    force = at_rest(one_mesh((BLOCK, BLOCK_TRIANGLES)), (0.002, -0.015, 0.004))
    assert force == NEAR(np.array([0.0, -K * 0.005, 0.0]), abs=1e-9)


def test_open_sheet_holds_from_its_front_and_ends_at_its_rim():
    play = one_mesh(SHEET)
    assert at_rest(play, (0.0, 0.0, 0.001), (0.01, 0.0, -0.002)) == NEAR(np.array([0.0, 0.0, K * 2e-3]), abs=1e-9)
    assert not at_rest(play, (0.051, 0.0, -0.002)).any()
    assert not at_rest(play, (0.0, 0.0, -0.002), (0.0, 0.0, 0.002)).any(), "from behind it is open"
    assert not at_rest(one_mesh(SHEET), (0.0, 0.0, -0.002)).any(), "it has no inside to start in"


def test_ball_at_a_ball_is_a_larger_ball():
    play = one_mesh(ball(RIM, 64), radius=0.006)
    error = RIM * (1.0 - np.cos(np.pi / 64) ** 2)
    for n in np.array([[0.0, 0.6, 0.8], [0.48, 0.6, -0.64]]):
        force = at_rest(play, 0.03 * n, (RIM + 0.004) * n)
        assert force == NEAR(K * 0.002 * n, abs=2.0 * K * error)
        assert not at_rest(play, (RIM + 0.0061) * n).any()
        deep = at_rest(play, (RIM + 0.001) * n, (RIM - 0.002) * n)
        assert np.linalg.norm(deep) == NEAR(K * 0.008, abs=2.0 * K * error)


def test_mesh_that_moves_over_a_resting_point_takes_its_stand_in_along():
    """The block rises through the point, then turns: the face that came first is held in its frame."""
    play = new_touch_play()
    body = play.add_body(flags=3, velocity=(0.0, 0.0, 1.0), position=(0.0, 0.0, -0.03))
    play.add_shape(ShapeKind.MESH, (), body, damping=0.0)
    add_point(play)
    force = follow(play, np.tile([0.004, 0.011, 0.0], (16, 1)), np.zeros(3), free=True)
    inside = np.flatnonzero(force.any(axis=1))
    assert inside[0] in (10, 11)
    assert not force[:, :2].any()
    assert force[-1, 2] == NEAR(K * (15 * 1e-3 - 0.01), rel=0.25)


@pytest.mark.parametrize(
    "vertices, triangles, reported",
    [
        (np.zeros((3, 3)), [[0, 1, 2]], "degenerate"),
        (np.eye(3), [], "no triangles"),
        (np.eye(3), [[0, 1, 3]], "vertex 3 of 3"),
        (np.array([[0.0, 0, 0], [1, 0, 0], [0, np.nan, 0]]), [[0, 1, 2]], "finite"),
        (np.vstack([np.eye(3), -np.eye(3)]), [[0, 1, 2], [1, 0, 3], [0, 1, 4]], "three triangles"),
        (np.vstack([np.eye(3), np.zeros((1, 3))]), [[0, 1, 2], [0, 1, 3]], "opposite orientations"),
    ],
)
def test_meshes_that_cannot_be_walked_are_refused_by_name(vertices, triangles, reported):
    with pytest.raises(ValueError, match=reported):
        build_mesh_table([(vertices, np.asarray(triangles, np.int64).reshape(-1, 3))])


def test_a_closed_mesh_wound_inward_is_turned():
    table = build_mesh_table([(BLOCK, BLOCK_TRIANGLES[:, ::-1])])
    assert table.rows[0]["closed"] == 1
    play = one_mesh((BLOCK, BLOCK_TRIANGLES[:, ::-1]))
    assert at_rest(play, (0.0, 0.0, 0.03), (0.0, 0.0, 0.018))[2] == NEAR(K * 2e-3)


def test_a_mesh_of_one_triangle_has_a_tree():
    table = build_mesh_table([(np.eye(3), [[0, 1, 2]])])
    assert len(table.boxes) == 1 and table.rows[0]["leaves"] == 1
