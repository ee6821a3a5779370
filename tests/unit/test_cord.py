"""The cord by closed form: length, ends, frame, ripples with normals, and what it says of figures that cannot be."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from mimics_app.lab.groups.ripple_distance import BENDS, crest_error, midway, straight
from mimics_app.maths.cord import Ripple, Ripples, hang
from mimics_app.world.content.cords import MAX_TAPS, Cord

SEED = 11


def random_cords(count: int):
    chance = np.random.default_rng(SEED)
    for _ in range(count):
        start = chance.normal(size=3)
        end = start + chance.normal(size=3)
        chord = float(np.linalg.norm(end - start))
        yield start, end, chord * (1.0 + 10.0 ** chance.uniform(-6.0, 1.0)), chance.uniform(-1.5, 1.5)


def test_it_is_as_long_as_it_says_and_ends_where_it_should() -> None:
    worst_end = worst_length = 0.0
    for start, end, length, swing in random_cords(300):
        curve = hang(start, end, length, swing)
        worst_end = max(worst_end, np.linalg.norm(curve.point([0.0, length]) - [start, end], axis=1).max() / length)
        # The arc length of an independent quadrature: Gauss-Legendre on |dP/ds| would be 1 by construction, so chords
        # of two resolutions extrapolated (Richardson) stand in for it.
        coarse, fine = (
            np.linalg.norm(np.diff(curve.point(np.linspace(0, length, n)), axis=0), axis=1).sum() for n in (2001, 4001)
        )
        worst_length = max(worst_length, abs((4 * fine - coarse) / 3 - length) / length)
    assert worst_end <= 1e-6
    assert worst_length <= 2e-6


def test_a_cord_that_is_shorter_than_its_way_is_straight() -> None:
    for length in (0.5, 1.0):
        curve = hang([0, 1, 0], [0, 1, -1], length)
        np.testing.assert_allclose(curve.point([0.0, 0.5, 1.0]), [[0, 1, 0], [0, 1, -0.5], [0, 1, -1]], atol=1e-9)
        assert curve.length == pytest.approx(1.0, abs=1e-12)
        assert curve.bend < 1e-6


@pytest.mark.parametrize("end", [[0.0, -0.6, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.0]])
def test_ends_above_each_other_fold_it_without_a_number_that_is_none(end: list[float]) -> None:
    curve = hang([0, 0, 0], end, 1.5)
    places = curve.point(np.linspace(0.0, 1.5, 50))
    assert np.isfinite(places).all()
    assert np.linalg.norm(places[-1] - end) <= 2e-3 * 1.5  # ends are kept a thousandth of the length apart sideways


@pytest.mark.parametrize("slack", [0.0, 1e-8, 1e-7, 4.9e-7, 5.1e-7, 1e-6])
def test_a_taut_cord_with_its_ends_above_each_other_is_straight(slack: float) -> None:
    curve = hang([0.0, 1.0, 0.0], [0.0, 0.0, 0.0], 1.0 + slack)
    ends = curve.point([0.0, 0.5 * curve.length, curve.length])
    np.testing.assert_allclose(ends, [[0.0, 1.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.0]], atol=1.1e-3)


def test_its_frame_has_no_twist_and_fits_its_curve() -> None:
    for start, end, length, swing in random_cords(60):
        curve = hang(start, end, length, swing)
        s = np.linspace(0.0, curve.length, 41)
        tangent, normal = curve.tangent(s), curve.normal(s)
        np.testing.assert_allclose(np.linalg.norm(tangent, axis=1), 1.0, atol=1e-12)
        np.testing.assert_allclose(tangent @ curve.binormal, 0.0, atol=1e-9)
        np.testing.assert_allclose((tangent * normal).sum(axis=1), 0.0, atol=1e-12)
        np.testing.assert_allclose(np.cross(tangent, normal), np.tile(curve.binormal, (41, 1)), atol=1e-9)


def test_swinging_changes_neither_its_length_nor_its_ends() -> None:
    still, swung = (hang([0, 1, 0], [0.3, 1.2, -1], 1.4, swing) for swing in (0.0, 0.7))
    np.testing.assert_allclose(still.point([0.0, 1.4]), swung.point([0.0, 1.4]), atol=1e-12)
    assert np.linalg.norm(still.point([0.7]) - swung.point([0.7])) > 0.1
    chord = np.array([0.3, 0.2, -1.0]) / np.linalg.norm([0.3, 0.2, -1.0])
    for curve in (still, swung):
        height = curve.point([0.7])[0] - [0, 1, 0]
        assert np.linalg.norm(height - chord * (height @ chord)) == pytest.approx(
            np.linalg.norm((still.point([0.7])[0] - [0, 1, 0]) - chord * ((still.point([0.7])[0] - [0, 1, 0]) @ chord))
        )


def test_a_crest_runs_at_its_speed_all_the_way_round_to_the_back() -> None:
    """On a straight cord the distance is the geodesic one. The crest is ahead of c t by what damping moves it."""
    waves, radius = Ripples(), 0.04
    ripple_at = (0.5, 0.3)
    for age in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3):
        for angle in (0.0, math.pi / 2, math.pi):  # along, aslant, and round to the back
            d = np.linspace(0.0, 0.3, 30_001)
            ds, around = d * math.cos(angle / 2), d * math.sin(angle / 2)
            inside = around <= math.pi * radius
            ripple = Ripple(*ripple_at, age, 0.01)
            h, _, _ = waves.height(ripple, radius, ripple_at[0] + ds, ripple_at[1] + around / radius)
            near = inside & (np.abs(d - waves.speed * age) < 0.012)
            if not near.any() or not inside[np.argmin(np.abs(d - waves.speed * age))]:
                continue
            crest = d[near][np.argmax(h[near])]
            # d/dx of exp(-alpha x) cos(k x) exp(-(x/w)^2) is 0 at -alpha / (k^2 + 2 / w^2): 0.09 mm behind.
            assert abs(crest - waves.speed * age) <= 1e-3


def test_the_shorter_way_round_counts() -> None:
    waves = Ripples()
    ripple = Ripple(0.5, 3.0, 0.1, 0.01)
    there, back = (waves.height(ripple, 0.05, 0.5, theta)[0] for theta in (3.0 + 0.4, 3.0 - 0.4 + 2 * math.pi))
    assert there == pytest.approx(back, rel=1e-12)


@pytest.mark.parametrize("bent", [False, True])
def test_normals_are_those_of_the_surface(bent: bool) -> None:
    curve = hang([0, 1, 0], [0, 1, -1], 1.25 if bent else 1.0)
    waves, radius = Ripples(), 0.03
    ripples = [Ripple(0.45, 0.6, 0.15, 0.008), Ripple(0.6, -2.0, 0.1, 0.006), Ripple(0.3, 3.0, 0.2, 0.005)]
    chance = np.random.default_rng(SEED)
    s, theta = chance.uniform(0.1, 0.9, 400), chance.uniform(-math.pi, math.pi, 400)
    # Where the shortest way round changes sides, and at the tap itself, there is no normal.
    for ripple in ripples:
        keep = (np.abs(np.remainder(theta - ripple.theta, 2 * math.pi) - math.pi) > 0.02) & (
            np.hypot(s - ripple.s, radius * (theta - ripple.theta)) > 0.004
        )
        s, theta = s[keep], theta[keep]
    _, normals = waves.surface(curve, radius, ripples, s, theta)
    step = 1e-5
    ahead, behind = (waves.surface(curve, radius, ripples, s + sign * step, theta)[0] for sign in (1, -1))
    left, right = (waves.surface(curve, radius, ripples, s, theta + sign * step)[0] for sign in (1, -1))
    found = np.cross(left - right, ahead - behind)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    angle = np.degrees(np.arccos(np.clip((found * normals).sum(axis=1), -1, 1)))
    assert angle.max() <= 0.1


def test_what_cannot_be_is_said_by_name_and_drawn_as_near_to_it_as_can_be() -> None:
    cord = Cord(length=1.05, radius=0.02)
    cord.tap(0.5, 0.0, 0.0, 0.05)
    assert cord.taps[0][3] == pytest.approx(0.01)
    assert [fault for fault in cord.faults if "ripple" in fault]
    cord.ends[1] = (0.05, 1.0, 0.0)
    cord.length, cord.radius = 1.0, 0.4
    assert cord.shown_radius * cord.curve.bend <= 0.951
    assert [fault for fault in cord.faults if "bend" in fault]
    assert len(cord.take_faults()) == 2
    cord.tap(0.5, 0.0, 0.0, 0.9)
    assert cord.take_faults() == []  # reported already


def test_eight_taps_at_once_and_the_oldest_gives_way() -> None:
    cord = Cord()
    for k in range(MAX_TAPS + 2):
        cord.tap(0.1 * k, 0.0, 0.1 * k, 0.001)
    assert len(cord.taps) == MAX_TAPS
    assert cord.taps[0][2] == pytest.approx(0.2)
    assert cord.ripples(0.15) == []
    assert len(cord.ripples(1.0)) == MAX_TAPS
    assert cord.ripples(20.0) == []


def test_a_crest_is_right_on_a_straight_cord_and_the_farther_off_the_sharper_the_bend() -> None:
    off = [crest_error(straight, bend) for bend in BENDS]
    assert off[0] <= 1e-9
    assert all(more > 1.5 * less for less, more in pairwise(off[1:]))
    assert off[1] <= 0.1 / 0.9 * 0.05 + 1e-6  # a tenth of a bend: the inside is a tenth shorter than the middle line
    assert all(crest_error(midway, bend) <= crest_error(straight, bend) for bend in BENDS)
