"""Scenarios of every kind, and of another package, by one conformance kit."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.app.play.script_reload import ScriptReload
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import BUILT_IN
from mimics_app.app.session.core import open_core
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.resources import root
from tests.support.plugin_site import write_package
from tests.support.scenario_kit import check_scenario

SCENES = root() / "scenes"
YARD = '''
"""Scenarios of scenes with a robot, right and with a fault each."""
from dataclasses import replace
import numpy as np
from mimics_app.contracts.messages.orders import HapticField, HapticOrder
from mimics_app.contracts.messages.stage_messages import Aim
from mimics_app.scenarios.parts.touch_scene import TouchScene


class Yard(TouchScene):
    def __init__(self, scene, world):
        super().__init__(scene, world)
        self.flag = world.find("flag") if "flag" in world else world.create_node("flag")

    def apply(self, orders, snapshot):
        super().apply(orders, snapshot)
        self.flag.set_position(snapshot.hip_world)


class Legless(Yard):
    @property
    def task_context(self):
        return replace(super().task_context, start_joints=(0.0,))


class Flat(Yard):
    @property
    def via_points_world(self):
        return super().via_points_world[:, :2]


class Wordless(Yard):
    @property
    def facts(self):
        return {"size": np.float32(1.0)}


class Shared(Yard):
    def scene_block(self):
        if not hasattr(self, "block"):
            self.block = super().scene_block()
        return self.block


class Dice(Yard):
    @property
    def via_points_world(self):
        return super().via_points_world + np.random.default_rng().normal(0.0, 0.01, 3)


class Heavy(Yard):
    def apply(self, orders, snapshot):
        super().apply(orders, snapshot)
        snapshot.hip_world[1] -= 0.01


class Bold(Yard):
    def haptic_orders(self):
        return HapticOrder({HapticField("force_limit"): 500.0})


class Restless(Yard):
    full = 20.0

    def haptic_orders(self):
        self.full += 0.01
        return HapticOrder({HapticField("grasp_force_full"): self.full})


class Aimless(Yard):
    def aim(self, snapshot):
        return Aim((0.0, float("nan"), 0.0), False)


class Skewed(Yard):
    def hand_frame(self):
        return np.diag([2.0, 1.0, 1.0, 1.0])


class Blind(Yard):
    def set_tracked_body(self, where, now_ns):
        self.flag.set_position(where("head", now_ns)[:3, 3])


class Again(Yard):
    def __init__(self, scene, world):
        super().__init__(scene, world)
        world.create_node()
'''
FAULTS = {
    "Legless": "a position of each joint",
    "Flat": "via points are places",
    "Wordless": "facts are plain values",
    "Shared": "owns the record",
    "Dice": "the same path",
    "Heavy": "nothing of the haptic state: hip_world",
    "Bold": "is a limit of the haptic loop",
    "Restless": "not ordered anew",
    "Aimless": "a place to go to",
    "Skewed": "rigid",
    "Blind": "not subscriptable",
    "Again": "adds nothing twice",
}
GROUP = "[mimics_app.scenarios]\n" + "".join(f"{name.lower()} = lab_of_yards:{name}\n" for name in ("Yard", *FAULTS))


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_yards", YARD, GROUP)))
    monkeypatch.delitem(sys.modules, "lab_of_yards", raising=False)  # of the folder of a test before


def played_by(scenario: str, folder: Path) -> Path:
    document = json.loads((SCENES / "examples" / "falling_pairs.json").read_text())
    document["scenario"] = scenario
    file = folder / "scene.json"
    file.write_text(json.dumps(document))
    return file


@pytest.mark.parametrize("name", [*BUILT_IN, "examples/falling_pairs"])
def test_scenario_keeps_the_contract(name: str) -> None:
    check_scenario(SCENES / f"{name}.json")


def test_a_module_among_the_built_in_scenarios_is_one(tmp_path: Path) -> None:
    """Nothing else names it, and it plays the scene of its name."""
    (tmp_path / "yard.py").write_text(YARD + "\n\nSCENARIO = Yard\n")
    scene = (SCENES / "examples" / "falling_pairs.json").read_text()
    (tmp_path / "yard.json").write_text(scene)
    code = (
        "import sys; from pathlib import Path;"
        "from mimics_app import scenarios; scenarios.__path__.append(sys.argv[1]);"
        "from tests.support.scenario_kit import check_scenario; check_scenario(Path(sys.argv[1], 'yard.json'));"
        "assert 'mimics_app.scenarios.yard' in sys.modules"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    done = subprocess.run(command, cwd=root(), capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


def test_a_scenario_of_a_package_keeps_the_contract(installed: None, tmp_path: Path) -> None:
    check_scenario(played_by("yard", tmp_path))


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_scenario_is_found(name: str, installed: None, tmp_path: Path) -> None:
    with pytest.raises((AssertionError, UsageError, TypeError), match=FAULTS[name]):
        check_scenario(played_by(name.lower(), tmp_path))


def test_a_saved_script_plays_from_the_next_trial_on_and_a_broken_one_does_not(installed: None, tmp_path: Path) -> None:
    script, scene = tmp_path / "lab_of_yards.py", load_checked_scene(played_by("yard", tmp_path))
    with open_core(prepare_scene(scene, RunSettings(scene.path))) as core:
        reload, before = ScriptReload(core), core.scenario  # type: ignore[arg-type]
        assert type(before).__module__ == "lab_of_yards" and not reload.check(between=True)
        source = script.read_text()
        for fault, why in (("\n  x", "line "), ("\nraise ValueError(7)", "ValueError: 7"), ("\ndel Yard", "Yard")):
            script.write_text(source + fault)
            assert not reload.check(between=False), "within a trial it waits"
            said = reload.check(between=True)
            assert said.startswith("the script stays as it was") and why in said and core.scenario is before, said
        script.write_text(source.replace("(TouchScene):\n", "(TouchScene):\n    mark = 5\n\n", 1))
        assert reload.check(between=True) == "script reloaded: lab_of_yards.py"
        assert core.scenario is not before and core.scenario.mark == 5
        assert not reload.check(between=True)
