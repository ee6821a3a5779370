"""A name that leads nowhere is refused before compiled code and graphics are imported, which takes seconds."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import pytest

from mimics_app.app.cli import main
from mimics_app.app.scenes.scene_search import find_file
from mimics_app.contracts.system.resources import root

HEAVY = {"numba", "moderngl", "glfw"}
REFUSED = (
    ("run scenes/nowhere.json", 3, "scene not found"),
    ("run --device simulated_haptcmaster", 4, 'did you mean "simulated_hapticmaster"'),
    ("run --device pointer:COM3", 4, "has no address"),
    ("run --device serial:/dev/nowhere@9600", 4, "/dev/nowhere cannot be opened: nothing is there"),
    ("run --device hapticmaster:127.0.0.1:1", 4, "no HapticMaster at 127.0.0.1:1"),
    ("run --physio serial:/dev/nowhere", 4, '"/dev/nowhere" cannot be opened: nothing is there'),
    ("run --physio file:nowhere.csv", 3, "nowhere.csv: no such file"),
    ("run --runs /dev/null/runs", 3, "a run folder cannot be created here: /dev/null is not a folder"),
    ("run --runs /proc/nope", 3, "a run folder cannot be created here"),
    ("run --video /proc/nope/x.mp4", 3, "/proc/nope/x.mp4: cannot be written"),
    ("render city_walk --output /proc/nope", 3, "/proc/nope: cannot be written"),
    ("sweep patients.json --out /proc/nope/x.parquet", 3, "/proc/nope/x.parquet: cannot be written"),
    ("lab chart --out /dev/null/charts", 3, "/dev/null is not a folder"),
    ("study wavy_tunnel --out /proc/nope", 3, "/proc/nope: cannot be written"),
    ("assets levels nowhere.glb", 3, "nowhere.glb: no such file"),
    ("assets levels assets/models/touch/bowl.glb --out /proc/nope", 3, "/proc/nope: cannot be written"),
    ("avatar import nowhere.glb", 3, "nowhere.glb: no such file"),
    ("avatar make --height 172", 2, "172 is not a height from 1.2 to 2.2 m"),
    ("avatar make --height 1.7 --weight 70 --sex f --out p.glb", 2, "make needs --age"),
    ("run city_walk --headless --avatar nowhere.glb", 3, "nowhere.glb: no such file"),
    ("physio sim:severre", 2, 'did you mean "severe"'),
    ("physio nowhere.csv", 3, "nowhere.csv: no such file"),
    ("physio sim --page /proc/nope/x.html", 3, "/proc/nope/x.html: cannot be written"),
    ("devices emulate nowhere", 2, 'there is no emulator of "nowhere"'),
    ("run --participant Anna", 2, "this looks like a name"),
    ("--versoin", 2, 'did you mean "--version"'),
    ("run wavy_tunnel --headless --from-trial 99", 2, "the session has no trial 99; it has 3"),
    ("run wavy_tunnel --headless --from-trial 8 --trials 6", 2, "the session has no trial 8; it has 7"),
    ("run --device replay --recording nowhere", 3, "is not a run folder"),
    ("run --action nowhere.json", 3, "nowhere.json: no such file"),
    ("run --display cave:nowhere.json", 3, "nowhere.json: no such file"),
    ("run --learn stair", 2, 'did you mean "staircase"'),
    ("run --learn kalman --goal succes", 2, 'unknown goal "succes"'),
    ("run --learn kalman --goal arousal:-0.2:0.3", 2, "these can: linucb, thompson"),
    ("run --physio sim --estimator ldaa", 2, 'did you mean "lda"'),
    ("render nowhere", 3, "scene not found"),
    ("explain nowhere", 3, "scene not found"),
    ("check nowhere.json", 3, "scene not found"),
    ("view nowhere.json --headless", 3, "scene not found"),
    ("view nowhere.glb", 3, "nowhere.glb: no such file"),
    ("view scenes/pick_and_place.json --motion nowhere.bvh", 3, "nowhere.bvh: no such file"),
    ("view scenes/pick_and_place.json", 4, "the viewer needs a display"),
    ("devices check nowhere", 4, 'there is no device "nowhere"'),
    ("replay nowhere", 3, "is not a run folder"),
    ("report nowhere", 3, "is not a run folder"),
    ("record info nowhere", 3, "is not a run folder"),
    ("sweep nowhere.json", 3, "nowhere.json"),
)
"""Line, exit code, and words of what is said."""

FAULTY = ("check", "explain", "render", "run --headless")
"""Commands that are given a scene with a fault."""

_SCRIPT = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from mimics_app.app import cli
for line in json.load(sys.stdin):
    before = set(sys.modules)
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as said:
        code = cli.main(line or [])
    print(json.dumps([code, sorted(set(sys.modules) - before), said.getvalue()]))
"""


