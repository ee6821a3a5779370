"""A controller of another package, installed as packages are: it plays a scene, is recorded, and replays equal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot, names_in
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from tests.support.command import Answer, mimics_with
from tests.support.plugin_site import write_package

ENTRY_POINTS = """
[mimics_app.controllers]
gait_spring = lab_of_gait:SPRING
unnamed = lab_of_gait:SPRING
"""

PACKAGE = '''
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_port import CONTROLLER, ControllerParameter, ControllerPlugin
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead


@typed_kernel(CONTROLLER)
def _spring(kin, now, parameters, memory, work, out):
    """Torque towards a pose, with the guidance of each joint."""
    for j in range(now.joints):
        out.torque[j] = parameters[0] * (parameters[1 + j] - now.q[j]) - parameters[3] * now.dq[j]


SPRING = ControllerPlugin(
    "gait_spring",
    _spring,
    Lead.PERSON,
    CommandKind.TORQUE,
    (
        ControllerParameter("stiffness", 50.0, 0.0, 500.0, "N m/rad"),
        ControllerParameter("pose", 0.2, -1.0, 2.0, "rad", size=2),
        ControllerParameter("damping", 1.0, 0.0, 50.0, "N m s/rad"),
    ),
)
'''


def _scene(folder: Path, mode: str = "torque", **controller: Any) -> Path:
    document = json.loads((root() / "scenes" / "examples" / "kicking.json").read_text())
    robot = next(each for each in document["entities"] if "robot" in each.get("components", {}))["components"]
    robot["robot"]["settings"] = {**robot["robot"].get("settings", {}), "mode": mode}
    robot["controller"] = controller
    path = folder / "guided.json"
    path.write_text(json.dumps(document))
    return path


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What commands say with the plug-in installed, by name; "replay" is of the run."""
    site = write_package(tmp_path_factory.mktemp("site"), "lab_of_gait", PACKAGE, ENTRY_POINTS)
    folder = {name: tmp_path_factory.mktemp(name) for name in ("good", "typo", "range", "velocity", "other", "runs")}
    good = _scene(folder["good"], name="gait_spring", parameters={"stiffness": 80.0, "pose": [0.4, 0.3]})
    options = ("--headless", "--seconds", 3, "--pictures", 0, "--sound", "off", "--json", "--runs", folder["runs"])
    commands = {
        "run": ("run", good, *options),
        "typo": ("check", _scene(folder["typo"], name="gait_sprnig")),
        "range": ("check", _scene(folder["range"], name="gait_spring", parameters={"stiffness": 1e6})),
        "other": ("check", _scene(folder["other"], name="unnamed")),
        "velocity": ("run", _scene(folder["velocity"], "motion", name="gait_spring"), *options),
    }
    found = dict(zip(commands, mimics_with(site, *commands.values()), strict=True))
    made = json.loads(found["run"].stdout)["run_dir"]
    (found["replay"],) = mimics_with(site, ("replay", made))
    return found


def test_it_moves_the_leg_and_is_recorded_by_name(answers: dict[str, Answer]) -> None:
    assert answers["run"].returncode == 0, answers["run"].stderr
    run = Run.open(Path(json.loads(answers["run"].stdout)["run_dir"]))
    block = run.parameters[max(run.parameters)][0]
    assert names_in(block["controller_names"])[Slot.PERSON] == "gait_spring"
    assert block["controller_parameters"][Slot.PERSON][:4].tolist() == [80.0, 0.4, 0.3, 1.0]
    assert np.abs(run.haptic["torque_command"]).max() > 1.0


def test_its_run_replays_bit_for_bit(answers: dict[str, Answer]) -> None:
    assert answers["replay"].returncode == 0, answers["replay"].stderr


def test_what_it_cannot_be_is_said_with_its_place_and_a_remedy(answers: dict[str, Answer]) -> None:
    assert answers["typo"].returncode == answers["range"].returncode == answers["other"].returncode == 3
    assert '/components/controller/name: there is no controller "gait_sprnig"; did you mean "gait_spring"' in (
        answers["typo"].stderr
    )
    assert "/components/controller/parameters: " in answers["range"].stderr
    assert "choose a value within 0 and 500 N m/rad" in answers["range"].stderr
    assert 'has the name "gait_spring"; name it like its entry point' in answers["other"].stderr
    assert answers["velocity"].returncode == 4
    (error,) = json.loads(answers["velocity"].stdout)["errors"]
    assert error["what"] == 'the controller "gait_spring" commands torque; "simulated_leg" takes velocity'
