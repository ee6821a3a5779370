"""Transforms against numpy's general products and inverses, and projections against their definition."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.maths import mat, quat
from mimics_app.maths.length import length

SETTINGS = settings(max_examples=150)
EPS = np.finfo(float).eps

numbers = st.floats(-10, 10)
rotations = (
    st.tuples(*[st.floats(-1, 1)] * 4)
    .filter(lambda q: np.linalg.norm(q) > 1e-3)
    .map(lambda q: quat.normalise_rows(np.array(q)))
)
rigid = st.builds(lambda t, q: mat.compose(t, q), st.tuples(numbers, numbers, numbers), rotations)
affine = st.builds(mat.compose, st.tuples(numbers, numbers, numbers), rotations, st.tuples(*[st.floats(0.1, 10)] * 3))


@SETTINGS
@given(affine)
def test_affine_inverse_undoes_a_transform_and_gives_its_determinant(m):
    out = np.empty((4, 4))
    determinant = mat.affine_inverse(m, out)
    assert determinant == pytest.approx(np.linalg.det(m[:3, :3]), rel=1e-12)
    # Condition number up to 100, translations up to 10 / 0.1.
    assert np.abs(out @ m - np.eye(4)).max() <= 1e4 * EPS * np.abs(m).max() * np.abs(out).max()


@SETTINGS
@given(affine)
def test_unscaled_axes_are_those_divided_by_their_lengths_to_the_last_bit(m):
    wanted = m.copy()
    wanted[:3, :3] /= np.linalg.norm(m[:3, :3], axis=0)
    mat.unscale(m)
    assert np.array_equal(m, wanted)


@SETTINGS
@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=4))
def test_the_length_of_a_vector_is_that_of_numpy_to_the_last_bit(values):
    assert length(np.array(values)) == np.linalg.norm(values)


def test_affine_inverse_of_a_flat_matrix_has_determinant_zero():
    out = np.empty((4, 4))
    assert mat.affine_inverse(mat.compose((1, 2, 3), quat.IDENTITY, (1, 0, 1)), out) == 0.0
    assert not np.isfinite(out).all()


@SETTINGS
@given(st.tuples(numbers, numbers, numbers), st.tuples(numbers, numbers, numbers))
def test_look_at_puts_the_target_straight_ahead(eye, target):
    distance = math.dist(eye, target)
    if distance < 1e-6:
        return
    pose = mat.look_at(eye, target)
    seen = np.linalg.inv(pose) @ [*target, 1.0]
    assert seen[:3] == pytest.approx([0, 0, -distance], abs=1e-12)
    assert pose[1, 1] >= -1e-12  # the eye's own +y leans up


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_look_at_straight_up_or_down_is_a_rotation(way):
    pose = mat.look_at((0, 0, 0), (0, way, 0))
    assert np.abs(pose[:3, :3] @ pose[:3, :3].T - np.eye(3)).max() <= 10 * EPS
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
    assert -pose[:3, 2] == pytest.approx([0, way, 0])


def test_look_at_its_own_place_is_refused():
    with pytest.raises(ValueError, match="no direction"):
        mat.look_at((1, 2, 3), (1, 2, 3))
