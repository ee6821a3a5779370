"""Bones of models of many programs, by tables, names and places; persons who look another way are turned round."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.commands.check import examine
from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.gait import Pace, Walk, natural_step
from mimics_app.world.content.motion.humanoid import NEEDED, find_humanoid
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.files.scene.model_world import load_model_world, read_model
from tests.support.gltf_maker import write_gltf
from tests.support.person_maker import PLACES, REST_ARMS, person, resting, write_person

SIDES = {"left": ("Left", "L", "l"), "right": ("Right", "R", "r")}


def _both(pattern: str, parts: dict[str, str]) -> dict[str, str]:
    """Names of both sides: {word}, {upper} and {lower} stand for Left, L and l, {part} for the part."""
    return {
        side + bone: pattern.format(word=word, upper=upper, lower=lower, part=part)
        for side, (word, upper, lower) in SIDES.items()
        for bone, part in parts.items()
    }


_ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")
_LEG = ("UpperLeg", "LowerLeg", "Foot", "Toes")


def _parts(*names: str) -> dict[str, str]:
    return dict(zip((*_ARM, *_LEG), names, strict=True))


RIGIFY_SPINE = {
    bone: f"spine.{number:03}" if number else "spine"
    for number, bone in enumerate(("hips", "spine", "chest", "upperChest", "neck", "head"))
}
RIGIFY = _both("{part}.{upper}", _parts("shoulder", "upper_arm", "forearm", "hand", "thigh", "shin", "foot", "toe"))
PROGRAMS = {
    "Rigify": RIGIFY_SPINE | RIGIFY,
    "Rigify, deforming": {bone: f"DEF-{name}" for bone, name in (RIGIFY_SPINE | RIGIFY).items()},
    "MotionBuilder, old": {"hips": "Hips", "chest": "Chest2", "head": "Head"}
    | _both("{word}{part}", _parts("Collar", "Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle", "Toe")),
    "MotionBuilder": {"hips": "Character1_Hips", "spine": "Character1_Spine", "head": "Character1_Head"}
    | _both(
        "Character1_{word}{part}",
        _parts("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase"),
    ),
    "Character Creator": {
        "hips": "CC_Base_Hip", "spine": "CC_Base_Waist", "chest": "CC_Base_Spine01", "upperChest": "CC_Base_Spine02",
        "neck": "CC_Base_NeckTwist01", "head": "CC_Base_Head",
    }
    | _both(
        "CC_Base_{upper}_{part}",
        _parts("Clavicle", "Upperarm", "Forearm", "Hand", "Thigh", "Calf", "Foot", "ToeBase"),
    ),
    "Maya": {
        "hips": "Root_M", "spine": "Spine1_M", "chest": "Spine2_M", "upperChest": "Chest_M", "neck": "Neck_M",
        "head": "Head_M",
    }
    | _both("{part}_{upper}", _parts("Scapula", "Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle", "Toes")),
    "Maya, in a name space": {"hips": "hero:Hips", "spine": "hero:Spine", "head": "hero:Head"}
    | _both("hero:{word}{part}", _parts("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase")),
    "Daz": {"hips": "hip", "spine": "abdomenLower", "head": "head"}
    | _both(
        "{lower}{part}",
        _parts("Collar", "ShldrBend", "ForearmBend", "Hand", "ThighBend", "Shin", "Foot", "Toe"),
    ),
}  # fmt: skip


def _animator(path: Path, **options: object) -> Animator:
    return next(iter(load_model_world(write_person(path, **options)).motion.animators.values()))


@pytest.mark.parametrize("program", PROGRAMS)
def test_bones_are_found_by_the_names_of_many_programs(tmp_path: Path, program: str) -> None:
    names = PROGRAMS[program]
    found = find_humanoid(_animator(tmp_path / "person.gltf", names=names).rig)
    assert found.complete and not found.guesses
    for bone in (*NEEDED, "leftShoulder", "rightShoulder", "leftToes", "rightToes", "chest", "upperChest"):
        assert found.names[bone] == names.get(bone, bone), bone


STRANGE = {bone: f"骨_{number:02}" for number, bone in enumerate(PLACES)}


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("rest", REST_ARMS)
def test_bones_of_strange_names_are_guessed_from_their_places(tmp_path: Path, rest: str, back: bool) -> None:
    animator = _animator(tmp_path / "person.gltf", names=STRANGE, places=resting(REST_ARMS[rest]), back=back)
    found = find_humanoid(animator.rig)
    assert found.complete
    for bone in (*NEEDED, "leftShoulder", "leftToes", "neck"):
        assert found.names[bone] == STRANGE[bone], bone
        assert any(guess.startswith(f"{bone}: ") and "by its place" in guess for guess in found.guesses)


def test_what_is_no_person_is_not_guessed_to_be_one(tmp_path: Path) -> None:
    """A chain, a fork and a crab with legs at one joint: no complete person."""
    chain = {"a": ("", (0, 0, 0)), **{c: (p, (0.0, 0.2 * k, 0.0)) for k, (p, c) in enumerate(("ab", "bc", "cd"), 1)}}
    fork = chain | {"e": ("d", (0.3, 1, 0)), "f": ("d", (-0.3, 1, 0))}
    crab = {"a": ("", (0.0, 0.5, 0.0))}
    for leg in range(6):
        side, along = (1.0 if leg % 2 else -1.0), 0.2 * (leg // 2)
        for joint in range(3):
            parent = f"{leg}{joint - 1}" if joint else "a"
            crab[f"{leg}{joint}"] = (parent, (side * 0.2 * (joint + 1), 0.5 - 0.15 * joint, along))
    for places in (chain, fork, crab):
        assert not find_humanoid(_animator(tmp_path / "thing.gltf", places=places).rig).complete


def _with_table(version: int, back: bool = False) -> dict[str, object]:
    document = person(STRANGE, back=back).document()
    nodes = {bone: 1 + number for number, bone in enumerate(PLACES)}
    if version:
        table = {"VRMC_vrm": {"humanoid": {"humanBones": {bone: {"node": node} for bone, node in nodes.items()}}}}
    else:
        table = {"VRM": {"humanoid": {"humanBones": [{"bone": b, "node": n} for b, n in nodes.items()]}}}
    return document | {"extensionsUsed": list(table), "extensions": table}


@pytest.mark.parametrize("version", [0, 1])
def test_the_table_of_a_vrm_file_is_taken_as_it_is(tmp_path: Path, version: int) -> None:
    path = write_gltf(tmp_path / "person.vrm", _with_table(version, back=not version))
    model = read_model(path)
    rig = next(iter(open_shown(path).world.motion.animators.values())).rig
    found = find_humanoid(rig)
    assert found.complete and not found.guesses
    assert {bone: found.names[bone] for bone in PLACES} == STRANGE
    report = examine(path)
    assert report["kind"] == "model" and report["notes"] == model.document.notes
    assert any("looks along -z" in note for note in model.document.notes) is (version == 0)


@pytest.mark.parametrize(
    ("humanoid", "pointer"),
    [
        ({"humanBones": {"hips": {"node": 99}}}, "/extensions/VRMC_vrm/humanoid/humanBones/hips/node"),
        ({"humanBones": {"hips": {}}}, "/extensions/VRMC_vrm/humanoid/humanBones/hips/node"),
        ({"humanBones": {"hips": 3}}, "/extensions/VRMC_vrm/humanoid/humanBones/hips"),
        ({"humanBones": []}, "/extensions/VRMC_vrm/humanoid/humanBones"),
        (7, "/extensions/VRMC_vrm/humanoid"),
    ],
)
def test_a_broken_table_is_refused_at_its_place(tmp_path: Path, humanoid: object, pointer: str) -> None:
    document = person().document() | {"extensions": {"VRMC_vrm": {"humanoid": humanoid}}}
    with pytest.raises(SceneError) as refused:
        read_model(write_gltf(tmp_path / "person.gltf", document))
    assert [issue.pointer for issue in refused.value.issues] == [pointer]


def test_a_table_may_name_bones_that_are_not_used_here(tmp_path: Path) -> None:
    document = _with_table(1)
    table = document["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]  # type: ignore[index]
    table["leftThumbMetacarpal"] = {"node": 1}
    world = load_model_world(write_gltf(tmp_path / "person.gltf", document))
    found = find_humanoid(next(iter(world.motion.animators.values())).rig)
    assert found.complete and "leftThumbMetacarpal" not in found.slots


@pytest.mark.parametrize("armature", [False, True])
@pytest.mark.parametrize("yaw", [0, 90, 180, 270])
def test_who_looks_another_way_is_turned_round_and_walks_forwards(tmp_path: Path, yaw: int, armature: bool) -> None:
    """Toes before ankles, left on the left, knees that bend forwards, whichever way the file has the person look."""
    document = json.loads(json.dumps(person(armature=armature).document()))
    half = np.radians(yaw) / 2.0
    nodes, scene = document["nodes"], document["scenes"][0]
    nodes.append({"rotation": [0.0, float(np.sin(half)), 0.0, float(np.cos(half))], "children": scene["nodes"]})
    scene["nodes"] = [len(nodes) - 1]
    path = write_gltf(tmp_path / "person.gltf", document)
    notes = read_model(path).document.notes
    looks = {90: "+x", 180: "-z", 270: "-x"}
    assert [f"looks along {looks[yaw]} " in note for note in notes] == [True] if yaw else not notes
    rig = next(iter(load_model_world(path).motion.animators.values())).rig
    chain, walk = Chain(rig), Walk(rig, find_humanoid(rig), lambda: Pace(1.0, natural_step(1.0)))

    def place(bone: str) -> np.ndarray:
        return chain.places[rig.slot(bone)]

    assert place("leftUpperArm")[0] > 0.1 and place("leftToes")[2] - place("leftFoot")[2] > 0.1
    most = 0.0
    for _ in range(60):
        pose = rig.rest.copy()
        walk(pose, 1.0 / 60.0)
        chain.follow(pose)
        hip, knee, foot = (place(f"left{bone}") for bone in ("UpperLeg", "LowerLeg", "Foot"))
        way = foot - hip
        off = knee - hip - way * ((knee - hip) @ way / (way @ way))
        most = max(most, float(off[2]), key=abs)
    assert most > 0.1
