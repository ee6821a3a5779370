"""Laws of the rotation group, on numbers chosen to break them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mimics_app.maths import quat, vec
from mimics_app.maths.decompose import decompose_trs
from mimics_app.maths.mat import compose
from mimics_app.maths.poses import pose_from_parts, rotate_vector

SETTINGS = settings(max_examples=150)
EPS = np.finfo(float).eps
# A product of two unit quaternions takes 28 rounded operations of numbers <= 1, three of them in a row 84.
CHAIN = 100 * EPS

component = st.floats(-1, 1)
quaternions = (
    st.tuples(component, component, component, component)
    .filter(lambda q: np.linalg.norm(q) > 1e-3)
    .map(lambda q: quat.normalise_rows(np.array(q)))
)
vectors = st.tuples(*[st.floats(-100, 100)] * 3).map(np.array)
rotation_vectors = st.tuples(*[st.floats(-3, 3)] * 3).map(np.array)


def product(a, b):
    out = np.empty(4)
    quat.multiply(a, b, out)
    return out


def turned(q, v):
    out = np.empty(3)
    quat.rotate(q, v, out)
    return out


def matrix(q):
    out = np.eye(3)
    quat.to_matrix(q, out)
    return out


@SETTINGS
@given(quaternions, quaternions, quaternions)
def test_product_is_associative_and_stays_unit(a, b, c):
    left, right = product(product(a, b), c), product(a, product(b, c))
    assert np.abs(left - right).max() <= CHAIN
    assert abs(np.linalg.norm(left) - 1) <= CHAIN


@SETTINGS
@given(quaternions, vectors)
def test_a_vector_is_rotated_as_by_the_matrix_of_its_pose(q, v):
    by_matrix = pose_from_parts((0.0, 0.0, 0.0), q)[:3, :3] @ v
    assert np.abs(rotate_vector(q, v) - by_matrix).max() <= CHAIN * 100.0


@SETTINGS
@given(quaternions)
def test_conjugate_is_the_inverse(q):
    back = np.empty(4)
    quat.conjugate(q, back)
    assert np.abs(product(q, back) - quat.IDENTITY).max() <= CHAIN


@SETTINGS
@given(quaternions, quaternions, vectors)
def test_product_turns_by_the_right_factor_first_like_matrices_on_columns(a, b, v):
    size = max(1.0, np.linalg.norm(v))
    assert np.abs(turned(product(a, b), v) - turned(a, turned(b, v))).max() <= CHAIN * size
    assert np.abs(turned(a, v) - matrix(a) @ v).max() <= CHAIN * size


@SETTINGS
@given(quaternions, vectors)
def test_rotate_back_undoes_rotate_and_keeps_length(q, v):
    out = turned(q, v)
    assert abs(np.linalg.norm(out) - np.linalg.norm(v)) <= CHAIN * max(1.0, np.linalg.norm(v))
    quat.rotate_back(q, out, out)
    assert np.abs(out - v).max() <= CHAIN * max(1.0, np.linalg.norm(v))


@SETTINGS
@given(quaternions)
def test_matrix_and_back_gives_the_canonical_quaternion(q):
    m = matrix(q)
    assert np.abs(m @ m.T - np.eye(3)).max() <= CHAIN
    assert np.linalg.det(m) == pytest.approx(1.0, abs=CHAIN)
    back = np.empty(4)
    quat.from_matrix(m, back)
    assert back[3] >= 0
    # Shepperd divides by a component >= 1/2, so the matrix's error is at most doubled twice.
    assert min(np.abs(back - q).max(), np.abs(back + q).max()) <= 4 * CHAIN


@pytest.mark.parametrize("axis", np.vstack([np.eye(3), -np.eye(3), np.ones((1, 3)), [[1, -1, 0]]]).tolist())
def test_matrix_of_a_half_turn_where_w_vanishes(axis):
    q = quat.about_axis(axis, math.pi)
    back = np.empty(4)
    quat.from_matrix(matrix(q), back)
    assert min(np.abs(back - q).max(), np.abs(back + q).max()) <= 4 * CHAIN


def log_of(q, out):
    """Rotation vector [rad] of a unit quaternion, the shorter way round."""
    sine, sign = np.linalg.norm(q[:3]), 1.0 if q[3] >= 0.0 else -1.0
    out[:] = 2.0 * sign * q[:3] * (1.0 if sine < 1e-9 else math.atan2(sine, sign * q[3]) / sine)


@SETTINGS
@given(rotation_vectors)
def test_log_undoes_exp_below_a_half_turn(w):
    assume(np.linalg.norm(w) < math.pi - 1e-3)
    q, back = np.empty(4), np.empty(3)
    quat.exp_map(w, q)
    log_of(q, back)
    assert np.abs(back - w).max() <= 20 * CHAIN


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-12, 1e-5, 0.99e-4, 1.01e-4, 1e-3])
def test_exp_is_smooth_through_zero_and_its_series_border(angle):
    q = np.empty(4)
    quat.exp_map(np.array([0.0, angle, 0.0]), q)
    assert q[1] == pytest.approx(math.sin(angle / 2), rel=1e-15, abs=0)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=4 * EPS)


@SETTINGS
@given(quaternions, quaternions, st.floats(0, 1))
def test_slerp_has_constant_speed_along_the_shorter_way(a, b, t):
    out, back, turn = np.empty(4), np.empty(4), np.empty(3)
    quat.conjugate(a, back)

    def angle_from_a(q):
        log_of(product(back, q), turn)
        return np.linalg.norm(turn)

    quat.slerp(a, b, t, out)
    assert abs(np.linalg.norm(out) - 1) <= CHAIN
    assert angle_from_a(b) <= math.pi + CHAIN
    # The angle of a nearly whole turn is found from a component of size eps^0.5.
    assert angle_from_a(out) == pytest.approx(t * angle_from_a(b), abs=1e-7)


def test_slerp_of_opposite_signs_of_one_rotation_stays_there():
    q = quat.about_axis((1, 2, 3), 1.0)
    out = np.empty(4)
    quat.slerp(q, -q, 0.5, out)
    assert np.abs(out - q).max() <= CHAIN


def test_slerp_of_a_half_turn_is_finite():
    out = np.empty(4)
    quat.slerp(np.array(quat.IDENTITY), np.array([1.0, 0, 0, 0]), 0.5, out)
    assert np.abs(out - quat.about_axis((1, 0, 0), math.pi / 2)).max() <= CHAIN


@pytest.mark.parametrize("bad", [[0, 0, 0, 0], [math.nan, 0, 0, 1], [0, math.inf, 0, 1], [0, 0, 0, math.nan]])
def test_normalise_of_what_is_no_rotation_gives_the_identity_and_says_so(bad):
    out = np.empty(4)
    assert quat.normalise(np.array(bad, float), out) == 0.0
    assert out.tolist() == list(quat.IDENTITY)
    with pytest.raises(ValueError, match="not a rotation"):
        quat.normalise_rows(np.array([bad], float))


@pytest.mark.parametrize("scale", [1e-300, 1e-160, 1.0, 1e160, 1e300])
def test_normalise_has_a_direction_where_squares_leave_the_range(scale):
    v, q = np.array([3.0, 0.0, 4.0]) * scale, np.array([0.0, 3.0, 0.0, -4.0]) * scale
    length = vec.normalise(v, v)
    assert length == pytest.approx(5 * scale, rel=4 * EPS)
    assert np.abs(v - [0.6, 0, 0.8]).max() <= 4 * EPS
    quat.normalise(q, q)
    assert np.abs(q - [0, -0.6, 0, 0.8]).max() <= 4 * EPS


@pytest.mark.parametrize("bad", [[0, 0, 0], [math.nan, 0, 1], [0, math.nan, 1], [math.inf, 0, 0]])
def test_a_vector_without_direction_is_refused_outside_and_zeroed_inside_the_loop(bad):
    out = np.ones(3)
    assert vec.normalise(np.array(bad, float), out) == 0.0
    assert out.tolist() == [0, 0, 0]
    with pytest.raises(ValueError, match="no direction"):
        vec.unit(bad)


@SETTINGS
@given(quaternions, st.tuples(*[st.floats(0.01, 100)] * 3), st.sampled_from([1.0, -1.0]))
def test_decomposing_undoes_composing_also_mirrored(q, scale, mirror):
    s = np.array(scale) * [mirror, 1.0, 1.0]
    t, back, found, shear = decompose_trs(compose((1, 2, 3), q, s))
    assert np.abs(found - s).max() <= CHAIN * abs(s).max()
    assert min(np.abs(back - q).max(), np.abs(back + q).max()) <= 10 * CHAIN
    assert shear <= CHAIN
    assert t.tolist() == [1, 2, 3]


def test_decomposing_a_sheared_matrix_says_so():
    m = np.eye(4)
    m[0, 1] = 0.5
    assert decompose_trs(m)[3] > 0.1


@pytest.mark.parametrize("flat", [(1.0, 0.0, 2.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)])
def test_decomposing_a_flat_matrix_gives_a_rotation_nevertheless(flat):
    _, q, s, shear = decompose_trs(compose((0, 0, 0), quat.IDENTITY, flat))
    assert s.tolist() == list(flat)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=CHAIN)
    assert shear == 0.0
