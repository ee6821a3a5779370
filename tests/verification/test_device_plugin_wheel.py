"""The example of a third party's device: built as its own wheel, installed beside the product, through the same kit."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.recording.run import Run
from tests.support.command import Answer, mimics, mimics_with
from tests.support.plugin_site import build_wheel

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "device_plugin"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel in it, for the module path: no registry is asked."""
    return build_wheel(EXAMPLE, tmp_path_factory.mktemp("plugin"))


def test_it_has_at_most_80_lines() -> None:
    assert len((EXAMPLE / "mass_on_rails.py").read_text(encoding="utf-8").splitlines()) <= 80


SCENE = {
    "format": "mimics-scene",
    "version": 1,
    "include": ["mimics:scenes/parts/touch_room.json"],
    "entities": [
        {
            "id": "pillow",
            "transform": {"translation": [0.0, 0.3, 0.45]},
            "components": {
                "mesh": {"primitive": {"shape": "sphere", "radius": 0.05}, "material": "rubber"},
                "haptic_object": {"mass": 1.0, "stiffness": 500.0, "enable_translation": False},
            },
        },
        {"id": "hand", "prefab": "hand", "transform": {"translation": [0.16, 0.30, 0.47]}},
        {"id": "robot", "prefab": "robot", "components": {"robot": {"device": "elbow_arm", "settings": {"link": 0.3}}}},
    ],
}


@pytest.fixture(scope="module")
def answers(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What commands say with the wheel installed, by name."""
    folder = tmp_path_factory.mktemp("pillow")
    (folder / "pillow.json").write_text(json.dumps(SCENE), encoding="utf-8")
    options = ("--headless", "--seconds", 2.5, "--pictures", 0, "--json", "--runs", folder / "runs")
    run = ("run", folder / "pillow.json", *options)
    commands: dict[str, tuple[object, ...]] = {
        "mass_on_rails": ("devices", "check", "mass_on_rails", "--json"),
        "elbow_arm": ("devices", "check", "elbow_arm", "--json"),
        "run": run,
        "other": (*run, "--device", "pointer"),
    }
    return dict(zip(commands, mimics_with(installed, *commands.values()), strict=True))


def test_it_passes_the_kit_under_its_name(answers: dict[str, Answer]) -> None:
    done = answers["mass_on_rails"]
    assert done.returncode == 0, done.stderr
    verdicts = [one["verdict"] for one in json.loads(done.stdout)["checks"]]
    assert verdicts.count("passed") >= 24 and "failed" not in verdicts


def test_a_device_of_another_shape_passes_too(answers: dict[str, Answer]) -> None:
    assert len((EXAMPLE / "elbow_arm.py").read_text(encoding="utf-8").splitlines()) <= 110
    done = answers["elbow_arm"]
    assert done.returncode == 0, done.stdout + done.stderr
    verdicts = {one["check"]: one["verdict"] for one in json.loads(done.stdout)["checks"]}
    assert "failed" not in verdicts.values()
    assert verdicts["has the jacobian of its points"] == "passed"


def test_one_device_more_touches_no_existing_file_and_plays_records_and_replays(
    installed: Path, answers: dict[str, Answer]
) -> None:
    """From a wheel alone: another number of joints, in the loop, in the recording, and simulated again from it."""
    done = answers["run"]
    assert done.returncode == 0, done.stdout + done.stderr
    answer = json.loads(done.stdout)
    assert answer["safety"]["stops"] == 0 and answer["ticks"] == 2500
    run = Run.open(Path(answer["run_dir"]))
    assert run.layout.extent.joints == ("rad", "rad") and not run.problems()
    assert float(abs(run.haptic["q"][-1, :2] - run.haptic["q"][0, :2]).max()) > 0.05, "it was driven to its start"
    (replayed,) = mimics_with(installed, ("replay", answer["run_dir"], "--json"))
    assert replayed.returncode == 0 and json.loads(replayed.stdout)["equal"] is True, replayed.stderr
    other = answers["other"]
    assert other.returncode == 4 and "2 joints" in other.stdout + other.stderr
    gone = mimics("replay", answer["run_dir"])
    assert gone.returncode == 4 and "elbow_arm" in gone.stderr


@pytest.mark.parametrize("number", [0, 1])
def test_its_guide_runs(installed: Path, number: int, tmp_path: Path) -> None:
    snippet = re.findall(r"```python\n(.*?)```", (EXAMPLE / "README.md").read_text(encoding="utf-8"), re.DOTALL)[number]
    environment = os.environ | {"PYTHONPATH": f"{installed}{os.pathsep}{ROOT}"}
    done = subprocess.run(
        [sys.executable, "-c", snippet], env=environment, capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert len(list(tmp_path.glob("runs/*"))) == number, "the second one plays a scene"


def test_without_the_wheel_its_name_is_unknown() -> None:
    done = mimics("devices", "check", "mass_on_rails")
    assert done.returncode == 4 and 'no device "mass_on_rails"' in done.stderr
