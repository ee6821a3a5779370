"""Our transforms against pyrr's: another library, other conventions (row vectors), the same geometry."""

from __future__ import annotations

import numpy as np
import pyrr
import pytest

from mimics_app.maths import quat

TOLERANCE = 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_rotation_matrix_is_the_one_of_pyrr(seed):
    q = quat.normalise_rows(np.random.default_rng(seed).normal(size=4))
    ours = np.eye(3)
    quat.to_matrix(q, ours)
    # pyrr's matrices act on rows, and its matrix of a quaternion turns the other way: the two transposes cancel.
    assert np.abs(ours - pyrr.matrix33.create_from_quaternion(q)).max() <= TOLERANCE
    vector = np.array([0.3, -0.7, 0.2])
    assert ours @ vector == pytest.approx(pyrr.quaternion.apply_to_vector(q, vector), abs=TOLERANCE)


def test_product_of_quaternions_is_the_one_of_pyrr():
    a, b = quat.about_axis((1, 2, 3), 0.7), quat.about_axis((-2, 0, 1), 1.9)
    out = np.empty(4)
    quat.multiply(a, b, out)
    assert out == pytest.approx(pyrr.quaternion.cross(a, b), abs=TOLERANCE)
