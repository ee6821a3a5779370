"""Primitive meshes: closed, facing outward, and of the volume and area that the formula gives for their facets."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from mimics_app.world.components.shapes import (
    BoxShape,
    CapsuleShape,
    CylinderShape,
    PlaneShape,
    RingShape,
    SphereShape,
    TorusShape,
)
from mimics_app.world.content.meshes import primitives
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.shape_levels import shape_levels


def solid(mesh):
    merged = trimesh.Trimesh(mesh.positions, mesh.indices.reshape(-1, 3), process=False)
    merged.merge_vertices(merge_tex=True, merge_norm=True)
    return merged


def facets(mesh):
    """(unit face normals, mean vertex normals, areas) in float64."""
    corners = mesh.positions.astype(float)[mesh.indices.reshape(-1, 3)]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(cross, axis=1) / 2
    return cross / (2 * areas[:, None]), mesh.normals[mesh.indices.reshape(-1, 3)].mean(axis=1), areas


def prism(n):
    """Share of a disc's area that its regular n-gon has."""
    return n / (2 * math.pi) * math.sin(2 * math.pi / n)


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (primitives.box(1, 2, 3), 6.0),
        (primitives.cylinder(0.5, 2.0, segments=24), math.pi / 2 * prism(24)),
        (primitives.cylinder(0.5, 2.0, top_radius=0.0, segments=24), math.pi / 6 * prism(24)),
        (primitives.cylinder(0.5, 3.0, top_radius=0.25, segments=24), math.pi * (0.25 + 0.125 + 0.0625) * prism(24)),
    ],
)
def test_solids_are_closed_and_have_the_volume_of_their_facets(mesh, volume):
    body = solid(mesh)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.volume == pytest.approx(volume, rel=1e-6)  # positions are float32


@pytest.mark.parametrize("mesh", [primitives.sphere(0.5, 96), primitives.icosphere(0.5, 4)])
def test_spheres_are_closed_and_nearly_full(mesh):
    body = solid(mesh)
    assert body.is_watertight
    assert np.linalg.norm(mesh.positions, axis=1) == pytest.approx(0.5, abs=1e-6)
    # A facet of angle a lies at most 1 - cos(a/2) of the radius inside: a = 2 pi / 48 from pole to pole.
    assert 1 - 3 * (1 - math.cos(math.pi / 48)) < body.volume / (math.pi / 6) < 1


@pytest.mark.parametrize(
    "shape",
    [
        PlaneShape(segments=3),
        BoxShape(),
        SphereShape(segments=48),
        SphereShape(segments=3),
        CylinderShape(),
        CylinderShape(top_radius=0.0),
        RingShape(),
        RingShape(inner_radius=0.0, start=-2.0, sweep=1.0, segments=3),
    ],
)
def test_every_shape_faces_along_its_normals_and_has_no_empty_triangle(shape):
    mesh = primitives.build_shape(shape)
    normals, vertex_normals, areas = facets(mesh)
    assert areas.min() > 1e-9
    assert np.einsum("ij,ij->i", normals, vertex_normals).min() > 0.3
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-6)
    assert mesh.uvs is not None
    assert mesh.uvs.min() >= 0.0
    assert mesh.uvs.max() <= 1.0


def depth_below(shape, points):
    """How far points lie inside the round that a shape stands for [m]."""
    if isinstance(shape, TorusShape):
        across = np.hypot(points[:, 0], points[:, 2]) - shape.radius
        return shape.bar_radius - np.hypot(across, points[:, 1])
    length = shape.length if isinstance(shape, CapsuleShape) else 0.0
    axis = np.clip(points[:, 1], -0.5 * length, 0.5 * length)
    return shape.radius - np.linalg.norm(points - axis[:, None] * [0.0, 1.0, 0.0], axis=1)


@pytest.mark.parametrize(
    "shape",
    [SphereShape(radius=0.3, segments=48), CapsuleShape(segments=32), TorusShape(), TorusShape(bar_radius=0.2)],
)
def test_coarser_forms_of_a_shape_are_seen_to_be_wrong_by_no_more_than_half_a_pixel(shape):
    """At the least coverage of a form its facets, and the middles of cells between them, lie so far off at most."""
    forms, coverages = shape_levels(shape)
    assert len(forms) == len(coverages) >= 3
    finest, radius, off = None, 0.0, []
    for form in forms:
        mesh = primitives.build_shape(form)
        corners = mesh.positions.astype(float)[mesh.indices.reshape(-1, 3)]
        inside = np.concatenate([corners.mean(axis=1), *(0.5 * (corners[:, k] + corners[:, k - 1]) for k in range(3))])
        off.append(float(depth_below(shape, inside).max()))
        radius = max(radius, mesh.radius)
        assert finest is None or len(corners) < 0.6 * finest
        finest = len(corners)
    for wrong, least in zip(off[1:], coverages, strict=False):
        pixel = radius / math.sqrt(least * 1920 * 1080 / math.pi)
        assert wrong - off[0] <= 0.5 * pixel * (1.0 + 1e-3)
        assert least == 1.0 or wrong - off[0] >= 0.1 * pixel
    assert coverages[-1] == 0.0


