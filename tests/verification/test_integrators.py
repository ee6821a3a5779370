"""One step of a mass, a spring and a damper: amplification against closed forms, exactness, limits, and (11)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mimics_app.lab.groups.integrator import STEPS, contact_error, step_implicit, step_rk4
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.integrators import (
    step_exact,
    step_explicit,
    step_free,
    step_midpoint,
    step_semi_implicit,
)

ALL = (step_explicit, step_semi_implicit, step_implicit, step_midpoint, step_rk4, step_exact)


def amplification(step, m, b, k, dt):
    """Matrix of one step without force, shape [2, 2]."""
    return np.column_stack([step(1.0, 0.0, 0.0, m, b, k, dt), step(0.0, 1.0, 0.0, m, b, k, dt)])


def growth(step, m, b, k, dt):
    return float(np.max(np.abs(np.linalg.eigvals(amplification(step, m, b, k, dt)))))


def exponential(A):
    """Matrix exponential in long double by scaling and squaring of its Taylor series."""
    squarings = max(0, math.ceil(math.log2(np.abs(A).sum() + 1e-300)) + 4)
    A = A.astype(np.longdouble) / 2**squarings
    total = term = np.eye(len(A), dtype=np.longdouble)
    for n in range(1, 25):
        term = term @ A / n
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


@pytest.mark.parametrize("hw", [0.01, 0.1, 1.0])
def test_growth_of_a_free_oscillation_is_the_closed_form(hw):
    m, k = 0.2, 2000.0
    dt = hw / math.sqrt(k / m)
    assert growth(step_explicit, m, 0.0, k, dt) == pytest.approx(math.sqrt(1.0 + hw**2), rel=1e-12)
    assert growth(step_semi_implicit, m, 0.0, k, dt) == pytest.approx(1.0, rel=1e-12)
    assert growth(step_implicit, m, 0.0, k, dt) == pytest.approx(1.0 / math.sqrt(1.0 + hw**2), rel=1e-12)
    assert growth(step_midpoint, m, 0.0, k, dt) == pytest.approx(1.0, rel=1e-12)
    assert growth(step_exact, m, 0.0, k, dt) == pytest.approx(1.0, rel=1e-12)
    rk4 = abs(sum((1j * hw) ** n / math.factorial(n) for n in range(5)))
    assert growth(step_rk4, m, 0.0, k, dt) == pytest.approx(rk4, rel=1e-12)


@settings(max_examples=200)
@given(st.floats(0.0, 2.5), st.floats(0.0, 2.2))
def test_explicit_and_semi_implicit_are_stable_exactly_within_their_limits(hw2, damping):
    """Explicit: h k < b and 4 - 2 h b/m + h^2 k/m > 0; semi-implicit: h^2 k/m + 2 h b/m < 4."""
    m, dt = 0.2, 1e-3
    k, b = hw2 * m / dt**2, damping * m / dt
    assume(hw2 > 0.01 and damping > 0.01)
    assume(
        abs(hw2 - damping) > 1e-3 and abs(4.0 - 2.0 * damping + hw2) > 1e-3 and abs(hw2 + 2.0 * damping - 4.0) > 1e-3
    )
    explicit = dt * k < b and 4.0 - 2.0 * damping + hw2 > 0.0
    assert (growth(step_explicit, m, b, k, dt) < 1.0) == explicit
    assert (growth(step_semi_implicit, m, b, k, dt) < 1.0) == (hw2 + 2.0 * damping < 4.0)


@pytest.mark.parametrize("step, limit", [(step_semi_implicit, 2.0), (step_rk4, 2.0 * math.sqrt(2.0))])
def test_limit_of_an_undamped_spring(step, limit):
    m, k = 0.2, 2000.0
    w = math.sqrt(k / m)
    assert growth(step, m, 0.0, k, 0.999 * limit / w) <= 1.0 + 1e-9
    assert growth(step, m, 0.0, k, 1.001 * limit / w) > 1.0


EXPONENT = st.floats(-3.0, 3.0)


@settings(max_examples=300)
@given(EXPONENT, st.none() | st.floats(-3.0, 4.0), st.none() | st.floats(-3.0, 6.0), st.floats(-5.0, -1.0))
def test_exact_step_is_the_matrix_exponential(mass, damping, stiffness, step):
    """Under, over and near critical damping, without spring, without damper, each or both."""
    m, dt = 10.0**mass, 10.0**step
    b = 0.0 if damping is None else 10.0**damping
    k = 0.0 if stiffness is None else 10.0**stiffness
    assume(max(b / m * dt, k / m * dt * dt) < 1e4)
    x, v, f = 0.7, -0.4, 1.3
    A = np.array([[0.0, dt, 0.0], [-k / m * dt, -b / m * dt, f / m * dt], [0.0, 0.0, 0.0]])
    expected = (exponential(A) @ np.array([x, v, 1.0], np.longdouble)).astype(float)
    w = math.sqrt(k / m)
    rounding = 1e-12 * (1.0 + w * dt + b / m * dt)
    size = np.array([1.0 + abs(expected[0]), 1.0 + abs(expected[1]) + w])
    assert np.all(np.abs(step_exact(x, v, f, m, b, k, dt) - expected[:2]) < rounding * size)


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-8, 1e-5, 1e-3, -1e-12, -1e-8, -1e-5, -1e-3])
@pytest.mark.parametrize("wt", [1e-3, 0.4, 3.0])
def test_exact_step_is_smooth_through_critical_damping(off, wt):
    m, dt = 1.0, 0.1
    k = (wt / dt) ** 2
    b = 2.0 * math.sqrt(k * m) * (1.0 + off)
    decay = math.exp(-wt)
    # At critical damping: x = (1 + w t) exp(-w t), v = -w^2 t exp(-w t) from x = 1 at rest.
    x, v = step_exact(1.0, 0.0, 0.0, m, b, k, dt)
    assert x == pytest.approx((1.0 + wt) * decay, abs=1e-13 + 2.0 * abs(off))
    assert v * dt == pytest.approx(-(wt**2) * decay, abs=1e-13 + 5.0 * abs(off))


@pytest.mark.parametrize("step, order", list(zip(ALL, (1, 1, 1, 2, 4, None), strict=True)))
def test_errors_fall_with_the_order_of_the_method(step, order):
    name = next(name for name, known in STEPS.items() if known is step)
    if order is None:
        assert contact_error(name, 1) < 1e-14
        return
    assert math.log2(contact_error(name, 8) / contact_error(name, 16)) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("step", ALL)
def test_a_body_in_equilibrium_stays(step):
    assert step(5e-3, 0.0, 10.0, 0.2, 4.0, 2000.0, 1e-3) == (5e-3, 0.0)


@pytest.mark.parametrize("dt", [1e-3, 5e-4])
def test_energy_of_a_bounce_ranks_the_methods(dt):
    """Undamped half oscillation in a contact, E' / E: explicit gains, implicit loses, the others stay within 1 %."""
    m, k = 0.2, 2000.0

    def speed_after(step):
        depth, v = 0.0, 0.1
        for _ in range(100_000):
            depth, v = step(depth, v, 0.0, m, 0.0, k, dt)
            if depth <= 0.0:
                return abs(v) / 0.1
        raise AssertionError

    assert speed_after(step_explicit) > 1.05
    assert speed_after(step_implicit) < 0.95
    for step in (step_midpoint, step_rk4, step_exact):
        assert speed_after(step) == pytest.approx(1.0, abs=0.02)


