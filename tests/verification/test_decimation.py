"""Coarser forms of meshes: exact stays exact, what is lost is stated, nothing tears, folds or loses its seams."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.world.content.meshes.primitives import box, sphere
from mimics_app.world.files.simplify.decimation import decimate


def grid(n, height=lambda x, y: 0.0 * x):
    """A square of n x n cells of 1 m, two triangles each."""
    x, y = (axis.ravel().astype(float) for axis in np.meshgrid(np.arange(n + 1), np.arange(n + 1)))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    lower = np.stack([first, first + 1, first + n + 1], 1)
    upper = np.stack([first + 1, first + n + 2, first + n + 1], 1)
    return np.stack([x, y, height(x, y)], 1), np.concatenate([lower, upper])


def faces(positions, indices):
    return np.asarray(positions, float)[np.asarray(indices).reshape(-1, 3)]


def area_vectors(corners):
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def volume(corners):
    return np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0


def open_edges(positions, indices):
    """Directed edges, by place, whose counterpart is missing."""
    _, place = np.unique(np.round(positions, 5) + 0.0, axis=0, return_inverse=True)
    corners = place.reshape(-1)[np.asarray(indices).reshape(-1, 3)]
    edges = {(int(a), int(b)) for triangle in corners for a, b in zip(triangle, np.roll(triangle, -1), strict=True)}
    return {edge for edge in edges if edge[::-1] not in edges}


def test_a_flat_square_becomes_two_triangles_without_loss():
    positions, indices = grid(24)
    coarse = decimate(positions, indices, 0, 1e-9)
    assert coarse.triangle_count == 2
    assert coarse.error == pytest.approx(0.0, abs=1e-12)
    assert area_vectors(faces(positions, coarse.indices)).sum(axis=0) == pytest.approx([0.0, 0.0, 24.0**2])


def test_a_folded_sheet_keeps_its_fold():
    """Two planes that meet at x = 8: four triangles are exact, and no vertex of the fold's line may leave it."""
    positions, indices = grid(16, lambda x, y: 0.5 * np.abs(x - 8.0))
    coarse = decimate(positions, indices, 0, 1e-7)
    assert coarse.triangle_count == 4
    assert coarse.error == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("triangles", [2000, 500, 120])
def test_a_ball_stays_closed_and_its_error_is_what_can_be_measured(triangles):
    """Chords of a ball of radius 1: the farthest old corner lies at most as far from a triangle as the ball's own
    surface over its middle, and no nearer than the sagitta of the corner's own cell."""
    ball = sphere(1.0, 64)
    coarse = decimate(ball.positions, ball.indices, triangles)
    assert triangles - 1 <= coarse.triangle_count <= triangles
    corners = faces(ball.positions, coarse.indices)
    assert not open_edges(ball.positions, coarse.indices)
    assert (
        len(np.unique(np.round(ball.positions[coarse.indices], 5) + 0.0, axis=0)) - 1.5 * len(corners) + len(corners)
        == 2
    )
    deepest = 1.0 - np.linalg.norm(corners.mean(axis=1), axis=1).min()
    assert 0.5 * deepest < coarse.error < 1.2 * deepest
    outward = np.einsum("ij,ij->i", area_vectors(corners), corners.mean(axis=1))
    assert outward.min() > 0.0
    # Garland & Heckbert: the loss falls with one over the number of triangles; the volume's likewise.
    assert volume(corners) == pytest.approx(4.0 / 3.0 * np.pi, rel=25.0 / triangles)


def test_seams_of_texture_and_normals_stay():
    """A box has three vertices at each corner: 12 triangles are the least, whatever error is allowed."""
    cube = box(1.0, 2.0, 3.0)
    assert decimate(cube.positions, cube.indices, 0).triangle_count == 12


def test_a_seam_moves_along_itself_only():
    """A flat square whose left half has other texture coordinates: the halves coarsen, their border stays a line."""
    positions, indices = grid(16)
    right = positions[indices.reshape(-1, 3)][..., 0].mean(axis=1) > 8.0
    split = indices.copy()
    split[right] += len(positions)
    both = np.concatenate([positions, positions])
    coarse = decimate(both, split, 0, 1e-9)
    triangles = coarse.indices.reshape(-1, 3)
    sides = triangles >= len(positions)
    assert (sides.all(axis=1) | ~sides.any(axis=1)).all(), "a triangle with corners of both halves"
    for half, expected in ((~sides.all(axis=1), 128.0), (sides.all(axis=1), 128.0)):
        assert area_vectors(faces(both, triangles[half])).sum(axis=0)[2] == pytest.approx(expected)
    assert coarse.triangle_count == 4


def test_the_same_mesh_gives_the_same_triangles():
    rough, indices = grid(20, lambda x, y: np.sin(x) * np.cos(0.7 * y))
    first, second = (decimate(rough, indices, 150) for _ in range(2))
    assert np.array_equal(first.indices, second.indices)
    assert first.error == second.error > 0.0


def test_less_is_taken_away_where_less_may_be_lost():
    rough, indices = grid(32, lambda x, y: 0.5 * np.sin(0.4 * x) * np.cos(0.3 * y))
    found = [decimate(rough, indices, 0, allowed) for allowed in (0.001, 0.01, 0.1)]
    counts, errors = [each.triangle_count for each in found], [each.error for each in found]
    assert counts[0] > counts[1] > 10 * counts[2], counts
    assert 0.0 < errors[0] < errors[1] < errors[2]


@pytest.mark.parametrize("indices", [[], [0, 0, 1], [0, 1, 1, 2, 2, 0]])
def test_nothing_but_slivers_becomes_nothing(indices):
    coarse = decimate(np.eye(3), np.array(indices, int), 10)
    assert coarse.triangle_count == 0 and coarse.error == 0.0


def test_three_sheets_on_one_edge_keep_it():
    """An edge of three triangles is no surface there: its ends must not wander off."""
    positions = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0.5], [-1, 1, 0.5], [-1, -1, 0.5]], float)
    indices = np.array([0, 1, 2, 0, 1, 3, 0, 1, 4])
    assert decimate(positions, indices, 0, 1e-3).triangle_count == 3
