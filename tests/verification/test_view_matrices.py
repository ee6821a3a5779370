"""Views and frusta as pyrr makes them against our own float64 and against fractions, which round nothing."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.maths import mat
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_clip_from_view, compose_look_at

SETTINGS = settings(max_examples=150)
EPS = np.finfo(float).eps

numbers = st.floats(-10, 10)
points = st.tuples(numbers, numbers, numbers)


@SETTINGS
@given(points, points, points)
def test_a_pose_is_that_of_our_own_look_at(eye, target, up):
    """A unit vector is off by a few roundings; those of `right` grow as the view nears the direction of `up`."""
    along = np.subtract(target, eye)
    slant = np.linalg.norm(np.cross(up, along)) / max(np.linalg.norm(up) * np.linalg.norm(along), 1e-300)
    if min(np.linalg.norm(along), np.linalg.norm(up)) < 1e-3 or slant < 1e-3:
        return
    ours, theirs = mat.look_at(eye, target, up), compose_look_at(eye, target, up)
    # Subtracting the two places loses as many digits as they are farther from the origin than from each other.
    lost = 1.0 + (np.linalg.norm(eye) + np.linalg.norm(target)) / np.linalg.norm(along)
    assert np.abs(ours - theirs).max() <= 32.0 * EPS * lost / slant
    assert np.abs(theirs[:3, :3].T @ theirs[:3, :3] - np.eye(3)).max() <= 32.0 * EPS / slant
    assert np.linalg.det(theirs[:3, :3]) > 0.0, "not mirrored"


def test_whole_numbers_are_taken_as_they_are():
    """pyrr keeps the type of what it is given: whole numbers would round its unit vectors to 0 and 1."""
    assert np.array_equal(
        compose_look_at((1, 2, 3), (0, 0, 1), (0, 1, 0)), compose_look_at((1.0, 2.0, 3.0), (0.0, 0.0, 1.0))
    )
    assert np.array_equal(
        compose_clip_from_view((-1, 2, -1, 1), 1, 3), compose_clip_from_view((-1.0, 2.0, -1.0, 1.0), 1.0, 3.0)
    )


@pytest.mark.parametrize("target", [(1.0, 2.0, 3.0), (1.0, 9.0, 3.0), (1.0, -9.0, 3.0)])
def test_a_view_without_direction_is_refused(target):
    with pytest.raises(ValueError, match="no view"):
        compose_look_at((1.0, 2.0, 3.0), target)


@SETTINGS
@given(st.floats(-3, 1), st.floats(0.1, 3), st.floats(-3, 1), st.floats(0.1, 3), st.floats(0.01, 1), st.floats(2, 1e4))
def test_a_frustum_is_that_of_exact_fractions(left, width, bottom, height, near, far):
    right, top = left + width, bottom + height
    made = compose_clip_from_view((left, right, bottom, top), near, far)
    l, r, b, t, n, f = (Fraction(each) for each in (left, right, bottom, top, near, far))  # noqa: E741
    exact = np.zeros((4, 4))
    exact[0, 0], exact[0, 2] = 2 / (r - l), (r + l) / (r - l)
    exact[1, 1], exact[1, 2] = 2 / (t - b), (t + b) / (t - b)
    exact[2, 2], exact[2, 3], exact[3, 2] = -(f + n) / (f - n), -2 * f * n / (f - n), -1
    # Borders in metres are rounded once, which their difference magnifies by cancellation; five more roundings.
    lost = np.ones((4, 4))
    lost[0] += (abs(left) + abs(right)) / width
    lost[1] += (abs(bottom) + abs(top)) / height
    assert (np.abs(made - exact) <= 8.0 * EPS * lost * np.maximum(np.abs(exact), (exact != 0.0))).all()


def clip(projection, point):
    x, y, z, w = projection @ [*point, 1.0]
    return np.array([x, y, z]) / w


@SETTINGS
@given(st.floats(-3, 1), st.floats(0.1, 3), st.floats(-3, 1), st.floats(0.1, 3), st.floats(0.01, 1), st.floats(2, 1e4))
def test_off_axis_borders_land_on_the_borders_of_clip_space(left, width, bottom, height, near, far):
    right, top = left + width, bottom + height
    projection = compose_clip_from_view((left, right, bottom, top), near, far)
    scale = 1e3 * EPS * (1 + max(abs(left), abs(right)) / width + max(abs(bottom), abs(top)) / height)
    for depth, z in ((near, -1.0), (far, 1.0)):
        assert clip(projection, (left * depth, bottom * depth, -depth)) == pytest.approx([-1, -1, z], abs=scale + 1e-9)
        assert clip(projection, (right * depth, top * depth, -depth)) == pytest.approx([1, 1, z], abs=scale + 1e-9)


def test_an_infinite_far_plane_keeps_far_points_inside():
    """A camera of a glTF file that states no far plane has none."""
    view = View(np.eye(4), (-1.0, 1.0, -1.0, 1.0), (0, 0, 8, 8), 0.1, math.inf)
    assert clip(view.clip_from_world, (0, 0, -0.1))[2] == pytest.approx(-1.0)
    assert 0.999 < clip(view.clip_from_world, (0, 0, -1e5))[2] <= 1.0
