"""Plug-ins of other packages: found, imported one by one, and never fatal."""

from __future__ import annotations

import ast
import importlib.metadata
import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app import cli
from mimics_app.app.installation import plugins, probes
from mimics_app.app.installation.plugins import list_plugins, plugin_groups, report_group
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.contracts.errors import DeviceError, SceneError, UsageError
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.physio.sources import open_source
from mimics_app.learning.registry import build_policy
from mimics_app.rendering.haptic.devices.device_names import PLUGINS as DEVICES
from mimics_app.rendering.haptic.devices.device_names import find_plugin
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Robot
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import load_scene
from tests.architecture.sources import modules, nodes
from tests.support.command import Answer, mimics_with
from tests.support.plugin_site import write_package

ROOT = Path(__file__).resolve().parents[2]

_ENTRY_POINTS = """
[mimics_app.devices]
good_robot = lab_of_somebody:build
left_robot = lab_that_leaves
lost_robot = lab_that_is_lost:build
[mimics_app.scenarios]
half = lab_of_somebody:no_such_thing
[mimics_app.components]
no_component = lab_of_somebody:build
[mimics_app.task_kinds]
no_kind = lab_of_somebody:build
[mimics_app.policies]
no_policy = lab_of_a_compiler:Policy
[mimics_app.signal_sources]
no_source = lab_of_a_compiler:open
"""


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A distribution with one plug-in that works and three that do not."""
    folder = tmp_path / "lab_of_somebody-1.2.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-somebody\nVersion: 1.2\n")
    (folder / "entry_points.txt").write_text(_ENTRY_POINTS)
    (tmp_path / "lab_of_somebody.py").write_text('def build(request):\n    """A robot of somebody.\n\n    More."""\n')
    (tmp_path / "lab_of_a_compiler.py").write_text("raise TypeError('it fails\\n  in line 3\\n    of the kernel')\n")
    (tmp_path / "lab_that_leaves.py").write_text("import sys\nsys.exit('no licence')\n")
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.fixture
def answers(monkeypatch: pytest.MonkeyPatch) -> dict[str, dict[str, Any]]:
    """What the probes answer instead of asking drivers."""
    found: dict[str, dict[str, Any]] = {
        "window": {"ok": False, "error": "no display"},
        "egl": {"ok": True, "version": "4.5", "renderer": "software", "vendor": "somebody"},
        "osmesa": {"ok": False, "error": "the driver crashed (signal 11)"},
        "sound": {"ok": True, "library": "libopenal.so.1", "hrtf": True, "device": ""},
        "scheduler": {"ok": True, "recipe": "ordinary+slack1ns", "fifo": False, "cores": 2},
        "attached": {"ok": False, "error": "no display"},
        "headset": {"ok": False, "error": "no OpenXR runtime"},
    }
    monkeypatch.setattr(probes, "probe", lambda name: found[name])
    return found


def test_each_plug_in_is_reported_with_its_package(installed: None) -> None:
    reports = {report.name: report for report in list_plugins()}
    assert reports["good_robot"].error == ""
    assert reports["good_robot"].loaded.__name__ == "build"
    assert reports["good_robot"].package == "lab-of-somebody 1.2"
    assert "SystemExit: no licence" in reports["left_robot"].error
    assert "lab_that_is_lost" in reports["lost_robot"].error
    assert "no_such_thing" in reports["half"].error
    assert "not a subclass of" in reports["no_component"].error
    assert "is not a mimics_app.tasks.kinds.kind.TaskKind" in reports["no_kind"].error


def test_each_stage_names_a_plug_in_that_fails_in_one_line(installed: None) -> None:
    why = "its plug-in lab_of_a_compiler:{} cannot be imported: TypeError: it fails in line 3 of the kernel"
    with pytest.raises(UsageError, match=why.format("Policy")):
        build_policy("no_policy")
    with pytest.raises(DeviceError, match=why.format("open")):
        open_source("no_source:x", 1)
    with pytest.raises(DeviceError, match="its plug-in lab_that_leaves cannot be imported: SystemExit: no licence"):
        find_plugin("left_robot")
    scene = load_scene(root() / "scenes" / "wavy_tunnel.json")
    scene.scenario = "half"
    with pytest.raises(SceneError, match="its plug-in lab_of_somebody:no_such_thing cannot be imported"):
        open_scenario(scene, World())


def test_one_group_is_asked_alone(installed: None) -> None:
    assert {report.group for report in report_group(DEVICES)} == {"mimics_app.devices"}


@pytest.mark.seconds
def test_every_group_that_is_announced_is_loaded() -> None:
    """A plug-in of a group that nothing loads would be called ok by doctor and do nothing."""
    declared = {
        str(getattr(node.args[0], "value", ""))
        for tree in modules().values()
        for node in nodes(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "PluginGroup"
    }
    assert {group.name for group in plugin_groups()} == declared


def test_no_plug_ins_is_no_error() -> None:
    assert [report for report in list_plugins() if report.error] == []


GROUPS = [group.name for group in plugin_groups()]
WRONG = "".join(f"[{group}]\nseven = lab_of_faults:SEVEN\ntorn = lab_of_faults:missing\n" for group in GROUPS)
HALF = """
SEVEN = 7

