"""A run on the left side is the mirror image of the run on the right side: of scene, person, touch and objects."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.mirror.mirror_display import MirroredScene
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.mirrored_scene import mirrored, why_not_mirrored
from mimics_app.app.scenes.person_edit import PersonEdit, edit_of_plain, plain_edit
from mimics_app.app.study.study_folder import StudyFolder
from mimics_app.app.study.study_runs import play_next
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.messages.fit import Fit
from mimics_app.contracts.system.resources import root
from mimics_app.world.components.robot import Patient
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.content.extent import world_extent
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.scene import Scene

EQUAL = 1e-9
LENGTHS = {"wavy_tunnel": 8.0, "pick_and_place": 10.0, "tower": 3.0, "impedance_control": 5.0}
LONG = ("two_fingers", "surfaces", "free_objects", "springs_and_magnets", "falling_pairs", "bisector_only")
LONG += ("guided_path", "shaking_and_sticking", "moving_sound", "printed_equations", "mirrors")
PLAYED = [*LENGTHS, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)]
LEFT = PersonEdit(side="left")


class Played:
    """A run without noise of the robot's sensors, which do not belong to the person.

    Attributes:
        samples: Columns of every tick.
        poses: Of the haptic bodies in each frame, [n, bodies, 7].
        scores: Of the trials.
    """

    def __init__(self, name: str, side: str) -> None:
        poses = []
        with mimics.open(name, seed=3, patient="moderate", side=side, record="memory") as session:
            session.edit("robot", sensor_noise=0.0, sensor_quantum=0.0)
            for _ in range(round(60 * LENGTHS.get(name, 16.0 if name == "two_fingers" else 7.0))):
                session.step()
                poses.append(session.state["poses"][0])
        self.samples, self.poses = session.haptic, np.array(poses)
        self.scores = [row.get("score") for row in session.trials]


@pytest.mark.parametrize("name", PLAYED)
def test_the_run_on_the_left_is_the_mirror_image_of_the_one_on_the_right(name: str) -> None:
    right, left = (Played(name, side) for side in ("right", "left"))
    for column in ("hip_world", "v_world", "f_virt_world", "f_user_world"):
        image = right.samples[column] * [-1.0, 1.0, 1.0]
        assert np.abs(image - left.samples[column]).max() <= EQUAL, column
    assert np.ptp(right.samples["hip_world"][:, 0]) > 0.02, "the hand went to the side"
    joints = right.samples["q"][:, :3] * [1.0, -1.0, 1.0]  # the robot is the same one, and turns the other way
    assert np.abs(joints - left.samples["q"][:, :3]).max() <= EQUAL
    if right.poses.size:
        assert np.abs(right.poses[..., :3] * [-1.0, 1.0, 1.0] - left.poses[..., :3]).max() <= EQUAL
    assert left.scores == pytest.approx(right.scores)


def _shown(scene: Scene) -> dict[str, Any]:
    """Extent of every model and body that is seen, by the entity of the scene."""
    world = build_world(scene)
    names = {name.removesuffix(".mirrored") for name, mesh, _ in scene.components(MeshComponent) if mesh.source}
    world.update()
    return {name: world_extent(world, world.find(name).index) for name in sorted(names) if name in world}


def test_what_is_seen_is_the_mirror_image() -> None:
    right, left = (_shown(load_checked_scene("pick_and_place", edit=edit)) for edit in (None, LEFT))
    assert right.keys() == left.keys() and {"stall", "bed", "own_arm", "obstacle_1", "tree_left"} <= right.keys()
    for name in right.keys() - {"encourager"}:  # a person keeps their left and right, at the mirrored place
        (low, high), (other_low, other_high) = right[name], left[name]
        assert [-high[0], *low[1:]] == pytest.approx(other_low.tolist(), abs=1e-6), name
        assert [-low[0], *high[1:]] == pytest.approx(other_high.tolist(), abs=1e-6), name


def test_twice_mirrored_is_the_scene_itself_for_all_that_is_felt() -> None:
    for name in ("wavy_tunnel", "pick_and_place", "free_objects", "springs_and_magnets"):
        document = load_checked_scene(name).document
        again = {entity["id"]: entity for entity in mirrored(mirrored(document))["entities"]}
        for entity in document["entities"]:
            felt = {key: value for key, value in entity["components"].items() if key not in ("mesh", "patient")}
            assert {key: again[entity["id"]]["components"][key] for key in felt} == felt, (name, entity["id"])


def test_no_text_of_a_scene_that_is_mirrored_names_a_side() -> None:
    """Texts are not mirrored: what is on the left is then on the right."""
    for file in sorted((root() / "scenes").rglob("*.json")):
        document = json.loads(file.read_text(encoding="utf-8"))
        if "entities" not in document or "parts" in file.parts or why_not_mirrored(load_scene(file).document):
            continue
        task = document.get("task") or {}
        texts = [part.get(name, "") for part in (document, task) for name in ("description", "instructions", "prompt")]
        assert not re.search(r"\b(?:left|right)\b", " ".join([*texts, *task.get("messages", {}).values()])), file.name


def test_the_person_is_mirrored_with_the_scene() -> None:
    scene = load_checked_scene("wavy_tunnel")
    for entity in scene.document["entities"]:
        if "patient" in entity["components"]:
            entity["components"]["patient"] |= {
                "range_of_motion": [0.1, 0.2, 0.3, 0.3, 0.3, 0.3],
                "hearing_left": -40.0,
            }
    (person,) = (
        e["components"]["patient"] for e in mirrored(scene.document)["entities"] if "patient" in e["components"]
    )
    assert person["range_of_motion"][:2] == [0.2, 0.1] and person["hearing_right"] == -40.0 and person["mirrored"]
    assert load_checked_scene("wavy_tunnel", edit=LEFT).first(Patient).mirrored


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("soccer", "a walk has no side"),
        ("avatar_cord", "both hands"),
        ("calibration", "both sides"),
        ("path_tunnel", "recorded"),
        ("models", "models"),
        ("force_field", "force field"),
        ("wired", "wires"),
    ],
)
def test_a_scene_without_a_mirror_image_is_refused_with_a_word(name: str, why: str) -> None:
    with pytest.raises(UsageError, match=f"cannot be mirrored: .*{why}"):
        load_checked_scene(name, edit=LEFT)


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        ({"robot_to_world": {"translation": [0.1, 0.0, 0.0]}}, "before the middle"),
        ({"robot_to_world": {"rotation": [[1, 0, 0], [0, 0, 1], [0, -1, 0]]}}, "before the middle"),
        ({"device": "simulated_leg"}, "worn on the legs"),
        ({}, ""),
    ],
)
def test_a_robot_that_stands_aside_has_no_mirror_image(robot: dict[str, Any], why: str) -> None:
    document = {"entities": [{"id": "robot", "parent": None, "transform": {}, "components": {"robot": robot}}]}
    assert why in why_not_mirrored(document) and bool(why) == bool(why_not_mirrored(document))


def test_a_second_display_and_a_replay_make_the_same_scene_from_what_they_are_given() -> None:
    scene = load_checked_scene("wavy_tunnel", edit=PersonEdit(Fit(reaches={"left": 0.08}, least_reach=0.2), "left"))
    sent = json.loads(json.dumps(plain_edit(scene)))
    assert MirroredScene("wavy_tunnel", scene.hash, sent).scene.hash == scene.hash
    assert edit_of_plain(sent) == scene.edit and edit_of_plain({}) is None
    with pytest.raises(SceneError, match="another one"):
        MirroredScene("wavy_tunnel", scene.hash)


def test_the_side_of_a_participant_is_that_of_the_form(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[list[str]] = []

    class Run:
        returncode = 1

    def play(command: list[str], **_: Any) -> Run:
        asked.append(command)
        return Run()

    monkeypatch.setattr("mimics_app.app.study.study_runs.subprocess.run", play)
    protocol = {
        "conditions": {"tunnel": {"scene": "wavy_tunnel"}, "ball": {"scene": "soccer"}},
        "blocks": [{"conditions": ["tunnel", "ball"]}],
    }
    study = StudyFolder.create(tmp_path / "study", protocol)
    person = study.find_or_add("P07")
    for answers, sides in (
        ({"hand": "right", "side": "none"}, []),
        ({"hand": "left", "side": "none"}, ["--side=left"]),
        ({"hand": "left", "side": "right"}, []),
        ({"hand": "right", "side": "left"}, ["--side=left"]),
    ):
        study.write_answers(person, "person", 1, answers)
        play_next(study, person, "" if len(asked) == 0 else "restart", [])
        assert [word for word in asked[-1] if word.startswith("--side")] == sides, answers
    play_next(study, person, "abandon", [])
    play_next(study, person, "", [])
    assert "soccer" in asked[-1][4] and not [word for word in asked[-1] if word.startswith("--side")]
