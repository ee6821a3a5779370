"""A component type of another package, installed as packages are: checked, in the schema, and read by its scenario."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from mimics_app.contracts.resources import root

ENTRY_POINTS = """
[mimics_app.components]
rain = lab_of_weather:Rain
snow = lab_of_weather:Snow
hail = lab_of_weather:no_such_thing
mesh = lab_of_weather:Snow
[mimics_app.scenarios]
weather = lab_of_weather:Weather
"""

PACKAGE = '''
from typing import Annotated
from msgspec import Meta
from mimics_app.scenarios.touch_scene import TouchScene
from mimics_app.world.components.registry import Component


class Rain(Component, frozen=True):
    """Drops."""

    per_s: Annotated[float, Meta(ge=0.0, description="How many [1/s].")]


class Snow(Component, frozen=True):
    """Flakes."""


class Weather(TouchScene):
    def __init__(self, scene, world):
        super().__init__(scene, world)
        (self.rain,) = [rain for _, rain, _ in scene.components(Rain)]
        assert self.rain.per_s == 3.0
'''


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    about = folder / "lab_of_weather-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-weather\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(ENTRY_POINTS)
    (folder / "lab_of_weather.py").write_text(PACKAGE)
    return folder


def mimics(site: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mimics_app.app.cli", *map(str, arguments)]
    environment = {**os.environ, "PYTHONPATH": str(site)}
    return subprocess.run(command, capture_output=True, text=True, timeout=240, check=False, env=environment)


def scene(folder: Path, **components: Any) -> Path:
    document = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    document["scenario"] = "weather"
    document["entities"].append({"id": "sky", "components": components})
    path = folder / "weather.json"
    path.write_text(json.dumps(document))
    return path


def test_the_schema_knows_it(installed: Path) -> None:
    done = mimics(installed, "schema")
    assert json.loads(done.stdout)["$defs"]["Rain"]["properties"]["per_s"]["description"] == "How many [1/s]."
    assert "Rain" not in json.loads(mimics(installed.parent, "schema").stdout)["$defs"]


def test_a_scene_with_it_is_checked(installed: Path, tmp_path: Path) -> None:
    assert mimics(installed, "check", scene(tmp_path, rain={"per_s": 3.0})).returncode == 0
    wrong = mimics(installed, "check", scene(tmp_path, rain={"per_s": -1.0}, hail={}))
    assert wrong.returncode == 3
    assert "/components/rain/per_s: " in wrong.stderr
    assert "its plug-in lab_of_weather:no_such_thing cannot be imported: AttributeError" in wrong.stderr


def test_its_scenario_reads_it_and_what_nobody_reads_is_told(installed: Path, tmp_path: Path) -> None:
    file = scene(tmp_path, rain={"per_s": 3.0}, snow={}, mirror={}, mesh={"primitive": {"shape": "plane"}})
    options = ("--headless", "--seconds", 0.2, "--pictures", 1, "--sound", "off", "--json", "--runs", tmp_path)
    done = mimics(installed, "run", file, *options)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["unread"] == ["snow"]


def test_doctor_tells_which_cannot_be_had(installed: Path) -> None:
    rows = json.loads(mimics(installed, "doctor", "--json").stdout)["plugins"]
    faults = {row["name"]: row["error"] for row in rows if row["group"] == "mimics_app.components"}
    assert faults["rain"] == faults["snow"] == ""
    assert "AttributeError" in faults["hail"] and "another component has that name" in faults["mesh"]
