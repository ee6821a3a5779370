"""Experiment S16 and the rule it draws: contacts of several directions against the eigenvalues of the sampled loop."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.lab.stability.contacts_loop import (
    Contact,
    Device,
    exact_limit,
    exact_matrix,
    region_of,
    rule_share,
    simulated_limit,
    span_of,
)
from mimics_app.lab.stability.linear import spectral_radius
from mimics_app.lab.stability.s16_contact_directions import EXPERIMENT, compare
from mimics_app.lab.stability.wall_loop import Wall
from mimics_app.lab.stability.wall_loop import exact_limit as exact_wall
from mimics_app.rendering.haptic.kernels.closed_region import contact_share
from mimics_app.rendering.haptic.kernels.directions import worst_direction
from tests.support.regions import linear_region

ANGLES = [0.0, 30.0, 60.0, 90.0]
CAP = 0.2


def test_small_grid_agrees_with_the_eigenvalues():
    outcome = EXPERIMENT.run(2)
    assert outcome.passed and outcome.disagreement < 0.005


def test_across_a_damper_lends_nothing_and_the_sum_promises_eight_times_the_truth():
    row = compare("one block", (Contact(math.pi / 2, 100.0, 60.0),))
    assert row["exact_n_m"] == pytest.approx(exact_limit(Device(), (Contact(0.0, 1.0, 0.0),)), rel=1e-4)
    assert row["sum_n_m"] / row["exact_n_m"] == pytest.approx(68.0 / 8.0, rel=0.02)
    assert row["worst_direction_n_m"] == pytest.approx(row["exact_n_m"], rel=0.005)


def test_one_contact_is_the_wall_of_s3():
    device = Device(mass=3.0, damping=5.0, delay=2)
    wall = Wall(mass=3.0, device_damping=5.0, wall_damping=20.0, delay=2)
    assert exact_limit(device, (Contact(0.3, 1.0, 20.0, 0.7),)) == pytest.approx(exact_wall(wall), rel=1e-4)


def test_one_tick_of_delay_more_than_thought_is_seen():
    """Planted fault: contacts one tick later than their matrix lose 18 % and more."""
    contacts = (Contact(0.0, 1.0, 0.0), Contact(math.pi / 3, 100.0, 30.0))
    assert simulated_limit(Device(delay=5), contacts) < 0.85 * exact_limit(Device(delay=4), contacts)


@given(k=st.floats(10.0, 1e5), B=st.floats(0.0, 60.0), b=st.floats(0.5, 30.0), angle=st.floats(0.0, 3.0))
def test_of_one_contact_the_worst_direction_is_its_normal(k: float, B: float, b: float, angle: float):
    device = Device(mass=1e6, damping=b)
    contacts = (Contact(angle, k, B, 0.3),)
    share = contact_share(linear_region(b, device.lag), k, B, CAP)
    assert rule_share(device, contacts, CAP) == pytest.approx(share, rel=1e-9)
    assert _margin(device, contacts) == pytest.approx(min(99.0, (b + B) / device.lag / k - 1.0), rel=1e-9, abs=1e-9)


def _margin(device: Device, contacts: tuple[Contact, ...]) -> float:
    """The stability margin of the worst direction [-], as the loop computes it."""
    span = span_of(contacts)
    worst_direction(span[0], region_of(device)[0])
    return float(span[0]["margin"])


def _contacts(angles: tuple[float, ...], k: tuple[float, ...], B: tuple[float, ...]) -> tuple[Contact, ...]:
    """The first, one at an angle to it, and one that leans out of their plane by the last angle."""
    leans = (0.0, 0.0, math.radians(angles[-1]))
    turns = (0.0, math.radians(angles[0]), math.radians(45.0))
    return tuple(Contact(turns[i], k[i], B[i], leans[i]) for i in range(len(k)))


def _stable(device: Device, contacts: tuple[Contact, ...], share: float = 1.0) -> bool:
    softer = tuple(Contact(c.angle, share * c.stiffness, share * c.damping, c.lift) for c in contacts)
    return spectral_radius(exact_matrix(device, softer)) < 1.0


STIFF = st.sampled_from([100.0, 400.0, 1500.0, 4000.0, 10000.0])
DAMPED = st.sampled_from([0.0, 0.0, 5.0, 20.0, 60.0])


@settings(max_examples=200)
@given(
    angles=st.tuples(st.sampled_from(ANGLES), st.sampled_from(ANGLES)), k=st.tuples(STIFF, STIFF, STIFF),
    B=st.tuples(DAMPED, DAMPED, DAMPED), b=st.floats(2.0, 15.0), delay=st.integers(1, 8), count=st.integers(2, 3),
    mass=st.sampled_from([1.5, 3.0]),
)  # fmt: skip
def test_what_the_cap_leaves_of_several_contacts_is_stable(
    angles: tuple[float, float],
    k: tuple[float, ...],
    B: tuple[float, ...],
    b: float,
    delay: int,
    count: int,
    mass: float,
):
    """Two and three contacts, unlike in stiffness and damping, at 0, 30, 60 and 90 degrees: no eigenvalue reaches 1."""
    device = Device(mass=mass, damping=b, delay=delay)
    contacts = _contacts(angles, k[:count], B[:count])
    share = rule_share(device, contacts, CAP)
    assert _stable(device, contacts, share)
    assert rule_share(device, contacts[::-1], CAP) == pytest.approx(share, rel=1e-12)


def _scaled(contacts: tuple[Contact, ...], times: float) -> tuple[Contact, ...]:
    return tuple(Contact(c.angle, times * c.stiffness, c.damping, c.lift) for c in contacts)


@settings(max_examples=100)
@given(
    angle=st.sampled_from(ANGLES), k=STIFF, other=STIFF, B=DAMPED, own=DAMPED, b=st.floats(2.0, 15.0),
    delay=st.integers(0, 6),
)  # fmt: skip
def test_the_margin_is_no_further_above_the_truth_than_that_of_one_contact(
    angle: float, k: float, other: float, B: float, own: float, b: float, delay: int
):
    """How much stiffer all may be, by eigenvalues, against what the margin says; one contact has all the damping."""
    device = Device(damping=b, delay=delay)
    contacts = (Contact(0.0, k, own), Contact(math.radians(angle), other, B))
    wall = Wall(mass=device.mass, device_damping=b, wall_damping=own + B, delay=delay)
    alone = exact_wall(wall) * device.lag / (b + own + B)
    times = 0.999 * min(1.0, alone) * (1.0 + _margin(device, contacts))
    assert spectral_radius(exact_matrix(device, _scaled(contacts, times))) < 1.0 - 1e-10
