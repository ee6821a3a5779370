"""Admittance control (equations 6, 7) in its three forms, against closed forms and against the seed's own errors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic import AdmittanceForm
from mimics_app.rendering.haptic.kernels.admittance import (
    VirtualMass,
    acceleration_cartesian,
    acceleration_polar,
    acceleration_seed,
    admit,
    limit_motion,
)
from mimics_app.rendering.haptic.kernels.kinematics import (
    apply_inverse_jacobian,
    apply_jacobian,
    forward,
    robot_to_tool,
)

D1 = 0.46
MASS = 3.0
UNLIMITED = 1e9
SEED, POLAR, CARTESIAN = (int(form) for form in AdmittanceForm)


@kernel
def _move(form, q, v, dq, f_robot, damping, ticks, dt, a_max, v_max):
    """A robot that follows at once (q by the midpoint of J^-1 v, or by dq); force constant in the world."""
    f = np.zeros(3)
    scratch = np.zeros(3)
    half = np.zeros(3)
    rate = np.zeros(3)
    for _ in range(ticks):
        robot_to_tool(q, f_robot, f)
        admit(form, q, f, VirtualMass(3.0, damping, a_max, v_max), 0.46, dt, scratch, v, dq)
        if form == 2:
            for i in range(3):
                half[i] = q[i] + 0.5 * dt * dq[i]
            apply_inverse_jacobian(half, 0.46, v, rate)
        else:
            rate[:] = dq
        for i in range(3):
            q[i] += dt * rate[i]


def _start(r: float, dr: float, dphi: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    q, dq, v = np.array([r - D1, 0.0, 0.0]), np.array([dr, dphi, 0.0]), np.zeros(3)
    apply_jacobian(q, D1, dq, v)
    return q, v, dq


def _position(q: np.ndarray) -> np.ndarray:
    x = np.zeros(3)
    forward(q, D1, x)
    return x


def jacobian_rate(q, dq):
    """(dJ/dt) dq, the centripetal and Coriolis acceleration [m/s^2]: the second derivative of x = (q1 + D1) e(q2)."""
    outward, along = np.array([math.cos(q[1]), math.sin(q[1]), 0.0]), np.array([-math.sin(q[1]), math.cos(q[1]), 0.0])
    return 2.0 * dq[0] * dq[1] * along - (q[0] + D1) * dq[1] ** 2 * outward


def test_polar_and_cartesian_accelerations_agree():
    """J q'' + J' q' = F / m at 5000 random poses, speeds and forces."""
    rng = np.random.default_rng(2)
    worst = 0.0
    for _ in range(5000):
        q = rng.uniform([-0.18, -0.5, -0.2], [0.18, 0.5, 0.2])
        dq, f = rng.uniform(-1, 1, 3), rng.uniform(-50, 50, 3)
        ddq, a, cartesian = np.zeros((3, 3))
        acceleration_polar(q, dq, f, MASS, D1, ddq)
        apply_jacobian(q, D1, ddq, a)
        coupling = jacobian_rate(q, dq)
        acceleration_cartesian(q, f, MASS, cartesian)
        worst = max(worst, float(np.abs(a + coupling - cartesian).max()))
    assert worst <= 1e-12


def test_seed_form_lacks_the_two_coupling_terms():
    q, dq = np.zeros(3), np.array([0.2, 1.0, 0.0])
    seed, polar = np.zeros(3), np.zeros(3)
    acceleration_seed(q, np.zeros(3), MASS, D1, seed)
    acceleration_polar(q, dq, np.zeros(3), MASS, D1, polar)
    assert MASS * (polar[0] - seed[0]) == pytest.approx(1.38, rel=1e-12)  # m r phi'^2
    assert MASS * D1 * (seed[1] - polar[1]) == pytest.approx(1.2, rel=1e-12)  # 2 m r' phi'


def test_seed_form_gains_energy_and_leaves_the_line():
    """r = 0.46 m, r' = 0.2 m/s, phi' = 1 rad/s, no force, 0.5 s: + 0.153 J, 78.6 mm off (notes of the seed form)."""
    q, v, dq = _start(0.46, 0.2, 1.0)
    x0, v0 = _position(q), v.copy()
    _move(SEED, q, v, dq, np.zeros(3), 0.0, 500, 1e-3, UNLIMITED, UNLIMITED)
    apply_jacobian(q, D1, dq, v)
    gained = 0.5 * MASS * (v @ v - v0 @ v0)
    off = np.linalg.norm(_position(q) - (x0 + 0.5 * v0))
    assert gained == pytest.approx(0.153, rel=0.01)
    assert off == pytest.approx(78.6e-3, rel=0.01)


def test_cartesian_free_flight_is_a_straight_line():
    q, v, dq = _start(0.46, 0.2, 1.0)
    x0, v0 = _position(q), v.copy()
    errors = []
    for ticks in (500, 1000):
        q, v, dq = _start(0.46, 0.2, 1.0)
        _move(CARTESIAN, q, v, dq, np.zeros(3), 0.0, ticks, 0.5 / ticks, UNLIMITED, UNLIMITED)
        assert np.all(v == v0)
        errors.append(np.linalg.norm(_position(q) - (x0 + 0.5 * v0)))
    assert errors[0] < 1e-7  # the follower's midpoint rule, second order; the mass itself is exact
    assert errors[1] == pytest.approx(errors[0] / 4, rel=0.1)


def test_polar_free_flight_converges_to_the_line_and_keeps_angular_momentum():
    x0, v0 = _position(_start(0.46, 0.2, 1.0)[0]), _start(0.46, 0.2, 1.0)[1]
    errors, momenta = [], []
    for ticks in (500, 1000, 2000):
        q, v, dq = _start(0.46, 0.2, 1.0)
        before = (q[0] + D1) ** 2 * dq[1]
        _move(POLAR, q, v, dq, np.zeros(3), 0.0, ticks, 0.5 / ticks, UNLIMITED, UNLIMITED)
        errors.append(np.linalg.norm(_position(q) - (x0 + 0.5 * v0)))
        momenta.append(abs((q[0] + D1) ** 2 * dq[1] - before))
    assert errors[0] < 1e-3 and momenta[0] < 1e-3
    assert errors[1] == pytest.approx(errors[0] / 2, rel=0.05)  # semi-implicit Euler: first order
    assert errors[2] == pytest.approx(errors[1] / 2, rel=0.05)
    assert momenta[2] == pytest.approx(momenta[1] / 2, rel=0.05)


@pytest.mark.parametrize(("form", "tolerance"), [(CARTESIAN, 1e-6), (POLAR, 1e-3)])
def test_constant_force(form: int, tolerance: float):
    """x = x0 + v0 t + F t (t + T) / 2m: the sum that semi-implicit Euler makes of it."""
    t, dt, force = 0.5, 1e-3, np.array([1.5, -0.9, 0.6])
    q, v, dq = _start(0.40, 0.05, -0.2)
    x0, v0 = _position(q), v.copy()
    _move(form, q, v, dq, force, 0.0, round(t / dt), dt, UNLIMITED, UNLIMITED)
    expected = x0 + v0 * t + force / MASS * t * (t + dt) / 2.0
    assert np.linalg.norm(_position(q) - expected) < tolerance
    if form == POLAR:  # its state is dq; the Cartesian form's is v itself
        apply_jacobian(q, D1, dq, v)
    assert np.linalg.norm(v - (v0 + force / MASS * t)) < 2 * tolerance


def test_virtual_damping_decays_exponentially():
    q, v, dq = _start(0.46, 0.2, 0.0)
    _move(CARTESIAN, q, v, dq, np.zeros(3), 6.0, 500, 1e-3, UNLIMITED, UNLIMITED)
    assert v[0] == pytest.approx(0.2 * (1 - 6.0 / MASS * 1e-3) ** 500, rel=1e-12)
    assert v[0] == pytest.approx(0.2 * math.exp(-1.0), rel=2e-3)


@pytest.mark.parametrize("form", [SEED, POLAR, CARTESIAN])
def test_limits_keep_the_direction(form: int):
    q, v, dq = np.array([0.0, 0.3, 0.0]), np.zeros(3), np.zeros(3)
    force = np.array([300.0, 400.0, -200.0])
    _move(form, q, v, dq, force, 0.0, 1, 1e-3, 20.0, 0.8)
    assert np.linalg.norm(v) == pytest.approx(20.0 * 1e-3, rel=1e-12)
    assert np.allclose(v / np.linalg.norm(v), force / np.linalg.norm(force), atol=1e-12)
    _move(form, q, v, dq, force, 0.0, 600, 1e-5, 1e4, 0.8)  # 180 m/s^2 for 6 ms would give 1.08 m/s
    assert np.linalg.norm(v) == pytest.approx(0.8, rel=1e-9)


def test_limited_wish_is_reached_along_the_straight_line():
    last, wish = np.array([0.1, 0.0, 0.0]), np.array([0.1, 3.0, 4.0])
    limit_motion(last, 20.0, 0.5, 1e-3, wish)
    assert np.allclose(wish, [0.1, 0.6 * 0.02, 0.8 * 0.02], atol=1e-15)
