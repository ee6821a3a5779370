"""Optical motion capture from C3D files: markers become bones of a model; what is guessed and missing is reported."""

from __future__ import annotations

import json
import random
import re
import warnings
from collections.abc import Mapping
from pathlib import Path

import c3d
import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.viewer.playing import read_motion
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system import read_budget
from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.layer import Layer
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.files.capture.c3d_file import read_c3d
from mimics_app.world.files.capture.markers import find_points
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.person_maker import PLACES, write_person
from tests.support.skin_maker import turn

JOINTS = {
    "Hip": "UpperLeg", "KneeJoint": "LowerLeg", "AJC": "Foot", "TOE": "Toes",
    "SHO": "UpperArm", "EJC": "LowerArm", "WJC": "Hand",
}  # fmt: skip
"""Labels without their side, of markers that tests put on joints."""

RATE = 50.0


def _write(
    path: Path, markers: Mapping[str, np.ndarray], *, unit: str = "mm", unseen: tuple[str, int] = ("", 0)
) -> Path:
    """A C3D file of markers [m], +y up, [frames, 3] each; z is up in it, and one may be unseen in a frame."""
    writer = c3d.Writer(point_rate=RATE, point_units=unit)
    writer.set_point_labels(list(markers))
    writer.set_screen_axis("+X", "+Z")
    scale = {"mm": 1e3, "m": 1.0}[unit]
    for k in range(len(next(iter(markers.values())))):
        points = np.zeros((len(markers), 5), np.float32)
        for row, (name, places) in enumerate(markers.items()):
            points[row, :3] = scale * places[k][[2, 0, 1]]
            if unseen == (name, k):
                points[row, 3] = -1.0
        writer.add_frames([(points, np.zeros((0, 0)))])
    with path.open("wb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        writer.write(file)
    return path


def _recorded(frames: int = 5, yaw: float = 30.0) -> dict[str, np.ndarray]:
    """Markers on the joints of the person of sticks who turns, raises the left arm and bends the right knee."""
    markers = {f"{side[0].upper()}{label}": [] for side in ("left", "right") for label in JOINTS}
    for k in range(frames):
        share = k / (frames - 1)
        bends = {
            "leftUpperArm": turn("z", 70 * share),
            "rightLowerLeg": turn("x", 60 * share),
            "hips": turn("y", yaw * share),
        }
        places = _posed(bends, np.array([0.0, 0.0, 0.4 * share]))
        for side in ("left", "right"):
            for label, bone in JOINTS.items():
                markers[f"{side[0].upper()}{label}"].append(places[side + bone])
    return {name: np.array(rows) for name, rows in markers.items()}


def _posed(bends: dict[str, list[float]], shift: np.ndarray) -> dict[str, np.ndarray]:
    places, turns = dict[str, np.ndarray](), dict[str, np.ndarray]()
    for bone, (parent, place) in PLACES.items():
        own = _matrix(np.array(bends.get(bone, (0, 0, 0, 1.0))))
        turns[bone] = (turns[parent] if parent else np.eye(3)) @ own
        places[bone] = (
            np.array(place) + shift
            if not parent
            else places[parent] + turns[parent] @ (np.array(place) - PLACES[parent][1])
        )
    return places


def _matrix(q: np.ndarray) -> np.ndarray:
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_bones_lie_as_the_markers_do_on_a_model_of_another_size_and_rest(tmp_path: Path, unit: str) -> None:
    markers = _recorded()
    file = _write(tmp_path / "take.c3d", markers, unit=unit)
    model = write_person(
        tmp_path / "person.gltf", scale=0.8, turns={"leftUpperArm": turn("z", 40), "hips": turn("y", 20)}
    )
    rig = next(iter(load_model_world(model).motion.animators.values())).rig
    clip, report = read_motion(file, rig, find_humanoid(rig))
    assert clip.name == "take" and clip.duration == pytest.approx(4 / RATE)
    assert any("scaled by 0.800" in line for line in report) and any("left out: the head" in line for line in report)
    chain, layer, pose = Chain(rig), Layer(clip, rig.rest, rig.morph_first), rig.rest.copy()
    for k in range(5):
        layer.sample(k / RATE, pose)
        chain.follow(pose)
        for side in ("left", "right"):
            for begin, end in (
                ("Hip", "KneeJoint"),
                ("KneeJoint", "AJC"),
                ("AJC", "TOE"),
                ("SHO", "EJC"),
                ("EJC", "WJC"),
            ):
                theirs = markers[side[0].upper() + end][k] - markers[side[0].upper() + begin][k]
                ours = chain.places[rig.slot(side + JOINTS[end])] - chain.places[rig.slot(side + JOINTS[begin])]
                # Places in the file are in single precision: 1e-7 of 1.5 m over a foot of 0.15 m.
                assert np.abs(ours / np.linalg.norm(ours) - theirs / np.linalg.norm(theirs)).max() < 1e-5
        middles = [0.5 * (a + b) for a, b in (
            (markers["LHip"][k], markers["RHip"][k]),
            (chain.places[rig.slot("leftUpperLeg")], chain.places[rig.slot("rightUpperLeg")]),
        )]  # fmt: skip
        assert np.abs(middles[1] - 0.8 * middles[0]).max() < 1e-5


def test_hip_joints_come_from_the_pelvis_and_gaps_are_filled(tmp_path: Path) -> None:
    markers = {name: rows for name, rows in _recorded(yaw=0.0).items() if "Hip" not in name}
    still = {
        "LASI": (0.12, 1.0, 0.09),
        "RASI": (-0.12, 1.0, 0.09),
        "LPSI": (0.05, 1.0, -0.09),
        "RPSI": (-0.05, 1.0, -0.09),
    }
    markers |= {f"Anna:{name}": np.tile(place, (5, 1)) for name, place in still.items()}
    take = read_c3d(_write(tmp_path / "take.c3d", markers, unseen=("LEJC", 2)))
    body = find_points(take, "take")
    # 0.36, 0.30 and 0.19 of 0.24 m from the middle of the front spines.
    assert np.abs(body.points["leftHip"] - (0.0864, 1.0 - 0.072, 0.09 - 0.0456)).max() < 1e-6
    between = 0.5 * (markers["LEJC"][1] + markers["LEJC"][3])
    assert np.abs(body.points["leftElbow"][2] - between).max() < 1e-6
    assert any("Bell" in line for line in body.report) and any(
        "LEJC is not seen in 1 frames" in line for line in body.report
    )


def test_what_cannot_be_read_is_refused(tmp_path: Path) -> None:
    whole = _write(tmp_path / "take.c3d", _recorded())
    for number, data in enumerate((b"", b"\x02\x50" + b"\0" * 600, whole.read_bytes()[:700])):
        file = tmp_path / f"{number}.c3d"
        file.write_bytes(data)
        with pytest.raises(SceneError) as refused:
            read_c3d(file)
        assert str(file) in str(refused.value)
    few = _write(tmp_path / "few.c3d", {name: rows for name, rows in _recorded().items() if "SHO" not in name})
    with pytest.raises(SceneError, match="leftShoulder, rightShoulder"):
        find_points(read_c3d(few), "few")


def test_the_viewer_plays_what_was_recorded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, take = write_person(tmp_path / "person.gltf"), _write(tmp_path / "take.c3d", _recorded())
    out = tmp_path / "out.npz"
    assert main(["view", str(model), "--motion", str(take), "--at", "0.08", "--vertices", str(out), "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    assert reported["clips"] == ["take"] and any("scaled by" in note for note in reported["notes"])
    posed = _posed({"leftUpperArm": turn("z", 70), "hips": turn("y", 30)}, np.array([0.0, 0.0, 0.4]))
    near = np.linalg.norm(np.load(out)["positions"] - posed["leftHand"], axis=1).min()
    assert near < 0.031  # its vertices are 3 cm from the joints
    (tmp_path / "take.fbx").touch()
    assert main(["view", str(model), "--motion", str(tmp_path / "take.fbx"), "--vertices", str(out)]) == 2


def _header(path: Path, **words: int) -> bytes:
    """The bytes of a right file with words of its header replaced, by their byte: "at6" is the one of byte 6."""
    data = bytearray(_write(path, _recorded()).read_bytes())
    for place, value in words.items():
        data[int(place[2:]) : int(place[2:]) + 2] = value.to_bytes(2, "little")
    return bytes(data)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ({"at6": 60_000, "at8": 3}, ""),
        ({"at6": 0, "at8": 0}, ""),
        ({"at514": 0}, "damaged, or of an unknown kind of processor"),
    ],
)
def test_a_header_that_lies_is_refused_in_words(
    tmp_path: Path, words: dict[str, int], told: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "take.c3d"
    path.write_bytes(_header(path, **words))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            read_c3d(path)
        except SceneError as error:
            assert re.search(told, str(error)) and "variable" not in str(error)
        else:
            assert not told
    assert capfd.readouterr().err == ""


def test_bits_flipped_in_a_take_make_no_noise(tmp_path: Path) -> None:
    """Refused or read; numbers that are none count as not seen, and numpy says nothing of them."""
    chance, path = random.Random(32), tmp_path / "take.c3d"
    whole, refused = _header(path), 0
    for _ in range(300):
        data = bytearray(whole)
        for _ in range(4):
            at = chance.randrange(len(data))
            data[at] ^= 1 << chance.randrange(8)
        path.write_bytes(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                read_c3d(path)
        except SceneError:
            refused += 1
    assert 10 < refused < 290


def test_more_frames_than_are_read_at_once_are_refused_before_any_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = _write(tmp_path / "take.c3d", _recorded(40))
    monkeypatch.setattr(read_budget, "READ_BUDGET", 32 * 40 * 14 - 1)
    monkeypatch.setattr(c3d.Reader, "read_frames", None)
    with pytest.raises(SceneError, match="memory"):
        read_c3d(path)
