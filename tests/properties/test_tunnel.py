"""What holds for every tunnel, ball and motion, near the limits too."""

from __future__ import annotations

from collections import Counter

import numpy as np
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from mimics_app.lab.groups.tunnel_projection import closest_by_roots
from mimics_app.maths import bspline
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE, TunnelStatus
from mimics_app.rendering.haptic.tunnel_geometry import TunnelError, build_tunnel
from tests.support.examples import same_examples
from tests.support.tunnels import record_of, walk

QUICK = settings(max_examples=60, suppress_health_check=[HealthCheck.filter_too_much])

length = st.floats(-0.3, 0.3, allow_subnormal=False)
point = st.tuples(length, length, length)
control_points = st.lists(point, min_size=4, max_size=9)
velocity = st.tuples(*[st.floats(-3.0, 3.0, allow_subnormal=False)] * 3)
SHALLOW = [(-0.3, 0.0, 0.0), (-0.1, 0.02, 0.0), (0.1, -0.02, 0.0), (0.3, 0.0, 0.0)]
"""A piece that is odd about its middle, the origin."""

anything = st.one_of(length, st.floats(-1e6, 1e6), st.floats(allow_nan=True, allow_infinity=True, width=64))


def lawful(points, share):
    """A tunnel whose radius x curvature is `share`, or None where the points make none."""
    try:
        thin = build_tunnel(points, 1e-4)
        radius = min(share * thin.max_radius_scale * 1e-4, 0.1)
        return build_tunnel(points, radius)
    except TunnelError:
        return None


def test_wall_force_never_pulls_and_power_of_the_rest_is_known():
    walls = []

    @same_examples
    @QUICK
    @given(control_points, st.floats(0.0, 0.999), point, velocity, st.floats(0.0, 0.05), st.floats(0.0, 3.0))
    @example(SHALLOW, 0.5, (0.0, 0.0, 0.0), (0.1, 0.0, 0.0), 0.001, 1.0)  # inside, which few that are drawn are
    def check(points, share, p, v, ball, scale):
        curve = lawful(points, share)
        assume(curve is not None)
        assume(scale * share < 1.0)
        record = record_of(curve, stiffness=1000.0, damping=20.0, radius_scale=scale)
        out = walk(record, p, v, ball)[0]
        e = np.asarray(p) - curve.point(out["s"])[0]
        assert out["status"] == TunnelStatus.FOLLOWING
        assert out["penetration"] >= 0.0 and 0.0 <= out["progress"] <= 1.0
        assert abs(out["distance"] - np.linalg.norm(e)) < 1e-12
        if out["penetration"] == 0.0:
            assert out["wall_force"] == 0.0
        across = out["force_world"] - (out["force_world"] @ out["tangent"]) * out["tangent"]
        assert across @ e <= 1e-9
        walls.append(float(out["wall_force"]))
        record["drag"], record["drag_growth"] = 5.0, 300.0
        dragged = walk(record, p, v, ball)[0]["force_world"] - out["force_world"]
        assert dragged @ np.asarray(v) <= 1e-9

    check()
    touched = sum(force > 0.0 for force in walls)
    assert 0.2 * len(walls) <= touched < len(walls), "inside and at the wall"


CLOSED = [(0.25, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.25), (0.25, 0.0, 0.0)]
"""One piece that comes back to its beginning: both of its ends are near the ball, and both are minima."""


@QUICK
@given(
    control_points, st.floats(0.1, 0.999), st.lists(st.floats(0.0, 1.0), min_size=2, max_size=2), st.floats(0.0, 6.28)
)
@example(CLOSED, 0.5, [1.0, 0.5], 0.0)
def test_followed_point_is_the_closest_as_long_as_branches_keep_apart(points, share, ends, turn):
    curve = lawful(points, share)
    assume(curve is not None)
    s = curve.parameter_at(np.linspace(ends[0], ends[1], 1500) * curve.length)
    _, n, b = curve.frame(s)
    radius = curve.radius(s)
    path = curve.point(s) + 0.98 * radius[:, None] * (np.cos(turn) * n + np.sin(turn) * b)
    assume(np.max(np.linalg.norm(np.diff(path, axis=0), axis=1)) < 0.005)
    out = walk(record_of(curve), path)
    for i in (500, 1000, 1499):
        exact = closest_by_roots(curve.pieces, path[i])[1]
        own = np.linalg.norm(curve.point(out["s"][i])[0] - path[i])
        # Either the closest point, or the point of the branch the ball travels on.
        assert own <= exact + 1e-9 or abs(own - 0.98 * radius[i]) < 1e-6 or own <= exact + max(radius[i], 0.01) + 0.02


def test_no_number_makes_a_force_that_is_not_finite():
    curve = build_tunnel([(0.0, 0.0, 0.0), (0.1, 0.05, 0.0), (0.2, -0.05, 0.02), (0.3, 0.0, 0.0)], [0.02, 0.01, 0.02])
    record = record_of(curve, stiffness=1500.0, damping=20.0, drag=2.0, drag_growth=1e3, centring=50.0, advance=3.0)
    statuses = Counter()

    @same_examples
    @settings(QUICK, max_examples=200)
    @given(anything, anything, anything, anything, anything)
    def check(x, y, vx, vy, ball):
        state = np.zeros(1, TUNNEL_STATE)
        for p, v in (((x, y, 0.0), (vx, vy, 0.0)), ((0.1, 0.0, 0.0), (0.0, 0.0, 0.0))):
            out = walk(record, p, v, ball, state)[0]
            assert np.isfinite(out["force_world"]).all() and np.isfinite(out["force_tnb"]).all()
            assert np.isfinite(out["s"]) and np.isfinite(out["progress"]) and np.isfinite(out["penetration"])
            statuses[TunnelStatus(out["status"])] += 1

    check()
    assert min(statuses[TunnelStatus.FOLLOWING], statuses[TunnelStatus.NOT_FINITE]) >= 50, statuses


@QUICK
@given(control_points, st.lists(st.floats(0.0, 0.05, allow_subnormal=False), min_size=1, max_size=12))
def test_radius_stays_between_its_values_and_the_curve_in_its_control_points(points, radius):
    try:
        curve = build_tunnel(points, radius, radius_scale=0.0)
    except TunnelError:
        assume(False)
        return
    s = np.linspace(0.0, len(curve.pieces), 400)
    assert curve.radius(s).max() <= max(radius) + 1e-12 and curve.radius(s).min() >= min(radius) - 1e-12
    assert np.all(curve.point(s) <= np.max(points, axis=0) + 1e-12)
    assert np.all(curve.point(s) >= np.min(points, axis=0) - 1e-12)
    t, n, b = curve.frame(s)
    np.testing.assert_allclose(np.sum(t * n, axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(b, axis=1), 1.0, atol=1e-12)


@QUICK
@given(control_points, st.floats(0.0, 1.0))
def test_arc_length_and_parameter_are_inverse(points, share):
    pieces = bspline.pieces_of(points)
    table = bspline.arc_lengths(pieces)
    assume(table[-1] > 1e-3)
    s = bspline.parameter_at(pieces, table, share * table[-1])
    assert abs(bspline.arc_length_at(pieces, table, s)[0] - share * table[-1]) <= 1e-11 * table[-1]


@QUICK
@given(st.integers(4, 30), st.floats(0.0, 1.0), st.sampled_from(["clamped", "uniform"]))
def test_basis_functions_sum_to_one(count, share, ends):
    values = bspline.basis_functions(count, share * (count - 3), ends)
    assert abs(values.sum() - 1.0) < 1e-13 and values.min() >= -1e-14
