"""Play from the editor: what is on the screen is what is played, and nothing stays of it."""

from __future__ import annotations

import json
import subprocess
import sys
import time

import pytest

from mimics_app.app.viewer import played_scene
from mimics_app.app.viewer.edited_scene import EditedScene
from mimics_app.app.viewer.played_scene import PlayedScene
from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.scene.file import load_scene

PART = '{"format": "mimics-scene", "version": 1, "entities": [{"id": "lamp", "components": {"light": {}}}]}'
WHOLE = '{"format": "mimics-scene", "version": 1, "include": ["part.json"], "entities": [{"id": "own"}]}'


@pytest.fixture
def edited(tmp_path):
    (tmp_path / "part.json").write_text(PART)
    (tmp_path / "whole.json").write_text(WHOLE)
    return EditedScene(open_shown(tmp_path / "whole.json"))


@pytest.fixture
def started(monkeypatch):
    """Commands that were started; in their place runs a child that says two lines and fails."""
    commands = []
    begin = subprocess.Popen

    def start(command, **streams):
        commands.append(command)
        return begin([sys.executable, "-c", "print('first'); print('no device'); raise SystemExit(4)"], **streams)

    monkeypatch.setattr(played_scene.subprocess, "Popen", start)
    return commands


def wait_for(played):
    end = time.monotonic() + 60.0
    while (outcome := played.outcome()) is None:
        assert time.monotonic() < end
        time.sleep(0.02)
    return outcome


def test_a_saved_scene_is_played_from_its_file(edited, started, tmp_path):
    assert wait_for(PlayedScene(edited)) == "no device", "why it failed"
    assert started[0][3:5] == ["run", str(tmp_path / "whole.json")]


def test_the_editor_hears_what_the_session_does_and_why_it_ended(edited, monkeypatch):
    said = (
        "import sys; from pathlib import Path; from mimics_app.app.play.journey_log import JourneyLog;"
        "from mimics_app.contracts.errors import DeviceError; log = JourneyLog(Path(sys.argv[1]));"
        "log.doing('Making the picture'); sys.stdin.read(1); log.shown(); sys.stdin.read(1)\n"
        "with log.reporting(): raise DeviceError('the robot is away')"
    )
    begin, children = subprocess.Popen, []

    def start(command, **streams):
        log = command[command.index("--journey") + 1]
        children.append(begin([sys.executable, "-c", said, log], stdin=subprocess.PIPE, **streams))
        return children[0]

    monkeypatch.setattr(played_scene.subprocess, "Popen", start)
    played = PlayedScene(edited)
    for words in ("Making the picture", ""):
        end = time.monotonic() + 60.0
        while played.doing != words:
            assert time.monotonic() < end
            time.sleep(0.02)
        if words:
            assert played.outcome() is None
        children[0].stdin.write(b" ")
        children[0].stdin.flush()
    assert wait_for(played) == "the robot is away"


def test_unsaved_edits_are_played_from_a_file_beside_that_goes_at_the_end(edited, started, tmp_path):
    edited.move("own", (1.0, 2.0, 3.0))
    edited.apply()
    played = PlayedScene(edited)
    file = tmp_path / "whole as edited.json"
    assert started[0][4] == str(file)
    copy = load_scene(file)
    assert (copy.hash, copy.name, copy.scenario) == (edited.scene.hash, "whole", "whole")
    with pytest.raises(SceneError, match="File exists"):
        PlayedScene(edited)
    played.end()
    assert sorted(each.name for each in tmp_path.iterdir()) == ["part.json", "whole.json"]
    assert (tmp_path / "whole.json").read_text() == WHOLE, "it was not saved by that"


def test_what_a_killed_viewer_has_left_is_taken_over_and_a_file_of_somebody_else_is_not(edited, started, tmp_path):
    edited.move("own", (1.0, 2.0, 3.0))
    edited.apply()
    file, ended = tmp_path / "whole as edited.json", subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    for words in (WHOLE, "", "[1]", json.dumps({"x-viewer": "me"}), json.dumps({"x-viewer": 10**30})):
        file.write_text(words)
        with pytest.raises(SceneError, match="File exists"):
            PlayedScene(edited)
        assert file.read_text() == words
    file.write_text(json.dumps({"x-viewer": ended.pid}))
    assert wait_for(PlayedScene(edited)) == "no device" and not file.exists()


def test_edits_of_an_included_file_have_to_be_saved_first(edited, started):
    edited.move("lamp", (1.0, 2.0, 3.0))
    edited.apply()
    with pytest.raises(SceneError, match=r"part\.json: has edits that are not saved"):
        PlayedScene(edited)
    assert not started
