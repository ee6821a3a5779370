"""Motion capture from BVH files: read, carried over to a model with another rest pose, refused where it is wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.layer import Layer
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.files.capture.bvh import capture_clip, read_bvh
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.person_maker import PLACES, write_person
from tests.support.skin_maker import turn


def _bvh(values: dict[str, tuple[float, float, float]], frames: int = 3) -> str:
    """The person of sticks as a BVH file in centimetres; joints turned Z X Y by degrees that grow with the frames."""
    lines, order = ["HIERARCHY"], list[str]()

    def write(bone: str, depth: int) -> None:
        parent, place = PLACES[bone]
        offset = 100.0 * (np.array(place) - (PLACES[parent][1] if parent else place))
        pad = "  " * depth
        order.append(bone)
        kind = "JOINT" if parent else "ROOT"
        shift = "" if parent else "Xposition Yposition Zposition "
        lines.extend([f"{pad}{kind} {bone}", f"{pad}{{", f"{pad}  OFFSET " + " ".join(f"{x:.6f}" for x in offset)])
        lines.append(f"{pad}  CHANNELS {3 if parent else 6} {shift}Zrotation Xrotation Yrotation")
        below = [child for child in PLACES if PLACES[child][0] == bone]
        for child in below:
            write(child, depth + 1)
        if not below:
            lines.extend([f"{pad}  End Site", f"{pad}  {{", f"{pad}    OFFSET 0 -2 0", f"{pad}  }}"])
        lines.append(f"{pad}}}")

    write("hips", 0)
    lines += ["MOTION", f"Frames: {frames}", "Frame Time: 0.5"]
    for k in range(frames):
        share = k / (frames - 1)
        row = [0.0, 95.0, 10.0 * k]
        for bone in order:
            row += [share * angle for angle in values.get(bone, (0.0, 0.0, 0.0))]
        lines.append(" ".join(f"{x:.6f}" for x in row))
    return "\n".join(lines) + "\n"


def test_what_was_recorded_is_done_by_a_model_of_another_size_and_rest(tmp_path: Path) -> None:
    angles = {"leftUpperArm": (40.0, 20.0, -30.0), "rightLowerLeg": (0.0, 60.0, 0.0), "head": (10.0, 0.0, 45.0)}
    (tmp_path / "take.bvh").write_text(_bvh(angles))
    capture = read_bvh(tmp_path / "take.bvh")
    turns = {"leftUpperArm": turn("z", 40), "head": turn("x", -70)}
    file = write_person(tmp_path / "person.gltf", scale=0.8, turns=turns)
    rig = next(iter(load_model_world(file).motion.animators.values())).rig
    clip, report = capture_clip(capture, "take", rig, find_humanoid(rig))
    assert clip.duration == 1.0 and any("bones carried over" in line for line in report)
    layer, pose = Layer(clip, rig.rest, rig.morph_first), rig.rest.copy()
    theirs, ours = Chain(capture.rig), Chain(rig)
    for k, at in enumerate((0.0, 0.5, 1.0)):
        layer.sample(at, pose)
        ours.follow(pose)
        theirs.places[:], theirs.turns[:] = 0.0, 0.0
        theirs.follow(Pose(capture.translations[k], capture.rotations[k], capture.rig.rest.scales, np.zeros(0)))
        for parent, child in (("leftUpperArm", "leftLowerArm"), ("rightLowerLeg", "rightFoot"), ("hips", "spine")):
            ways = [
                chain.places[chain.rig.slot(child)] - chain.places[chain.rig.slot(parent)] for chain in (ours, theirs)
            ]
            a, b = (way / np.linalg.norm(way) for way in ways)
            assert np.abs(a - b).max() < 1e-5
        # The recorded hips are 0.93 m over the lowest joint, the model's stand at 0.76 m.
        hips = ours.places[rig.slot("hips")] - rig.rest.translations[rig.slot("hips")]
        assert hips[2] == pytest.approx(0.1 * k * 0.8, rel=0.05)


@pytest.mark.parametrize(
    ("spoil", "line", "what"),
    [
        (lambda text: "SOMETHING\n" + text, "line 1", "HIERARCHY"),
        (lambda text: text.replace("OFFSET", "OFSET", 1), "line 4", "not understood"),
        (lambda text: text.replace("CHANNELS 6", "CHANNELS 5"), "line 5", "channels"),
        (lambda text: text.rsplit("\n", 3)[0], "", "ends too early"),
        (lambda text: text.replace("Frame Time: 0.5", "Frame Time: 0"), "", "out of range"),
        (lambda text: text.replace(" 95.000000 ", " nan ", 1), "", "numbers"),
        (lambda text: text.replace("OFFSET 0 -2 0", "OFFSET 0 -1e308 0", 1), "line", "numbers"),
        (lambda text: text.replace("}", "", 1), "", "braces"),
    ],
)
def test_wrong_files_are_refused_with_their_line(tmp_path: Path, spoil, line: str, what: str) -> None:
    file = tmp_path / "take.bvh"
    file.write_text(spoil(_bvh({})))
    with pytest.raises(SceneError) as refused:
        read_bvh(file)
    (issue,) = refused.value.issues
    assert what in issue.what and issue.pointer.startswith(line or "line")


@pytest.mark.parametrize(("frames", "joints"), [(1_000_000, 10), (50_000, 990), (400_000, 12)])
def test_a_recording_is_refused_by_what_it_would_take_and_not_by_its_bytes(
    tmp_path: Path, frames: int, joints: int
) -> None:
    """Two bytes a frame, and joints that do not move: a file of 2 MB could ask for 30 GB."""
    head = "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 1 Yrotation\n"
    chain = "JOINT j\n{\nOFFSET 0 1 0\nCHANNELS 0\n" * joints + "}\n" * (joints + 1)
    text = f"{head}{chain}MOTION\nFrames: {frames}\nFrame Time: 0.01\n" + "0\n" * frames
    (tmp_path / "long.bvh").write_text(text)
    with pytest.raises(SceneError, match="MB of memory"):
        read_bvh(tmp_path / "long.bvh")
    (tmp_path / "short.bvh").write_text(text[: -2 * frames].replace(f"Frames: {frames}", "Frames: 9000") + "0\n" * 5)
    with pytest.raises(SceneError, match=r"5 lines for 9000 frames|MB of memory"):
        read_bvh(tmp_path / "short.bvh")


def test_a_recording_of_a_crowd_of_nodes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "take.bvh").write_text(_bvh({}, 2000))
    capture = read_bvh(tmp_path / "take.bvh")
    rig = next(iter(load_model_world(write_person(tmp_path / "person.gltf")).motion.animators.values())).rig
    crowd = replace(rig, names=rig.names * 200)
    with pytest.raises(ValueError, match="MB of memory"):
        capture_clip(capture, "take", crowd, find_humanoid(rig))
