"""The guide of models that move, its example and its command: every piece does what the text says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.system.resources import root
from mimics_app.world.files.scene.file import build_world, load_scene
from tests.support.gltf_maker import write_gltf
from tests.support.guide import pieces, written_module
from tests.support.person_maker import PLACES, person
from tests.support.skin_maker import add_clip, turn

PIECES = pieces(root() / "docs" / "guide" / "avatars.md")


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A person of sticks who can stand idle and wave the left arm."""
    maker = person()
    arm = 1 + [node["name"] for node in maker.more["nodes"][1:]].index("leftUpperArm")
    add_clip(maker, "wave", [(arm, "rotation", [0.0, 1.0], [turn("z", 0), turn("z", 90)], "LINEAR")])
    add_clip(maker, "idle", [(1, "rotation", [0.0, 1.0], [turn("y", 0), turn("y", 5)], "LINEAR")])
    return write_gltf(tmp_path / "person.gltf", maker.document())


def _piece(purpose: str) -> str:
    return next(piece.text for piece in PIECES if piece.purpose == purpose)


def test_the_scene_of_the_guide_greets_when_the_goal_is_met(tmp_path: Path, model: Path) -> None:
    document = {"format": "mimics-scene", "version": 1, "scenario": "none", "assets": {"person": {"uri": model.name}}}
    camera = {"id": "eye", "transform": {"translation": [1.0, 1.6, 2.0]}, "components": {"camera": {}}}
    scene = {**document, "entities": [json.loads(_piece("entity")), camera]}
    world = build_world(load_scene(write_gltf(tmp_path / "scene.json", scene)))
    (machine,) = world.motion.machines.values()
    hand = world.find("friend/leftHand")
    before = hand.world_matrix()[1, 3]
    world.motion.trigger("goal")
    world.motion.time = 0.7
    world.update()
    assert machine.state == "cheer" and hand.world_matrix()[1, 3] > before + 0.2


def test_the_python_of_the_guide_runs(tmp_path: Path, model: Path) -> None:
    found = {piece.purpose: piece for piece in PIECES if piece.language == "python"}
    heights = written_module(tmp_path, found["walk"]).poses(model)
    assert len(heights) == 30 and max(heights) > min(heights) + 0.2
    assert callable(written_module(tmp_path, found["capture"]).add_take)
    module = written_module(tmp_path, found["trackers"])
    from mimics_app.world.files.scene.model_world import load_model_world

    person = next(iter(load_model_world(model).motion.animators.values()))
    module.follow(person, module.Trackers(np.array([0.0, 1.5, 0.1, 0, 0, 0, 1.0])))
    person.step(0.1)
    assert not np.allclose(person.pose.rotations, person.rig.rest.rotations)


def test_the_example_draws_the_clip(tmp_path: Path, model: Path) -> None:
    import importlib.util

    file = root() / "examples" / "moving_model" / "moving_model.py"
    assert len(file.read_text(encoding="utf-8").splitlines()) <= 60
    spec = importlib.util.spec_from_file_location("moving_model", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    files = module.draw(model, "wave", "leftHand", tmp_path / "frames", frames=3)
    assert len({path.read_bytes() for path in files}) == 3


def test_the_command_says_what_it_took_for_what(
    model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["avatar", "import", str(model), "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    assert reported["command"] == "avatar" and reported["bones"]["leftHand"] == "leftHand" and reported["missing"] == []
    other = write_gltf(tmp_path / "other.gltf", person({"head": "skull"}, back=True).document())
    assert main(["avatar", "import", str(other)]) == 0
    told = capsys.readouterr().out
    assert 'guessed: head: "skull", by its place' in told and "looks along -z in the file and is turned" in told
    places = {bone: place for bone, place in PLACES.items() if "Leg" not in bone and "Foot" not in bone}
    places = {bone: place for bone, place in places.items() if "Toes" not in bone}
    assert main(["avatar", "import", str(write_gltf(tmp_path / "half.gltf", person(places=places).document()))]) == 3
    assert "missing: leftUpperLeg" in capsys.readouterr().out
