"""The operator's ceiling of a machine: no scene raises it, a run says what it changes, a damaged file is refused."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.app import cli
from mimics_app.app.commands.check import examine
from mimics_app.app.session.effective_settings import effective_settings
from mimics_app.app.session.header import describe_session
from mimics_app.app.session.preparation import SessionParts, prepare
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.ceiling import hold_limits
from mimics_app.app.touch.ceilings import CEILINGS, asked_of, read_ceiling, set_ceiling
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import LIMIT_NAMES
from mimics_app.contracts.system.resources import root
from mimics_app.recording.report import page_of
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.world.components.robot import Admittance, Safety
from tests.support.command import mimics

DANGEROUS = {
    "force_limit": 500.0, "force_rate_limit": 1e6, "velocity_limit": 10.0, "measured_force_limit": 1e4,
    "workspace_margin": 1.0, "ramp_time_s": 0.0, "ramp_force": 1000.0, "late_hold_s": 0.9, "late_damp_s": 0.95,
    "late_stop_s": 1.0, "missed_stop": 1000, "stale_warn_s": 0.9, "stale_stop_s": 1.0, "arm_damping": 1e5,
    "power_limit": 1e4, "position_jump": 10.0, "energy_limit": 100.0, "stiffness_cap": "warn", "passivity": False,
    "tank_size": 1000.0, "tank_refill": 1000.0, "tank_return": 1.0, "cap_margin": 0.0, "passivity_damping": 1e5,
    "drive_speed": 0.25,
}  # fmt: skip
"""The farthest that a scene may write of each."""


@pytest.fixture(autouse=True)
def _own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def _scene(tmp_path: Path, **safety: object) -> Path:
    scene = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    robot = next(each for each in scene["entities"] if each.get("prefab") == "robot")
    robot["components"] = {"safety": safety, "admittance": {"max_velocity": 100.0, "max_acceleration": 1e4}}
    scene["include"] = [f"mimics:scenes/parts/{Path(part).name}" for part in scene["include"]]
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    return file


def _prepared(file: Path) -> SessionParts:
    return prepare(RunSettings(file, headless=True, sound="off"), live=False)


def test_every_limit_of_a_scene_has_a_ceiling():
    assert set(CEILINGS) == {*Safety.__struct_fields__, "max_velocity", "max_acceleration"}
    assert set(DANGEROUS) == set(Safety.__struct_fields__)
    assert set(DANGEROUS) - LIMIT_NAMES == {
        "ramp_time_s", "late_hold_s", "late_damp_s", "late_stop_s", "stale_warn_s", "stale_stop_s", "stiffness_cap",
    }  # fmt: skip
    for name, bound in CEILINGS.items():
        assert bound.held(bound.conservative, bound.farthest) == bound.conservative, name


@pytest.mark.requirement("R18")
def test_a_scene_that_asks_for_everything_gets_the_ceiling_and_is_named_line_by_line(tmp_path: Path):
    parts = _prepared(_scene(tmp_path, **DANGEROUS))
    block = parts.parameter_store.block[0]
    expected = {
        "force_limit": 80.0, "force_rate_limit": 2000.0, "velocity_limit": 2.5, "power_limit": 60.0, "passivity": 1,
        "cap": 1, "late_stop_ns": 50_000_000, "stale_stop_ns": 20_000_000, "missed_stop": 20, "ramp_time": 0.2,
        "position_jump": 0.001, "energy_limit": 1.0, "tank_size": 5.0, "max_velocity": 1.5, "max_acceleration": 50.0,
        "drive_speed": 0.1, "arm_damping": 10.0, "cap_margin": 0.2,
    }  # fmt: skip
    assert {name: block[name].item() for name in expected} == expected
    assert parts.held.names == set(CEILINGS)
    notes = describe_session(parts)["beyond_usual_limits"]
    assert len(notes) == len(CEILINGS)
    assert "force_limit 500 N, usually 60 N: held at 80 N on this machine" in notes
    origin = {each.name: each.origin for each in effective_settings(parts, {})}
    assert "mimics limits" in origin["force_limit"]


def test_an_operator_may_raise_the_ceiling_and_a_scene_within_it_is_still_told(tmp_path: Path):
    file = _scene(tmp_path, force_limit=120.0)
    set_ceiling("force_limit", 150.0)
    parts = _prepared(file)
    assert parts.parameter_store.block["force_limit"][0] == 120.0
    assert "force_limit 120 N, usually 60 N: in force" in parts.held.notes
    set_ceiling("force_limit", None)
    assert _prepared(file).parameter_store.block["force_limit"][0] == 80.0


def test_a_lower_ceiling_lowers_scenes_that_say_nothing():
    set_ceiling("force_limit", 20.0)
    held = hold_limits(scene_from_components(), read_ceiling())
    assert held.values == {"force_limit": 20.0} and held.names == {"force_limit"} and held.notes == ()


def test_a_scene_within_the_usual_limits_says_nothing():
    safety = Safety(force_limit=10.0, ramp_time_s=3.0, stale_stop_s=0.01)
    held = hold_limits(scene_from_components(safety=safety, admittance=Admittance()), read_ceiling())
    assert (held.values, held.notes) == ({}, ())
    assert asked_of(safety)["force_limit"] == 10.0


@pytest.mark.parametrize(
    ("content", "what"),
    [
        ("{", "cannot be read"), ("[1]", "holds no object"), ('{"force_limt": 1}', 'no limit "force_limt"'),
        ('{"force_limit": 1e9}', "may not be above 500 N"), ('{"force_limit": "60"}', "must be a number"),
        ('{"force_limit": NaN}', "must be a number"), ('{"force_limit": -1}', "must be a number"),
        ('{"passivity": true}', "must be a number"),
    ],
)  # fmt: skip
def test_a_damaged_file_is_refused_and_never_ignored(tmp_path: Path, content: str, what: str):
    folder = tmp_path / "config" / "mimics"
    folder.mkdir(parents=True)
    (folder / "limits.json").write_text(content)
    with pytest.raises(UsageError, match=what):
        read_ceiling()
    with pytest.raises(UsageError, match=what):
        _prepared(root() / "scenes" / "examples" / "free_objects.json")


def test_the_command_prints_sets_and_puts_back(capsys: pytest.CaptureFixture[str]):
    def limits(*words: str) -> dict[str, float]:
        assert cli.main(["limits", *words, "--json"]) == 0
        return {row["name"]: row["value"] for row in json.loads(capsys.readouterr().out)["limits"]}

    assert limits()["force_limit"] == 80.0
    assert limits("force_limit", "45")["force_limit"] == 45.0
    assert limits("force_limit", "--reset")["force_limit"] == 80.0
    limits("velocity_limit", "1"), limits("ramp_time_s", "2")
    assert limits("--reset") == {name: bound.conservative for name, bound in CEILINGS.items()}
    for words in (["force_limit"], ["force_limit", "1e6"], ["no_limit", "3"], ["force_limit", "3", "--reset"]):
        assert cli.main(["limits", *words]) == 2, words


def test_a_run_says_so_on_the_terminal_and_in_the_report(tmp_path: Path):
    file = _scene(tmp_path, force_limit=500.0)
    runs = tmp_path / "runs"
    answer = mimics("run", str(file), "--headless", "--seconds", "1", "--pictures", "0", "--runs", str(runs))
    assert "this scene goes beyond the usual limits: force_limit 500 N, usually 60 N: held at 80 N" in answer.stderr
    (folder,) = runs.iterdir()
    page = (folder / "report.html").read_text()
    assert "Beyond the usual limits: force_limit 500 N, usually 60 N: held at 80 N on this machine" in page
    assert page_of(Run.open(folder), ()).safety.limits[0].startswith("force_limit")  # type: ignore[union-attr]


def test_check_says_so(tmp_path: Path):
    notes = examine(_scene(tmp_path, late_stop_s=0.9))["notes"]
    assert "late_stop_s 0.9 s, usually 0.05 s: held at 0.05 s on this machine" in notes


def test_the_launcher_says_so_on_the_card_of_a_scene():
    from mimics_app.app.play.launching import launcher_cards

    limits = {card.scene.stem: card.limits for card in launcher_cards(Path("none"))}
    assert limits["kicking"] == "beyond the usual limits: force_limit 80 N, velocity_limit 2.5 m/s"
    assert limits["lokomat_wall"] == "beyond the usual limits: force_limit 80 N"
    assert {name for name, text in limits.items() if text} == {
        "kicking",
        "lokomat_free_swing",
        "lokomat_obstacle",
        "lokomat_wall",
    }


def test_two_programs_that_set_ceilings_at_once_lose_none() -> None:
    code = (
        "import sys; from mimics_app.app.touch.ceilings import set_ceiling\n"
        "for n in range(40): set_ceiling(sys.argv[1], float(sys.argv[2])); set_ceiling(sys.argv[1], None)\n"
        "set_ceiling(sys.argv[1], float(sys.argv[2]))"
    )
    values = {"force_limit": 11.0, "velocity_limit": 0.25}
    setting = [subprocess.Popen([sys.executable, "-c", code, name, str(value)]) for name, value in values.items()]
    assert [each.wait(timeout=120) for each in setting] == [0, 0]
    assert {name: read_ceiling()[name] for name in values} == values
