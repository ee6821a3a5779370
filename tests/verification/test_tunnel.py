"""The tunnel's force against closed forms, its potential, and the work it does (D2.1 4.2.10)."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.groups.tunnel_projection import closest_by_roots
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE, TunnelStatus
from tests.support.tunnels import afresh, coil, record_of, ring, straight, walk, wavy

K = 1500.0  # N/m
B = 12.0  # N s/m


def potential(curve, p, ball_radius, k=K):
    """k d^2 / 2 [J] from the reference projection, which shares no code with the tick."""
    s, distance = closest_by_roots(curve.pieces, np.asarray(p))
    room = max(0.0, curve.radius(s)[0] - ball_radius)
    return 0.5 * k * max(0.0, distance - room) ** 2


def points_in_wall(curve, count, seed, depth=0.006, ball_radius=0.008):
    """Points whose ball is 0..depth in the wall, away from the ends."""
    rng = np.random.default_rng(seed)
    s = curve.parameter_at(rng.uniform(0.06, 0.94, count) * curve.length)
    _, n, b = curve.frame(s)
    turn = rng.uniform(0.0, 2.0 * np.pi, count)
    direction = np.cos(turn)[:, None] * n + np.sin(turn)[:, None] * b
    rho = np.maximum(0.0, curve.radius(s) - ball_radius) + rng.uniform(0.0005, depth, count)
    return curve.point(s) + rho[:, None] * direction


def test_straight_tunnel_is_a_spring_outside_the_room_and_nothing_inside():
    record = record_of(straight(0.02), stiffness=K)
    rng = np.random.default_rng(1)
    rho, turn, x = rng.uniform(0.0, 0.03, 200), rng.uniform(0.0, 6.28, 200), rng.uniform(0.02, 0.38, 200)
    u = np.column_stack([np.zeros(200), np.cos(turn), np.sin(turn)])
    out = afresh(record, x[:, None] * [1.0, 0.0, 0.0] + rho[:, None] * u, ball_radius=0.005)
    depth = np.maximum(0.0, rho - 0.015)
    assert np.count_nonzero(depth) > 50 and np.count_nonzero(depth == 0.0) > 50
    np.testing.assert_allclose(out["force_world"], -K * depth[:, None] * u, atol=1e-11)
    np.testing.assert_allclose(out["penetration"], depth, atol=1e-14)
    np.testing.assert_allclose(out["progress"], x / 0.4, atol=1e-12)


def test_ring_tunnel_follows_the_torus():
    bend, radius, ball = 0.1, 0.03, 0.01
    curve, off = ring(bend, radius)
    assert off < 1e-6
    record = record_of(curve, stiffness=K, damping=B)
    rng = np.random.default_rng(2)
    phi, turn, rho = rng.uniform(0.1, 4.4, 100), rng.uniform(0.0, 6.28, 100), rng.uniform(0.0, 0.04, 100)
    outward = np.column_stack([np.cos(phi), np.sin(phi), 0.0 * phi])
    tangent = np.column_stack([-np.sin(phi), np.cos(phi), 0.0 * phi])
    u = np.cos(turn)[:, None] * outward + np.sin(turn)[:, None] * [0.0, 0.0, 1.0]
    v = rng.normal(0.0, 0.1, (100, 3))
    out = afresh(record, bend * outward + rho[:, None] * u, v, ball)
    depth = np.maximum(0.0, rho - (radius - ball))
    push = np.where(depth > 0.0, np.maximum(0.0, K * depth + B * np.sum(u * v, axis=1)), 0.0)
    # The bisector is off the circle by `off`, in waves of a piece of 8 mm: its direction by 2 pi off / 8 mm < 1e3 off.
    np.testing.assert_allclose(out["force_world"], -push[:, None] * u, atol=(K + 1e3 * push.max()) * off)
    np.testing.assert_allclose(out["progress"], phi / 4.5, atol=1e-5)
    np.testing.assert_allclose(out["tangent"], tangent, atol=1e3 * off)


def test_force_is_the_gradient_of_the_wall_energy_also_where_the_radius_varies():
    step = 1e-6
    for curve in (straight([0.03, 0.012, 0.03]), wavy([0.03, 0.014, 0.02, 0.035]), coil([0.02, 0.01, 0.02])):
        record = record_of(curve, stiffness=K)
        points = points_in_wall(curve, 25, seed=3)
        out = afresh(record, points, ball_radius=0.008)
        for p, force in zip(points, out["force_world"], strict=True):
            gradient = [
                (potential(curve, p + step * e, 0.008) - potential(curve, p - step * e, 0.008)) / (2.0 * step)
                for e in np.eye(3)
            ]
            # Second differences of the energy are of order k, so the quotient errs by less than k step.
            np.testing.assert_allclose(force, np.negative(gradient), atol=K * step)


def test_closed_loop_in_the_wall_takes_and_gives_no_work_but_a_purely_radial_force_would():
    curve = straight([0.03, 0.01, 0.03])
    record = record_of(curve, stiffness=K)
    angle = np.linspace(0.0, 2.0 * np.pi, 4001)
    path = np.column_stack([0.12 + 0.05 * np.cos(angle), 0.034 + 0.004 * np.sin(angle), 0.0 * angle])
    force = walk(record, path)["force_world"]
    mean, moved = 0.5 * (force[1:] + force[:-1]), np.diff(path, axis=0)
    # The trapezoid rule on a smooth closed loop converges faster than any power of the step.
    assert abs(np.sum(mean * moved)) < 1e-9
    radial = force.copy()
    radial[:, 0] = 0.0
    gained = np.sum(0.5 * (radial[1:] + radial[:-1]) * moved)
    assert abs(gained) > 1e-3


def test_damper_takes_pi_b_w_a_squared_a_cycle():
    record = record_of(straight(0.02), stiffness=K, damping=B)
    amplitude, omega = 0.001, 2.0 * np.pi * 5.0
    t = np.arange(2001) / 2000.0 * 0.2
    path = np.column_stack([0.2 + 0.0 * t, 0.03 + amplitude * np.sin(omega * t), 0.0 * t])
    v = np.column_stack([0.0 * t, amplitude * omega * np.cos(omega * t), 0.0 * t])
    force = walk(record, path, v)["force_world"]
    power = np.sum(force * v, axis=1)
    taken = -np.sum(power[:-1]) * (t[1] - t[0])
    assert taken == pytest.approx(np.pi * B * omega * amplitude**2, rel=1e-9)


def test_depth_rate_is_the_derivative_of_the_depth():
    curve = wavy([0.03, 0.014, 0.02, 0.035])
    record = record_of(curve, stiffness=K, damping=B)
    points = points_in_wall(curve, 40, seed=4)
    v = np.random.default_rng(5).normal(0.0, 0.2, points.shape)
    dt = 1e-6
    before = afresh(record, points - v * dt, ball_radius=0.008)["penetration"]
    after = afresh(record, points + v * dt, ball_radius=0.008)["penetration"]
    rate = afresh(record, points, v, 0.008)["approach_speed"]
    np.testing.assert_allclose(rate, (after - before) / (2.0 * dt), atol=1e-7)


def test_wall_never_pulls_however_fast_the_ball_leaves():
    curve = wavy([0.03, 0.014, 0.02, 0.035])
    record = record_of(curve, stiffness=K, damping=200.0)
    points = points_in_wall(curve, 200, seed=6)
    v = np.random.default_rng(7).normal(0.0, 2.0, points.shape)
    still = afresh(record, points, ball_radius=0.008)
    moving = afresh(record, points, v, 0.008)
    along = np.sum(moving["force_world"] * still["normal_world"], axis=1)
    assert np.count_nonzero(along == 0.0) > 20 and np.count_nonzero(along > 0.0) > 20
    assert along.min() >= -1e-12


def test_growing_ball_meets_the_wall_with_its_own_rate():
    record = record_of(straight(0.02), stiffness=K, damping=B)
    state = np.zeros(1, TUNNEL_STATE)
    state["ball_radius_rate"] = 0.05
    out = walk(record, [0.2, 0.015, 0.0], ball_radius=0.01, state=state)[0]
    assert out["approach_speed"] == pytest.approx(0.05)
    np.testing.assert_allclose(out["force_world"], [0.0, -(K * 0.005 + B * 0.05), 0.0], atol=1e-12)


def test_ball_larger_than_the_tunnel_is_held_to_the_bisector_without_a_flip():
    record = record_of(straight(0.01), stiffness=K)
    y = np.linspace(-1e-4, 1e-4, 201)
    force = walk(record, np.column_stack([0.2 + 0.0 * y, y, 0.0 * y]), ball_radius=0.025)["force_world"]
    np.testing.assert_allclose(force[:, 1], -K * y, atol=1e-10)


def test_ball_larger_than_the_tunnel_is_dragged_more_the_larger_it_is():
    record = record_of(straight(0.01), stiffness=K, drag=3.0, drag_growth=400.0)
    for ball in (0.004, 0.01, 0.02, 0.05):
        out = walk(record, [0.2, 0.0, 0.0], [0.1, 0.02, 0.0], ball)[0]
        c = 3.0 + 400.0 * max(0.0, ball - 0.01)
        np.testing.assert_allclose(out["force_world"], [-0.1 * c, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("ball", [0.0, 0.03])
def test_radius_zero_keeps_the_ball_on_the_bisector(ball):
    curve = wavy(0.02)
    record = record_of(curve, stiffness=K, radius_scale=0.0)
    points = points_in_wall(curve, 50, seed=8)
    out = afresh(record, points, ball_radius=ball)
    nearest = np.array([curve.point(closest_by_roots(curve.pieces, p)[0])[0] for p in points])
    np.testing.assert_allclose(out["force_world"], K * (nearest - points), atol=1e-7)


def test_ball_exactly_on_the_bisector_feels_no_wall():
    for scale in (0.0, 1.0):
        record = record_of(straight(0.02), stiffness=K, damping=B, radius_scale=scale)
        out = walk(record, [0.2, 0.0, 0.0], [0.0, 0.5, 0.0])[0]
        np.testing.assert_array_equal(out["force_world"], 0.0)


@pytest.mark.parametrize(("x", "sign"), [(0.4, 1.0), (0.0, -1.0)])
def test_ball_pushed_out_of_an_end_is_pushed_back_along_the_tangent_only(x, sign):
    record = record_of(straight(0.02), stiffness=K, damping=B)
    beyond = np.array([0.01, 0.0149, 0.0151, 0.02, 0.08])
    path = np.column_stack([x + sign * beyond, 0.01 + 0.0 * beyond, -0.003 + 0.0 * beyond])
    out = afresh(record, path, [sign * 0.1, 0.3, 0.2], ball_radius=0.005)
    depth = beyond - 0.015
    push = np.where(depth > 0.0, K * depth + B * 0.1, 0.0)
    np.testing.assert_allclose(out["force_world"], -sign * push[:, None] * [1.0, 0.0, 0.0], atol=1e-11)
    np.testing.assert_allclose(out["penetration"], np.maximum(depth, 0.0), atol=1e-15)
    np.testing.assert_array_equal(out["progress"], 1.0 if sign > 0.0 else 0.0)


def test_ball_at_rest_at_either_end_touches_nothing():
    curve = coil()
    record = record_of(curve, stiffness=K, damping=B)
    ends = curve.point([0.0, len(curve.pieces)])
    out = afresh(record, ends, [0.2, 0.2, 0.2], ball_radius=0.01)
    np.testing.assert_array_equal(out["wall_force"], 0.0)
    np.testing.assert_array_equal(out["penetration"], 0.0)


def test_beyond_an_end_the_wall_goes_on_as_a_pipe():
    record = record_of(straight(0.02), stiffness=K)
    out = walk(record, [0.41, 0.023, 0.0], ball_radius=0.005)[0]
    np.testing.assert_allclose(out["force_world"], [0.0, -K * 0.008, 0.0], atol=1e-12)


def test_force_of_the_caps_is_the_gradient_of_their_energy():
    record = record_of(straight(0.02), stiffness=K)

    def energy(p):
        cap = max(0.0, p[0] - 0.4 - 0.015)
        wall = max(0.0, np.hypot(p[1], p[2]) - 0.015)
        return 0.5 * K * (cap**2 + wall**2)

    p, step = np.array([0.42, 0.012, 0.014]), 1e-6
    gradient = [(energy(p + step * e) - energy(p - step * e)) / (2.0 * step) for e in np.eye(3)]
    force = walk(record, p, ball_radius=0.005)[0]["force_world"]
    np.testing.assert_allclose(force, np.negative(gradient), atol=K * step)


def test_advance_leads_to_the_end_and_fades_there_and_centring_leads_to_the_bisector():
    record = record_of(straight(0.02), advance=2.0, centring=50.0)
    x = np.array([0.1, 0.389, 0.395, 0.4, 0.41, -0.01])
    expected = [2.0, 2.0, 1.0, 0.0, -0.5, 2.5]
    out = afresh(record, np.column_stack([x, 0.004 + 0.0 * x, 0.0 * x]))
    np.testing.assert_allclose(out["force_world"][:, 0], expected, atol=1e-9)
    np.testing.assert_allclose(out["force_world"][:, 1], -0.2, atol=1e-12)


def test_traces_in_t_n_b_add_up_and_agree_with_the_curve():
    curve = coil()
    record = record_of(curve, stiffness=K, damping=B, drag=3.0, centring=20.0)
    points = points_in_wall(curve, 200, seed=9)
    out = afresh(record, points, np.random.default_rng(1).normal(0.0, 0.1, points.shape), 0.008)
    t, n, b = out["tangent"], out["normal_n"], out["binormal"]
    np.testing.assert_allclose(np.cross(t, n), b, atol=1e-14)
    f = out["force_tnb"]
    np.testing.assert_allclose(f[:, :1] * t + f[:, 1:2] * n + f[:, 2:] * b, out["force_world"], atol=1e-12)
    offset = out["offset_n"][:, None] * n + out["offset_b"][:, None] * b
    np.testing.assert_allclose(curve.point(out["s"]) + offset, points, atol=1e-11)
    for tick, curve_axis in zip((t, n, b), curve.frame(out["s"]), strict=True):
        # The tick carries n over a whole piece in one step, the curve in sixteen: fourth order in the piece.
        np.testing.assert_allclose(tick, curve_axis, atol=2e-3)


def test_frame_of_the_tick_has_no_step_at_the_knots():
    curve = coil()
    record = record_of(curve)
    knots = np.arange(1.0, len(curve.pieces))
    before = afresh(record, curve.point(knots - 1e-9))["normal_n"]
    after = afresh(record, curve.point(knots + 1e-9))["normal_n"]
    np.testing.assert_allclose(before, after, atol=1e-7)


def test_binormal_of_a_planar_tunnel_is_constant_across_its_inflections():
    curve = wavy()
    out = walk(record_of(curve), curve.point(np.linspace(0.0, len(curve.pieces), 3000)))
    np.testing.assert_allclose(out["binormal"], np.broadcast_to([0.0, 0.0, 1.0], (3000, 3)), atol=1e-12)


def test_progress_is_the_share_of_the_arc_length():
    curve = coil()
    s = np.linspace(0.0, len(curve.pieces), 500)
    out = walk(record_of(curve), curve.point(s))
    # Three Gauss points on the clamped end pieces, whose speed falls to a third along them.
    np.testing.assert_allclose(out["progress"], curve.arc_at(s) / curve.length, atol=1e-4)
    assert np.all(np.diff(out["progress"]) > 0.0)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e200, 1e7])
def test_input_that_is_not_finite_gives_no_force_and_a_flag_and_the_next_tick_is_right(bad):
    curve = wavy()
    record = record_of(curve, stiffness=K, damping=B)
    good = points_in_wall(curve, 1, seed=10)[0]
    expected = walk(record, good, ball_radius=0.008)[0]["force_world"]
    assert np.linalg.norm(expected) > 0.5
    for place in range(3):
        p, v, ball = good.copy(), np.zeros(3), 0.008
        if place == 0:
            p[1] = bad
        elif place == 1:
            v[2] = bad
        else:
            ball = bad
        state = np.zeros(1, TUNNEL_STATE)
        walk(record, good, ball_radius=0.008, state=state)
        out = walk(record, p, v, ball, state)[0]
        assert out["status"] == TunnelStatus.NOT_FINITE
        np.testing.assert_array_equal(out["force_world"], 0.0)
        np.testing.assert_array_equal(out["force_tnb"], 0.0)
        after = walk(record, good, ball_radius=0.008, state=state)[0]
        assert after["status"] == TunnelStatus.FOLLOWING
        np.testing.assert_array_equal(after["force_world"], expected)


def test_force_that_overflows_is_released():
    record = record_of(straight(0.02), stiffness=1e308)
    out = walk(record, [0.2, 100.0, 0.0])[0]
    assert out["status"] == TunnelStatus.NOT_FINITE
    np.testing.assert_array_equal(out["force_world"], 0.0)


def test_no_tunnel_no_force():
    record = record_of(straight(0.02), stiffness=K)
    record["pieces"] = 0
    out = walk(record, [0.2, 0.1, 0.0])[0]
    assert out["status"] == TunnelStatus.NO_TUNNEL
    np.testing.assert_array_equal(out["force_world"], 0.0)


def test_same_ticks_give_the_same_bits():
    curve = coil()
    record = record_of(curve, stiffness=K, damping=B, drag=1.0)
    path = points_in_wall(curve, 500, seed=11)
    assert walk(record, path).tobytes() == walk(record, path).tobytes()
