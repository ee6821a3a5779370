"""The warm-up leaves no shipped scene to be compiled by its first run."""

from __future__ import annotations

import functools
import json
import os
from typing import Any

import pytest

from mimics_app.app import cli
from mimics_app.app.commands import warmup
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.system.resources import root


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the scenes whose loop is played without a picture."""
    names: list[str] = []
    monkeypatch.setattr(warmup, "PARTS", {})
    monkeypatch.setattr(warmup, "compile_beside", lambda tasks: [task() or name for name, task in tasks.items()])
    monkeypatch.setattr(warmup, "_play_start", lambda scene: names.append(scene.path.name))
    return names


def test_every_shipped_scene_is_drawn(
    monkeypatch: pytest.MonkeyPatch, played: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    drawn: list[str] = []
    monkeypatch.setattr(
        "mimics_app.app.play.stills.draw_stills", lambda settings, folder, seconds: drawn.append(settings.scene.name)
    )
    assert cli.main(["warmup", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["seconds"] >= 0.0
    assert sorted(drawn) == sorted(file.name for file in (root() / "scenes").glob("*.json"))
    assert drawn[0] == "avatar_gallery.json", "what has no loop waits for none"
    assert played == []


def test_where_nothing_draws_the_loops_are_compiled_all_the_same(
    monkeypatch: pytest.MonkeyPatch, played: list[str]
) -> None:
    """A scene that nobody plays has no loop."""

    def refuse(*_: Any, **__: Any) -> None:
        raise DeviceError("there is no way to draw")

    monkeypatch.setattr("mimics_app.app.play.stills.draw_stills", refuse)
    assert cli.main(["warmup", "--json"]) == 0
    assert played == [
        "avatar_cord.json",
        "calibration.json",
        "canyon_walk.json",
        "city_walk.json",
        "guided_walk.json",
        "pick_and_place.json",
        "soccer.json",
        "wavy_tunnel.json",
    ]


def test_large_parts_are_compiled_in_processes_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    assert sorted(warmup.PARTS) == ["devices", "loop", "objects"]
    assert sorted(warmup.compile_beside({"one": os.getpid, "other": os.getppid})) == ["one", "other"]
    with pytest.raises(ValueError, match="no number"):
        list(warmup.compile_beside({"none": functools.partial(int, "no number")}))
