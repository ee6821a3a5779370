"""Friction of 4.3.2 and its rivals: stop distance, creep, cone, hysteresis, rest, and the step that bristles bear."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.groups.friction import LAWS, hold
from mimics_app.lab.haptic.friction_laws import Bristles, karnopp, lugre_explicit, lugre_implicit, regularised
from mimics_app.lab.haptic.printed_equations import regularised_printed
from mimics_app.rendering.haptic.kernels.contact_records import FRICTION
from mimics_app.rendering.haptic.kernels.friction import forget_friction, hayward_armstrong

MU, NORMAL, THRESHOLD = 0.4, 30.0, 0.01
G = 9.81
CONE = MU * NORMAL
TANGENT = 1e4  # [N/m]


def fresh():
    return np.zeros(1, FRICTION)[0]


def slow_down(v0, mass, dt, law):
    """Distance [m] on which a body comes to rest under a law of its velocity."""
    x, v, force = 0.0, np.array([v0]), np.zeros(1)
    for _ in range(2_000_000):
        law(v, mass * G, MU, THRESHOLD, force)
        v += force * (dt / mass)
        x += v[0] * dt
        if abs(v[0]) < 1e-9 * v0:
            break
    return x


@pytest.mark.parametrize("v0", [0.05, 0.3])
def test_432_stop_distance(v0):
    """(v0^2 + v_th^2)/(2 mu g): constant deceleration, then the exponential end below the threshold."""
    dt = 1e-5
    exact = (v0**2 + THRESHOLD**2) / (2.0 * MU * G)
    assert slow_down(v0, 0.5, dt, regularised) == pytest.approx(exact, abs=v0 * dt)


def test_432_creeps_under_a_load_it_should_hold():
    """At v_th F/(mu F_N): where friction and load balance, the body still moves."""
    load, force = 3.0, np.zeros(1)
    creep = THRESHOLD * load / CONE
    regularised(np.array([creep]), NORMAL, MU, THRESHOLD, force)
    assert force[0] == pytest.approx(-load, rel=1e-14)


@given(st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=2), st.floats(0.0, 100.0))
def test_432_opposes_motion_inside_the_cone_and_is_continuous_at_the_threshold(v, normal_force):
    v, force = np.array(v), np.zeros(2)
    regularised(v, normal_force, MU, THRESHOLD, force)
    assert force @ v <= 0.0
    # hypot: the square of a force of 1e-157 N is not a number to reckon with.
    assert np.hypot(*force) <= MU * normal_force * (1.0 + 1e-14) + 1e-300
    speed = np.linalg.norm(v)
    if speed > 1e-3:
        below, above = np.zeros(2), np.zeros(2)
        regularised(v * (THRESHOLD * (1.0 - 1e-9) / speed), normal_force, MU, THRESHOLD, below)
        regularised(v * (THRESHOLD * (1.0 + 1e-9) / speed), normal_force, MU, THRESHOLD, above)
        assert below == pytest.approx(above, abs=1e-6)


@pytest.mark.parametrize("excess, stable", [(0.95, True), (1.05, False)])
def test_432_below_the_threshold_is_a_damper_with_its_own_limit(excess, stable):
    """H mu F_N/(v_th m) < 2 in a semi-implicit step: 1200 N s/m are rendered at 30 N."""
    dt = 1e-3
    mass = dt * CONE / (THRESHOLD * 2.0 * excess)
    v, force = np.array([1e-5]), np.zeros(1)
    for _ in range(60):
        regularised(v, NORMAL, MU, THRESHOLD, force)
        v += force * (dt / mass)
    assert bool(abs(v[0]) < 1e-5) is stable


def test_432_printed_drives_the_body():
    v, right, printed = np.array([0.03, -0.04]), np.zeros(2), np.zeros(2)
    regularised(v, NORMAL, MU, THRESHOLD, right)
    regularised_printed(v, NORMAL, MU, THRESHOLD, printed)
    assert printed.tolist() == (-right).tolist()
    assert printed @ v > 0.0


def cycle_work(amplitude, normal_force=NORMAL, parts=20_000):
    """Work [J] taken from a hand per cycle of a sine by the anchor law, after the first quarter."""
    state, force = fresh(), np.zeros(1)
    work, before, last = 0.0, None, None
    for i in range(-parts // 4, parts + 1):
        x = np.array([amplitude * math.sin(2.0 * math.pi * i / parts)])
        hayward_armstrong(x, normal_force, MU, TANGENT, state, force)
        if before is not None and i > 0:
            work -= 0.5 * (force[0] + last) * (x[0] - before)
        before, last = x[0], force[0]
    return work


def test_anchor_takes_the_hysteresis_work():
    """4 mu F_N (A - mu F_N/k_t) a cycle beyond the reach of the anchor's spring; nothing for a stroke within it."""
    amplitude = 5e-3
    assert cycle_work(amplitude) == pytest.approx(4.0 * CONE * (amplitude - CONE / TANGENT), rel=1e-4)
    assert cycle_work(0.45 * CONE / TANGENT) == pytest.approx(0.0, abs=1e-12)


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_anchor_never_leaves_the_cone_and_rests_where_it_is_left(seed):
    rng = np.random.default_rng(seed)
    state, force, x = fresh(), np.zeros(2), np.zeros(2)
    for normal_force in rng.uniform(0.0, 50.0, 100):
        x += rng.normal(0.0, 2e-3, 2)
        hayward_armstrong(x, normal_force, MU, TANGENT, state, force)
        assert np.linalg.norm(force) <= MU * normal_force * (1.0 + 1e-12)
    held = force.copy()
    anchor = state["anchor"].copy()
    for _ in range(100):
        hayward_armstrong(x, normal_force, MU, TANGENT, state, force)
    assert force == pytest.approx(held, rel=1e-12, abs=1e-12)
    assert state["anchor"] == pytest.approx(anchor, rel=1e-12)


