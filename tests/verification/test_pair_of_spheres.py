"""Two bodies in contact, (17): momentum, spin, order, restitution, and what the printed sign does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.lab.groups.contact_law import restitution_spring_damper
from mimics_app.lab.haptic.printed_equations import pair_force_printed
from mimics_app.rendering.haptic.kernels.contact import wall
from mimics_app.rendering.haptic.kernels.contact_law import pair_force
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from tests.support.body_play import new_play
from tests.support.contact_play import Pair, angle_factor, bounce, bounce_pair

DT = 1e-5
NORMAL = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
CLOSING = 0.4  # [m/s]


def damped(zeta):
    free = Pair()
    return Pair(b=2.0 * zeta * math.sqrt(free.k * free.reduced))


def closing(pair, speed=CLOSING):
    """Velocities of both before the bounce [m/s]: head on, and both carried along."""
    carried = np.array([0.05, -0.03, 0.02])
    return carried + 0.3 * speed * NORMAL, carried - 0.7 * speed * NORMAL


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.251, 0.7])
def test_17_restitution_contact_depth_and_velocities_are_the_closed_form(zeta):
    """As (9) with the reduced mass; v1+ = ((m1 - e m2) v1 + (1 + e) m2 v2)/(m1 + m2) along the normal."""
    pair = damped(zeta)
    v1, v2 = closing(pair)
    found = bounce_pair(pair, v1, v2, NORMAL, DT)
    e, w, a = restitution_spring_damper(zeta), math.sqrt(pair.k / pair.reduced), angle_factor(zeta)
    assert -(found.v1 - found.v2) @ NORMAL / CLOSING == pytest.approx(e, rel=1e-3)
    assert found.depth == pytest.approx(CLOSING / w * math.exp(-zeta * a), rel=1e-3)
    expected = ((pair.m1 - e * pair.m2) * v1 + (1.0 + e) * pair.m2 * v2) @ NORMAL / (pair.m1 + pair.m2)
    assert found.v1 @ NORMAL == pytest.approx(expected, abs=1e-3 * CLOSING)
    across = np.eye(3) - np.outer(NORMAL, NORMAL)
    assert across @ found.v1 == pytest.approx(across @ v1, abs=1e-12)


def test_17_undamped_contact_lasts_pi_over_w():
    pair = damped(0.0)
    found = bounce_pair(pair, *closing(pair), NORMAL, DT)
    assert found.time == pytest.approx(math.pi * math.sqrt(pair.reduced / pair.k), abs=3.0 * DT)


@pytest.mark.parametrize("zeta", [0.0, 0.251])
def test_17_momentum_and_angular_momentum_are_kept_to_the_last_digits(zeta):
    pair = damped(zeta)
    v1, v2 = closing(pair)
    found = bounce_pair(pair, v1 + [0.0, 0.1, 0.2], v2, NORMAL, 1e-4)
    for kept in (found.momentum, found.spin):
        assert np.max(np.abs(kept - kept[0])) < 1e-12 * np.linalg.norm(kept[0])


def test_17_energy_never_grows():
    """Damped: kinetic and spring energy fall at every tick, within the k v^2 h^2 a step of 10 us stores wrongly."""
    pair = damped(0.251)
    found = bounce_pair(pair, *closing(pair), NORMAL, DT)
    assert np.all(np.diff(found.energy) < 1e-6 * found.energy[0])
    assert found.energy[-1] < 0.99 * found.energy[0]


def test_17_printed_gains_speed():
    """+b_s (v_d.n)^2 of power: e = exp(pi zeta/sqrt(1 - zeta^2)) = 2.256 as printed, 1.979 = 1/0.505 when clamped."""
    pair = damped(0.251)
    zeta = pair.zeta
    free = bounce_pair(pair, *closing(pair), NORMAL, DT, law=pair_force_printed)
    e = -(free.v1 - free.v2) @ NORMAL / CLOSING
    assert math.exp(math.pi * zeta / math.sqrt(1.0 - zeta**2)) == pytest.approx(2.256, abs=3e-3)
    assert e == pytest.approx(math.exp(math.pi * zeta / math.sqrt(1.0 - zeta**2)), rel=2e-3)
    clamped = bounce_pair(pair, *closing(pair), NORMAL, DT, law=lambda *a: max(0.0, pair_force_printed(*a)))
    e = -(clamped.v1 - clamped.v2) @ NORMAL / CLOSING
    assert e == pytest.approx(1.0 / restitution_spring_damper(zeta), rel=2e-3)
    assert e == pytest.approx(1.979, abs=6e-3)


VECTOR = st.lists(st.floats(-0.06, 0.06), min_size=3, max_size=3)


def one_tick(first, second):
    """Changes of momentum [kg m/s] of two balls given as (place, velocity, radius), by one tick of the loop."""
    play = new_play()
    for place, velocity, radius in (first, second):
        play.add_ball(radius, 0.2, {"stiffness": 4000.0, "damping": 10.0}, position=place, velocity=velocity)
    play.run(1)
    return [0.2 * (play.motions[i]["velocity"] - np.array(ball[1])) for i, ball in enumerate((first, second))]


@given(VECTOR, VECTOR, VECTOR, VECTOR)
def test_17_knows_no_order_of_its_bodies(p1, p2, v1, v2):
    """Whichever row is first, each body gets the same push, and the other the opposite; to rounding of m v."""
    ball_a, ball_b = (p1, v1, 0.03), (p2, v2, 0.05)
    (a, b), (b_again, a_again) = one_tick(ball_a, ball_b), one_tick(ball_b, ball_a)
    assert a == pytest.approx(-b, abs=1e-15)
    if np.linalg.norm(np.subtract(p1, p2)) > 1e-11:
        assert a == pytest.approx(a_again, abs=1e-15) and b == pytest.approx(b_again, abs=1e-15)


def test_17_coinciding_centres_keep_the_last_normal():
    play = new_play()
    for radius, place in ((0.03, (0.0, 0.0, 0.0)), (0.05, (0.01, 0.0, 0.0))):
        play.add_ball(radius, 1e9, {"stiffness": 4000.0, "damping": 0.0}, position=place)
    play.run(1)
    play.motions[1]["centre"] = play.motions[1]["position"] = play.motions[0]["position"]
    play.run(1)
    assert play.motions[1]["force"] == pytest.approx([2000.0 * 0.08, 0.0, 0.0])


@pytest.mark.parametrize("zeta", [0.0, 0.251])
def test_17_sphere_on_a_wall_is_the_wall_of_its_lowest_point(zeta):
    """A body flung at a wall bounces as (9) with its own mass: d = r - z'."""
    b, contact = 2.0 * zeta * math.sqrt(2000.0 * 0.3), np.zeros(1, CONTACT)[0]

    def law(depth, rate):
        wall(np.array([0.0, 0.0, -depth]), contact)
        return pair_force(float(contact["depth"]), rate, 2000.0, b)

    assert bounce(law, 0.3, 0.4, 2e-5).restitution == pytest.approx(restitution_spring_damper(zeta), rel=2e-3)
