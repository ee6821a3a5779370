"""Closest point of the bisector where following it is hard: bends, jumps, crossings, the ends.

The reference finds the real roots of the slope on every piece and shares no code with the tick.
"""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.groups.tunnel_projection import closest_by_roots
from mimics_app.maths.bspline import evaluate
from mimics_app.rendering.haptic.kernels.tunnel_projection import project_golden_section
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE, restart_tracking
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from tests.support.tunnels import afresh, coil, record_of, straight, walk, wavy

HAIRPIN = [
    (x, y, 0.0) for x, y in ((0, 0), (0.1, 0), (0.2, 0), (0.3, 0.01), (0.3, 0.05), (0.2, 0.06), (0.1, 0.06), (0, 0.06))
]
"""Two legs 60 mm apart and a bend of about 20 mm."""
FIGURE_EIGHT = [(0.1 * np.sin(2.0 * a), 0.2 * np.sin(a), 0.0) for a in np.linspace(-1.2, 2.0 * np.pi - 1.2, 30)]


def reference(curve, points):
    return np.array([closest_by_roots(curve.pieces, p) for p in np.atleast_2d(points)])


def bare_newton(curve, p, s):
    """The textbook iteration: no halving, no search; only kept inside the tunnel."""
    for _ in range(50):
        e = curve.point(s)[0] - p
        first, second = evaluate(curve.pieces, s, 1)[0], evaluate(curve.pieces, s, 2)[0]
        s = min(max(s - (e @ first) / (first @ first + e @ second), 0.0), len(curve.pieces))
    return s


def ball_path(curve, share, ticks, seed):
    """A ball at `share` of the tunnel radius that goes to the end and back while it circles."""
    rng = np.random.default_rng(seed)
    t = np.arange(ticks)
    arc = 0.5 * curve.length * (1.0 - np.cos(2.0 * np.pi * t / ticks))
    s = curve.parameter_at(arc)
    _, n, b = curve.frame(s)
    turn = 2.0 * np.pi * (rng.uniform() + 7.0 * t / ticks)
    offset = share * curve.radius(s)
    return curve.point(s) + offset[:, None] * (np.cos(turn)[:, None] * n + np.sin(turn)[:, None] * b)


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_followed_point_is_the_closest_one_inside_the_tunnel(share):
    for curve in (wavy(0.03), coil(0.015)):
        path = ball_path(curve, share, 3000, seed=1)
        out = walk(record_of(curve), path)
        assert out["restarts"][-1] == 1
        every = slice(0, None, 50)
        np.testing.assert_allclose(out["distance"][every], reference(curve, path[every])[:, 1], atol=1e-10)


@pytest.mark.parametrize("product", [0.9, 0.99, 0.999])
def test_tunnel_projection_at_hairpin(product):
    """Radius x curvature -> 1: on the inner wall Newton's denominator 1 - kappa rho goes to zero."""
    limit = build_tunnel(HAIRPIN, 1e-3).max_radius_scale * 1e-3
    curve = build_tunnel(HAIRPIN, product * limit)
    s = np.linspace(0.05, 0.95, 4000)
    bend = curve.curvature(s)
    inward = bend / np.linalg.norm(bend, axis=1, keepdims=True)
    path = curve.point(s) + 0.999 * curve.radius(s)[:, None] * inward
    out = walk(record_of(curve), path)
    # The distance is flat to fourth order here: it is right to rounding although s is not.
    every = slice(0, None, 40)
    np.testing.assert_allclose(out["distance"][every], reference(curve, path[every])[:, 1], atol=1e-9)
    assert np.all(np.isfinite(out["force_world"]))
    assert np.all(np.diff(out["s"]) > 0.0)


def test_search_saves_the_point_that_bare_newton_loses():
    """A ball carried straight across the bend: its closest point jumps from leg to leg, its old minimum vanishes."""
    curve = build_tunnel(HAIRPIN, 0.004)
    record = record_of(curve, stiffness=1000.0)
    ticks = 4000
    across = np.column_stack([np.full(ticks, 0.15), np.linspace(-0.01, 0.08, ticks), np.zeros(ticks)])
    along = np.column_stack([np.linspace(0.15, 0.4, ticks), np.full(ticks, 0.08), np.zeros(ticks)])
    path = np.concatenate([across, along])
    path = np.concatenate([path, path[::-1]])
    out = walk(record, path)
    exact = reference(curve, path[::100])[:, 1]
    # Followed, the ball may stay with its leg while the other is nearer by 10 mm at most, and for the
    # sixteen ticks in which the pieces are looked over; each of them changes both distances by 0.0625 mm at most.
    assert np.all(out["distance"][::100] <= exact + 0.010 + 16 * 2 * 0.0625e-3)
    lost = 0
    for i in range(500, len(path), 500):
        s = bare_newton(curve, path[i], out["s"][i - 500])
        lost += np.linalg.norm(curve.point(s)[0] - path[i]) > closest_by_roots(curve.pieces, path[i])[1] + 0.016
    assert lost >= 1


def test_lost_minimum_is_noticed_in_the_same_tick():
    """From inside the bend outwards: the distance grows by more than the ball moved, so all is searched."""
    curve = build_tunnel(HAIRPIN, 0.004)
    path = np.column_stack([np.linspace(0.1, 0.5, 2000), np.full(2000, 0.031), np.zeros(2000)])
    out = walk(record_of(curve), path)
    exact = reference(curve, path[::20])[:, 1]
    assert np.all(out["distance"][::20] <= exact + 0.010 + 1e-9)
    assert np.all(out["distance"][-200::20] <= exact[-10:] + 1e-9)