def test_anchor_is_set_anew_by_a_new_touch():
    state, force = fresh(), np.zeros(2)
    for x, normal_force in ((0.0, 10.0), (0.01, 0.0), (0.02, 10.0)):
        hayward_armstrong(np.array([x, 0.0]), normal_force, MU, TANGENT, state, force)
        assert force.tolist() == [0.0, 0.0]
    assert state["anchor"].tolist() == [0.02, 0.0]
    forget_friction(state)
    assert state["touching"] == 0


def test_karnopp_holds_the_load_slides_at_the_cone_and_breaks_away():
    state, force = fresh(), np.zeros(2)
    load = np.array([6.0, -8.0])
    karnopp(np.zeros(2), load, NORMAL, MU, 0.5, THRESHOLD, state, force)
    assert force.tolist() == (-load).tolist()
    assert state["sticking"] == 1
    karnopp(np.array([0.3, 0.4]), load, NORMAL, MU, 0.5, THRESHOLD, state, force)
    assert force == pytest.approx([-0.6 * CONE, -0.8 * CONE])
    assert state["sticking"] == 0
    karnopp(np.zeros(2), 2.0 * load, NORMAL, MU, 0.5, THRESHOLD, state, force)
    assert force == pytest.approx([-0.6 * CONE, 0.8 * CONE])
    karnopp(np.zeros(2), np.zeros(2), 0.0, MU, 0.5, THRESHOLD, state, force)
    assert force.tolist() == [0.0, 0.0]


def test_karnopp_between_both_cones_holds_what_rests_and_not_what_slides():
    """13.5 N lie between the 12 N of sliding and the 15 N of rest."""
    state, force = fresh(), np.zeros(1)
    load = np.array([0.45 * NORMAL])
    karnopp(np.zeros(1), load, NORMAL, MU, 0.5, THRESHOLD, state, force)
    assert force[0] == -load[0] and state["sticking"] == 1
    karnopp(np.array([2.0 * THRESHOLD]), load, NORMAL, MU, 0.5, THRESHOLD, state, force)
    assert force[0] == pytest.approx(-CONE) and state["sticking"] == 0
    karnopp(np.zeros(1), np.array([0.55 * NORMAL]), NORMAL, MU, 0.5, THRESHOLD, state, force)
    assert force[0] == pytest.approx(-CONE) and state["sticking"] == 0, "broken away it slides"


