"""Boxes inside meshes: every ray from where they may be used meets a front face before the box."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.visual.drawing.occluder_boxes import find_solid
from mimics_app.rendering.visual.drawing.t_junctions import remove_t_junctions, unmatched_edges
from mimics_app.rendering.visual.kernels.solid import winding_number
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.primitives import box, cylinder, icosphere, plane, sphere, torus


def mesh_of(positions, triangles):
    positions = np.asarray(positions, np.float32)
    indices = np.asarray(triangles, np.uint32).reshape(-1)
    return MeshData(positions, compute_normals(positions, indices), indices).validated()


def without_face(mesh, axis, side):
    """A box without one of its faces."""
    triangles = mesh.indices.reshape(-1, 3)
    outer = mesh.bounds[side][axis]
    kept = (mesh.positions[triangles][:, :, axis] != np.float32(outer)).any(axis=1)
    return mesh_of(mesh.positions, triangles[kept])


def house(rng, cells=3):
    """Four walls of plates that do not meet corner to corner, open above and below, float32 as files have them."""
    quads = []
    width, depth, height = rng.uniform(6, 9), rng.uniform(5, 8), rng.uniform(3, 9)
    corners = np.array([[-width, 0, depth], [width, 0, depth], [width, 0, -depth], [-width, 0, -depth]])
    for k in range(4):
        start, along = corners[k], (corners[(k + 1) % 4] - corners[k]) / cells
        up = np.array([0.0, height, 0.0])
        for c in range(cells):
            low = start + c * along
            s, t = 0.3, 0.4
            quads.append([low, low + along, low + along + t * up, low + t * up])
            quads.append([low + t * up, low + s * along + t * up, low + s * along + up, low + up])
            quads.append([low + s * along + t * up, low + along + t * up, low + along + up, low + s * along + up])
    positions = np.array(quads).reshape(-1, 3)
    first = 4 * np.arange(len(quads))[:, None]
    return mesh_of(positions, first + np.array([0, 1, 2, 0, 2, 3]))


def area_of(mesh):
    corners = mesh.positions[mesh.indices.reshape(-1, 3)].astype(np.float64)
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()


def meets_front_first(solid, eye, targets):
    """For rays from an eye to points of the box: is some triangle met before the point, its front to the eye?"""
    corners = solid.mesh.positions[solid.mesh.indices.reshape(-1, 3)].astype(np.float64)
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(u, v)
    met = np.zeros(len(targets), np.bool_)
    for k, target in enumerate(targets):
        ray = target - eye
        facing = normal @ ray
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.einsum("ij,ij->i", normal, a - eye) / facing
            p = eye + t[:, None] * ray - a
            n2 = np.einsum("ij,ij->i", normal, normal)
            one = np.einsum("ij,ij->i", np.cross(p, v), normal) / n2
            two = np.einsum("ij,ij->i", np.cross(u, p), normal) / n2
        inside = (one > -1e-9) & (two > -1e-9) & (one + two < 1 + 1e-9)
        met[k] = bool((inside & (facing < 0.0) & (t > 0.0) & (t < 1.0)).any())
    return met


@pytest.mark.parametrize(
    ("mesh", "share"),
    [(box(4.0, 3.0, 2.0), 0.95), (icosphere(1.0, 3), 0.25), (cylinder(1.0, 3.0), 0.4), (sphere(2.0, 24), 0.25)],
)
def test_a_closed_mesh_holds_a_box_of_good_size(mesh, share):
    """Of its bounding box; the largest cube in a ball is 0.19 of it, the best box by surface is no larger."""
    solid = find_solid(mesh)
    volume = np.prod(solid.upper - solid.lower) / np.prod(mesh.bounds[1] - mesh.bounds[0])
    assert volume > 0.7 * min(share, 0.19 if share == 0.25 else share)
    assert len(solid.caps) == 0
    assert solid.mesh.triangle_count <= mesh.triangle_count, "nothing to repair but slivers at the poles"
    assert len(solid.mesh.positions) == len(mesh.positions)
    assert np.abs(solid.mesh.positions - mesh.positions).max() < 1e-5
    triangles = solid.mesh.positions[solid.mesh.indices.reshape(-1, 3)].astype(np.float64)
    rng = np.random.default_rng(1)
    for point in rng.uniform(solid.lower, solid.upper, (20, 3)):
        assert winding_number(triangles, point) == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("turn", [[0, 1, 2], [2, 0, 1], [1, 0, 2]])
def test_a_flat_rectangle_is_a_box_without_thickness_for_those_in_front(turn):
    """Of any number of triangles, in each plane; the last turn reverses the faces."""
    grid = plane(4.0, 3.0, segments=5)
    mesh = mesh_of(grid.positions[:, turn], grid.indices.reshape(-1, 3))
    solid = find_solid(mesh)
    assert solid is not None
    assert (solid.upper - solid.lower).tolist() == (mesh.bounds[1] - mesh.bounds[0]).tolist()
    corners = mesh.positions[mesh.indices[:3]].astype(np.float64)
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    front = corners[0] + normal / np.linalg.norm(normal)
    (cap,) = solid.caps
    assert cap[:3] @ front + cap[3] < 0.0 < cap[:3] @ (2.0 * corners[0] - front) + cap[3]


@pytest.mark.parametrize("change", ["gap", "twice", "facing away", "corner"])
def test_a_flat_mesh_that_does_not_fill_its_rectangle_once_hides_nothing(change):
    grid = plane(4.0, 3.0, segments=5)
    triangles, positions = grid.indices.reshape(-1, 3).copy(), grid.positions.copy()
    if change == "gap":
        triangles = np.delete(triangles, 9, axis=0)
    elif change == "twice":
        triangles[9] = triangles[20]  # as large as the gap that it leaves
    elif change == "facing away":
        triangles[9] = triangles[9, ::-1]
    else:
        positions[0] = 0.5 * (positions[0] + positions[1])
    assert find_solid(mesh_of(positions, triangles)) is None


def test_what_has_no_inside_has_no_box():
    inverted = box()
    inverted = mesh_of(inverted.positions, inverted.indices.reshape(-1, 3)[:, ::-1])
    bent = mesh_of(np.random.default_rng(0).normal(size=(30, 3)), np.arange(30))
    assert find_solid(inverted) is None, "a sky is seen from inside"
    assert find_solid(bent) is None


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("side", range(2))
def test_a_missing_face_is_a_cap_one_has_to_be_behind(axis, side):
    solid = find_solid(without_face(box(2.0, 2.0, 2.0), axis, side))
    assert solid.caps.shape == (1, 4)
    expected = np.zeros(4)
    expected[axis], expected[3] = (1.0, -1.0) if side else (-1.0, -1.0)
    assert np.abs(solid.caps[0] - expected).max() < 1e-6


def test_walls_of_loose_plates_are_sealed_and_hide():
    """All edges run both ways but for the rims above and below; the surface itself has not moved."""
    rng = np.random.default_rng(4)
    for _ in range(4):
        mesh = house(rng)
        sealed = remove_t_junctions(mesh)
        assert sealed.repaired > 0
        rims = sealed.points[np.unique(unmatched_edges(sealed.triangles))]
        assert set(np.round(rims[:, 1], 4).tolist()) == {0.0, round(float(mesh.bounds[1][1]), 4)}
        assert area_of(sealed.mesh) == pytest.approx(area_of(mesh), rel=1e-5)
        solid = find_solid(mesh)
        assert len(solid.caps) == 2
        for eye in rng.uniform([-30, 0.1, -30], [30, 2.5, 30], (20, 3)):
            if (np.abs(eye) > mesh.bounds[1]).any():
                assert meets_front_first(solid, eye, rng.uniform(solid.lower, solid.upper, (20, 3))).all()


def test_from_beyond_a_cap_one_would_look_in():
    """What the caps are for: from above, rays reach the box without meeting a front face."""
    rng = np.random.default_rng(4)
    solid = find_solid(house(rng))
    eye = np.array([0.0, 40.0, 0.0])
    assert (solid.caps[:, :3] @ eye + solid.caps[:, 3] > 0.0).any()
    assert not meets_front_first(solid, eye, rng.uniform(solid.lower, solid.upper, (20, 3))).any()


def test_inserted_corners_carry_what_lies_between_the_ends():
    """A long edge with two short ones along it: pictures and colours do not jump at the new corner."""
    positions = np.float32([[0, 0, 0], [4, 0, 0], [0, 2, 0], [1, 0, 0], [0, -2, 0], [4, -2, 0]])
    triangles = np.array([[0, 1, 2], [0, 4, 3], [3, 4, 5], [3, 5, 1]])
    uvs = (positions[:, :2] * [0.25, 0.5]).astype(np.float32)
    colours = np.concatenate([positions / 8 + 0.5, np.ones((6, 1))], axis=1).astype(np.float32)
    mesh = MeshData(
        positions, np.tile(np.float32([0, 0, 1]), (6, 1)), triangles.reshape(-1).astype(np.uint32), uvs, colours
    )
    sealed = remove_t_junctions(mesh.validated())
    assert sealed.repaired == 1
    out = sealed.mesh
    assert len(out.positions) == 7 and out.triangle_count == 5
    assert np.allclose(out.uvs, out.positions[:, :2] * [0.25, 0.5], atol=1e-6)
    assert np.allclose(out.colours[:, :3], out.positions / 8 + 0.5, atol=1e-6)


def test_a_torus_keeps_its_hole_free():
    """The best box lies in the ring's own bar, not across the hole."""
    solid = find_solid(torus(2.0, 0.8, 32))
    middle = 0.5 * (solid.lower + solid.upper)
    assert np.linalg.norm(middle) > 1.0