# --- (11)


@pytest.mark.parametrize("b", [0.0, 1e-9, 0.5, 40.0])
def test_11_velocity_is_the_closed_form(b):
    """V = v_inf + (v0 - v_inf) exp(-b t/m), to 1e-13 of the way after 1000 steps; b = 0: v0 + f t/m."""
    m, f, x, v, t = 0.4, -3.0, 0.2, 0.5, 1.0
    for _ in range(1000):
        x, v = step_free(x, v, f, m, b, t / 1000)
    if b < 1e-6:
        assert v == pytest.approx(0.5 + f * t / m, rel=1e-8)
        assert x == pytest.approx(0.2 + 0.5 * t + 0.5 * f / m * t * t, rel=1e-8)
        return
    final = f / b
    assert v == pytest.approx(final + (0.5 - final) * math.exp(-b * t / m), rel=1e-12)
    assert x == pytest.approx(0.2 + final * t + (0.5 - final) * m / b * (1.0 - math.exp(-b * t / m)), rel=1e-12)


def test_11_terminal_speed_is_m_g_over_b():
    assert step_free(0.0, 0.0, -0.4 * 9.81, 0.4, 2.0, 50.0)[1] == pytest.approx(-0.4 * 9.81 / 2.0, rel=1e-14)


def test_11_immovable_body_stays():
    assert step_free(0.3, 0.0, 100.0, math.inf, 5.0, 1e-3) == (0.3, 0.0)


def test_11_drop_of_half_a_second():
    """Exact: z = g t^2/2. Semi-implicit is g t h/2 too low, 2.4525 mm at 1 ms, to the last digits."""
    exact, simple = (0.0, 0.0), (0.0, 0.0)
    for _ in range(500):
        exact = step_free(*exact, -9.81, 1.0, 0.0, 1e-3)
        simple = step_semi_implicit(*simple, -9.81, 1.0, 0.0, 0.0, 1e-3)
    assert exact[0] == pytest.approx(-0.5 * 9.81 * 0.25, rel=1e-12)
    assert simple[0] - exact[0] == pytest.approx(-2.4525e-3, rel=1e-10)


def test_11_object_takes_the_momentum_the_user_gives():
    """F_virt on the object is minus the force on the user: both impulses and the object's momentum sum to nothing."""
    m, dt, x, v, impulse_on_user = 0.4, 1e-3, 0.0, 0.0, 0.0
    for tick in range(300):
        hip, v_hip = 1e-3 + 0.05 * tick * dt, 0.05
        f = spring_damper(hip - x, v_hip - v, 800.0, 3.0)  # the HIP presses towards +x
        x, v = step_free(x, v, f, m, 0.0, dt)
        impulse_on_user -= f * dt
    assert m * v > 0.01
    assert m * v + impulse_on_user == pytest.approx(0.0, abs=1e-12 * m * v)
