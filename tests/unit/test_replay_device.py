"""A recording played back on the device `replay` keeps the person who moved the recorded robot."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mimics_app.app.session.header import describe_session
from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.system.resources import root
from tests.support.synthetic_run import write_synthetic_run

SCENE = root() / "scenes" / "wavy_tunnel.json"


@pytest.mark.parametrize(
    "moved_by",
    [
        {"device": "hapticmaster:10.0.0.2", "person": "at the robot"},
        {"device": "simulated_hapticmaster", "person": "simulated", "preset": "severe"},
        {},
    ],
)
def test_the_header_of_a_replay_names_the_person_of_the_recording(moved_by: dict[str, str], tmp_path: Path) -> None:
    write_synthetic_run(tmp_path, 8.0)
    header = tmp_path / "session.json"
    header.write_text(json.dumps(json.loads(header.read_text()) | {"moved_by": moved_by}))
    parts = prepare(RunSettings(SCENE, device="replay", recording=tmp_path), live=False)
    kept = {key: value for key, value in moved_by.items() if key != "device"}
    assert describe_session(parts)["moved_by"] == {"device": "replay", "kind": "simulated_hapticmaster", **kept}


def test_a_simulated_robot_is_moved_by_a_simulated_person() -> None:
    parts = prepare(RunSettings(SCENE, patient="severe"), live=False)
    moved_by = describe_session(parts)["moved_by"]
    assert moved_by == {"device": "simulated_hapticmaster", "person": "simulated", "preset": "severe"}
