"""Mass, centre and inertia of filled shapes against integrals done another way."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.world.content.meshes.mass_properties import (
    box_integrals,
    capsule_integrals,
    combine,
    cylinder_integrals,
    sphere_integrals,
)
from mimics_app.world.content.meshes.primitives import box, capsule, cylinder, sphere
from mimics_app.world.files.scene.solids import SolidMesh, convex_hull, enclosing_sphere, mesh_integrals

FINE = 256


def solid(mesh) -> SolidMesh:
    return SolidMesh(mesh.positions.astype(float), mesh.indices.reshape(-1, 3).astype(np.int32), watertight=True)


@pytest.mark.parametrize(
    ("formula", "mesh"),
    [
        (box_integrals((0.2, 0.1, 0.4)), box(0.2, 0.1, 0.4)),
        (sphere_integrals(0.07), sphere(0.07, FINE)),
        (cylinder_integrals(0.05, 0.2), cylinder(0.05, 0.2, segments=FINE)),
        (capsule_integrals(0.05, 0.2), capsule(0.05, 0.2, segments=FINE)),
        (capsule_integrals(0.05, 1e-9), sphere(0.05, FINE)),
    ],
    ids=["box", "sphere", "cylinder", "capsule", "capsule_of_no_length"],
)
def test_formula_equals_the_integral_over_the_surface(formula, mesh):
    """Of a polyhedron with 256 facets round: volume and inertia are less by about 2/3 (pi/256)^2 twice = 2e-4."""
    volume, centre, inertia = mesh_integrals(solid(mesh))
    assert volume == pytest.approx(formula.volume, rel=5e-4)
    assert np.abs(centre - formula.centre).max() < 1e-7
    assert np.abs(inertia - formula.inertia).max() < 1e-3 * formula.inertia.max()


def test_cylinder_with_h_of_sqrt_3_r_is_isotropic():
    inertia = cylinder_integrals(0.1, 0.1 * 3**0.5).inertia
    assert np.abs(inertia - inertia[0, 0] * np.eye(3)).max() < 1e-15


def test_box_of_two_halves_is_the_box():
    """Steiner: halves side by side, one of them turned by 90 degrees so that its own axes are others."""
    whole = box_integrals((0.4, 0.1, 0.2))
    left = box_integrals((0.2, 0.1, 0.2)).placed(np.array([-0.1, 0.0, 0.0]), np.eye(3))
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    right = box_integrals((0.1, 0.2, 0.2)).placed(np.array([0.1, 0.0, 0.0]), turn)
    both = combine([left, right])
    assert both.volume == pytest.approx(whole.volume)
    assert np.abs(both.centre).max() < 1e-17
    assert np.abs(both.inertia - whole.inertia).max() < 1e-15


def test_hull_of_points_in_and_on_a_box_is_the_box():
    """Points on edges and faces, and a cloud inside: twelve triangles' worth of surface and the box's volume."""
    rng = np.random.default_rng(3)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float) * [0.1, 0.2, 0.3]
    on_edges = 0.5 * (corners[[0, 0, 1, 2]] + corners[[1, 2, 3, 6]])
    cloud = rng.uniform(-1.0, 1.0, (500, 3)) * [0.1, 0.2, 0.3] * 0.99
    vertices, triangles = convex_hull(np.vstack([cloud, corners, on_edges, corners]))
    hull = SolidMesh(vertices, triangles, watertight=True)
    assert mesh_integrals(hull)[0] == pytest.approx(8 * 0.1 * 0.2 * 0.3, rel=1e-9)


def test_hull_contains_every_point_and_is_closed():
    rng = np.random.default_rng(5)
    points = rng.normal(size=(400, 3))
    vertices, triangles = convex_hull(points)
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(q - p, r - p)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert ((points @ normals.T) - np.einsum("ij,ij->i", p, normals)).max() < 1e-6
    edges = {tuple(edge) for t in triangles for edge in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    assert all((b, a) in edges for a, b in edges)


def test_flat_points_have_no_hull():
    points = np.random.default_rng(1).normal(size=(30, 3)) * [1.0, 1.0, 0.0]
    with pytest.raises(ValueError, match="plane"):
        convex_hull(points)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_points_that_are_not_finite_have_no_hull(bad):
    points = np.random.default_rng(1).normal(size=(30, 3))
    points[7, 1] = bad
    with pytest.raises(ValueError, match="not finite"):
        convex_hull(points)


def test_points_too_far_away_to_tell_have_no_hull():
    """A thin solid at 10,000 km: its height is lost in the digits of its place."""
    points = np.random.default_rng(1).normal(size=(30, 3)) * [1e-2, 1e-2, 1e-8] + 1e7
    with pytest.raises(ValueError, match="plane"):
        convex_hull(points)


def test_sphere_round_a_box_touches_its_corners():
    vertices = box(0.2, 0.4, 0.1).positions.astype(float) + [1.0, 2.0, 3.0]
    centre, radius = enclosing_sphere(vertices)
    smallest = 0.5 * np.linalg.norm([0.2, 0.4, 0.1])
    assert np.abs(centre - [1.0, 2.0, 3.0]).max() < 0.02 * smallest
    assert smallest * (1.0 - 1e-6) <= radius < 1.02 * smallest


def test_sphere_round_a_tetrahedron_off_its_box():
    """The smallest sphere is the circumscribed one; the middle of the axis-aligned box is not its centre."""
    vertices = np.array([[1.0, 0.0, 0.0], [-0.5, 0.75**0.5, 0.0], [-0.5, -(0.75**0.5), 0.0], [0.0, 0.0, 2**0.5]])
    centre, radius = enclosing_sphere(vertices)
    exact = 1.5 / 2**0.5  # of a regular tetrahedron with edge 3^0.5: edge sqrt(3/8)
    assert exact * (1.0 - 1e-9) <= radius < 1.03 * exact
    assert np.abs(centre - [0.0, 0.0, 2**0.5 - exact]).max() < 0.1