class Half:
    def begin(self, start, rng): ...
    def act(self): ...
"""


def test_what_a_group_cannot_use_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    half = "[mimics_app.policies]\nhalf = lab_of_faults:Half\n"
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_faults", HALF, WRONG.replace(half[:22], half))))
    faults = {(report.group, report.name): report.error for report in list_plugins()}
    assert all(faults[group, name] for group in GROUPS for name in ("seven", "torn"))
    assert faults["mimics_app.policies", "half"] == "lacks learn, see mimics_app.learning.policy.Policy"


@pytest.fixture(scope="module")
def refusals(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What commands say that need a wrong plug-in, by its group."""
    site = write_package(tmp_path_factory.mktemp("site"), "lab_of_faults", HALF, WRONG)
    document = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    scene = site / "scene.json"
    scene.write_text(json.dumps({**document, "scenario": "torn"}))
    commands: dict[str, tuple[object, ...]] = {
        "mimics_app.task_kinds": ("check", "wavy_tunnel"),
        "mimics_app.scenarios": ("check", scene),
        "mimics_app.policies": ("run", "wavy_tunnel", "--headless", "--learn", "seven"),
        "mimics_app.signal_sources": ("run", "wavy_tunnel", "--headless", "--physio", "seven"),
        "mimics_app.devices": ("run", "wavy_tunnel", "--headless", "--device", "seven"),
    }
    return dict(zip(commands, mimics_with(site, *commands.values()), strict=True))


@pytest.mark.seconds
@pytest.mark.parametrize(
    ("group", "code", "said"),
    [
        ("mimics_app.task_kinds", 0, 'the kind of task "seven" is left out: its plug-in lab_of_faults:SEVEN is not a'),
        ("mimics_app.scenarios", 3, '#/scenario: the scenario "torn" is not available; its plug-in lab_of_faults:'),
        ("mimics_app.policies", 2, 'the policy "seven" is not available: its plug-in lab_of_faults:SEVEN cannot be'),
        ("mimics_app.signal_sources", 4, 'the source of body signals "seven" is not available: its plug-in lab_of'),
        ("mimics_app.devices", 4, 'the device "seven" is not available: its plug-in lab_of_faults:SEVEN cannot be'),
    ],
)
def test_a_wrong_plug_in_ends_only_what_needs_it(refusals: dict[str, Answer], group: str, code: int, said: str) -> None:
    """Each is one line with its place, not a traceback; the tunnel runs beside a kind of task that is none."""
    everything = "".join(answer.stderr for answer in refusals.values())  # a wrong kind is reported once in a process
    assert refusals[group].returncode == code, refusals[group].stderr
    assert said in everything and "Traceback" not in everything