@pytest.mark.parametrize("shape", [SphereShape(segments=23), BoxShape(), PlaneShape(segments=99), CylinderShape()])
def test_what_is_flat_or_has_few_facets_has_one_form(shape):
    assert shape_levels(shape) == ([shape], (0.0,))


def test_a_ring_sector_starts_at_its_angle_and_has_the_area_of_its_facets():
    mesh = primitives.ring(0.28, 0.64, start=0.5, sweep=1.0, segments=40)
    angles = np.arctan2(-mesh.positions[:, 2], mesh.positions[:, 0])
    assert angles.min() == pytest.approx(0.5, abs=1e-6)
    assert angles.max() == pytest.approx(1.5, abs=1e-6)
    exact = 40 * math.sin(1 / 40) / 2 * (0.64**2 - 0.28**2)
    assert facets(mesh)[2].sum() == pytest.approx(exact, rel=1e-6)


def frames(n):
    return np.tile([0.0, 1.0, 0.0], (n, 1)), np.tile([0.0, 0.0, 1.0], (n, 1))


@pytest.mark.parametrize("inward", [False, True])
def test_a_straight_tube_has_the_side_area_of_its_prism_and_faces_out_or_in(inward):
    x = np.linspace(0, 2, 9)
    mesh = primitives.tube(np.stack([x, 0 * x, 0 * x], axis=1), *frames(9), np.full(9, 0.3), sides=24, inward=inward)
    normals, vertex_normals, areas = facets(mesh)
    assert areas.sum() == pytest.approx(2 * 0.3 * 2 * math.sin(math.pi / 24) * 24, rel=1e-6)
    out = mesh.positions[mesh.indices.reshape(-1, 3)].mean(axis=1)[:, 1:]
    side = np.einsum("ij,ij->i", normals[:, 1:], out)
    assert (side < 0).all() if inward else (side > 0).all()
    assert np.einsum("ij,ij->i", normals, vertex_normals).min() > 0.98


def test_normals_of_a_widening_tube_are_those_of_the_cone():
    x = np.linspace(0, 1, 5)
    mesh = primitives.tube(np.stack([x, 0 * x, 0 * x], axis=1), *frames(5), 0.1 + 0.5 * x, sides=12)
    assert mesh.normals[:, 0] == pytest.approx(-0.5 / math.hypot(1, 0.5), abs=1e-6)


def test_a_tube_of_radius_zero_somewhere_and_of_coincident_points_is_finite():
    points = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0], [2, 0, 0.0]])
    mesh = primitives.tube(points, *frames(4), np.array([0.1, 0.1, 0.0, 0.1]))
    assert np.isfinite(mesh.normals).all()


def test_a_tube_of_one_point_is_refused():
    with pytest.raises(ValueError, match="two points"):
        primitives.tube(np.zeros((1, 3)), *frames(1), np.ones(1))


def test_normals_are_weighted_by_area_and_point_up_where_no_triangle_is():
    positions = np.array([[0, 0, 0], [0, 0, 2], [2, 0, 0], [0, 1, 0], [9, 9, 9], [5, 5, 5]], float)
    normals = compute_normals(positions, np.array([0, 1, 2, 0, 3, 1, 4, 4, 5]))
    # Faces at vertex 0: area 2 along +y, area 1 along +x.
    assert normals[0] == pytest.approx(np.array([1, 2, 0]) / math.sqrt(5), abs=1e-6)
    assert normals[4].tolist() == [0, 1, 0]


def test_bounds_of_a_mesh_hold_every_vertex_and_an_empty_one_has_none():
    mesh = primitives.box(2, 4, 6)
    assert mesh.centre.tolist() == [0, 0, 0]
    assert mesh.radius == pytest.approx(math.sqrt(14))
    empty = MeshData(np.zeros((0, 3), "f4"), np.zeros((0, 3), "f4"), np.zeros(0, "u4")).validated()
    assert (empty.radius, empty.triangle_count) == (0.0, 0)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"positions": np.full((4, 3), np.nan, "f4")}, "finite"),
        ({"normals": np.zeros((3, 3), "f4")}, "normals: shape"),
        ({"indices": np.array([0, 1], "u4")}, "multiple of three"),
        ({"uvs": np.zeros((4, 3), "f4")}, "uvs: shape"),
        ({"colours": np.zeros((4, 3), "f4")}, "colours: shape"),
    ],
)
def test_a_mesh_with_a_wrong_array_is_refused_by_its_name(change, what):
    mesh = primitives.plane()
    fields = {name: getattr(mesh, name) for name in ("positions", "normals", "indices", "uvs", "colours")} | change
    with pytest.raises(ValueError, match=what):
        MeshData(**fields).validated()
