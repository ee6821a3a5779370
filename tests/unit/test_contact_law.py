"""How loud a touch is, and when it is too soon for another."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.rendering.audio.contact_gain import REFRACTORY_NS, ContactGate, contact_gain, scrape_gain

SPEED = st.floats(0.0, 5.0)
FORCE = st.floats(0.0, 100.0)


@given(SPEED, SPEED, FORCE, FORCE)
def test_level_is_monotone_and_bounded(speed_a, speed_b, force_a, force_b):
    low = contact_gain(min(speed_a, speed_b), min(force_a, force_b))
    high = contact_gain(max(speed_a, speed_b), max(force_a, force_b))
    assert 0.05 <= low <= high <= 1.0


def test_level_grows_where_people_touch():
    gains = [contact_gain(speed, 0.0) for speed in (0.02, 0.05, 0.1, 0.2, 0.4)]
    assert all(b > 1.15 * a for a, b in pairwise(gains))
    assert contact_gain(0.0, 20.0, full_force=20.0) == contact_gain(0.0, 10.0, full_force=10.0)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_level_of_not_finite_is_that_of_nothing(value):
    assert contact_gain(value, value) == contact_gain(0.0, 0.0)
    assert scrape_gain(value, 3.0) == 0.0


@given(SPEED, FORCE)
def test_scrape_needs_both_sliding_and_pressing(speed, force):
    assert scrape_gain(0.0, force) == 0.0
    assert scrape_gain(speed, 0.0) == 0.0
    assert 0.0 <= scrape_gain(speed, force) < 0.25


def test_chatter_of_one_pair_sounds_25_times_a_second():
    gate = ContactGate()
    passed = sum(gate.passes(0, -1, tick * 1_000_000, 0.5) for tick in range(1000))
    assert passed == 1000_000_000 // REFRACTORY_NS


def test_gate_knows_pairs_apart_and_bodies_in_any_order():
    gate = ContactGate()
    assert gate.passes(0, 1, 0, 0.5)
    assert not gate.passes(1, 0, 1_000_000, 0.5)
    assert gate.passes(0, 2, 1_000_000, 0.5)


def test_a_much_harder_hit_is_not_held_back():
    gate = ContactGate()
    assert gate.passes(0, 1, 0, 0.2)
    assert gate.passes(0, 1, 5_000_000, 0.4)
