"""Normal forces against closed forms: (9) clamped and printed, Hunt and Crossley's, and the series of (17).

A semi-implicit bounce errs to first order in the tick: restitution and depth by at most 3.3 % at 1 ms for 3 kg on
2 kN/m and zeta <= 0.7, and by a hundredth of that at 10 us, hence the tolerances.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.lab.groups.contact_law import restitution_hunt_crossley, restitution_spring_damper
from mimics_app.lab.haptic.printed_equations import spring_damper_printed
from mimics_app.rendering.haptic.kernels.contact_law import hunt_crossley, pair_damping, pair_stiffness, spring_damper
from tests.support.contact_play import angle_factor, bounce, energy_of_cycle

K = 2000.0
M = 0.2
W = math.sqrt(K / M)
DT = 1e-5
SLOPE = 0.033 * DT / 1e-3


def law_9(zeta):
    return lambda depth, rate: spring_damper(depth, rate, K, 2.0 * zeta * math.sqrt(K * M))


def printed_9(zeta):
    return lambda depth, rate: spring_damper_printed(depth, rate, K, 2.0 * zeta * math.sqrt(K * M))


def test_9_static_force_is_k_d():
    assert spring_damper(3e-3, 0.0, K, 20.0) == 6.0
    assert spring_damper(-3e-3, 0.1, K, 20.0) == 0.0
    assert spring_damper(0.0, 0.1, K, 20.0) == 0.0


@given(st.floats(-0.1, 0.1), st.floats(-5.0, 5.0), st.floats(0.0, 1e5), st.floats(0.0, 1e3))
def test_9_never_pulls_and_never_acts_from_outside(depth, rate, k, b):
    force = spring_damper(depth, rate, k, b)
    assert force >= 0.0
    assert depth > 0.0 or force == 0.0


@pytest.mark.parametrize("zeta", [0.05, 0.251, 0.3, 0.7, 1.0, 1.5])
def test_9_bounce_is_the_closed_form(zeta):
    """Restitution exp(-2 zeta a), greatest depth (v/w) exp(-zeta a): at 10 us, from a touch at a tick."""
    found = bounce(law_9(zeta), M, 0.1, DT)
    a = angle_factor(zeta)
    slope = SLOPE * max(1.0, zeta / 0.7) ** 2
    assert found.restitution == pytest.approx(math.exp(-2.0 * zeta * a), rel=slope)
    assert found.depth == pytest.approx(0.1 / W * math.exp(-zeta * a), rel=slope)


@pytest.mark.parametrize("zeta", [0.05, 0.3, 0.7])
def test_9_pushes_for_the_contact_time(zeta):
    """The force is positive for 2 a/w, and ends while the surface is still dented."""
    pushing = 0

    def counted(depth, rate):
        nonlocal pushing
        force = law_9(zeta)(depth, rate)
        pushing += force > 0.0
        return force

    assert bounce(counted, M, 0.1, DT).time > pushing * DT
    assert pushing * DT == pytest.approx(2.0 * angle_factor(zeta) / W, abs=3.0 * DT)


def test_9_restitution_of_zeta_03_is_045098():
    assert restitution_spring_damper(0.3) == pytest.approx(0.45098, abs=5e-6)
    assert restitution_spring_damper(1.0) == pytest.approx(restitution_spring_damper(1.0 + 1e-7), rel=1e-6)


@pytest.mark.parametrize("zeta", [0.05, 0.251, 0.5, 0.7])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.7, 0.999])
def test_9_errs_by_at_most_3_percent_at_1_ms_wherever_the_touch_falls(zeta, phase):
    """The 3 kg of admittance control on 2 kN/m: h w = 0.026."""
    b = 2.0 * zeta * math.sqrt(K * 3.0)
    found = bounce(lambda d, r: spring_damper(d, r, K, b), 3.0, 0.1, 1e-3, phase)
    assert found.restitution == pytest.approx(restitution_spring_damper(zeta), rel=0.033)
    depth = 0.1 / math.sqrt(K / 3.0) * math.exp(-zeta * angle_factor(zeta))
    assert found.depth == pytest.approx(depth, rel=0.033)


def test_9_restitution_converges_to_first_order():
    """One tenth of the tick: one tenth of the error, averaged over the phase of the touch."""
    exact = restitution_spring_damper(0.3)

    def worst(dt):
        return max(abs(bounce(law_9(0.3), M, 0.1, dt, phase).restitution - exact) for phase in np.arange(0.0, 1.0, 0.1))

    assert worst(1e-3) / worst(1e-4) == pytest.approx(10.0, rel=0.35)


def test_9_printed_is_sticky():
    """Without clamp e = exp(-pi zeta/sqrt(1 - zeta^2)): .443 against .505 at zeta = .251 shows a missing clamp."""
    zeta = 0.251
    sticky = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta * zeta))
    assert sticky == pytest.approx(0.443, abs=5e-4)
    assert restitution_spring_damper(zeta) == pytest.approx(0.505, abs=5e-4)
    assert bounce(printed_9(zeta), M, 0.1, DT).restitution == pytest.approx(sticky, rel=SLOPE)
    assert bounce(law_9(zeta), M, 0.1, DT).restitution == pytest.approx(restitution_spring_damper(zeta), rel=SLOPE)


def test_9_takes_pi_b_w_a2_a_cycle():
    """1.974 mJ at b = 20 N s/m, 5 Hz, 1 mm; k T/2b = 5e-5 of it is the price of a tick of 1 us."""
    expected = math.pi * 20.0 * 2.0 * math.pi * 5.0 * 1e-6
    assert expected == pytest.approx(1.974e-3, abs=1e-6)
    taken = energy_of_cycle(lambda d, r: spring_damper(d, r, K, 20.0), 5.0, 1e-3, 1e-5, 3e-3)
    assert taken == pytest.approx(expected * (1.0 - K * 1e-5 / 40.0), rel=1e-6)


def test_9_held_over_a_tick_takes_pi_w_a2_times_b_minus_kt_half():
    """1.875 mJ at k = 2000 N/m and 1 ms: the tick takes k T/2 of the damper away."""
    taken = energy_of_cycle(lambda d, r: spring_damper(d, r, K, 20.0), 5.0, 1e-3, 1e-3, 3e-3)
    expected = math.pi * 2.0 * math.pi * 5.0 * 1e-6 * (20.0 - K * 1e-3 / 2.0)
    assert taken == pytest.approx(expected, rel=2e-4)
    assert taken == pytest.approx(1.875e-3, rel=1e-3)


@pytest.mark.parametrize("excess, stable", [(1.02, True), (0.98, False)])
def test_9_lightest_stable_mass(excess, stable):
    """Semi-implicit, m > (h^2 k + 2 h b)/4: pressed onto the wall a lighter body leaves its place growing."""
    h, b = 1e-3, 5.0
    mass = excess * (h * h * K + 2.0 * h * b) / 4.0
    depth, rate, rest = 5e-3 + 1e-7, 0.0, 5e-3
    for _ in range(400):
        rate += h * (K * rest - spring_damper(depth, rate, K, b)) / mass
        depth += h * rate
    assert (abs(depth - rest) < 1e-7) is stable


@pytest.mark.parametrize("exponent", [1.0, 1.5])
@pytest.mark.parametrize("u", [0.05, 0.5, 2.0])
@pytest.mark.parametrize("mass", [0.2, 3.0])
def test_hunt_crossley_bounce_is_the_closed_form(exponent, u, mass):
    """(1+e) u = ln((1+u)/(1-e u)) and depth^(n+1) = (n+1) m k/lam^2 (u - ln(1+u)), any mass and exponent."""
    k = K if exponent == 1.0 else K / math.sqrt(1e-3)
    lam = u * k / 0.1
    found = bounce(lambda d, r: hunt_crossley(d, r, k, lam, exponent), mass, 0.1, 2e-5)
    assert found.restitution == pytest.approx(restitution_hunt_crossley(u), rel=2e-3)
    depth = ((exponent + 1.0) * mass * k / lam**2 * (u - math.log1p(u))) ** (1.0 / (exponent + 1.0))
    assert found.depth == pytest.approx(depth, rel=2e-3)


def test_hunt_crossley_restitution_of_half_is_0748435():
    assert restitution_hunt_crossley(0.5) == pytest.approx(0.748435, abs=5e-7)
    assert restitution_hunt_crossley(1e-3) == pytest.approx(1.0 - 2e-3 / 3.0, abs=1e-6)


def test_hunt_crossley_does_not_step_at_first_touch():
    """(9) jumps to b v there; F_x = k dx, the pure spring of 4.3.2, is lam = 0."""
    assert hunt_crossley(1e-12, 0.1, K, 1e4, 1.0) < 1e-8
    assert spring_damper(1e-12, 0.1, K, 20.0) == pytest.approx(2.0)
    assert hunt_crossley(3e-3, 0.0, K, 0.0, 1.0) == 6.0
    assert hunt_crossley(1e-3, -10.0, K, 1e4, 1.0) == 0.0


@pytest.mark.parametrize("rigid", [math.inf, 1e300])
def test_17_rigid_partner_leaves_the_other_ones_contact(rigid):
    assert pair_stiffness(K, rigid) == pytest.approx(K, rel=1e-15)
    assert pair_damping(K, 7.0, rigid, 100.0) == pytest.approx(7.0, rel=1e-15)


@given(st.floats(10.0, 1e5), st.floats(0.0, 100.0), st.floats(10.0, 1e5), st.floats(0.0, 100.0))
def test_17_series_knows_no_order_and_is_softer_than_either(k1, b1, k2, b2):
    assert pair_stiffness(k1, k2) == pytest.approx(pair_stiffness(k2, k1), rel=1e-15)
    assert pair_damping(k1, b1, k2, b2) == pytest.approx(pair_damping(k2, b2, k1, b1), rel=1e-14, abs=1e-300)
    assert pair_stiffness(k1, k2) < min(k1, k2)


def series_damping(k1, b1, k2, b2, w):
    """Damping of two spring-dampers in series at the angular frequency w, from their complex stiffness."""
    return (1.0 / (1.0 / (k1 + 1j * w * b1) + 1.0 / (k2 + 1j * w * b2))).imag / w


def test_17_damping_is_the_slow_limit_of_the_series():
    """3000/12 on 1500/1: 1.78 N s/m, falling to 0.92; equal bodies get half of one, not the double that is printed."""
    assert pair_damping(3000.0, 12.0, 1500.0, 1.0) == pytest.approx(series_damping(3000.0, 12.0, 1500.0, 1.0, 1e-3))
    assert pair_damping(3000.0, 12.0, 1500.0, 1.0) == pytest.approx(1.78, abs=5e-3)
    assert series_damping(3000.0, 12.0, 1500.0, 1.0, 1e7) == pytest.approx(0.92, abs=5e-3)
    assert pair_damping(K, 8.0, K, 8.0) == 4.0
    assert 8.0 + 8.0 == 4.0 * pair_damping(K, 8.0, K, 8.0), "(17) prints the sum"


def test_17_damping_is_exact_where_the_time_constants_agree():
    exact = 1.0 / (1.0 / 6.0 + 1.0 / 3.0)
    assert pair_damping(2000.0, 6.0, 1000.0, 3.0) == pytest.approx(exact, rel=1e-15)
    assert series_damping(2000.0, 6.0, 1000.0, 3.0, 500.0) == pytest.approx(exact, rel=1e-12)
