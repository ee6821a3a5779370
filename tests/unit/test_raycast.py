"""Rays against triangles: closed forms, an independent solver, and the cases where a naive test fails."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.raycast import cast_ray, meet_triangles
from mimics_app.world.content.world import World

DOWN = np.array([0.0, -1.0, 0.0])


def make_world() -> World:
    world = World()
    world.replace_mesh("box", box(1.0, 1.0, 1.0))
    world.replace_mesh("plane", plane(10.0, 10.0))
    return world


def test_random_triangles_against_a_linear_solver():
    """t d = a + u (b - a) + v (c - a) - o, solved by elimination; both must agree on hit, miss and distance."""
    rng = np.random.default_rng(3)
    corners = rng.normal(size=(2000, 3, 3))
    origin = np.array([2.0, 1.0, -1.5])
    direction = -0.7 * origin
    ours = meet_triangles(origin, direction, corners)
    for distance, (a, b, c) in zip(ours, corners, strict=True):
        t, u, v = np.linalg.solve(np.stack([direction, a - b, a - c], axis=1), a - origin)
        inside = min(t, u, v, 1.0 - u - v)
        if abs(inside) > 1e-9:  # nearer to an edge rounding decides
            assert np.isfinite(distance) == (inside > 0.0)
        if inside > 1e-9:
            assert distance == pytest.approx(t, rel=1e-9)
    assert 10 < np.isfinite(ours).sum() < 1990, "the test must see both"


def test_a_ray_in_the_plane_of_a_triangle_misses_it():
    corners = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
    assert np.isinf(meet_triangles(np.array([-1.0, 0.0, 0.2]), np.array([1.0, 0.0, 0.0]), corners)).all()


def test_nearest_first_through_rotated_scaled_and_mirrored_nodes():
    world = make_world()
    high = world.root.create_child("high", (0.2, 3.0, 0.0), scale=(-2.0, 1.0, 1.0))
    turned = high.create_child("turned", (0.0, -1.5, 0.0), (0.0, 0.0, np.sin(np.pi / 8), np.cos(np.pi / 8)))
    high.create_entity("box")
    turned.create_entity("box")
    world.root.create_child("floor").create_entity("plane")
    world.update()
    hits = cast_ray(world, np.array([0.2, 10.0, 0.1]), 2.0 * DOWN)
    assert [world.node(hit.entity).name for hit in hits] == ["high", "turned", "floor"]
    # Turned by 45 degrees the box stands on its edge, half a diagonal high; half as many lengths of a ray of length 2.
    tops = np.array([3.5, 1.5 + np.sqrt(0.5), 0.0])
    assert [hit.distance for hit in hits] == pytest.approx((10.0 - tops) / 2.0, abs=1e-7)
    assert [hit.point_world[1] for hit in hits] == pytest.approx(tops, abs=1e-6)


def test_what_is_hidden_behind_the_eye_flat_or_empty_is_not_met():
    world = make_world()
    world.root.create_child("behind", (0.0, 5.0, 0.0)).create_entity("box")
    world.root.create_child("flat", scale=(1.0, 0.0, 1.0)).create_entity("box")
    hidden = world.root.create_child("hidden", (0.0, -1.0, 0.0))
    hidden.create_entity("box")
    hidden.visible = False
    world.update()
    assert cast_ray(world, np.array([0.0, 2.0, 0.0]), DOWN) == []


def test_a_sphere_is_met_where_its_triangles_are():
    """An eye inside meets it from within; the sagitta of its facets bounds the error."""
    world = World()
    segments = 64
    world.replace_mesh("ball", sphere(1.0, segments))
    world.root.create_child("ball").create_entity("ball")
    world.update()
    (hit,) = cast_ray(world, np.zeros(3), np.array([0.3, 0.4, -0.5]))
    sagitta = 1.0 - np.cos(np.pi / segments) ** 2
    assert 1.0 - sagitta - 1e-6 <= np.linalg.norm(hit.point_world) <= 1.0 + 1e-6