def test_doctor_lists_plug_ins_that_fail(
    installed: None, answers: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "lost_robot" in said
    assert "No module named 'lab_that_is_lost'" in said


def test_doctor_says_that_no_plug_in_is_installed(
    answers: dict[str, Any], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plugins, "list_plugins", list)
    assert cli.main(["doctor"]) == 0
    assert "Plug-ins\n      none installed\n" in capsys.readouterr().out


def test_doctor_lacks_a_package_that_a_run_needs(
    answers: dict[str, Any], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The required packages are those of the distribution itself: a list of its own would fall behind them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = [re.split("[<>=]", each)[0].lower() for each in project["dependencies"]]
    known = importlib.metadata.version

    def version(name: str) -> str:
        if name == required[-1]:
            raise importlib.metadata.PackageNotFoundError(name)
        return known(name)

    monkeypatch.setattr(importlib.metadata, "version", version)
    assert cli.main(["doctor", "--json"]) == 4
    versions = json.loads(capsys.readouterr().out)["versions"]
    assert set(required) <= set(versions)
    assert [name for name, found in versions.items() if not found] == [required[-1]]


def test_doctor_without_any_picture_is_a_device_error(
    answers: dict[str, dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    answers["egl"] = {"ok": False, "error": "libEGL.so.1 is missing"}
    assert cli.main(["doctor"]) == 4
    assert "libEGL.so.1 is missing" in capsys.readouterr().out


def test_doctor_names_the_apt_line(
    answers: dict[str, Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from mimics_app.app.installation.system_packages import SystemNeed

    needs = (SystemNeed("libnope1", "nothing at all", libraries=("libnope.so.9",)),)
    monkeypatch.setattr("mimics_app.app.installation.system_packages.NEEDS", needs)
    cli.main(["doctor", "--json"])
    answer = json.loads(capsys.readouterr().out)
    assert answer["missing"] == ["libnope1"]
    assert answer["apt"] == "sudo apt-get install -y libnope1"
    cli.main(["doctor"])
    assert "sudo apt-get install -y libnope1" in capsys.readouterr().out


def test_doctor_says_what_may_be_written(
    answers: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cli.main(["doctor", "--json", "--runs", str(tmp_path / "not" / "there" / "yet")])
    text = capsys.readouterr().out
    answer = json.loads(text)
    assert "null" not in text
    assert answer["runs"]["writable"] is True
    assert answer["runs"]["free_gb"] > 0
    assert answer["kernel_cache"]["folder"]
    assert answer["scheduler"]["recipe"] == "ordinary+slack1ns"


def test_devices_lists_built_in_simulators_and_plug_ins(
    installed: None, answers: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["devices", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    devices = {device["name"]: device for device in answer["devices"]}
    assert {"simulated_hapticmaster", "pointer", "replay", "good_robot", "lost_robot"} <= set(devices)
    assert devices["good_robot"]["about"] == "A robot of somebody."
    assert devices["lost_robot"]["error"]
    abouts = [device["about"] for device in answer["devices"]]
    assert all(abouts) and len(set(abouts[:8])) == 8  # each of the built-in ones says what it alone is
    assert answer["notes"] == ["displays: no display"]


def test_devices_for_a_person(answers: dict[str, dict[str, Any]], capsys: pytest.CaptureFixture[str]) -> None:
    screen = {"name": "left wall", "size_px": [1920, 1080], "size_m": [2.0, 1.1], "refresh_hz": 60, "primary": True}
    answers["attached"] = {"ok": True, "displays": [screen], "gamepads": ["some pad"]}
    assert cli.main(["devices"]) == 0
    said = capsys.readouterr().out
    assert "left wall: 1920 x 1080 at 60 Hz (primary)" in said
    assert "some pad" in said


@pytest.mark.parametrize(
    ("made", "why"),
    [
        ("raise ValueError('no line')", r"raised ValueError: no line \(lab_of_a_robot.py, line 2\)"),
        ("return None", r"made an object of the type NoneType; see mimics_app.contracts.loop.loop_ports.DevicePlugin"),
    ],
)
def test_a_device_of_a_package_that_cannot_be_made_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made: str, why: str
) -> None:
    points = "[mimics_app.devices]\nrobot_of_a_lab = lab_of_a_robot:build\n"
    source = f"def build(request):\n    {made}\n"
    monkeypatch.delitem(sys.modules, "lab_of_a_robot", raising=False)
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_a_robot", source, points)))
    with pytest.raises(DeviceError, match=rf'the device "robot_of_a_lab" cannot be opened: its plug-in lab.*{why}'):
        build_device(Robot(device="robot_of_a_lab"))
