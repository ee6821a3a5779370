"""The scenes that come with the product: found by name, described in words, each with a picture of its own."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimics_app.app import cli
from mimics_app.app.play.launching import (
    last_choice,
    launcher_cards,
    launcher_settings,
    refusals,
    remember,
    settings_of_choice,
)
from mimics_app.app.scenes import shipped
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.scenes.shipped import GROUPS, find_shipped, shipped_scenes, thumbnail_of
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
from mimics_app.tasks.task import TaskSpec
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.reading.paths import SHIPPED
from mimics_app.world.files.scene.file import load_scene


def test_every_shipped_scene_is_listed_with_what_it_takes(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["scenes", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["scenes"]
    files = {path.stem for folder in ("", "examples") for path in (root() / "scenes" / folder).glob("*.json")}
    assert {row["name"] for row in rows} == files and {row["group"] for row in rows} == set(GROUPS)
    assert all(row["title"] and row["description"] and row["takes"] for row in rows)
    assert {row["name"]: row["lasts"] for row in rows}["wavy_tunnel"] == "2 trials, up to 4 min"
    assert {row["name"]: row["lasts"] for row in rows}["avatar_cord"] == "4 trials, about 10 min"
    assert all(bool(row["lasts"]) is (row["group"] != "places") for row in rows)
    assert cli.main(["scenes"]) == 0
    assert "wavy_tunnel" in capsys.readouterr().out


def test_the_usual_length_of_a_trial_is_the_tasks_own() -> None:
    assert shipped._SECONDS == TaskSpec().time_limit_s


def test_what_begins_the_place_of_a_shipped_file_is_that_of_the_reader() -> None:
    assert shipped._SHIPPED == SHIPPED


def test_other_devices_of_a_scene_are_those_of_its_files() -> None:
    for name, devices in (("canyon_walk", ("lokomat",)), ("free_objects", ())):
        scene = find_shipped(name)
        assert scene is not None and scene.also == load_scene(scene.file).devices == devices


def test_a_walk_may_be_started_with_the_orthosis_and_not_with_a_leg() -> None:
    walk = find_shipped("canyon_walk")
    assert walk is not None
    refused = {value for _, value in refusals(walk)}
    assert "lokomat" not in refused and "simulated_leg" in refused


@pytest.mark.parametrize("asked", ["free_objects", "examples/free_objects", "scenes/examples/free_objects.json"])
def test_a_scene_is_found_by_name_from_anywhere(asked: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert find_scene(Path(asked)) == root() / "scenes" / "examples" / "free_objects.json"


def test_a_name_that_is_nearly_right_is_answered_with_the_right_one() -> None:
    for wrong in ("fre_objects", "tasks/free_objects.json"):
        with pytest.raises(SceneError, match='did you mean "free_objects"'):
            find_scene(Path(wrong))


@pytest.mark.parametrize("scene", shipped_scenes(), ids=lambda scene: scene.name)
def test_every_scene_has_a_picture_of_its_own(scene: shipped.ShippedScene) -> None:
    with Image.open(thumbnail_of(scene.name)) as picture:
        assert picture.size == (512, 288)
        rows = np.asarray(picture.convert("RGB"), float)
    across = np.abs(np.diff(rows, axis=1)).max(axis=-1)
    assert (across > 24.0).sum() > 200, "a gradient has no edges"


def test_pictures_are_small() -> None:
    assert sum(thumbnail_of(scene.name).stat().st_size for scene in shipped_scenes()) < 2_000_000


@pytest.fixture
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "mimics" / "launcher.json"


def chosen(**values: str) -> LauncherChoice:
    scene = find_shipped("wavy_tunnel")
    assert scene is not None
    return LauncherChoice(scene.file, {each.name: each.default for each in launcher_settings()} | values)


def test_the_last_choice_is_remembered(config: Path) -> None:
    assert last_choice() is None
    remember(chosen(participant="P7", device="serial", address="/dev/ttyUSB3"))
    assert last_choice() == chosen(participant="P7", device="serial", address="/dev/ttyUSB3")
    config.write_text("{")
    assert last_choice() is None
    config.unlink()
    os.rmdir(config.parent)
    config.parent.touch()  # no folder can be made there
    remember(chosen())
    assert last_choice() is None


def test_settings_become_those_of_a_run() -> None:
    settings = settings_of_choice(
        chosen(device="serial", address="/dev/ttyUSB3", patient="severe", trials="5", difficulty="easier", sound="off")
    )
    assert (settings.device, settings.patient) == ("serial:/dev/ttyUSB3", ""), "a robot has no simulated patient"
    assert (settings.trials, settings.difficulty, settings.sound, settings.display) == (5, "easier", "off", "")
    by_mouse = settings_of_choice(chosen(address="/dev/ttyUSB3"))
    assert (by_mouse.device, by_mouse.trials, by_mouse.participant) == ("", 0, "")


def test_sessions_played_lately_are_cards_with_their_score(tmp_path: Path) -> None:
    for day, score in ((1, 60.0), (2, 75.0)):
        folder = tmp_path / f"2026010{day}T101500Z_x"
        folder.mkdir()
        header = {
            "scene": {"name": "wavy_tunnel"},
            "settings": {"participant": "P1"},
            "clock": {"utc": f"2026-01-0{day}T10:15:00+00:00"},
        }
        task = {"completed": 1, "trials": 2, "score": score, "time_s": 3.25}
        manifest = {"status": "clean", "state_hash": "", "rows": 0, "events": 0, "trials": 0, "parameters": 0}
        (folder / "session.json").write_text(json.dumps(header))
        (folder / "manifest.json").write_text(json.dumps({**manifest, "summary": {"task": task}}))
    cards = launcher_cards(tmp_path)
    assert next(card for card in cards if card.scene.stem == "wavy_tunnel").badge == "last: 75 of 100"
    recent = [card for card in cards if card.group == "Recent"]
    assert [card.badge for card in recent] == ["75 of 100", "60 of 100"]
    assert recent[0].description == "1 of 2 trials finished, mean time 3.2 s."
    assert "2026-01-02" in recent[0].facts and recent[0].facts.endswith("P1")


def test_a_scene_that_is_only_looked_at_needs_a_display_and_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert cli.main(["run", "lanterns"]) == 4
    assert "without one: mimics view" in capsys.readouterr().err


@pytest.mark.parametrize("scene", [each for each in shipped_scenes() if each.lasts], ids=lambda scene: scene.name)
def test_every_task_says_what_to_do(scene: shipped.ShippedScene) -> None:
    """On a page of its own before the first trial; a task without another line says it during a trial too."""
    task = json.loads(scene.file.read_text())["task"]
    assert 20 < len(task["instructions"]) < 240 and task["instructions"].endswith((".", "?"))
    if [goal["kind"] for goal in task.get("goals", ())] == ["duration"]:
        assert task["prompt"] and not task["prompt"].endswith(".")


def test_a_scene_without_a_robot_of_its_own_has_the_usual_one() -> None:
    assert Robot().device == shipped.SIMULATED
