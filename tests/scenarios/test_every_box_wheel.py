"""One package replaces each box of D2.1 Figure 1 by entry points: built as its own wheel, it plays the tunnel."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import pytest

from mimics_app.contracts.loop.controller_slots import Slot, names_in
from mimics_app.recording.run import Run
from tests.support.command import Answer, mimics_with
from tests.support.plugin_site import build_wheel

EXAMPLE = Path(__file__).parents[2] / "examples" / "figure_1_plugin"
SCENE = EXAMPLE / "every_box.json"
SIGNALS = ("--physio", "belt:", "--baseline-s", 2, "--estimator", "by_stretch", "--learn", "calm_steps")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel in it, for the module path: no registry is asked."""
    return build_wheel(EXAMPLE, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def played(site: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Answer, Path]:
    """What the run says, and its folder."""
    options = ("--headless", "--seconds", 14, "--pictures", 1, "--size", "320x180", "--json")
    runs = tmp_path_factory.mktemp("runs")
    (done,) = mimics_with(site, ("run", SCENE, *options, *SIGNALS, "--goal", "success:0.7", "--runs", runs))
    assert done.returncode == 0, done.stderr
    return done, Path(json.loads(done.stdout)["run_dir"])


def test_no_module_has_more_than_80_lines() -> None:
    lengths = {path.name: len(path.read_text(encoding="utf-8").splitlines()) for path in EXAMPLE.rglob("*.py")}
    assert len(lengths) == 13 and max(lengths.values()) <= 80, lengths


def test_the_lines_of_its_page_name_settings_and_the_scene() -> None:
    (lines,) = re.findall(r"```python\n(.*?)```", (EXAMPLE / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, Any] = {}
    exec(lines.partition("with mimics")[0], names)
    opened = re.search(r"open\(scene, (.*), \*\*signals\)", lines)
    assert opened is not None and EXAMPLE.parents[1] / names["scene"] == SCENE
    given = {*names["signals"], *re.findall(r"(\w+)=", opened[1])}
    assert {f"--{name.replace('_', '-')}" for name in given} == {*SIGNALS[::2], "--goal", "--seconds"}


def test_the_tunnel_is_played_with_all_of_them(played: tuple[Answer, Path]) -> None:
    done, folder = played
    result: dict[str, Any] = json.loads(done.stdout)
    run = Run.open(folder)
    assert result["task"]["practice"]["completed"] == 1, "its device and its controller bring the ball to the goal"
    assert result["unread"] == [], "its scenario reads its component"
    assert result["audio"]["mixer"] == "night" and result["audio"]["sounds"] > 0
    assert run.session["moved_by"]["device"] == "led_handle"
    block = run.parameters[max(run.parameters)][0]
    assert names_in(block["controller_names"])[Slot.PERSON] == "heavy_mass"
    with (folder / "trials.csv").open(newline="") as file:
        assert float(next(csv.DictReader(file))["lingering_s"]) > 0.0
    depths = [line["values"]["stretch_range"] for line in run.lines_of("app", "features")]
    assert len(depths) > 8 and max(depths) < 4.5, "the belt moves by 4 mm in all"
    assert any(line["arousal"] is not None for line in run.lines_of("app", "person"))
    assert run.lines_of("app", "choice")[0]["propensity"] == 1.0
    assert len((folder / "trackers.jsonl").read_text().splitlines()) > 100


def test_device_check_replay_and_export_know_them(site: Path, played: tuple[Answer, Path], tmp_path: Path) -> None:
    _, folder = played
    export = ("record", "export", folder, "--to", "trial_lines", "--output", tmp_path / "out")
    checked, replayed, exported = mimics_with(
        site, ("devices", "check", "led_handle", "--json"), ("replay", folder), export
    )
    verdicts = [one["verdict"] for one in json.loads(checked.stdout)["checks"]]
    assert verdicts.count("passed") >= 24 and "failed" not in verdicts
    assert replayed.returncode == 0, replayed.stderr
    assert exported.returncode == 0, exported.stderr
    assert (tmp_path / "out" / "trials.txt").read_text().startswith("wide: finished after ")
