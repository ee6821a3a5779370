"""Our transforms against pyrr's: another library, other conventions (row vectors), the same geometry."""

from __future__ import annotations

import math

import numpy as np
import pyrr
import pytest

from mimics_app.maths import mat, quat

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


@pytest.mark.parametrize(
    ("fov", "aspect", "near", "far"), [(60, 16 / 9, 0.05, 100), (100, 1.0, 0.1, 10), (20, 0.5, 1, 1e4)]
)
def test_projection_is_the_transpose_of_pyrr(fov, aspect, near, far):
    theirs = pyrr.matrix44.create_perspective_projection(fov, aspect, near, far, dtype=np.float64)
    ours = mat.perspective(math.radians(fov), aspect, near, far)
    assert np.abs(ours - theirs.T).max() <= TOLERANCE * np.abs(ours).max()


def test_off_axis_projection_is_the_transpose_of_pyrr():
    near = 0.2
    borders = (-0.3, 0.9, -0.5, 0.4)
    theirs = pyrr.matrix44.create_perspective_projection_from_bounds(*(near * b for b in borders), near, 50.0)
    ours = mat.perspective_from_tangents(*borders, near, 50.0)
    assert np.abs(ours - theirs.T).max() <= TOLERANCE * np.abs(ours).max()


def test_view_of_look_at_is_the_transpose_of_pyrr():
    eye, target, up = (1.0, 2.0, 3.0), (-2.0, 0.5, 1.0), (0.0, 1.0, 0.0)
    theirs = pyrr.matrix44.create_look_at(np.array(eye), np.array(target), np.array(up))
    ours = np.empty((4, 4))
    mat.rigid_inverse(mat.look_at(eye, target, up), ours)
    assert np.abs(ours - theirs.T).max() <= TOLERANCE