def test_start_far_away_and_teleports_find_the_closest_point():
    rng = np.random.default_rng(2)
    for curve in (wavy(), coil(), build_tunnel(FIGURE_EIGHT, 0.01)):
        points = np.concatenate([rng.normal(0.0, 0.15, (60, 3)), rng.normal(0.0, 100.0, (20, 3))])
        out = walk(record_of(curve, stiffness=1000.0), points)
        assert out["restarts"][-1] == len(points)
        # The first tick of a fresh state prefers the beginning within 5 mm; all others take the closest point.
        np.testing.assert_allclose(out["distance"][1:], reference(curve, points)[1:, 1], rtol=1e-12, atol=1e-11)
        assert np.all(np.isfinite(out["force_world"]))


def test_slow_drift_to_another_branch_is_found_within_sixteen_ticks():
    curve = build_tunnel(HAIRPIN, 0.001)
    record = record_of(curve)
    state = np.zeros(1, TUNNEL_STATE)
    walk(record, [0.05, 0.0, 0.0], state=state)
    across = np.column_stack([np.full(2000, 0.05), np.linspace(0.0, 0.06, 2000), np.zeros(2000)])
    out = walk(record, across, state=state)
    upper_leg = reference(curve, across[-1])[0, 0]
    assert out["s"][-1] == pytest.approx(upper_leg, abs=1e-9)
    difference = out["distance"][:, None] - np.linalg.norm(curve.point(upper_leg) - across, axis=1)[:, None]
    late = np.flatnonzero(difference[:, 0] > 0.010)
    assert len(late) <= 16


def test_ball_goes_straight_on_where_the_tunnel_crosses_itself():
    curve = build_tunnel(FIGURE_EIGHT, 0.01)
    path = ball_path(curve, 0.9, 4000, seed=3)[:2001]
    out = walk(record_of(curve), path, ball_radius=0.0)
    assert np.all(np.diff(out["progress"]) > -1e-6)
    assert np.max(np.diff(out["progress"])) < 0.01
    assert out["progress"][-1] > 0.999


def test_closed_tunnel_starts_at_its_beginning_and_ends_at_its_end():
    phi = np.linspace(0.0, 2.0 * np.pi, 40)
    curve = build_tunnel(np.column_stack([0.1 * np.cos(phi), 0.1 * np.sin(phi), 0.0 * phi]), 0.015)
    record = record_of(curve)
    jitter = np.random.default_rng(4).normal(0.0, 5e-4, (50, 3))
    starts = afresh(record, curve.point(0.0) + jitter)
    assert starts["progress"].max() < 0.02
    s = curve.parameter_at(np.linspace(0.0, curve.length, 4000))
    out = walk(record, curve.point(s) + 0.005 * curve.frame(s)[1])
    assert np.all(np.diff(out["progress"]) >= 0.0) and out["progress"][-1] == pytest.approx(1.0)


def test_restart_forgets_the_end_of_a_closed_tunnel():
    phi = np.linspace(0.0, 2.0 * np.pi, 40)
    curve = build_tunnel(np.column_stack([0.1 * np.cos(phi), 0.1 * np.sin(phi), 0.0 * phi]), 0.015)
    record = record_of(curve)
    state = np.zeros(1, TUNNEL_STATE)
    end = curve.point(curve.parameter_at(np.linspace(0.5, 1.0, 2000) * curve.length))
    assert walk(record, end, state=state)["progress"][-1] == pytest.approx(1.0)
    restart_tracking(state[0])
    assert walk(record, end[-1], state=state)["progress"][-1] < 1e-3


def test_new_geometry_under_the_same_state_is_found_at_once():
    curve, other = coil(), wavy()
    state = np.zeros(1, TUNNEL_STATE)
    p = other.point(1.3) + [0.0, 0.0, 0.01]
    walk(record_of(curve), p, state=state)
    out = walk(record_of(other), p, state=state)
    np.testing.assert_allclose(out["distance"], reference(other, p)[:, 1], atol=1e-12)


def test_ball_at_the_centre_of_curvature_gets_a_finite_force():
    phi = np.linspace(0.0, 4.0, 60)
    curve = build_tunnel(np.column_stack([0.05 * np.cos(phi), 0.05 * np.sin(phi), 0.0 * phi]), [0.02, 0.01, 0.02])
    record = record_of(curve, stiffness=1000.0, damping=10.0)
    out = walk(record, np.random.default_rng(5).normal(0.0, 1e-6, (500, 3)), [0.1, 0.1, 0.1])
    force = np.linalg.norm(out["force_world"], axis=1)
    assert np.all(np.isfinite(force))
    # The wall tilts by at most r' / 0.05, so the push of 1000 x 0.04 N grows by no more than that.
    assert force.max() < 1000.0 * 0.05 * 20.0


def test_ball_leaving_through_an_end_far_away_comes_back_to_it():
    curve = straight()
    x = np.concatenate([np.linspace(0.39, 3.0, 500), np.linspace(3.0, 0.39, 500)])
    out = walk(record_of(curve, stiffness=100.0), np.column_stack([x, 0.0 * x, 0.0 * x]))
    assert out["progress"].max() == 1.0
    assert out["progress"][-1] == pytest.approx(0.39 / 0.4)
    np.testing.assert_allclose(out["distance"], np.maximum(x - 0.4, 0.0), atol=1e-12)


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_golden_section_reaches_the_very_end(end):
    """Short of it by the root of machine precision, a ball pushed out of the tunnel would not meet the cap."""
    curve = wavy(0.03)
    s = end * len(curve.pieces)
    beyond = curve.point(s)[0] + (2.0 * end - 1.0) * 0.005 * curve.tangent(s)[0]
    found = project_golden_section(record_of(curve)[0], *beyond, np.zeros(1, TUNNEL_STATE)[0])
    assert found == s
