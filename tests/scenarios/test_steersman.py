"""A source of commands of another package, and a view that a scene file adds: no file of the product changes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.app.session.core import open_core
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.ports.command_port import open_steersman
from mimics_app.contracts.system.resources import root
from tests.scenarios.test_steered_session import Journal
from tests.support.core_play import CorePlay
from tests.support.plugin_site import write_package

LAB = """
from mimics_app.contracts.commands.vocabulary import Mark, Pause, Reset, View

class Pilot:
    told = []
    def __init__(self): self.frames = 0
    def step(self, snapshot, view, now_ns):
        self.frames += 1
        if self.frames == 5:
            raise ValueError("no more fuel")
        return {1: [View("from_above")], 2: [Pause(), Reset()], 3: [Mark(view.state.value)]}.get(self.frames, ())
    def refused(self, command, why): self.told.append(why)
    def close(self): self.told.append("closed")
"""


def _scene(folder: Path) -> Path:
    """The wavy tunnel with one more entity, which has a camera."""
    scene = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text())
    camera = {"id": "from_above", "transform": {"translation": [0, 2, 0]}, "components": {"camera": {}}}
    scene["entities"].append(camera)
    file = folder / "wavy_tunnel.json"
    file.write_text(json.dumps(scene))
    return file


def test_a_program_of_another_package_steers_to_a_view_that_a_scene_adds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    point = "[mimics_app.command_sources]\npilot = lab_that_flies:Pilot\n"
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_that_flies", LAB, point)))
    scene = check_scene(read_scene(_scene(tmp_path)))
    play = CorePlay(open_core(prepare_scene(scene, RunSettings(scene.path, seed=2, steer="pilot")), Journal))
    said: list[str] = []
    with play.core:
        play.core.report = said.append
        for _ in range(7):
            play.step()
        assert play.core.view == "from_above"
    lines = [line for kind, line in play.recorder.lines if kind == "command"]
    assert [(line["command"], line["from"], line["who"], line["done"]) for line in lines] == [
        ("view", "python", "pilot", True),
        ("pause", "python", "pilot", True),
        ("reset", "python", "pilot", False),
        ("mark", "python", "pilot", True),
    ]
    import lab_that_flies

    assert lab_that_flies.Pilot.told == ["no stop is latched", "closed"]
    assert len(said) == 1 and "raised ValueError: no more fuel" in said[0] and "not asked again" in said[0]


def test_a_program_that_nobody_installed_is_named() -> None:
    with pytest.raises(UsageError, match='no source of commands "nobody"'):
        open_steersman("nobody")
