"""A name that leads nowhere is refused before compiled code and graphics are imported, which takes seconds."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("numba", "moderngl", "glfw")
SCRIPT = (
    "import json, sys; from mimics_app.app import cli; code = cli.main(sys.argv[1:]); "
    f"print(json.dumps([code, [name for name in {HEAVY} if name in sys.modules]]))"
)


@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ("run scenes/nowhere.json", 3, "there is no such scene"),
        ("run --device simulated_haptcmaster", 4, 'did you mean "simulated_hapticmaster"'),
        ("run --device pointer:COM3", 4, "it has no address"),
        ("run --device serial:/dev/nowhere@9600", 4, "/dev/nowhere cannot be opened: nothing is there"),
        ("run --device hapticmaster:127.0.0.1:1", 4, "no HapticMaster at 127.0.0.1:1"),
        ("run --physio serial:/dev/nowhere", 4, '"/dev/nowhere" cannot be opened: nothing is there'),
        ("run --physio file:nowhere.csv", 3, "nowhere.csv: there is no such file"),
        ("run --runs /dev/null/runs", 2, "no run folder can be made here: /dev/null is no folder"),
        ("run wavy_tunnel --headless --from-trial 99", 2, "the session has no trial 99; it has 3"),
        ("run wavy_tunnel --headless --from-trial 8 --trials 6", 2, "the session has no trial 8; it has 7"),
        ("run --device replay --recording nowhere", 3, "is no run folder"),
        ("run --action nowhere.json", 3, "nowhere.json: no such file"),
        ("run --display cave:nowhere.json", 3, "nowhere.json: no such file"),
        ("run --learn stair", 2, 'did you mean "staircase"'),
        ("run --learn kalman --goal succes", 2, '"succes" is no goal'),
        ("run --physio sim --estimator ldaa", 2, 'did you mean "lda"'),
        ("render nowhere", 3, "there is no such scene"),
        ("explain nowhere", 3, "there is no such scene"),
        ("check nowhere.json", 3, "there is no such scene"),
        ("view nowhere.json --headless", 3, "there is no such scene"),
        ("view scenes/pick_and_place.json", 4, "no display for a window"),
        ("devices check nowhere", 4, 'there is no device "nowhere"'),
        ("replay nowhere", 3, "is no run folder"),
        ("report nowhere", 3, "is no run folder"),
        ("record info nowhere", 3, "is no run folder"),
        ("sweep nowhere.json", 3, "nowhere.json"),
    ],
)
def test_what_is_not_there_is_refused_before_anything_heavy_is_imported(line: str, code: int, said: str) -> None:
    blind = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *line.split()], capture_output=True, text=True, check=True, env=blind
    )
    assert said in done.stderr
    assert json.loads(done.stdout) == [code, []]


@pytest.mark.parametrize("command", ["check", "explain", "render", "run --headless"])
def test_a_scene_with_a_fault_is_refused_before_anything_heavy_is_imported(command: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "entities": [{"id": "a", "part": 1}]}))
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *command.split(), str(file)], capture_output=True, text=True, check=True
    )
    assert 'unknown key "part"' in done.stderr
    assert json.loads(done.stdout) == [3, []]
