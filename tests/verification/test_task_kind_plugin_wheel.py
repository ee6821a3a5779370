"""A third kind of task, built as its own wheel and installed beside the product: scene, board, score and report."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "task_kind_plugin"
SCENE = str(EXAMPLE / "reach.json")


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel in it, for the module path: no registry is asked."""
    folder = tmp_path_factory.mktemp("kind")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder / "wheel")]
    subprocess.run(command, cwd=EXAMPLE, check=True, capture_output=True)
    with ZipFile(next((folder / "wheel").glob("*.whl"))) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def _mimics(site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": f"{site}{os.pathsep}{ROOT}"}
    command = [sys.executable, "-m", "mimics_app", *arguments]
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def answer(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    runs = str(tmp_path_factory.mktemp("runs"))
    done = _mimics(
        installed, "run", SCENE, "--headless", "--seconds", "25", "--pictures", "0", "--runs", runs, "--json"
    )
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def test_it_has_at_most_120_lines() -> None:
    assert len((EXAMPLE / "reach_targets.py").read_text(encoding="utf-8").splitlines()) <= 120


def test_its_scene_is_played_and_scored(answer: dict[str, Any]) -> None:
    task = answer["task"]
    assert (task["completed"], task["trials"], task["reached"]) == (1, 1, 3)
    assert task["detour_m"] > 0.0 and 0.0 < task["score"] <= 100.0
    with (Path(answer["run_dir"]) / "trials.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["reached"], row["outcome"]) == ("3", "finished") and "drops" not in row


def test_its_section_stands_in_the_report(answer: dict[str, Any]) -> None:
    page = Path(answer["report"]).read_text(encoding="utf-8")
    for words in ("<h2>Reaching</h2>", "targets reached", "detour", "slowest"):
        assert words in page, words


def test_what_is_wrong_with_its_scene_is_said_with_the_place(installed: Path, tmp_path: Path) -> None:
    scene = json.loads(Path(SCENE).read_text(encoding="utf-8"))
    scene["task"]["reach"] = {"targets": ["yellow_lmp"], "within": 7}
    file = tmp_path / "wrong.json"
    file.write_text(json.dumps(scene))
    done = _mimics(installed, "check", str(file))
    assert done.returncode == 3 and "#/task/reach/within: " in done.stderr
    scene["task"]["reach"]["within"] = 0.02
    file.write_text(json.dumps(scene))
    done = _mimics(installed, "check", str(file))
    assert '#/task/reach/targets/0: no entity is called "yellow_lmp"; did you mean "yellow_lamp"' in done.stderr


def test_without_the_wheel_its_words_are_unknown(tmp_path: Path) -> None:
    done = _mimics(tmp_path, "check", SCENE)
    assert done.returncode == 3
    assert '#/task/reach: unknown key "reach"' in done.stderr
    assert '#/task/goals/0/kind: "all_reached" is not possible here' in done.stderr
    assert '/components/hud/show/0: "targets" is not possible here' in done.stderr
