"""Frames along a curve against closed forms, and where two of the three fail."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.groups.tunnel_frame import helix, twist_between
from mimics_app.maths import frames
from tests.support.tunnels import coil, straight, wavy


def helix_error(count):
    points, _, _, tangents, exact = helix(count)
    normals = frames.rotation_minimising_normals(points, tangents, exact[0])
    return np.max(np.abs(twist_between(tangents, normals, exact)))


def test_closed_form_of_the_helix_does_not_turn_about_its_tangent():
    """n' of a rotation-minimising frame is parallel to t: checked by differences, so that the reference is no guess."""
    _, _, _, tangents, normals = helix(200_001)
    change = normals[2:] - normals[:-2]
    binormals = np.cross(tangents, normals)[1:-1]
    step = 4.0 * np.pi * np.hypot(0.1, 0.08 / (2.0 * np.pi)) / 200_000
    assert np.max(np.abs(np.sum(change * binormals, axis=1))) / (2.0 * step) < 1e-6


def test_double_reflection_on_the_helix_is_of_order_four():
    errors = np.array([helix_error(count) for count in (13, 25, 49)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all(orders > 3.8)


def test_normals_stay_unit_and_square_over_many_points():
    points, _, _, tangents, exact = helix(100_001, turns=50.0)
    normals = frames.rotation_minimising_normals(points, tangents, exact[0])
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(np.sum(normals * tangents, axis=1), 0.0, atol=1e-14)


def test_frenet_normal_turns_over_at_an_inflection_and_double_reflection_does_not():
    curve = wavy()
    s = np.linspace(0.0, len(curve.pieces), 4001)
    _, frenet, _ = curve.frame(s, "frenet")
    _, carried, _ = curve.frame(s)
    turn_frenet = np.degrees(np.arccos(np.clip(np.sum(frenet[1:] * frenet[:-1], axis=1), -1.0, 1.0)))
    turn_carried = np.degrees(np.arccos(np.clip(np.sum(carried[1:] * carried[:-1], axis=1), -1.0, 1.0)))
    assert np.count_nonzero(turn_frenet > 179.0) >= 2
    assert turn_carried.max() < 1.0


def test_frenet_normal_of_a_straight_tunnel_is_undefined_and_double_reflection_is_not():
    curve = straight()
    _, frenet, _ = curve.frame([1.0, 2.0], "frenet")
    _, carried, _ = curve.frame([1.0, 2.0])
    assert np.isnan(frenet).all()
    np.testing.assert_allclose(carried, [[0.0, 1.0, 0.0]] * 2, atol=1e-15)


def test_projected_up_is_undefined_where_the_curve_is_vertical():
    normals = frames.projected_up_normals([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], [0.0, 1.0, 0.0])
    assert np.isnan(normals[0]).all()
    np.testing.assert_array_equal(normals[1], [0.0, 1.0, 0.0])


def test_binormal_of_a_planar_curve_is_the_normal_of_its_plane():
    curve = wavy()
    _, _, b = curve.frame(np.linspace(0.0, len(curve.pieces), 1000))
    np.testing.assert_allclose(b, np.broadcast_to([0.0, 0.0, 1.0], b.shape), atol=1e-13)


def test_frames_are_right_handed_and_unit():
    curve = coil()
    s = np.linspace(0.0, len(curve.pieces), 500)
    for method in ("double_reflection", "frenet", "projected_up"):
        t, n, b = curve.frame(s, method)
        stack = np.stack([t, n, b], axis=1)
        np.testing.assert_allclose(
            stack @ stack.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (500, 3, 3)), atol=1e-12
        )
        np.testing.assert_allclose(np.linalg.det(stack), 1.0, atol=1e-12)


def test_one_step_for_many_points_is_the_step_of_the_chain():
    points, _, _, tangents, exact = helix(50)
    chain = frames.rotation_minimising_normals(points, tangents, exact[0])
    single = frames.carry_normals(points[:-1], tangents[:-1], chain[:-1], points[1:], tangents[1:])
    np.testing.assert_allclose(single, chain[1:], atol=1e-14)


def test_points_that_coincide_keep_the_normal():
    normals = frames.rotation_minimising_normals(
        np.zeros((3, 3)), np.tile([1.0, 0.0, 0.0], (3, 1)), np.array([0.0, 1.0, 0.0])
    )
    np.testing.assert_array_equal(normals, [[0.0, 1.0, 0.0]] * 3)


@pytest.mark.parametrize(
    ("points", "tangent", "expected"),
    [
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [1, 0, 0], [0, 1, 0]),
        ([[0, 0, 0], [1, 0, 0], [1, -1, 0]], [1, 0, 0], [0, 1, 0]),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [1, 0, 0], [0, 1, 0]),
        ([[0, 0, 0], [0, 1, 0]], [0, 1, 0], [-1, 0, 0]),
        ([[0, 0, 0], [0, 0, 1]], [0, 0, 1], [1, 0, 0]),
    ],
)
def test_start_normal_lies_in_the_plane_of_the_curve(points, tangent, expected):
    np.testing.assert_allclose(frames.start_normal(points, tangent), expected, atol=1e-12)


def test_start_normal_where_the_best_plane_is_square_to_the_start():
    points = [[0, 0, 0], [0, 0, 0.01], [1, 0, 0.01], [0, 1, 0.01]]
    n = frames.start_normal(points, frames.plane_normal(points))
    assert np.linalg.norm(n) == pytest.approx(1.0)
    assert abs(n @ frames.plane_normal(points)) < 1e-12