def slide(law, speed, dt, ticks=4000, mu_static=0.6, s0=1e5):
    """Force [N] after sliding at one speed under LuGre."""
    state, force = fresh(), np.zeros(1)
    for _ in range(ticks):
        law(np.array([speed]), 1.0 / MU, Bristles(MU, mu_static, 0.01, s0, 0.0), dt, state, force)
    return float(force[0])


@pytest.mark.parametrize("speed", [1e-3, 0.01, 0.1])
def test_lugre_slides_at_the_stribeck_curve(speed):
    """G(v) = F_N (mu + (mu_s - mu) exp(-(v/v_s)^2)), approached with the time constant g/(s0 v) or less."""
    g = (MU + 0.2 * math.exp(-((speed / 0.01) ** 2))) / MU
    assert slide(lugre_implicit, speed, 1e-3) == pytest.approx(-g, rel=1e-9)
    assert slide(lugre_implicit, -speed, 1e-3) == pytest.approx(g, rel=1e-9)


def test_lugre_explicit_bears_2_g_over_s0_v_and_no_more():
    """20 us at s0 = 1e5 N/m, g = 1 N, v = 1 m/s; implicit Euler bears any step."""
    limit = 2.0 * 1.0 / (1e5 * 1.0)
    assert limit == pytest.approx(20e-6)
    assert slide(lugre_explicit, 1.0, 0.9 * limit) == pytest.approx(-1.0, rel=1e-9)
    assert abs(slide(lugre_explicit, 1.0, 1.1 * limit, ticks=1000)) > 1e6
    assert slide(lugre_implicit, 1.0, 1e-3) == pytest.approx(-1.0, rel=1e-9)


def test_lugre_forgets_its_bristles_when_the_contact_ends():
    state, force = fresh(), np.ones(2)
    for law in (lugre_explicit, lugre_implicit):
        state["bristle"] = 1.0
        law(np.ones(2), 0.0, Bristles(MU, MU, 0.01, 1e4, 1.0), 1e-3, state, force)
        assert force.tolist() == [0.0, 0.0]
        assert state["bristle"].tolist() == [0.0, 0.0]


def test_held_object_drifts_as_each_law_must():
    """One minute of 1 N and a shaking 0.5 N on 4 N of friction: who holds, who creeps, and how fast."""
    found = {law: hold(law) for law in LAWS}
    creep = THRESHOLD * 1.0 / (4.0 + 5.0 * THRESHOLD)  # the hand's damper of 5 N s/m helps
    assert found["regularised"].drift == pytest.approx(60.0 * creep, rel=1e-3)
    assert found["Karnopp"].drift == 0.0
    assert found["Hayward-Armstrong"].drift < 1e-8
    assert 1e-4 < found["LuGre implicit"].drift < 1e-2
    assert not found["LuGre explicit"].cone < 1e6
    for law in ("regularised", "Karnopp", "Hayward-Armstrong", "LuGre implicit"):
        assert found[law].cone <= 1.0 + 1e-12


def test_held_object_stops_where_coulomb_says():
    """With F = 4 N, m = 0.5 kg, b = 5 N s/m: m/b (v0 - F/b ln(1 + b v0/F)); a tick is worth v0 T."""
    stop = 0.5 / 5.0 * (0.5 - 4.0 / 5.0 * math.log1p(5.0 * 0.5 / 4.0))
    for law in ("regularised", "Karnopp", "Hayward-Armstrong", "LuGre implicit"):
        assert hold(law).stop == pytest.approx(stop, abs=0.5 * 1e-3), law
