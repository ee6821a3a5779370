"""A third kind of task, built as its own wheel and installed beside the product: scene, board, score and report."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from tests.support.command import Answer, mimics, mimics_with
from tests.support.plugin_site import build_wheel

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "task_kind_plugin"
SCENE = str(EXAMPLE / "reach.json")


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel in it, for the module path: no registry is asked."""
    return build_wheel(EXAMPLE, tmp_path_factory.mktemp("kind"))


@pytest.fixture(scope="module")
def answers(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What commands say with the wheel installed: of a run, of a wrong size, of a name that nothing has."""
    folder = tmp_path_factory.mktemp("runs")
    scene = json.loads(Path(SCENE).read_text(encoding="utf-8"))
    options = ("--headless", "--seconds", 25, "--pictures", 0, "--runs", folder, "--json")
    commands: dict[str, tuple[object, ...]] = {"run": ("run", SCENE, *options)}
    for name, within in (("within", 7), ("targets", 0.02)):
        scene["task"]["reach"] = {"targets": ["yellow_lmp"], "within": within}
        file = folder / f"{name}.json"
        file.write_text(json.dumps(scene))
        commands[name] = ("check", file)
    return dict(zip(commands, mimics_with(installed, *commands.values()), strict=True))


@pytest.fixture
def answer(answers: dict[str, Answer]) -> dict[str, Any]:
    done = answers["run"]
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


def test_what_is_wrong_with_its_scene_is_said_with_the_place(answers: dict[str, Answer]) -> None:
    done = answers["within"]
    assert done.returncode == 3 and "#/task/reach/within: " in done.stderr
    done = answers["targets"]
    assert '#/task/reach/targets/0: no entity "yellow_lmp"; did you mean "yellow_lamp"' in done.stderr


def test_without_the_wheel_its_words_are_unknown() -> None:
    done = mimics("check", SCENE)
    assert done.returncode == 3
    assert '#/task/reach: unknown key "reach"' in done.stderr
    assert '#/task/goals/0/kind: "all_reached" is not possible here' in done.stderr
    assert '/components/hud/show/0: "targets" is not possible here' in done.stderr
