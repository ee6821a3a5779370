"""Skins, clips and morph targets of glTF files against a reference of plain float64 loops, and hostile ones by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.viewer.playing import play_clip
from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.world.content.motion.posing import posed_positions
from mimics_app.world.files.gltf.file import load_gltf
from tests.support.gltf_maker import GltfMaker, write_gltf
from tests.support.gltf_reference import Reference
from tests.support.shared_data import shared_folder
from tests.support.skin_maker import add_clip, bar, turn

SHARED = (
    ("RiggedSimple.glb", "clip 0"),
    ("SimpleSkin.gltf", "clip 0"),
    ("BoxAnimated.glb", "clip 0"),
    ("AnimatedMorphCube.glb", "Square"),
    ("01_morphed_cube/01_morphed_cube.gltf", "KeyAction"),
    ("03_animated_cube/03_animated_cube.gltf", "CubeAction"),
    ("glTF/SimpleMorph.gltf", "clip 0"),
    ("glTF/MorphPrimitivesTest.gltf", ""),
    ("quad_skin.glb", ""),
)


def _posed(path: Path, clip: str, at: float) -> np.ndarray:
    """All drawn vertices of a file in the world, in the order of nodes and primitives."""
    shown = open_shown(path)
    if clip:
        play_clip(shown, clip, at, speed=0.0)
    world, listed = shown.world, shown.world.subentities()
    found = []
    for number in range(len(listed.mesh)):
        mesh = world.meshes[listed.mesh[number]]
        body = world.motion.body_of.get(listed.mesh[number])
        local = mesh.positions.astype(np.float64) if body is None else posed_positions(mesh, body)
        matrix = world.transforms.world[listed.row[number]]
        found.append(local @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(found)


def _agree(path: Path, clip: str, at: float) -> None:
    """Every vertex of one lies on one of the other, both ways: flat normals give a vertex several copies."""
    ours = _posed(path, clip, at)
    wanted = np.concatenate([positions for _, _, positions in Reference(path).posed(clip, at)])
    size = float(np.ptp(wanted, axis=0).max())
    away = np.linalg.norm(ours[:, None] - wanted[None], axis=2)
    # Single precision of the palette: 2e-7 of the model's size, of its distance from the node's origin too.
    tolerance = 1e-6 * max(size, float(np.abs(wanted).max()))
    assert away.min(axis=1).max() < tolerance
    if len(ours) == len(wanted):
        assert np.abs(np.diagonal(away)).max() < tolerance or len(ours) > 24


@pytest.mark.parametrize(("file", "clip"), SHARED)
def test_poses_of_third_party_files_agree_with_the_reference(file: str, clip: str) -> None:
    path = shared_folder("gltf") / file
    for at in (0.0, 0.37, 1.0, 1.9) if clip else (0.0,):
        _agree(path, clip, at)


def _bending(maker: GltfMaker) -> GltfMaker:
    times = [0.0, 0.5, 1.0]
    turns = [turn("z", 0), turn("z", 70), turn("x", -50)]
    add_clip(maker, "bend", [(2, "rotation", times, turns, "LINEAR"), (3, "rotation", times, turns[::-1], "LINEAR")])
    return maker


@pytest.mark.parametrize("kind", ["STEP", "LINEAR", "CUBICSPLINE"])
@pytest.mark.parametrize("path", ["translation", "rotation", "scale"])
def test_interpolations_of_node_transforms(tmp_path: Path, kind: str, path: str) -> None:
    maker, parts = bar(), 3 if kind == "CUBICSPLINE" else 1
    rng = np.random.default_rng(3)
    width = 4 if path == "rotation" else 3
    values = rng.normal(size=(4, parts, width)) * 0.3 + (1.0 if path == "scale" else 0.0)
    if path == "rotation":
        values[:, parts // 2] /= np.linalg.norm(values[:, parts // 2], axis=1, keepdims=True)
    add_clip(maker, "move", [(2, path, [0.0, 0.4, 0.9, 2.0], values, kind)])
    file = write_gltf(tmp_path / "bar.gltf", maker.document())
    for at in (0.0, 0.2, 0.4, 0.65, 1.7, 2.0):
        _agree(file, "move", at)


def test_the_place_of_the_node_that_carries_a_skin_is_ignored(tmp_path: Path) -> None:
    maker = _bending(bar())
    plain = _posed(write_gltf(tmp_path / "plain.gltf", maker.document()), "bend", 0.3)
    maker.more["nodes"][0] |= {"translation": [3.0, 2.0, -1.0], "rotation": turn("y", 40), "scale": [2.0, -0.5, 1.0]}
    moved = _posed(write_gltf(tmp_path / "moved.gltf", maker.document()), "bend", 0.3)
    assert np.allclose(plain, moved, atol=4e-6)


def test_a_mirrored_chain_of_joints_turns_no_triangle_inside_out(tmp_path: Path) -> None:
    """The joints mirror the mesh and its node does not: outside must stay outside."""
    maker = bar()
    maker.more["nodes"][1]["scale"] = [-1.0, 1.0, 1.0]
    shown = open_shown(write_gltf(tmp_path / "bar.gltf", maker.document()))
    key = next(iter(shown.world.motion.body_of))
    mesh, body = shown.world.meshes[key], shown.world.motion.body_of[key]
    corners = posed_positions(mesh, body)[mesh.indices.reshape(-1, 3)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = corners.mean(axis=1) * (1.0, 0.0, 1.0)
    assert (np.einsum("ij,ij->i", normals, outwards) > 0.0).all()


def test_normalised_bytes_and_a_second_set_of_joints(tmp_path: Path) -> None:
    from tests.support.skin_maker import bar_arrays

    *_, shares = bar_arrays()
    bytes_ = np.round(shares * 255).astype(np.uint8)
    file = write_gltf(tmp_path / "bytes.gltf", _bending(bar(weights=bytes_, normalized=True)).document())
    _agree(file, "bend", 0.6)
    maker = _bending(bar())
    attributes = maker.more["meshes"][0]["primitives"][0]["attributes"]
    count = len(shares)
    attributes["JOINTS_1"] = maker.array(np.tile(np.array([2, 0, 0, 0], np.uint16), (count, 1)))
    attributes["WEIGHTS_1"] = maker.array(np.tile(np.array([0.25, 0, 0, 0], "f4"), (count, 1)))
    file = write_gltf(tmp_path / "two.gltf", maker.document())
    _agree(file, "bend", 0.6)
    assert any("did not add up to 1" in note and "scaled" in note for note in load_gltf(file).notes)
    assert load_gltf(file).meshes[0].primitives[0].mesh.weights.influences == 3


def test_two_skins_that_share_joints_and_morphs_before_the_skin(tmp_path: Path) -> None:
    maker = _bending(bar())
    primitive = maker.more["meshes"][0]["primitives"][0]
    rng = np.random.default_rng(5)
    count = maker.accessors[0]["count"]
    primitive["targets"] = [{"POSITION": maker.array(rng.normal(size=(count, 3)).astype("f4") * 0.02)} for _ in "ab"]
    maker.more["meshes"][0] |= {"weights": [0.5, 0.0], "extras": {"targetNames": ["smile", "blink"]}}
    maker.more["skins"].append({**maker.more["skins"][0], "name": "Again"})
    maker.more["nodes"].append({"name": "Second", "mesh": 0, "skin": 1, "weights": [0.0, 1.0]})
    maker.more["scenes"][0]["nodes"].append(4)
    add_clip(maker, "grin", [(4, "weights", [0.0, 1.0], [[0.0, 0.0], [1.0, 2.0]], "LINEAR")])
    file = write_gltf(tmp_path / "bar.gltf", maker.document())
    for clip, at in (("bend", 0.8), ("grin", 0.25)):
        wanted = np.concatenate([positions for _, _, positions in Reference(file).posed(clip, at)])
        assert np.abs(_posed(file, clip, at) - wanted).max() < 2e-6
    shown = open_shown(file)
    assert next(iter(shown.world.motion.animators.values())).rig.morph_names == ("smile", "blink") * 2


def _spoil_joint(maker: GltfMaker) -> None:
    maker.more["skins"][0]["joints"] = [1, 2]


def _spoil_cycle(maker: GltfMaker) -> None:
    maker.more["nodes"][3]["children"] = [1]


def _spoil_zero(maker: GltfMaker) -> None:
    attributes = maker.more["meshes"][0]["primitives"][0]["attributes"]
    attributes["WEIGHTS_0"] = maker.array(np.zeros((maker.accessors[0]["count"], 4), "f4"))


def _spoil_bind(maker: GltfMaker) -> None:
    values = np.tile(np.eye(4, dtype="f4").ravel(), (3, 1))
    values[1, 5] = np.nan
    maker.more["skins"][0]["inverseBindMatrices"] = maker.array(values)


def _spoil_twice(maker: GltfMaker) -> None:
    maker.more["skins"][0]["joints"] = [1, 2, 2]


def _spoil_empty(maker: GltfMaker) -> None:
    maker.more["skins"][0]["joints"] = []


def _spoil_few_binds(maker: GltfMaker) -> None:
    values = np.tile(np.eye(4, dtype="f4").ravel(), (2, 1))
    maker.more["skins"][0]["inverseBindMatrices"] = maker.array(values)


def _spoil_negative(maker: GltfMaker) -> None:
    attributes = maker.more["meshes"][0]["primitives"][0]["attributes"]
    values = np.tile(np.array([1.5, -0.5, 0, 0], "f4"), (maker.accessors[0]["count"], 1))
    attributes["WEIGHTS_0"] = maker.array(values)


def _spoil_times(maker: GltfMaker) -> None:
    add_clip(maker, "bad", [(2, "translation", [0.0, 0.6, 0.5], np.zeros((3, 3)), "LINEAR")])


def _spoil_output(maker: GltfMaker) -> None:
    add_clip(maker, "bad", [(2, "translation", [0.0, 0.5, 0.6], np.zeros((2, 3)), "LINEAR")])


def _spoil_quaternion(maker: GltfMaker) -> None:
    add_clip(maker, "bad", [(2, "rotation", [0.0, 0.5], np.zeros((2, 4)), "LINEAR")])


def _spoil_kind(maker: GltfMaker) -> None:
    add_clip(maker, "bad", [(2, "translation", [0.0, 0.5], np.zeros((2, 3)), "SINUS")])


def _spoil_channel(maker: GltfMaker) -> None:
    one: Any = (2, "translation", [0.0, 0.5], np.zeros((2, 3)), "LINEAR")
    add_clip(maker, "bad", [one, one])


@pytest.mark.parametrize(
    ("spoil", "pointer", "what"),
    [
        (_spoil_joint, "/meshes/0/primitives/0/attributes/JOINTS_0", "follows joint 2; skin 0 has 2 joints"),
        (_spoil_cycle, "/nodes/", "loop"),
        (_spoil_zero, "/meshes/0/primitives/0/attributes/WEIGHTS_0", "no vertex follows a joint"),
        (_spoil_bind, "/accessors/", "element 1 is not finite"),
        (_spoil_twice, "/skins/0/joints/2", "is a joint of this skin already"),
        (_spoil_empty, "/skins/0/joints", "has no joint"),
        (_spoil_few_binds, "/skins/0/inverseBindMatrices", "has 2 matrices, the skin has 3 joints"),
        (_spoil_negative, "/meshes/0/primitives/0/attributes/WEIGHTS_0", "negative weight"),
        (_spoil_times, "/animations/0/samplers/0/input", "is before the one before it"),
        (_spoil_output, "/animations/0/samplers/0/output", "3 keys need 9"),
        (_spoil_quaternion, "/animations/0/samplers/0/output", "zero quaternion"),
        (_spoil_kind, "/animations/0/samplers/0/interpolation", "SINUS"),
        (_spoil_channel, "/animations/0/channels/1/target", "second channel"),
    ],
)
def test_hostile_skins_and_clips_are_refused_by_name(tmp_path: Path, spoil: Any, pointer: str, what: str) -> None:
    maker = bar()
    spoil(maker)
    with pytest.raises(SceneError) as refused:
        load_gltf(write_gltf(tmp_path / "bar.gltf", maker.document()))
    issues = [issue for issue in refused.value.issues if what in issue.what]
    assert issues and all(issue.pointer.startswith(pointer) for issue in issues), refused.value.issues


def test_a_level_of_detail_with_a_joint_beyond_the_skin_of_its_node_is_refused(tmp_path: Path) -> None:
    document = bar().document()
    document["skins"][0] = {"joints": document["skins"][0]["joints"][:2]}
    shown = next(node for node in document["nodes"] if "skin" in node)
    document["meshes"].append(document["meshes"][0])
    document["nodes"].append({"mesh": 1})
    shown |= {"mesh": 2, "extensions": {"MSFT_lod": {"ids": [len(document["nodes"]) - 1]}}}
    fine = {name: value for name, value in document["meshes"][0]["primitives"][0]["attributes"].items()}
    weightless = {name: value for name, value in fine.items() if not name.startswith(("JOINTS", "WEIGHTS"))}
    document["meshes"].append({"primitives": [{"attributes": weightless}]})
    with pytest.raises(SceneError, match="follows joint 2; skin 0 has 2 joints"):
        load_gltf(write_gltf(tmp_path / "bar.gltf", document))


def test_the_box_about_a_bent_body_holds_it(tmp_path: Path) -> None:
    file = write_gltf(tmp_path / "bar.gltf", _bending(bar()).document())
    shown = open_shown(file)
    body = next(iter(shown.world.motion.bodies.values()))
    for skinning in ("linear", "dual"):
        body.skinning = skinning
        for at in np.linspace(0.0, 1.0, 9):
            play_clip(shown, "bend", float(at), speed=0.0)
            (key,) = body.meshes
            positions = posed_positions(shown.world.meshes[key], body)
            least, greatest = shown.world.mesh_bounds(key)
            assert (positions >= least).all() and (positions <= greatest).all()


def test_the_command_writes_every_vertex(tmp_path: Path) -> None:
    file = write_gltf(tmp_path / "bar.gltf", _bending(bar()).document())
    out = tmp_path / "out.npz"
    assert main(["view", str(file), "--clip", "bend", "--at", "0.3", "--vertices", str(out)]) == 0
    with np.load(out) as written:
        assert written["positions"].dtype == np.float64
        assert set(written["mesh"]) == {"BarMesh"} and set(written["node"]) == {"Bar"}
        wanted = np.concatenate([positions for _, _, positions in Reference(file).posed("bend", 0.3)])
        assert np.abs(written["positions"] - wanted).max() < 2e-6
    assert main(["view", str(file), "--clip", "bent", "--vertices", str(out)]) == 3
    assert main(["view", str(file), "--at", "1", "--vertices", str(out)]) == 2
