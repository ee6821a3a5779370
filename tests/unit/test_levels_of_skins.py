"""Levels of detail of what bends: vertices of their own, few joints, every attribute, and the error of bent poses."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.maths.quat import about_axis, to_matrix
from mimics_app.world.content.meshes.deform import MorphTarget, VertexWeights
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.gltf.writer import GltfWriter, MeshPart
from mimics_app.world.files.simplify.decimation import decimate
from mimics_app.world.files.simplify.level_vertices import Bending, bent_joints, bent_places, lighter, morphed_places
from mimics_app.world.files.simplify.level_writer import write_levels

ROWS, AROUND, LONG, THICK = 33, 24, 1.0, 0.08


def tube():
    """A closed-sided tube along y whose upper half follows a second joint: positions, normals, indices, weights."""
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    ring = np.stack([np.cos(turn), 0.0 * turn, np.sin(turn)], axis=1)
    heights = np.linspace(0.0, LONG, ROWS)
    positions = np.concatenate([THICK * ring + [0.0, y, 0.0] for y in heights]).astype(np.float32)
    first = (np.arange(ROWS - 1)[:, None] * AROUND + np.arange(AROUND)).ravel()
    beside = first - first % AROUND + (first + 1) % AROUND
    quads = [(first, first + AROUND, beside), (beside, first + AROUND, beside + AROUND)]
    indices = np.concatenate([np.stack(each, axis=1) for each in quads])
    upper = np.repeat(np.clip((heights - 0.35) / 0.3, 0.0, 1.0), AROUND).astype(np.float32)
    swapped = (upper > 0.5)[:, None]
    joints = np.where(swapped, [1, 0], [0, 1]).astype(np.uint16)
    shares = np.where(swapped, np.stack([upper, 1 - upper], 1), np.stack([1 - upper, upper], 1)).astype(np.float32)
    normals = np.tile(ring, (ROWS, 1)).astype(np.float32)
    return positions, normals, indices.astype(np.uint32), VertexWeights(joints, shares)


INVERSE = np.tile(np.eye(4), (2, 1, 1))
INVERSE[1, 1, 3] = -0.5
"""Of joints at the foot and in the middle of the tube."""


def test_joints_are_bent_against_the_one_above():
    poses = bent_joints(INVERSE, (-1, 0))
    turn = np.empty((3, 3))
    for axis, pose in zip(np.eye(3), poses, strict=True):
        to_matrix(about_axis(axis, np.pi / 4), turn)
        assert pose[0, :3, :3] == pytest.approx(turn)
        assert pose[1, :3, :3] == pytest.approx(turn @ turn)
        assert (pose[1] @ [0.0, 0.5, 0.0, 1.0])[:3] == pytest.approx(turn @ [0.0, 0.5, 0.0])


def test_joints_that_hang_on_each_other_in_a_ring_do_not_hang_the_program():
    assert all(np.isfinite(pose).all() for pose in bent_joints(INVERSE, (1, 0)))


def test_what_bends_keeps_its_rings_where_it_bends():
    """At rest the tube is straight and needs two rings only; bent, the zone between the joints needs more."""
    positions, _, indices, weights = tube()
    poses = [bent_places(positions, weights, joints) for joints in bent_joints(INVERSE, (-1, 0))]
    still, bent = (decimate(positions, indices.ravel(), 0, 1e-3, poses=each) for each in ((), poses))
    assert still.triangle_count <= 2 * AROUND
    assert bent.triangle_count > 2 * still.triangle_count
    used = positions[np.unique(bent.indices), 1]
    assert ((used > 0.3) & (used < 0.7)).mean() > 0.5
    assert bent.error < 0.01


def test_a_vertex_follows_no_more_joints_than_can_be_seen():
    positions, _, _, weights = tube()
    joints = bent_joints(INVERSE, (-1, 0))
    bending = Bending(positions, weights, joints, [bent_places(positions, weights, each) for each in joints])
    kept = np.arange(len(positions))
    assert lighter(bending, kept, 1e-4)[0].influences == 2
    few, apart = lighter(bending, kept, 0.5)
    assert few.influences == 1 and 0.0 < apart < 0.5
    assert few.weights == pytest.approx(1.0)


def test_morphs_are_poses():
    step = np.full((2, 3), 0.5, np.float32)
    (place,) = morphed_places(np.zeros((2, 3)), [MorphTarget("smile", step)])
    assert place == pytest.approx(step)


def write_tube(file, highest=1):
    """The tube as a file with one morph, that lifts it, and normalised shares in 16 bits."""
    positions, normals, indices, weights = tube()
    writer = GltfWriter("test")
    shades = np.full((len(positions), 4), 200, np.uint8)
    uvs = np.ascontiguousarray(positions[:, :2])
    part = writer.add_part(MeshPart(positions, normals, uvs, shades, indices.ravel()))
    joints = np.zeros((len(positions), 4), np.uint8)
    joints[:, :2] = np.where(weights.joints == 1, highest, 0)
    shares = np.zeros((len(positions), 4), np.uint16)
    shares[:, :2] = np.round(65535 * weights.weights)
    own = dict(part.attributes)
    own |= {"JOINTS_0": writer._array(joints, 34962), "WEIGHTS_0": writer._array(shares, 34962, normalized=True)}
    lift = writer._array(np.tile(np.float32([0.0, 0.25, 0.0]), (len(positions), 1)), 34962, bounds=True)
    primitive = {"attributes": own, "indices": part.indices, "targets": [{"POSITION": lift}]}
    mesh = writer._add("meshes", {"name": "tube", "primitives": [primitive]})
    foot = writer.add_node("foot")
    middle = writer.add_node("middle", parent=foot, translation=(0.0, 0.5, 0.0))
    columns = np.ascontiguousarray(INVERSE.transpose(0, 2, 1).reshape(-1, 16), np.float32)
    skin = writer._add("skins", {"joints": [foot, middle], "inverseBindMatrices": writer._array(columns, 0)})
    writer._tables["nodes"][writer.add_node("body", mesh=mesh)]["skin"] = skin
    file.write_bytes(writer.to_bytes())
    return file


def test_levels_of_a_skin_have_vertices_of_their_own_and_all_attributes(tmp_path):
    (levels,) = write_levels(write_tube(tmp_path / "tube.glb"), tmp_path / "out.glb", (0.4, 0.1))
    model = load_gltf(tmp_path / "out.glb")
    body = model.nodes[model.find_node("body")]
    assert [model.nodes[level].skin for level in body.levels] == [body.skin, body.skin]
    fine = model.meshes[body.mesh].primitives[0].mesh
    lines = {tuple(row) for row in np.hstack([fine.positions, fine.normals, fine.uvs, fine.colours])}
    before = len(fine.positions)
    for level in body.levels:
        mesh = model.meshes[model.nodes[level].mesh].primitives[0].mesh
        assert len(mesh.positions) < before and set(mesh.indices) == set(range(len(mesh.positions)))
        assert {tuple(row) for row in np.hstack([mesh.positions, mesh.normals, mesh.uvs, mesh.colours])} <= lines
        assert mesh.morphs[0].positions == pytest.approx(np.tile([0.0, 0.25, 0.0], (len(mesh.positions), 1)))
        assert mesh.weights.weights.sum(axis=1) == pytest.approx(1.0)
        before = len(mesh.positions)
    assert levels.errors == tuple(sorted(levels.errors)) and levels.errors[1] < 0.02
    assert not model.notes


def test_a_joint_that_the_skin_does_not_have_is_refused(tmp_path):
    with pytest.raises(SceneError, match="JOINTS_0"):
        write_levels(write_tube(tmp_path / "tube.glb", highest=7), tmp_path / "out.glb")
    assert not (tmp_path / "out.glb").exists()
