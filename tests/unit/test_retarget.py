"""Poses carried over between models that rest differently: limbs point where those of the source do."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.layer import Layer
from mimics_app.world.content.motion.retarget import Retarget
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.files.capture.bvh import capture_clip, read_bvh
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.person_maker import REST_ARMS, resting, write_person
from tests.support.skin_maker import turn

LIMBS = [
    (f"{side}{bone}", f"{side}{after}")
    for side in ("left", "right")
    for bone, after in (
        ("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"),
    )
]  # fmt: skip
STIFF = ["hips", "spine", "chest", "upperChest", "neck", "head"]


def _rig(path: Path, **options: object) -> Rig:
    return next(iter(load_model_world(write_person(path, **options)).motion.animators.values())).rig


def _matrix(q: np.ndarray) -> np.ndarray:
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _places(rig: Rig, rotations: np.ndarray, translations: np.ndarray) -> tuple[dict[str, np.ndarray], ...]:
    """Places and rotations of all joints by plain products of matrices."""
    places, turns = dict[str, np.ndarray](), dict[str, np.ndarray]()
    world = list[np.ndarray]()
    for slot, name in enumerate(rig.names):
        own = np.eye(4)
        own[:3, :3] = _matrix(rotations[slot]) * rig.rest.scales[slot]
        own[:3, 3] = translations[slot]
        above = int(rig.parents[slot])
        world.append(world[above] @ own if above >= 0 else own)
        places[name] = world[-1][:3, 3]
        turns[name] = world[-1][:3, :3] / np.linalg.norm(world[-1][:3, 0])
    return places, turns


def _random_pose(rig: Rig, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Every joint of the skeleton turned by up to 80 degrees, the hips moved."""
    rotations, translations = rig.rest.rotations.copy(), rig.rest.translations.copy()
    for slot, name in enumerate(rig.names):
        if name in ("", "Body", "Armature"):
            continue
        extra = np.append(rng.uniform(-0.4, 0.4, 3), 1.0)
        extra /= np.linalg.norm(extra)
        x, y, z, w = extra
        a, b, c, d = rotations[slot]
        rotations[slot] = [
            w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a, w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        ]  # fmt: skip
    translations[rig.slot("hips")] += rng.uniform(-0.2, 0.2, 3)
    return rotations, translations


def _way(places: dict[str, np.ndarray], start: str, end: str) -> np.ndarray:
    way = places[end] - places[start]
    return way / np.linalg.norm(way)


@pytest.mark.parametrize("rests", list(itertools.product(REST_ARMS, REST_ARMS)), ids="-".join)
def test_limbs_point_where_those_of_the_source_do_between_any_two_rests(tmp_path: Path, rests: tuple[str, str]) -> None:
    """Legs apart by 20 degrees as well, other axes of the joints, vertebrae that only one has a name for."""
    there = resting(REST_ARMS[rests[0]], apart=20.0)
    there["more"] = ("spine", (0.0, 1.12, 0.0))
    there["chest"] = ("more", there["chest"][1])
    source = _rig(tmp_path / "a.gltf", places=there)
    turns = {"leftUpperArm": turn("z", 40), "rightLowerLeg": turn("x", -70), "spine": turn("y", 30)}
    target = _rig(tmp_path / "b.gltf", places=resting(REST_ARMS[rests[1]]), scale=0.8, turns=turns)
    retarget = Retarget(source, find_humanoid(source), target, find_humanoid(target))
    rng, pose = np.random.default_rng(8), target.rest.copy()
    _, rest_a = _places(source, source.rest.rotations, source.rest.translations)
    _, rest_b = _places(target, target.rest.rotations, target.rest.translations)
    for _ in range(5):
        rotations, translations = _random_pose(source, rng)
        retarget.apply(rotations, translations, pose)
        theirs, turned = _places(source, rotations, translations)
        ours, own = _places(target, pose.rotations, pose.translations)
        for start, end in LIMBS:
            assert np.abs(_way(ours, start, end) - _way(theirs, start, end)).max() < 1e-9, (start, end)
        for bone in STIFF:
            assert np.abs(own[bone] @ rest_b[bone].T - turned[bone] @ rest_a[bone].T).max() < 1e-9, bone
    told = " ".join(retarget.report)
    apart = abs(REST_ARMS[rests[0]] - REST_ARMS[rests[1]])
    assert f"leftLowerArm {apart:.1f}" in told if apart else "leftLowerArm" not in told
    assert "leftLowerLeg 20." in told or "leftLowerLeg 19." in told
    assert max(retarget.residuals[start] for start, _ in LIMBS) < 1e-9


def test_what_alignment_leaves_is_told(tmp_path: Path) -> None:
    """A head that is carried forward keeps its own neck: the angle of the necks is in the report."""
    stooped = resting(45.0)
    for bone in ("head", "leftEye", "rightEye"):
        stooped[bone] = (stooped[bone][0], tuple(np.array(stooped[bone][1]) + (0.0, 0.0, 0.1)))
    source, target = _rig(tmp_path / "a.gltf", places=stooped), _rig(tmp_path / "b.gltf", places=resting(45.0))
    retarget = Retarget(source, find_humanoid(source), target, find_humanoid(target))
    assert np.degrees(retarget.residuals["neck"]) == pytest.approx(np.degrees(np.arctan2(0.11, 0.1) - 0.0997), abs=0.2)
    assert any("not aligned" in line and "neck 42" in line for line in retarget.report)


