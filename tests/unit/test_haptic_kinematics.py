"""Equations 1-4 of D2.1: round trips, differences, duality, and the places where the printed forms fail."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.maths.vec import clamp_joints
from mimics_app.rendering.haptic.kernels import kinematics as kin

D1 = 0.46
RANDOM_POSES = 20_000


def _poses(n: int = 500) -> np.ndarray:
    rng = np.random.default_rng(4)
    return rng.uniform([-0.18, -0.5, -0.2], [0.18, 0.5, 0.2], (n, 3))


def _matrix(function, *args) -> np.ndarray:
    out = np.full((3, 3), np.nan)
    function(*args, out)
    return out


def _vector(function, *args) -> np.ndarray:
    out = np.full(3, np.nan)
    function(*args, out)
    return out


def test_origin_of_the_joints_is_origin_of_the_robot_frame():
    assert np.all(_vector(kin.forward, np.zeros(3), D1) == 0.0)


def test_round_trip_over_the_whole_workspace():
    worst = 0.0
    for q in _poses(RANDOM_POSES):
        back = np.zeros(3)
        kin.inverse(_vector(kin.forward, q, D1), D1, back)
        worst = max(worst, float(np.abs(back - q).max()))
    assert worst <= 1e-12


def test_quadrant_behind_the_axis_is_kept():
    q = np.zeros(3)
    kin.inverse(np.array([-0.1 - D1, 0.05, 0.0]), D1, q)
    assert q[1] == pytest.approx(math.atan2(0.05, -0.1), abs=1e-15)
    assert q[1] == pytest.approx(2.678, abs=1e-3)  # the printed arctg(y / (x + d1)) gives -0.46


def test_on_the_axis_the_last_angle_stays():
    q = np.array([0.1, 0.3, 0.0])
    kin.inverse(np.array([-D1, 0.0, 0.07]), D1, q)
    assert q.tolist() == [-D1, 0.3, 0.07]


def test_angle_is_continuous_on_a_circle_about_the_axis():
    angles = []
    q = np.zeros(3)
    for a in np.linspace(-3.0, 3.0, 601):
        kin.inverse(np.array([0.4 * math.cos(a) - D1, 0.4 * math.sin(a), 0.0]), D1, q)
        angles.append(q[1])
    assert np.allclose(np.diff(angles), 0.01, atol=1e-12)


def test_clamp_names_the_joint_that_was_outside():
    q = np.array([0.2, 0.0, -0.3])
    assert clamp_joints(q, np.array([-0.18, -0.5, -0.2]), np.array([0.18, 0.5, 0.2])) == 0b101
    assert q.tolist() == [0.18, 0.0, -0.2]


def test_jacobian_is_the_central_difference_of_the_position():
    h = 1e-6  # error h^2/6 * r ~ 1e-13, rounding 1e-16/h ~ 1e-10
    for q in _poses(100):
        J = _matrix(kin.jacobian, q, D1)
        for j in range(3):
            step = np.zeros(3)
            step[j] = h
            column = (_vector(kin.forward, q + step, D1) - _vector(kin.forward, q - step, D1)) / (2 * h)
            assert np.allclose(J[:, j], column, atol=5e-10)
        assert np.linalg.det(J) == pytest.approx(q[0] + D1, abs=1e-14)


def test_vector_forms_equal_the_matrices():
    rng = np.random.default_rng(6)
    for q in _poses(200):
        dq, v = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)
        assert np.allclose(_vector(kin.apply_jacobian, q, D1, dq), _matrix(kin.jacobian, q, D1) @ dq, atol=1e-15)
        inverse = np.linalg.solve(_matrix(kin.jacobian, q, D1), v)
        assert np.allclose(_vector(kin.apply_inverse_jacobian, q, D1, v), inverse, atol=1e-14)


def test_power_is_the_same_in_both_frames():
    rng = np.random.default_rng(7)
    for q in _poses():
        f, dq = rng.uniform(-50, 50, 3), rng.uniform(-1, 1, 3)
        torque = _vector(kin.apply_jacobian_transposed, q, D1, f)
        assert f @ _vector(kin.apply_jacobian, q, D1, dq) == pytest.approx(torque @ dq, rel=1e-12, abs=1e-12)


def test_tool_frame_turns_with_the_arm():
    q = np.array([0.0, math.pi / 2, 0.0])
    assert np.allclose(_vector(kin.tool_to_robot, q, np.array([1.0, 2.0, 3.0])), [-2.0, 1.0, 3.0], atol=1e-15)
    for q in _poses(50):
        f = np.array([1.0, -2.0, 3.0])
        assert np.allclose(_vector(kin.robot_to_tool, q, _vector(kin.tool_to_robot, q, f)), f, atol=1e-15)
