"""Cuts of closed meshes by the plane of a leg, against trimesh, and polygons that are none."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull
from trimesh.transformations import random_rotation_matrix

from mimics_app.rendering.haptic.control.lokomat.mesh_cut import cut_mesh, polygon_fault
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import EDGES, OUTLINE, outline_distance, put_polygon

STEP = np.array([(0.0, 0.0), (0.0, 0.2), (0.1, 0.2), (0.1, 0.1), (0.2, 0.1), (0.2, 0.0)])
"""A step of two treads, the object on the right of its edges."""


def _prism(polygon: np.ndarray, y: float = 0.3) -> tuple[np.ndarray, np.ndarray]:
    """A closed prism along y over a polygon whose first corner sees all others."""
    n = len(polygon)
    corners = np.array([(x, side, z) for side in (-y, y) for x, z in polygon])
    fan = [(0, i, i + 1) for i in range(1, n - 1)]
    sides = [face for i in range(n) for face in ((i, i + n, (i + 1) % n), ((i + 1) % n, i + n, (i + 1) % n + n))]
    mesh = trimesh.Trimesh(corners, [*fan, *((c + n, b + n, a + n) for a, b, c in fan), *sides], process=False)
    mesh.fix_normals()
    return mesh.vertices, mesh.faces


def _area(polygon: np.ndarray) -> float:
    x, z = polygon.T
    return 0.5 * float(x @ np.roll(z, -1) - z @ np.roll(x, -1))


def _outline(polygon: np.ndarray, rounding: float) -> np.ndarray:
    filled = np.vstack([polygon, np.repeat(polygon[-1:], EDGES - len(polygon), axis=0)])
    outline = np.zeros(1, OUTLINE)
    put_polygon(outline[0], filled[:, 0].copy(), filled[:, 1].copy(), rounding)
    return outline[0]


def _distance(outline: np.ndarray, x: float, z: float) -> float:
    return outline_distance(outline["edges"], int(outline["count"]), float(outline["radius"]), x, z)[0]


@pytest.mark.parametrize("seed", range(5))
def test_the_cut_of_a_convex_mesh_is_that_of_trimesh(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for mesh in (trimesh.creation.box((0.3, 0.4, 0.2)), trimesh.convex.convex_hull(rng.normal(0.0, 0.2, (12, 3)))):
        mesh.apply_transform(random_rotation_matrix(rng.random(3)))
        y = float(mesh.centroid[1]) + 0.02
        ends = trimesh.intersections.mesh_plane(mesh, (0.0, 1.0, 0.0), (0.0, y, 0.0)).reshape(-1, 3)[:, [0, 2]]
        hull, polygon = ConvexHull(ends), cut_mesh(mesh.vertices, mesh.faces, y)
        assert -_area(polygon) == pytest.approx(hull.volume, rel=1e-6), "its area, run through with it on the right"
        assert np.abs(hull.equations[:, :2] @ polygon.T + hull.equations[:, 2:]).min(axis=0).max() < 1e-6


def test_a_step_keeps_its_inner_corner_and_its_edges_are_rounded() -> None:
    polygon = cut_mesh(*_prism(STEP), 0.05)
    assert sorted(map(tuple, np.round(polygon, 9).tolist())) == sorted(map(tuple, STEP.tolist()))
    for order in (polygon, polygon[::-1]):
        outline = _outline(order, 0.02)
        assert _distance(outline, -0.03, 0.1) == pytest.approx(0.03), "before its face"
        assert _distance(outline, 0.15, 0.13) == pytest.approx(0.03), "above its lower tread"
        assert _distance(outline, 0.05, 0.1) < -0.04, "in it"
        corner = np.hypot(0.02, 0.02) - 0.02
        assert _distance(outline, 0.0, 0.2) == pytest.approx(corner), "its edge is a quarter of a circle"


def test_what_is_no_outline_is_said() -> None:
    box = trimesh.creation.box((0.2, 0.2, 0.2))
    two = trimesh.util.concatenate([box, box.copy().apply_translation((0.5, 0.0, 0.0))])
    for mesh, y, said in ((box, 0.2, "misses it"), (two, 0.0, "several parts")):
        with pytest.raises(ValueError, match=said):
            cut_mesh(mesh.vertices, mesh.faces, y)
    with pytest.raises(ValueError, match="not closed"):
        cut_mesh(box.vertices, box.faces[1:], 0.05)
    assert polygon_fault(STEP, 0.02) == ""
    assert "too small or too sharp" in polygon_fault(STEP, 0.06)
    assert "crosses itself" in polygon_fault(STEP[[0, 2, 1, 3, 4, 5]], 0.0)
    assert "fewer than three" in polygon_fault(STEP[:2], 0.0)
    angle = np.linspace(0.0, 6.0, 17)
    assert "17 corners" in polygon_fault(np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.01)
