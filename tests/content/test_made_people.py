"""People made to measure: what trimesh and the tape find on the file, against what was asked."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from mimics_app.app.cli import main
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.person_edit import PersonEdit, edit_of_plain, plain_edit
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.resources import root
from mimics_app.world.files.scene.model_world import load_model_world

F8 = NDArray[np.float64]
FINEST = ("face", "face_1", "body", "body_1", "body_2", "things", "things_1", "things_2")
"""Names that trimesh gives to the parts of the finest level."""
ASKED = {
    "waist": 0.86, "hip": 1.09, "neck": 0.35, "chest": 1.02, "calf": 0.39, "biceps": 0.315, "wrist": 0.165,
    "upper_arm": 0.34, "forearm": 0.235, "hand": 0.19, "knee_height": 0.5, "foot": 0.26, "shoulders": 0.40,
}  # fmt: skip
HEIGHT, WEIGHT = 1.72, 72.0
PEOPLE = root() / "assets" / "models" / "avatars"
BODY = json.loads((PEOPLE / "bodies.json").read_text())["woman_anna"]


@dataclass
class Model:
    file: Path
    scene: trimesh.Scene
    mesh: trimesh.Trimesh
    skin: trimesh.Trimesh

    def joint(self, name: str) -> F8:
        return np.asarray(self.scene.graph.get(name)[0][:3, 3])

    def apart(self, one: str, other: str) -> float:
        return float(np.linalg.norm(self.joint(one) - self.joint(other)))


def _model(file: Path) -> Model:
    scene = trimesh.load_scene(file, process=False)
    whole, skin = (_joined(scene, names) for names in (FINEST, FINEST[:5]))
    return Model(file, scene, whole, skin)


def _joined(scene: trimesh.Scene, names: tuple[str, ...]) -> trimesh.Trimesh:
    parts = [scene.geometry[name] for name in names]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = np.vstack([part.faces + start for part, start in zip(parts, starts, strict=False)])
    return trimesh.Trimesh(np.vstack([part.vertices for part in parts]), faces, process=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Model:
    folder = tmp_path_factory.mktemp("made")
    (folder / "measures.json").write_text(json.dumps(ASKED))
    words = f"avatar make --height {HEIGHT} --weight {WEIGHT} --age 60 --sex f --like woman_anna"
    assert main([*words.split(), "--measures", str(folder / "measures.json"), "--out", str(folder / "eva.glb")]) == 0
    return _model(folder / "eva.glb")


@pytest.fixture(scope="module")
def before() -> Model:
    return _model(PEOPLE / "woman_anna.glb")


def _tape(model: Model, near: NDArray[np.bool_], normal: F8, size: float) -> float:
    """Length of a tape around a section through the mean of some vertices: of the loops about it, so without hair."""
    middle = model.mesh.vertices[near].mean(axis=0)
    lines = trimesh.intersections.mesh_plane(model.skin, normal, middle)
    points, index = np.unique(np.round(lines.reshape(-1, 3), 5), axis=0, return_inverse=True)
    pairs = index.reshape(-1, 2)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    loop = connected_components(graph, directed=False)[1]
    loops = [points[loop == number] for number in np.unique(loop)]
    ends = np.vstack([each for each in loops if np.linalg.norm(each.mean(axis=0) - middle) < 0.4 * size])
    aside = np.cross(normal, [0.0, 0.0, 1.0])
    return float(ConvexHull(ends @ np.stack([aside, [0.0, 0.0, 1.0]], axis=1)).area)


@pytest.mark.parametrize("name", ["neck", "chest", "waist", "hip", "calf", "biceps", "wrist"])
def test_girths_on_the_file_grow_as_those_of_the_body_were_asked_to(made: Model, before: Model, name: str) -> None:
    """By sections of skin or cloth through the same vertices: the cloth lies on the body as before."""
    ring = np.array(BODY["rings"][name])
    middle, size = ring.mean(axis=0), 1.35 * np.linalg.norm(ring - ring.mean(axis=0), axis=1).max()
    arm = before.joint("leftHand") - before.joint("leftUpperArm")
    normal = arm / np.linalg.norm(arm) if name in ("biceps", "wrist") else np.array([0.0, 1.0, 0.0])
    offset = before.mesh.vertices - middle
    near = (np.abs(offset @ normal) < 0.012) & (np.linalg.norm(offset, axis=1) < size)
    body = ConvexHull((ring - middle) @ np.linalg.svd(ring - middle)[2][:2].T).area
    grown = _tape(made, near, normal, 1.3 * size) / _tape(before, near, normal, size)
    assert grown == pytest.approx(ASKED[name] / body, rel=0.012)


def test_segments_on_the_file_are_as_long_as_asked(made: Model, before: Model) -> None:
    lengths = BODY["lengths"]
    for name, ends in (
        ("upper_arm", ("leftUpperArm", "leftLowerArm")),
        ("forearm", ("rightLowerArm", "rightHand")),
        ("hand", ("leftHand", "leftMiddleDistal")),
        ("foot", ("leftFoot", "leftToes")),
        ("shoulders", ("leftUpperArm", "rightUpperArm")),
    ):
        wanted = ASKED[name] / lengths[name] * before.apart(*ends)
        assert made.apart(*ends) == pytest.approx(wanted, rel=0.01), name
    knee = before.joint("leftLowerLeg")[1] - lengths["knee_height"]
    assert made.joint("leftLowerLeg")[1] - knee == pytest.approx(ASKED["knee_height"], rel=0.01)


def test_height_and_volume_are_those_asked(made: Model, before: Model) -> None:
    crown = [model.scene.geometry["face"].vertices[:, 1].max() for model in (made, before)]
    assert crown[0] / crown[1] == pytest.approx(HEIGHT / BODY["lengths"]["stature"], rel=0.01)
    volume = made.mesh.volume / before.mesh.volume
    assert volume == pytest.approx(WEIGHT / BODY["mass"], rel=0.01)


def test_the_person_has_every_joint_morph_clip_and_level(made: Model, before: Model) -> None:
    one, two = (load_model_world(model.file) for model in (made, before))
    a, b = (next(iter(world.motion.animators.values())) for world in (one, two))
    assert (
        a.rig.names[1:] == b.rig.names[1:] and a.rig.morph_names == b.rig.morph_names and list(a.clips) == list(b.clips)
    )
    assert list(made.scene.geometry) == list(before.scene.geometry)
    assert not made.file.with_name("hair_base.jpg").exists()  # the textures are inside


def _lowest_ankle(model: Model) -> float:
    """How far the ankles get below their place at rest in the walk [m]."""
    world = load_model_world(model.file)
    animator = next(iter(world.motion.animators.values()))
    feet = [animator.rig.entities[animator.rig.slot(name)] for name in ("leftFoot", "rightFoot")]
    animator.play("walk")
    heights = []
    for number in range(27):
        world.motion.time = number / 25.0
        world.update()
        heights += [float(world.graph.world_matrix(foot)[1, 3]) for foot in feet]
    return min(heights) - float(model.joint("leftFoot")[1])


def test_feet_keep_to_the_ground_in_the_walk(made: Model, before: Model) -> None:
    assert _lowest_ankle(made) == pytest.approx(_lowest_ankle(before), abs=0.003)


def test_what_cannot_be_reached_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "measures.json").write_text('{"waist": 1.9, "acromial_height": 1.7, "x-from": "a tape"}')
    words = f"avatar make --height 1.6 --weight 60 --age 30 --sex m --measures {tmp_path}/measures.json --json"
    assert main([*words.split(), "--out", str(tmp_path / "p.glb")]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["measures"]}
    assert not rows["waist"]["reached"] and rows["waist"]["asked"] == 1.9 and rows["waist"]["value"] < 1.85
    assert rows["height"]["reached"] and not rows["acromial_height"]["reached"]
    places = _model(tmp_path / "p.glb").mesh.vertices
    assert np.isfinite(places).all() and places[:, 1].max() < 1.65  # shoulders over the head would fold the neck


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"wais": 0.8}', '/wais: unknown measure "wais"; did you mean "waist"'),
        ('{"waist": 86}', "/waist: 86 is not a length from 0.05 to 2.5 m; give metres"),
        ('{"waist": "wide"}', "/waist: 'wide' is not a length"),
        ("[0.8]", "is no file of measures"),
        ('{"waist": ' + 20_000 * "[" + 20_000 * "]" + "}", "is no file of measures"),
    ],
)
def test_faulty_measures_are_refused_where_they_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, words: str
) -> None:
    (tmp_path / "m.json").write_text(text)
    line = f"avatar make --height 1.6 --weight 60 --age 30 --sex m --measures {tmp_path}/m.json --out {tmp_path}/p.glb"
    assert main(line.split()) == 3
    assert words in capsys.readouterr().err
    assert not (tmp_path / "p.glb").exists()


def test_the_person_is_the_own_body_of_a_scene(made: Model) -> None:
    edit = PersonEdit(avatar=str(made.file))
    plain, own = (load_checked_scene("avatar_cord", edit=each) for each in (None, edit))
    assert own.assets["own_body"].path == made.file and own.hash != plain.hash
    assert edit_of_plain(plain_edit(own)) == edit  # as a replay and a second display get it
    with pytest.raises(UsageError, match="shows no own body; leave --avatar out"):
        load_checked_scene("wavy_tunnel", edit=edit)
