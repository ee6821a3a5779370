"""Cubic B-splines: basis functions, pieces, arc length, curvature, fit."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mimics_app.maths import bspline
from mimics_app.maths.bspline_fit import fit_spline


def random_points(count, seed=1, dimensions=3):
    return np.random.default_rng(seed).normal(size=(count, dimensions))


@pytest.mark.parametrize("ends", ["clamped", "uniform"])
@pytest.mark.parametrize("count", [4, 5, 6, 7, 20])
def test_basis_functions_are_a_partition_of_unity_and_local(count, ends):
    s = np.linspace(0.0, count - 3, 40 * count)
    values = bspline.basis_functions(count, s, ends)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-14)
    assert values.min() > -1e-15
    assert np.count_nonzero(values > 1e-12, axis=1).max() <= 4


def test_five_basis_functions_of_figure_45_are_mirror_images():
    values = bspline.basis_functions(5, np.linspace(0.0, 2.0, 101))
    np.testing.assert_allclose(values, values[::-1, ::-1], atol=1e-15)
    np.testing.assert_array_equal(np.argmax(values, axis=0)[[0, 2, 4]], [0, 50, 100])


def test_uniform_pieces_are_the_textbook_polynomials():
    expected = np.array([[1, -3, 3, -1], [4, 0, -6, 3], [1, 3, 3, -3], [0, 0, 0, 1]]) / 6.0
    for piece in bspline.basis_pieces(8, "uniform"):
        np.testing.assert_allclose(piece, expected, atol=1e-14)


def test_one_clamped_piece_is_bezier():
    expected = [[1, -3, 3, -1], [0, 3, -6, 3], [0, 0, 3, -3], [0, 0, 0, 1]]
    np.testing.assert_allclose(bspline.basis_pieces(4)[0], expected, atol=1e-14)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_fewer_than_four_basis_functions_are_refused(count):
    with pytest.raises(ValueError, match="at least 4"):
        bspline.basis_pieces(count)


@pytest.mark.parametrize("derivative", [0, 1, 2])
@pytest.mark.parametrize("ends", ["clamped", "uniform"])
def test_curve_and_two_derivatives_have_no_step_at_the_knots(ends, derivative):
    pieces = bspline.pieces_of(random_points(9), ends)
    left = [np.polynomial.polynomial.polyval(1.0, np.polynomial.polynomial.polyder(p.T, derivative)) for p in pieces]
    right = [np.polynomial.polynomial.polyval(0.0, np.polynomial.polynomial.polyder(p.T, derivative)) for p in pieces]
    np.testing.assert_allclose(left[:-1], right[1:], atol=1e-12)


def test_pieces_are_the_sum_of_basis_functions_and_start_and_end_at_the_outer_points():
    points = random_points(11)
    pieces = bspline.pieces_of(points)
    s = np.linspace(0.0, 8.0, 200)
    np.testing.assert_allclose(bspline.evaluate(pieces, s), bspline.basis_functions(11, s) @ points, atol=1e-13)
    np.testing.assert_allclose(bspline.evaluate(pieces, [0.0, 8.0]), points[[0, -1]], atol=1e-13)


def test_derivatives_match_differences():
    pieces = bspline.pieces_of(random_points(8))
    s, h = np.array([0.3, 1.5, 3.7]), 1e-6
    for order in (1, 2, 3):
        difference = bspline.evaluate(pieces, s + h, order - 1) - bspline.evaluate(pieces, s - h, order - 1)
        np.testing.assert_allclose(bspline.evaluate(pieces, s, order), difference / (2.0 * h), atol=1e-6)


@pytest.mark.parametrize("factor", [1, 2, 3, 7])
def test_subdivided_curve_is_the_same_curve(factor):
    pieces = bspline.pieces_of(random_points(7))
    fine = bspline.subdivide(pieces, factor)
    s = np.linspace(0.0, 4.0, 333)
    assert len(fine) == 4 * factor
    np.testing.assert_allclose(bspline.evaluate(fine, factor * s), bspline.evaluate(pieces, s), atol=1e-13)


def test_two_points_make_a_line_and_three_a_parabola():
    line = bspline.pieces_of(bspline.raise_to_cubic([[0.0, 1.0], [4.0, 3.0]]))
    np.testing.assert_allclose(bspline.evaluate(line, [0.0, 0.25, 1.0]), [[0, 1], [1, 1.5], [4, 3]], atol=1e-14)
    parabola = bspline.pieces_of(bspline.raise_to_cubic([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]))
    u = np.linspace(0.0, 1.0, 5)
    np.testing.assert_allclose(bspline.evaluate(parabola, u), np.column_stack([2 * u, 4 * u * (1 - u)]), atol=1e-14)


def test_arc_length_of_a_parabola_and_of_a_line():
    parabola = bspline.pieces_of(bspline.raise_to_cubic([[-1.0, 1.0], [0.0, -1.0], [1.0, 1.0]]))  # y = x^2
    exact = np.sqrt(5.0) + 0.5 * np.arcsinh(2.0)
    assert bspline.arc_lengths(parabola)[-1] == pytest.approx(exact, rel=1e-12)
    line = bspline.pieces_of(np.linspace([0.0, 0.0, 0.0], [1.0, 2.0, 2.0], 9))
    assert bspline.arc_lengths(line)[-1] == pytest.approx(3.0, rel=1e-14)


def test_parameter_at_is_the_inverse_of_arc_length_at_also_near_a_standstill():
    nearly_cusp = np.array([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0001], [1.0, 0.0]])
    for points in (random_points(9), nearly_cusp):
        pieces = bspline.pieces_of(points)
        table = bspline.arc_lengths(pieces)
        lengths = np.linspace(0.0, table[-1], 301)
        s = bspline.parameter_at(pieces, table, lengths)
        assert np.all(np.diff(s) > 0.0)
        np.testing.assert_allclose(bspline.arc_length_at(pieces, table, s), lengths, atol=1e-12 * table[-1])


def test_parameter_beyond_the_ends_is_clipped():
    pieces = bspline.pieces_of(random_points(6))
    table = bspline.arc_lengths(pieces)
    np.testing.assert_allclose(bspline.parameter_at(pieces, table, [-1.0, 1e9]), [0.0, 3.0], atol=1e-12)
    np.testing.assert_array_equal(bspline.evaluate(pieces, [-5.0, 99.0]), bspline.evaluate(pieces, [0.0, 3.0]))


def test_curvature_of_a_parabola_points_inside():
    pieces = bspline.pieces_of(bspline.raise_to_cubic([[-1.0, 1.0], [0.0, -1.0], [1.0, 1.0]]))  # y = x^2
    x = np.array([-0.8, 0.0, 0.5])
    vector = bspline.curvature(pieces, (x + 1.0) / 2.0)
    np.testing.assert_allclose(np.linalg.norm(vector, axis=1), 2.0 / (1.0 + 4.0 * x**2) ** 1.5, rtol=1e-12)
    assert np.all(vector[:, 1] > 0.0)


def test_curvature_is_infinite_where_the_curve_stands_still():
    pieces = bspline.pieces_of([[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    assert np.isinf(np.linalg.norm(bspline.curvature(pieces, [0.0])))


def test_interpolated_values_pass_through_and_stay_between():
    values = np.array([0.03, 0.0, 0.0, 0.05, 0.04, 0.041])
    share = np.linspace(0.0, 1.0, 1001)
    y, slope = bspline.interpolate_values(values, share)
    np.testing.assert_allclose(y[::200], values, atol=1e-15)
    for i in range(5):
        part = y[200 * i : 200 * i + 201]
        assert part.min() >= values[i : i + 2].min() - 1e-15 and part.max() <= values[i : i + 2].max() + 1e-15
    np.testing.assert_allclose(slope[1:-1], (y[2:] - y[:-2]) / 0.002, atol=2e-3)


def test_one_value_is_constant_and_two_are_a_line():
    share = np.linspace(-0.5, 1.5, 9)
    np.testing.assert_array_equal(bspline.interpolate_values([0.02], share)[0], 0.02)
    y, slope = bspline.interpolate_values([1.0, 3.0], share)
    np.testing.assert_allclose(y, 1.0 + 2.0 * np.clip(share, 0.0, 1.0), atol=1e-14)
    np.testing.assert_allclose(slope, 2.0, atol=1e-14)


@pytest.mark.parametrize("count", [4, 5, 8, 12, 25])
def test_fit_finds_a_path_that_is_such_a_spline(count):
    rng = np.random.default_rng(count)
    i = np.arange(count)
    points = np.column_stack([0.05 * i, 0.05 * np.sin(1.1 * i), 0.005 * rng.normal(size=count)])
    s = np.sort(np.concatenate([[0.0, count - 3.0], rng.uniform(0.0, count - 3.0, 400)]))
    fit = fit_spline(bspline.evaluate(bspline.pieces_of(points), s), count)
    assert fit.residual_max < 1e-9
    assert fit.residual_rms <= fit.residual_max


def test_residual_falls_with_the_number_of_basis_functions_down_to_the_noise():
    noise = 1e-4
    t = np.linspace(0.0, 1.0, 600)
    path = np.column_stack([0.5 * t, 0.06 * np.sin(12.5 * t), 0.02 * np.sin(7.0 * t)])
    path += noise * np.random.default_rng(1).normal(size=path.shape)
    residuals = [fit_spline(path, count).residual_rms for count in (4, 6, 8, 12, 20)]
    assert all(more < fewer for fewer, more in pairwise(residuals))
    # Two of three directions are across the curve; the third is slid away.
    assert residuals[-1] == pytest.approx(np.sqrt(2.0) * noise, rel=0.1)


def test_residuals_are_the_distances_of_the_samples():
    t = np.linspace(0.0, 1.0, 200)
    path = np.column_stack([t, 0.1 * np.sin(9.0 * t), 0.0 * t])
    fit = fit_spline(path, 6)
    dense = bspline.evaluate(bspline.pieces_of(fit.control_points), np.linspace(0.0, 3.0, 20001))
    distance = np.min(np.linalg.norm(path[:, None] - dense[None], axis=2), axis=1)
    assert fit.residual_max == pytest.approx(distance.max(), rel=1e-3)
    assert fit.residual_rms == pytest.approx(np.sqrt(np.mean(distance**2)), rel=1e-3)


def test_fit_skips_repeated_samples_and_follows_a_closed_path_once_round():
    phi = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = np.column_stack([np.cos(phi), np.sin(phi)])
    fit = fit_spline(np.repeat(circle, 2, axis=0), 16)
    assert fit.residual_max < 1e-3
    assert bspline.arc_lengths(bspline.pieces_of(fit.control_points))[-1] == pytest.approx(2.0 * np.pi, rel=1e-3)


@pytest.mark.parametrize(
    ("path", "count", "words"),
    [
        (np.zeros((10, 3)), 4, "different samples"),
        (np.eye(3), 4, "different samples"),
        (np.full((9, 3), np.nan), 4, "finite"),
        (np.zeros((0, 3)), 4, "different samples"),
        (np.arange(30.0), 4, "shape"),
        (np.random.default_rng(1).normal(size=(9, 3)), 3, "at least 4"),
    ],
)
def test_paths_that_cannot_be_fitted_are_refused(path, count, words):
    with pytest.raises(ValueError, match=words):
        fit_spline(path, count)
