"""Orientation from angular momentum, (12): closed forms of tops, what is conserved, and what the printed form does."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.groups.rotation_update import MOMENTS, RATE, angle_between, drift_of, follow_top
from mimics_app.lab.haptic.printed_equations import rotate_printed
from mimics_app.lab.haptic.rotation_updates import (
    angular_velocity,
    kinetic_energy,
    rotate_axes,
    rotate_exponential,
    rotate_rk4,
    rotate_start,
)
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.rotation import turn_body

TILT = np.array([0.1, -0.2, 0.3, np.sqrt(1.0 - 0.14)])
"""Body from principal axes, of a body that is not modelled along them."""


def rotate_in_the_loop(q, momentum, inverse, dt):
    """As the haptic loop turns a body, whose own frame is tilted against its principal axes."""
    body, conjugate = np.zeros(4), TILT * [-1.0, -1.0, -1.0, 1.0]
    quat.multiply(q, conjugate, body)
    turn_body(body, momentum, inverse, TILT, dt, np.zeros(3))
    quat.multiply(body, TILT, q)


ALL = (rotate_printed, rotate_axes, rotate_start, rotate_exponential, rotate_rk4)


def matrix(q):
    R = np.zeros((3, 3))
    quat.to_matrix(q, R)
    return R


def about(axis, angle):
    """Rotation by `angle` [rad] about an axis, shape [3, 3]."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K


def angle_of(R):
    """Angle of a rotation matrix [rad], also a small one."""
    return 2.0 * math.asin(min(1.0, np.linalg.norm(R - np.eye(3)) / math.sqrt(8.0)))


def identity():
    return np.array([0.0, 0.0, 0.0, 1.0])


def test_12_axisymmetric_top_is_its_closed_form():
    """R(t) = exp(t [L]/I_p) R0 exp(t (1/I_3 - 1/I_p) L_3 [e3]): precession about L and spin about the axis."""
    across, along = 0.02, 0.03
    q = np.array([0.3, -0.2, 0.5, 0.7])
    quat.normalise(q, q)
    R0 = matrix(q)
    L = np.array([0.05, 0.12, -0.08])
    spin = (R0.T @ L)[2] * (1.0 / along - 1.0 / across)
    exact = about(L, 2.0 * np.linalg.norm(L) / across) @ R0 @ about((0.0, 0.0, 1.0), 2.0 * spin)
    inverse = np.array([1.0 / across, 1.0 / across, 1.0 / along])
    for rotate, dt, most in (
        (rotate_rk4, 1e-3, 1e-9),
        (rotate_exponential, 1e-3, 2e-5),
        (rotate_in_the_loop, 1e-3, 2e-5),
    ):
        turned = q.copy()
        for _ in range(round(2.0 / dt)):
            rotate(turned, L, inverse, dt)
        assert angle_of(matrix(turned) @ exact.T) < most, rotate.__name__


@pytest.mark.parametrize(
    "rotate, order",
    [(rotate_start, 1), (rotate_axes, 1), (rotate_exponential, 2), (rotate_in_the_loop, 2), (rotate_rk4, 4)],
)
def test_12_errors_fall_with_the_order_of_the_method(rotate, order):
    """Halving the step divides the error by 2^order, on an asymmetric top over one second."""
    L, inverse = np.array([0.05, 0.12, -0.08]), 1.0 / np.array(MOMENTS)

    def end(method, dt):
        q = identity()
        for _ in range(round(0.5 / dt)):
            method(q, L, inverse, dt)
        return q

    exact = end(rotate_rk4, 2.5e-4)
    coarse, fine = (float(angle_between(end(rotate, dt), exact)) for dt in (0.02, 0.01))
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.35)


def test_12_free_top_keeps_energy_and_angle_at_1_ms():
    """10 s at 7 rad/s about the middle axis: half step within 1e-5 of energy and .25 degrees, start of step 6 %."""
    half, start, rk4 = drift_of("exponential, half step"), drift_of("exponential, start"), drift_of("rk4")
    assert half.energy < 1e-5
    assert half.angle < math.radians(0.25)
    assert start.energy == pytest.approx(0.06, abs=0.005)
    assert rk4.energy < 1e-9
    assert rk4.angle < 1e-7
    reference = follow_top("rk4", 1e-4)
    at_the_end = float(angle_between(follow_top("exponential, half step")[-1], reference[-1]))
    assert at_the_end < math.radians(0.2)


@pytest.mark.parametrize("name", ["axis product", "exponential, start", "exponential, half step", "rk4"])
def test_12_angular_momentum_is_kept_to_1e12(name):
    assert drift_of(name).momentum < 1e-12


def test_12_top_tumbles_and_the_printed_form_never_does():
    """Dzhanibekov: turning about the middle axis it turns over; with a constant inverse inertia never."""
    L, inverse, omega = np.array(MOMENTS) * np.array(RATE), 1.0 / np.array(MOMENTS), np.zeros(3)

    def about_middle(path):
        spins = []
        for q in path:
            angular_velocity(q, L, inverse, omega)
            spins.append((matrix(q).T @ omega)[1])
        return np.array(spins)

    assert np.min(about_middle(follow_top("exponential, half step"))) < -6.9
    assert np.min(about_middle(follow_top("rk4"))) < -6.9
    assert np.min(about_middle(follow_top("printed"))) > 6.8
    printed = float(angle_between(follow_top("printed")[-1], follow_top("rk4")[-1]))
    assert printed > math.radians(60.0)
    assert drift_of("printed").angle > math.radians(170.0)