class Refusal(NamedTuple):
    """What one command of several came to: its exit code, what it imported first, what it said."""

    code: int
    imported: list[str]
    said: str


def _answers(lines: Iterable[str | list[str]], **environment: str) -> list[Refusal]:
    """What the lines of one process come to that has no display but one that is given."""
    words = [line.split() if isinstance(line, str) else line for line in lines]
    blind = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    command = [sys.executable, "-c", _SCRIPT]
    done = subprocess.run(
        command, input=json.dumps(words), capture_output=True, text=True, check=True, env=blind | environment
    )
    return [Refusal(*json.loads(answer)) for answer in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def refusals(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Refusal]:
    """By line, or by the command alone, of one process that has no display: heavy modules would stay in it."""
    file = tmp_path_factory.mktemp("faulty") / "scene.json"
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "entities": [{"id": "a", "part": 1}]}))
    asked = {line: line.split() for line, _, _ in REFUSED} | {
        command: [*command.split(), str(file)] for command in FAULTY
    }
    return dict(zip(asked, _answers(asked.values()), strict=True))


@pytest.mark.seconds
@pytest.mark.parametrize(("line", "code", "said"), REFUSED)
def test_what_is_not_there_is_refused_before_anything_heavy_is_imported(
    refusals: dict[str, Refusal], line: str, code: int, said: str
) -> None:
    refusal = refusals[line]
    assert said in refusal.said
    assert refusal.code == code and not HEAVY & set(refusal.imported)


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [_Terminal(), io.StringIO()], ids=["terminal", "file"])
def test_a_run_says_on_a_terminal_at_once_what_it_loads(monkeypatch: pytest.MonkeyPatch, stream: io.StringIO) -> None:
    monkeypatch.setattr(sys, "stderr", stream)
    assert main(["run", "scenes/nowhere.json"]) == 3
    assert stream.getvalue().startswith("mimics: loading nowhere: touch, sound, picture\n") == stream.isatty()
    assert "scene not found" in stream.getvalue()


@pytest.mark.parametrize("command", FAULTY)
def test_a_scene_with_a_fault_is_refused_before_anything_heavy_is_imported(
    refusals: dict[str, Refusal], command: str
) -> None:
    refusal = refusals[command]
    assert 'unknown key "part"' in refusal.said
    assert refusal.code == 3 and not HEAVY & set(refusal.imported)


@pytest.mark.parametrize("line", ["run wavy_tunnel", ""], ids=["run", "launcher"])
def test_a_screen_that_does_not_answer_is_said_before_a_picture_is_made(line: str) -> None:
    (refusal,) = _answers([line], DISPLAY=":9977")
    assert "no screen answers at DISPLAY=:9977" in refusal.said and refusal.code == 4
    assert not {"numba", "moderngl"} & set(refusal.imported)


def test_the_list_of_experiments_does_not_wait_for_the_loop() -> None:
    (refusal,) = _answers(["sweep --list"])
    assert refusal.code == 0 and not HEAVY & set(refusal.imported)


def test_files_of_the_readme_are_found_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("assets/models/market/apple.glb", "assets/models/touch/bowl.glb", "assets/models"):
        assert find_file(Path(name)) == root() / name
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "models").mkdir()
    assert find_file(Path("assets/models")) == Path("assets/models"), "one's own comes first"
    assert find_file(Path("nowhere.glb")) == Path("nowhere.glb")


@pytest.mark.seconds
@pytest.mark.parametrize("command", ["render", "view --output x.png"])
def test_a_misspelt_camera_is_refused_before_a_picture_is_made(command: str) -> None:
    (refusal,) = _answers([f"{command} city_walk --camera crosing"])
    assert refusal.code == 3 and 'did you mean "crossing"' in refusal.said
    assert not HEAVY & set(refusal.imported)