@pytest.mark.parametrize("armature", [False, True])
def test_hips_move_as_the_sources_whatever_is_above_them(tmp_path: Path, armature: bool) -> None:
    source = _rig(tmp_path / "a.gltf")
    target = _rig(tmp_path / "b.gltf", scale=0.5, armature=armature)
    retarget = Retarget(source, find_humanoid(source), target, find_humanoid(target))
    pose, rng = target.rest.copy(), np.random.default_rng(2)
    rotations, translations = _random_pose(source, rng)
    retarget.apply(rotations, translations, pose)
    moved = []
    for rig, turned, shifted in (
        (source, rotations, translations),
        (target, pose.rotations, pose.translations),
    ):
        before, _ = _places(rig, rig.rest.rotations, rig.rest.translations)
        after, _ = _places(rig, turned, shifted)
        moved.append(after["hips"] - before["hips"])
    assert np.abs(moved[0]).max() > 0.05
    assert np.abs(moved[1] - 0.5 * moved[0]).max() < 1e-6


def test_who_looks_the_other_way_does_the_same_in_his_own_direction(tmp_path: Path) -> None:
    source, ahead = _rig(tmp_path / "a.gltf"), _rig(tmp_path / "b.gltf", places=resting(0.0))
    # As a BVH file may have it; a model is turned round when it is read.
    rest = ahead.rest.copy()
    rest.translations[:] *= (-1.0, 1.0, -1.0)
    target = replace(ahead, rest=rest)
    retarget = Retarget(source, find_humanoid(source), target, find_humanoid(target))
    pose, rng = target.rest.copy(), np.random.default_rng(2)
    rotations, translations = _random_pose(source, rng)
    retarget.apply(rotations, translations, pose)
    theirs, _ = _places(source, rotations, translations)
    ours, _ = _places(target, pose.rotations, pose.translations)
    for start, end in LIMBS:
        wanted = _way(theirs, start, end) * (-1.0, 1.0, -1.0)
        assert np.abs(_way(ours, start, end) - wanted).max() < 1e-9


PEOPLE = Path(__file__).parents[2] / "assets" / "models" / "avatars"
BVH = """HIERARCHY
ROOT Hips
{
 OFFSET 0 0 0
 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
 JOINT Spine
 {
  OFFSET 0 10 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  JOINT Head
  {
   OFFSET 0 50 0
   CHANNELS 3 Zrotation Xrotation Yrotation
   End Site { OFFSET 0 18 0 }
  }
  ARM_Left
  ARM_Right
 }
 LEG_Left
 LEG_Right
}
MOTION
Frames: 2
Frame Time: 0.5
"""


def _t_pose() -> str:
    """A recording in centimetres whose skeleton rests as a T: in frame 0 the arms hang, in frame 1 they rest."""
    text = BVH
    for word, sign in (("Left", 1), ("Right", -1)):
        arm = [(f"{word}Arm", f"{17 * sign} 38 0"), ("ForeArm", f"{28 * sign} 0 0"), ("Hand", f"{26 * sign} 0 0")]
        leg = [(f"{word}UpLeg", f"{9 * sign} -3 0"), ("Leg", "0 -42 0"), ("Foot", "0 -41 0")]
        for kind, joints, tip in (("ARM", arm, f"{10 * sign} 0 0"), ("LEG", leg, "0 -4 14")):
            lines = ""
            for name, offset in joints:
                full = name if name.startswith(word) else word + name
                lines += f"JOINT {full}\n{{\nOFFSET {offset}\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
            lines += f"End Site\n{{\nOFFSET {tip}\n}}\n" + "}\n" * 3
            text = text.replace(f"{kind}_{word}", lines)
    hanging = np.zeros((2, 48))
    hanging[:, 1], hanging[0, 12], hanging[0, 21] = 90.0, -90.0, 90.0  # after the hips, the spine and the head
    rows = "\n".join(" ".join(f"{number:g}" for number in row) for row in hanging)
    return text.replace("End Site { OFFSET 0 18 0 }", "End Site\n{\nOFFSET 0 18 0\n}") + rows + "\n"


@pytest.mark.parametrize("person", sorted(path.stem for path in PEOPLE.glob("*.glb")))
def test_a_recording_from_a_t_pose_is_played_right_on_every_shipped_person(tmp_path: Path, person: str) -> None:
    (tmp_path / "take.bvh").write_text(_t_pose())
    rig = next(iter(load_model_world(PEOPLE / f"{person}.glb").motion.animators.values())).rig
    clip, report = capture_clip(read_bvh(tmp_path / "take.bvh"), "take", rig, find_humanoid(rig))
    layer, pose = Layer(clip, rig.rest, rig.morph_first), rig.rest.copy()
    for at, arm in ((0.0, (0.0, -1.0, 0.0)), (0.5, (1.0, 0.0, 0.0))):
        layer.sample(at, pose)
        places, _ = _places(rig, pose.rotations, pose.translations)
        for side, sign in (("left", 1.0), ("right", -1.0)):
            for start, end in (("UpperArm", "LowerArm"), ("LowerArm", "Hand")):
                way = _way(places, f"{side}{start}", f"{side}{end}")
                assert np.abs(way - np.array(arm) * (sign, 1.0, 1.0)).max() < 1e-6
            for start, end in (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot")):
                assert np.abs(_way(places, f"{side}{start}", f"{side}{end}") - (0.0, -1.0, 0.0)).max() < 1e-6
    assert any("leftUpperArm 4" in line for line in report)
