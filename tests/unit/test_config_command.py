"""`mimics config`: every value has the origin that set it."""

from __future__ import annotations

import json
import re
from dataclasses import fields

import pytest

from mimics_app.app import cli
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.system.resources import root
from mimics_app.world.components.robot import Safety
from tests.support.command import mimics


def _settings(*words: str) -> dict[tuple[str, str], dict[str, object]]:
    answer = mimics("config", *words, "--headless", "--json")
    assert answer.returncode == 0, answer.stderr
    assert "null" not in answer.stdout
    return {(row["section"], row["name"]): row for row in json.loads(answer.stdout)["settings"]}


def test_every_value_names_what_set_it(tmp_path):
    scene = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    safety = {"force_limit": 25.0, "ramp_force": Safety().ramp_force}
    robot = next(k for k, entity in enumerate(scene["entities"]) if entity.get("prefab") == "robot")
    scene["entities"][robot]["components"] = {"safety": safety}
    scene["systems"] = {"tolerances": {"force_N": 0.2}}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    shown = _settings(str(file), "--profile", "study", "--seed", "7")
    stated = f"{file}#/entities/{robot}/components/safety"
    expected = {
        ("run", "seed"): (7, "", "command line"),
        ("run", "difficulty"): ("usual", "", "default"),
        ("safety", "force_limit"): (25.0, "N", f"{stated}/force_limit"),
        ("safety", "ramp_force"): (Safety().ramp_force, "N", f"{stated}/ramp_force"),
        ("safety", "velocity_limit"): (Safety().velocity_limit, "m/s", "default"),
        ("safety", "late_latches"): (False, "", "device simulated_hapticmaster"),
        ("tolerances", "force_N"): (0.2, "N", f"{file}#/systems/tolerances/force_N"),
        ("tolerances", "angle_rad"): (1e-4, "rad", "profile study"),
    }
    for key, (value, unit, origin) in expected.items():
        assert (shown[key]["value"], shown[key]["unit"], shown[key]["origin"]) == (value, unit, origin), key
    assert "value" not in shown["run", "seconds"]
    hidden = {"despite", "journey"}
    assert {name for section, name in shown if section == "run"} == {f.name for f in fields(RunSettings)} - hidden
    assert {name for section, name in shown if section == "safety"} >= set(Safety.__struct_fields__)
    limits = [row for (section, _), row in shown.items() if section == "safety"]
    for row in [shown["run", name] for name in ("seconds", "size", "baseline_s")] + limits:
        told = re.search(r"\[([^\]]+)\]", str(row["meaning"]))
        assert row["unit"] == ("" if told is None or told[1] == "-" else told[1]), "a unit is that of the description"
    assert shown["run", "display"]["unit"] == "", "KIND[:FILE] is no unit"


@pytest.mark.parametrize(("display", "device"), [("", "simulated_hapticmaster"), (":99", "pointer")])
def test_the_device_is_that_of_a_run_here(monkeypatch, capsys, display, device):
    """Without a display the simulated patient plays; nothing is opened to say so."""
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", display)
    assert cli.main(["config", "wavy_tunnel", "--json"]) == 0
    (row,) = [row for row in json.loads(capsys.readouterr().out)["settings"] if row["name"] == "late_latches"]
    assert row["origin"] == f"device {device}"


def test_a_scene_that_cannot_be_read_is_refused_as_by_run(tmp_path):
    answer = mimics("config", str(tmp_path / "none.json"), "--headless")
    assert answer.returncode == 3 and "none.json" in answer.stderr
