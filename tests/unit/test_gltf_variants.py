"""What exporters write less often: instances, rotation keys of other lengths, compression without fallback."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.gltf_maker import GltfMaker, square, write_gltf


def _instanced(maker: GltfMaker, attributes: dict[str, int], **node: object) -> dict[str, object]:
    extension = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    maker.more = {
        "extensionsUsed": list(extension),
        "extensionsRequired": list(extension),
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [10, 0, 0], "extensions": extension, **node}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    }
    return maker.document()


def _triangle() -> GltfMaker:
    maker = GltfMaker()
    maker.array(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "f4"), min=[0, 0, 0], max=[1, 1, 0])
    return maker


def test_every_instance_is_shown_where_it_says(tmp_path: Path) -> None:
    maker, rng = _triangle(), np.random.default_rng(2)
    places, sizes = rng.normal(size=(7, 3)).astype("f4"), rng.uniform(0.5, 2.0, (7, 3)).astype("f4")
    turns = rng.normal(size=(7, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    whole = np.round(turns * 127).astype("i1")  # normalised bytes, not of length 1
    attributes = {"TRANSLATION": maker.array(places), "SCALE": maker.array(sizes)}
    attributes["ROTATION"] = maker.array(whole, normalized=True)
    world = load_model_world(write_gltf(tmp_path / "a.gltf", _instanced(maker, attributes)))
    listed = world.subentities()
    assert len(listed.mesh) == 7
    corners = np.array([[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1]], float)
    found = np.array([corners @ world.transforms.world[row].T for row in listed.row])[:, :, :3]
    wanted = []
    for place, turn, size in zip(places, whole / np.linalg.norm(whole, axis=1, keepdims=True), sizes, strict=True):
        x, y, z, w = turn
        matrix = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        wanted.append((corners[:, :3] * size) @ matrix.T + place + (10.0, 0.0, 0.0))
    order = [np.argsort(points[:, 0, 0]) for points in (found, np.array(wanted))]
    assert np.abs(found[order[0]] - np.array(wanted)[order[1]]).max() < 1e-5


@pytest.mark.parametrize(
    ("attributes", "node", "what"),
    [
        ({}, {}, "no TRANSLATION"),
        ({"TRANSLATION": 1, "SCALE": 2}, {}, "differ in number"),
        ({"TRANSLATION": 99}, {}, "accessor"),
        ({"ROTATION": 3}, {}, "zero quaternion"),
        ({"TRANSLATION": 4}, {}, "is beyond"),
    ],
)
def test_instances_that_cannot_be_are_refused(
    tmp_path: Path, attributes: dict[str, int], node: dict[str, object], what: str
) -> None:
    maker = _triangle()
    for values in (np.zeros((2, 3)), np.ones((3, 3)), np.zeros((2, 4)), np.full((2, 3), 1e30)):
        maker.array(values.astype("f4"))
    with pytest.raises(SceneError) as refused:
        load_gltf(write_gltf(tmp_path / "a.gltf", _instanced(maker, attributes, **node)))
    (issue,) = refused.value.issues
    assert what in issue.what and issue.pointer.startswith("/nodes/0/extensions/EXT_mesh_gpu_instancing")


def test_rotation_keys_are_of_length_1_before_they_are_interpolated(tmp_path: Path) -> None:
    """Half-way between keys of lengths 1 and 0.99 the rotation is half of it, exactly."""
    maker, half = _triangle(), np.radians(50.0)
    keys = np.array([[0, 0, 0, 1.0], [0.99 * np.sin(half), 0, 0, 0.99 * np.cos(half)]], "f4")
    sampler = {"input": maker.array(np.array([0.0, 1.0], "f4"), min=[0], max=[1]), "output": maker.array(keys)}
    channel = {"sampler": 0, "target": {"node": 0, "path": "rotation"}}
    maker.more = {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "it"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [
            {
                "name": "turn",
                "samplers": [sampler],
                "channels": [channel],
            }
        ],
    }
    world = load_model_world(write_gltf(tmp_path / "a.gltf", maker.document()))
    (animator,) = world.motion.animators.values()
    layer = animator.play("turn", speed=0.0, at=0.5)
    layer.sample(0.25, animator.pose)
    wanted = [np.sin(half / 4), 0.0, 0.0, np.cos(half / 4)]
    assert np.abs(animator.pose.rotations[0] - wanted).max() < 1e-6


@pytest.mark.parametrize("fallback", [False, True])
def test_compression_without_a_fallback_is_told(tmp_path: Path, fallback: bool) -> None:
    document = square()
    primitive = document["meshes"][0]["primitives"][0]
    primitive["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    document["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    if not fallback:
        for accessor in document["accessors"]:
            accessor.pop("bufferView")
    path = write_gltf(tmp_path / "a.gltf", document)
    if fallback:
        assert len(load_gltf(path).meshes[0].primitives) == 1
        return
    with pytest.raises(SceneError) as refused:
        load_gltf(path)
    assert any("KHR_draco_mesh_compression" in issue.what for issue in refused.value.issues)