def test_12_constant_torque_about_a_principal_axis_turns_tau_t2_over_2i():
    """Half the torque's momentum before a step and half after it: exact at any step."""
    torque, dt, L, q = np.array([0.0, 0.0, 0.06]), 1e-2, np.zeros(3), identity()
    for _ in range(100):
        L += 0.5 * dt * torque
        rotate_exponential(q, L, 1.0 / np.array(MOMENTS), dt)
        L += 0.5 * dt * torque
    assert angle_of(matrix(q)) == pytest.approx(0.06 / (2.0 * 0.03), rel=1e-12)


def test_12_isotropic_drag_turns_w0_i_over_b():
    """Omega0 exp(-b t/I): its integral, with the momentum at the middle of each step, to second order."""
    inertia, drag, dt, q = 0.02, 0.05, 1e-3, identity()
    for step in range(1000):
        L = inertia * np.array([1.0, 0.5, -0.3]) * math.exp(-drag * (step + 0.5) * dt / inertia)
        rotate_exponential(q, L, np.full(3, 1.0 / inertia), dt)
    size = np.linalg.norm([1.0, 0.5, -0.3])
    exact = size * inertia / drag * (1.0 - math.exp(-drag / inertia))
    assert angle_of(matrix(q)) == pytest.approx(exact, rel=(drag * dt / inertia) ** 2)


@kernel
def _million_steps(q, L, inverse):
    for _ in range(1_000_000):
        rotate_exponential(q, L, inverse, 1e-3)


def test_12_rotation_stays_a_rotation_for_a_million_steps():
    q, L = identity(), np.array(MOMENTS) * np.array(RATE)
    _million_steps(q, L, 1.0 / np.array(MOMENTS))
    R = matrix(q)
    assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-12)
    assert R.T @ R == pytest.approx(np.eye(3), abs=1e-12)
    assert kinetic_energy(q, L, 1.0 / np.array(MOMENTS)) == pytest.approx(0.5 * L @ np.array(RATE), rel=1e-4)


@pytest.mark.parametrize("rotate", ALL)
def test_12_body_at_rest_stays(rotate):
    q = np.array([0.5, -0.5, 0.5, 0.5])
    rotate(q, np.zeros(3), 1.0 / np.array(MOMENTS), 1e-3)
    assert q.tolist() == [0.5, -0.5, 0.5, 0.5]


@pytest.mark.parametrize("rotate", [rotate_axes, rotate_start, rotate_exponential, rotate_rk4])
def test_12_locked_axis_does_not_turn(rotate):
    """Inverse inertia 0 about x and z: a torque of any direction turns about y only."""
    q = identity()
    for _ in range(100):
        rotate(q, np.array([0.3, 0.1, -0.2]), np.array([0.0, 50.0, 0.0]), 1e-3)
    assert q[0] == q[2] == 0.0
    assert 2.0 * math.atan2(q[1], q[3]) == pytest.approx(0.5, rel=1e-3)


def constant_rate_error(rotate, omega, seconds=10.0, dt=1e-3):
    """Degrees between steps and the exact rotation at a constant angular velocity: that of a body of moments 1."""
    q, omega = identity(), np.array(omega)
    for _ in range(round(seconds / dt)):
        rotate(q, omega, np.ones(3), dt)
    return math.degrees(angle_of(matrix(q) @ about(omega, np.linalg.norm(omega) * seconds).T))


@pytest.mark.parametrize("omega", [(3.0, 4.0, 5.0), (6.0, 8.0, 10.0)])
def test_12_axis_product_drifts_by_its_closed_form(omega):
    """(h/2) |wx wy wz|/|w| rad/s: 2.43 and 9.71 degrees in 10 s at 1 ms, where the exponential map errs by nothing."""
    expected = math.degrees(0.5e-3 * abs(np.prod(omega)) / np.linalg.norm(omega) * 10.0)
    assert constant_rate_error(rotate_axes, omega) == pytest.approx(expected, rel=5e-3)
    assert constant_rate_error(rotate_exponential, omega) < 1e-9


def test_12_axis_product_matches_the_matrices_it_is_written_as():
    omega, dt, q = np.array([3.0, -4.0, 5.0]), 0.05, np.array([0.1, 0.7, -0.3, 0.5])
    quat.normalise(q, q)
    R0, x, y, z = matrix(q), *(dt * omega)
    right, printed = q.copy(), q.copy()
    rotate_axes(right, omega, np.ones(3), dt)
    rotate_printed(printed, omega, np.ones(3), dt)
    rot = [about(e, angle) for e, angle in zip(np.eye(3), (x, y, z), strict=True)]
    assert matrix(right) == pytest.approx(rot[0] @ rot[1] @ rot[2] @ R0, abs=1e-14)
    assert matrix(printed) == pytest.approx(rot[0] @ rot[1] @ rot[1] @ R0, abs=1e-14)


def test_12_literal_product_turns_by_another_velocity():
    """Rot(x) rot(y) rot(y) is the turn of (wx, 2 wy, 0): at (3, 4, 5) rad/s 151 degrees off after 10 s."""
    expected = about((3.0, 8.0, 0.0), math.hypot(30.0, 80.0)) @ about((3.0, 4.0, 5.0), math.sqrt(50.0) * 10.0).T
    assert constant_rate_error(rotate_printed, (3.0, 4.0, 5.0)) == pytest.approx(
        math.degrees(angle_of(expected)), abs=1.0
    )
    assert math.degrees(angle_of(expected)) == pytest.approx(151.0, abs=1.0)


def test_12_angle_between_orientations_knows_no_sign():
    q = np.array([[0.1, 0.2, 0.3, 0.4]]) / np.linalg.norm([0.1, 0.2, 0.3, 0.4])
    assert angle_between(q, -q)[0] == pytest.approx(0.0, abs=1e-15)
