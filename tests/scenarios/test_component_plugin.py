"""A component type of another package, installed as packages are: checked, in the schema, and read by its scenario."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from mimics_app.contracts.system.resources import root
from tests.support.command import Answer, mimics, mimics_with
from tests.support.plugin_site import write_package

ENTRY_POINTS = """
[mimics_app.components]
rain = lab_of_weather:Rain
snow = lab_of_weather:Snow
hail = lab_of_weather:no_such_thing
mesh = lab_of_weather:Snow
[mimics_app.scenarios]
weather = lab_of_weather:Weather
storm = lab_of_weather:Storm
"""

PACKAGE = '''
from typing import Annotated
from msgspec import Meta
from mimics_app.scenarios.parts.touch_scene import TouchScene
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


class Storm(Weather):
    def apply(self, orders, snapshot):
        if snapshot.t_ns > 50_000_000:
            raise RuntimeError("lightning")
        super().apply(orders, snapshot)
'''


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_package(tmp_path_factory.mktemp("site"), "lab_of_weather", PACKAGE, ENTRY_POINTS)


def scene(folder: Path, scenario: str = "weather", **components: Any) -> Path:
    document = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    document["scenario"] = scenario
    document["entities"].append({"id": "sky", "components": components})
    path = folder / f"{scenario}.json"
    path.write_text(json.dumps(document))
    return path


@pytest.fixture(scope="module")
def answers(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What commands say with the plug-in installed, by name."""
    good, wrong, unread = (tmp_path_factory.mktemp("scene") for _ in range(3))
    options = ("--headless", "--seconds", 0.2, "--pictures", 1, "--sound", "off", "--json", "--runs", unread)
    snow = scene(unread, rain={"per_s": 3.0}, snow={}, mirror={}, mesh={"primitive": {"shape": "plane"}})
    commands = {
        "schema": ("schema",),
        "check": ("check", scene(good, rain={"per_s": 3.0})),
        "check wrong": ("check", scene(wrong, rain={"per_s": -1.0}, hail={})),
        "run": ("run", snow, *options),
        "storm": ("run", scene(unread, "storm", rain={"per_s": 3.0}), *options),
        "doctor": ("doctor", "--json"),
    }
    return dict(zip(commands, mimics_with(installed, *commands.values()), strict=True))


def test_the_schema_knows_it(answers: dict[str, Answer]) -> None:
    known = json.loads(answers["schema"].stdout)["$defs"]
    assert known["Rain"]["properties"]["per_s"]["description"] == "How many [1/s]."
    assert "Rain" not in json.loads(mimics("schema").stdout)["$defs"]


def test_a_scene_with_it_is_checked(answers: dict[str, Answer]) -> None:
    assert answers["check"].returncode == 0
    wrong = answers["check wrong"]
    assert wrong.returncode == 3
    assert "/components/rain/per_s: " in wrong.stderr
    assert "its plug-in lab_of_weather:no_such_thing cannot be imported: AttributeError" in wrong.stderr


def test_its_scenario_reads_it_and_what_nobody_reads_is_reported(answers: dict[str, Answer]) -> None:
    done = answers["run"]
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["unread"] == ["snow"]


def test_the_recording_up_to_a_fault_of_a_package_is_closed_and_named(answers: dict[str, Answer]) -> None:
    done = answers["storm"]
    assert done.returncode == 1 and "RuntimeError: lightning" in done.stderr, "its author needs the traceback"
    assert [error["what"] for error in json.loads(done.stdout)["errors"]] == ["internal error: RuntimeError: lightning"]
    (folder,) = re.findall("broken off; mimics report (.*) shows what was recorded", done.stderr)
    assert json.loads((Path(folder) / "manifest.json").read_text())["rows"] >= 50


def test_doctor_says_which_cannot_be_had(answers: dict[str, Answer]) -> None:
    rows = json.loads(answers["doctor"].stdout)["plugins"]
    faults = {row["name"]: row["error"] for row in rows if row["group"] == "mimics_app.components"}
    assert faults["rain"] == faults["snow"] == ""
    assert "AttributeError" in faults["hail"] and "has the name of another component" in faults["mesh"]
